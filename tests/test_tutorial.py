"""The tutorial of the README: its commands run in its order, and say what it says they say."""

import json
import math
import re
import shlex

import pytest

from bench.cli import main

SECTION = re.compile(r"## What is my model missing\?\n(.*?)\n## ", flags=re.DOTALL)
NUMBER = re.compile(r"[-+−]?\d+(?:\.\d+)?")
DRAWN = re.compile(r"[█-▏─•]+")  # bars, rules and bullets
CLOSE = 0.05  # relative: the words are held to the letter, numbers to what another rounding may change


@pytest.fixture(scope="module")
def blocks(project_root):
    """(language, text) of every block of the section."""
    (section,) = SECTION.findall((project_root / "README.md").read_text(encoding="utf-8"))
    return re.findall(r"```(\w+)\n(.*?)```", section, flags=re.DOTALL)


def words(text):
    return DRAWN.sub(" ", text).split()


def masked(tokens):
    return [NUMBER.sub("#", token) for token in tokens]


def said(shown, printed):
    """The part of what was printed that has the words of what is shown, whatever its numbers."""
    wanted, there = masked(words(shown)), masked(words(printed))
    for start in range(len(there) - len(wanted) + 1):
        if there[start : start + len(wanted)] == wanted:
            return words(printed)[start : start + len(wanted)]
    return None


@pytest.mark.slow
def test_the_commands_run_and_say_what_is_shown(blocks, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    printed, shown = "", 0
    for language, text in blocks:
        if language == "sh":
            for command in text.strip().splitlines():
                program, *arguments = shlex.split(command)
                assert program == "bench"
                assert main(arguments) == 0
                printed = capsys.readouterr().out
            continue
        assert language == "text"
        # a block of sentences is held line by line, as bullets stand between them
        whole = (
            [text] if "noise of the currents" in text or "falls from" in text else text.strip().splitlines()
        )
        for part in whole:
            found = said(part, printed)
            assert found is not None, f"not said: {part}"
            numbers = [float(one.replace("−", "-")) for one in NUMBER.findall(" ".join(words(part)))]
            now = [float(one.replace("−", "-")) for one in NUMBER.findall(" ".join(found))]
            assert all(math.isclose(a, b, rel_tol=CLOSE) for a, b in zip(numbers, now, strict=True)), part
            shown += 1
    assert shown >= 6
    folder = tmp_path / "results" / "tutorial"
    truth = json.loads((folder / "data.truth.json").read_text())
    model = json.loads((folder / "model.json").read_text())
    hidden = {one["effect"]: one for one in truth["hidden"]}
    for effect, parameter in (("coulomb_friction", "Fc"), ("viscous_friction", "Fv")):
        found = model["effect_parameters"][effect]["left"][parameter]["value"]
        assert found == pytest.approx(hidden[effect][parameter], rel=0.01)
    gain = model["drive_gains"]["left"]["value"]
    assert gain == pytest.approx(truth["drive_gains"]["left"]["true"], rel=0.002)
    pictures = {path.name for path in folder.rglob("*.png")}
    assert {"errors_left.png", "ladder.png", "gains.png", "errors.png"} <= pictures


def test_a_block_is_found_with_other_numbers_but_not_with_other_words():
    printed = "• motor left: error 10 %, 61.2 times\n  the noise ██▎ -3"
    assert said("motor left: error 9.9 %, 60 times the noise", printed)[3] == "10"
    assert said("motor left: error 9.9 %, 60 times the current", printed) is None
