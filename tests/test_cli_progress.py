"""Long work says what it is doing on a terminal, and nothing elsewhere."""

import os
import pty
import select
import signal
import subprocess
import sys
import time
from contextlib import suppress

import pytest

from bench.basics.errors import BenchError
from bench.benchmarks.speed.start_up import until_words
from bench.cli import main
from bench.cli.progress import progress_to, shown_progress
from bench.cli.termination import leaving_on_termination

PATIENCE = 60.0  # s: a machine that does other work as well is slow to start a process
FIRST = {
    "simulate": ["simulate", "tutorial", "-o", "{folder}/out"],
    "diagnose": ["diagnose", "{data}"],
    "report": ["report", "{data}", "-o", "{folder}/page.html"],
    "discriminate": [
        "discriminate",
        "{data}",
        "coulomb_friction",
        "viscous_friction",
        "-o",
        "{folder}/motion",
    ],
    "trial": ["trial", "five_bar", "--kinds", "nothing", "--seeds", "1", "-o", "{folder}/trial"],
    "sweep": ["sweep", "five_bar_seeds", "-o", "{folder}/sweep", "--workers", "1"],
}


BRIEF = """
base = "tutorial"
[design]
optimise = false
duration = 6.0
"""


@pytest.fixture(scope="module")
def brief(tmp_path_factory):
    """A scenario that is soon simulated."""
    file = tmp_path_factory.mktemp("scenario") / "brief.toml"
    file.write_text(BRIEF)
    return file


@pytest.fixture(scope="module")
def data(brief):
    assert main(["simulate", str(brief), "-o", str(brief.with_name("data"))]) == 0
    return brief.with_name("data")


def shown(arguments, until):
    """What a command writes to a terminal on its standard error, until that has every one of the words."""
    ours, theirs = pty.openpty()
    command = [sys.executable, "-m", "bench", *arguments]
    text, end = "", time.monotonic() + PATIENCE
    environment = {**os.environ, "TERM": "xterm", "COLUMNS": "160"}
    with subprocess.Popen(command, stderr=theirs, stdout=subprocess.DEVNULL, env=environment) as process:
        os.close(theirs)
        while not all(word in text for word in until) and time.monotonic() < end:
            if select.select([ours], [], [], 1.0)[0]:
                try:
                    text += os.read(ours, 65536).decode(errors="replace")
                except OSError:  # the command has ended
                    break
        process.terminate()
    os.close(ours)
    return text


def arguments(name, folder, data):
    return [word.format(folder=folder, data=data) for word in FIRST[name]]


@pytest.mark.parametrize(
    ("name", "phases", "steps"),
    [
        ("simulate", ["starting", "designing trajectories", "simulating"], ["/132", "left"]),
        ("trial", ["starting", "designing trajectories"], []),
        ("sweep", ["starting", "designing trajectories"], []),
    ],
)
def test_a_terminal_shows_the_phases_from_the_beginning(name, phases, steps, tmp_path, data):
    """And, where it has any, the steps and the time left."""
    text = shown(arguments(name, tmp_path, data), [*phases, *steps])
    assert all(step in text for step in steps)
    places = [text.find(phase) for phase in phases]
    assert -1 not in places, text
    assert places == sorted(places)


class SeenError(Exception):
    """Enough was told."""


class Until:
    """Progress that keeps the phases, and ends the command at the last of them."""

    def __init__(self, phases):
        self.phases, self.told = phases, []

    def phase(self, name, total=None):
        self.told.append(name)
        if name.startswith(self.phases[-1]):
            raise SeenError

    def advance(self, steps=1):
        """Not what is looked at."""


@pytest.mark.parametrize(
    ("name", "phases"),
    [
        ("diagnose", ["starting", "reading the recordings", "searching, round 1"]),
        ("report", ["starting", "reading the recordings"]),
        ("discriminate", ["starting", "fitting both models"]),
    ],
)
def test_commands_that_share_their_bar_tell_their_phases_from_the_beginning(name, phases, tmp_path, data):
    heard = Until(phases)
    with pytest.raises(SeenError), progress_to(heard):
        main(arguments(name, tmp_path, data))
    assert heard.told[0] == phases[0]
    places = [heard.told.index(next(told for told in heard.told if told.startswith(one))) for one in phases]
    assert places == sorted(places)


@pytest.mark.parametrize("name", ["diagnose", "report", "discriminate"])
def test_their_first_words_stand_on_a_terminal(name, tmp_path, data):
    assert until_words(arguments(name, tmp_path, data)) > 0.0


def test_a_command_that_says_nothing_of_its_progress_has_no_first_words(tmp_path):
    with pytest.raises(BenchError, match=r"bench table .*: says nothing of its progress: .*no_such"):
        until_words(["table", str(tmp_path / "no_such")])


def test_nothing_is_shown_when_piped(tmp_path, brief, capfd):
    assert main(["simulate", str(brief), "-o", str(tmp_path / "out")]) == 0
    assert capfd.readouterr().err == ""


def test_nothing_is_shown_when_quiet(tmp_path, brief):
    words = ["simulate", str(brief), "-o", str(tmp_path / "out"), "--quiet"]
    assert shown(words, ["never"]) == ""
    assert (tmp_path / "out" / "dataset.toml").is_file()


@pytest.mark.parametrize("name", FIRST)
def test_long_commands_can_be_quiet(name, capsys):
    assert main([name, "--help"]) == 0
    assert "--quiet" in capsys.readouterr().out


def test_a_termination_that_was_lost_is_repeated_by_progress():
    """As where the signal arrives in a callback of the garbage collector, which drops the exception."""
    said = []
    with (
        pytest.raises(SystemExit, match="143"),
        leaving_on_termination(lambda: said.append("terminated")),
        shown_progress(quiet=True) as progress,
    ):
        progress.phase("before")
        with suppress(SystemExit):
            signal.raise_signal(signal.SIGTERM)
        progress.advance()
        pytest.fail("not reached")
    assert said == ["terminated"]
    with leaving_on_termination(lambda: None), shown_progress(quiet=True) as progress:
        progress.phase("another command")
