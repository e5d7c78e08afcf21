"""What is seen of a sweep while it runs."""

from dataclasses import dataclass, field
from io import StringIO

import pytest
from rich.console import Console

from bench.studies.sweep import progress
from bench.studies.sweep.progress import duration_text, rate_text, shown_progress


@dataclass
class Counts:
    """Stands for a journal."""

    count: int = 0
    failed: set = field(default_factory=set)


@pytest.fixture
def clock(monkeypatch):
    """A clock that is set by hand."""
    now = [100.0]
    monkeypatch.setattr(progress.time, "monotonic", lambda: now[0])
    return now


def test_without_a_terminal_a_line_says_rate_time_left_and_failures(clock):
    console = Console(file=StringIO(), width=100)
    with shown_progress(console, 1000) as report:
        report(Counts(200))  # kept from an earlier start: they say nothing about the rate
        clock[0] += 10
        report(Counts(250))
        clock[0] += 30
        report(Counts(400, {1, 2}))
        clock[0] += 1
        report(Counts(401, {1, 2}))
    lines = console.file.getvalue().splitlines()
    assert lines == ["400 of 1000 runs, 5.0 runs/s, 2 min left, 2 failed"]


def test_on_a_terminal_a_bar_says_the_same():
    console = Console(file=StringIO(), width=120, force_terminal=True)
    with shown_progress(console, 10) as report:
        report(Counts(0))
        report(Counts(7, {3}))
    text = console.file.getvalue()
    assert "7/10" in text
    assert "1 failed" in text
    assert "left" in text


@pytest.mark.parametrize(("finished", "said"), [(2, True), (3, False)])
def test_until_the_first_run_the_bar_says_what_goes_on(finished, said):
    console = Console(file=StringIO(), width=120, force_terminal=True)
    with shown_progress(console, 10) as report:
        report(Counts(2))  # kept from an earlier start
        report(Counts(finished))
        report.phase("designing trajectories")
    last = console.file.getvalue().rpartition("2K")[2]  # where the last drawing of the bar begins
    assert ("designing trajectories" in last) == said
    assert ("runs" in last) != said


def test_a_quiet_console_shows_nothing():
    for terminal in (True, False):
        console = Console(file=StringIO(), force_terminal=terminal, quiet=True)
        with shown_progress(console, 10) as report:
            report.phase("starting workers")
            report(Counts(7, {3}))
        assert console.file.getvalue() == ""


@pytest.mark.parametrize(
    ("seconds", "text"), [(0.4, "0 s"), (99, "99 s"), (600, "10 min"), (5999, "100 min"), (7200, "2.0 h")]
)
def test_durations(seconds, text):
    assert duration_text(seconds) == text


@pytest.mark.parametrize(("rate", "text"), [(0, ""), (2.5, "2.5 runs/s"), (0.1, "6.0 runs/min")])
def test_rates(rate, text):
    assert rate_text(rate) == text
