"""bench check: alarms where something got worse, and only there."""

import dataclasses
import json
from io import StringIO

import numpy as np
import pytest
from rich.console import Console

from bench.basics.errors import BenchError
from bench.cli import main
from bench.studies.sweep import check as command
from bench.studies.sweep.check import CheckOptions, check_accuracy, update_reference
from bench.studies.sweep.reference import (
    ReferenceLine,
    compare_line,
    load_reference,
    reference_folder,
    reference_sweeps,
    save_reference,
)
from tests.sweep_stand_in import Inline, StandIn

SWEEP = """
base = "five_bar"
seeds = 12
quick = 4
[axes]
method = ["ls", "current"]
[tolerances]
gain_error = 0.5
"""


@pytest.fixture(autouse=True)
def in_this_process(monkeypatch):
    monkeypatch.setattr(command, "LocalPool", lambda workers: Inline())


@pytest.fixture
def options(tmp_path):
    (tmp_path / "scenarios").mkdir()
    (tmp_path / "scenarios" / "small.toml").write_text(SWEEP)
    return CheckOptions(reference=tmp_path / "reference", scenarios=tmp_path / "scenarios")


@dataclasses.dataclass(frozen=True)
class Changed(StandIn):
    """The stand-in with its gain errors changed: by method, for the runs it has."""

    factor: float = 1.0
    only: str = ""
    fails: bool = False

    def runs(self, runs, trajectories):
        return ChangedRuns(super().runs(runs, trajectories), self.factor, self.only, self.fails)


@dataclasses.dataclass(frozen=True)
class ChangedRuns:
    """Rows of the stand-in, changed."""

    inner: object
    factor: float
    only: str
    fails: bool

    def __call__(self, shared):
        rows = self.inner(shared)
        for row in rows:
            if self.only in ("", row["method"]):
                row["gain_error"] *= 0.001 * self.factor
                if self.fails and row["seed"] == 2:
                    row |= {"status": "failed", "reason": "no more", "gain_error": None}
            else:
                row["gain_error"] *= 0.001
        return rows


def checked(options, **changes):
    """Exit code and text of a check."""
    console = Console(file=StringIO(), width=120)
    code = check_accuracy(options, console, lambda sweep: Changed(**changes))
    return code, console.file.getvalue()


@pytest.fixture
def with_reference(options):
    everything = dataclasses.replace(options, full=True)
    update_reference(everything, "first of all", Console(file=StringIO()), lambda sweep: Changed())
    return options


@pytest.mark.parametrize("full", [False, True])
def test_unchanged_is_silent(with_reference, full):
    code, text = checked(dataclasses.replace(with_reference, full=full))
    assert code == 0
    assert text.strip().endswith("0 worse, 0 better, 2 as before")
    assert "gain_error" not in text


def test_all_figures_on_request(with_reference):
    _, text = checked(dataclasses.replace(with_reference, verbose=True))
    assert text.count("gain_error") == 2
    assert text.count("same") == 2


def test_worse_is_an_alarm_that_names_scenario_metric_and_size(with_reference):
    code, text = checked(with_reference, factor=3.0, only="ls")
    assert code == 1
    (row,) = [line for line in text.splitlines() if "worse" in line and "gain_error" in line]
    assert "small, method = ls" in text
    assert "method = current" not in text
    assert "σ" in row
    assert "1 worse, 0 better, 1 as before" in text
    assert "\nnext: bench check --full --verbose --only small    " in text


def test_better_is_told_and_no_alarm(with_reference):
    code, text = checked(with_reference, factor=0.1)
    assert code == 0
    assert "0 worse, 2 better, 0 as before" in text


def test_a_run_that_fails_now_is_an_alarm(with_reference):
    code, text = checked(with_reference, fails=True)
    assert code == 1
    assert "+inf σ" in text


def test_no_run_may_exceed_the_tolerance_of_its_scenario(options):
    update_reference(
        options, "bad from the start", Console(file=StringIO()), lambda sweep: Changed(factor=20)
    )
    code, text = checked(options, factor=20)
    assert code == 1
    assert "over its limit" in text


def test_a_scenario_without_reference_is_an_alarm(options):
    code, text = checked(options)
    assert code == 1
    assert "small: has no reference yet" in text


def test_a_changed_scenario_is_an_alarm_until_the_reference_is_updated(with_reference):
    path = with_reference.scenarios / "small.toml"
    path.write_text(SWEEP.replace("[axes]", "[scenario.sensors]\nencoder_bits = 14\n[axes]"))
    code, text = checked(with_reference)
    assert code == 1
    assert "small: its scenario has changed" in text


def test_the_reason_goes_into_the_reference(with_reference):
    content = json.loads((with_reference.reference / "small.json").read_text())
    assert content["reason"] == "first of all"
    assert set(content["program"]) >= {"commit", "version.mujoco"}
    with pytest.raises(BenchError, match="--reason"):
        update_reference(with_reference, " ", Console(file=StringIO()), lambda sweep: Changed())
    assert main(["check", "--update"]) == 2


def test_a_reference_survives_being_written_and_read(with_reference):
    path = with_reference.reference / "small.json"
    reference = load_reference(path)
    assert list(reference.lines) == ["method = ls", "method = current"]
    assert reference.lines["method = ls"].seeds == tuple(range(1, 13))
    before = path.read_bytes()
    save_reference(path, reference)
    assert path.read_bytes() == before


def test_a_spoilt_reference_is_refused(with_reference):
    (with_reference.reference / "small.json").write_text("{}")
    with pytest.raises(BenchError, match=r"small\.json: is not a reference"):
        checked(with_reference)


@dataclasses.dataclass(frozen=True)
class Counted(StandIn):
    """The stand-in, which notes the designs that it was asked for."""

    designs: list = dataclasses.field(default_factory=list)

    def design(self, run):
        self.designs.append(run.design)
        return super().design(run)


def test_trajectories_that_several_scenarios_need_are_designed_once(options):
    (options.scenarios / "other.toml").write_text(SWEEP.replace("seeds = 12", "seeds = 6"))
    (options.scenarios / "robot.toml").write_text(SWEEP.replace("five_bar", "two_link"))
    work = Counted()
    update_reference(options, "three sweeps", Console(file=StringIO()), lambda sweep: work)
    assert len(work.designs) == len(set(work.designs)) == 2
    assert {path.stem for path in options.reference.glob("*.json")} == {"small", "other", "robot"}


def test_an_unknown_scenario_is_named(with_reference):
    with pytest.raises(BenchError, match="no reference scenario 'big'"):
        checked(dataclasses.replace(with_reference, only=("big",)))


def line_of(metric, values):
    return ReferenceLine(tuple(range(len(values))), {metric: tuple(values)})


def test_change_is_in_units_of_the_spread_from_seed_to_seed():
    values = np.random.default_rng(1).normal(5, 2, 400)
    (one,) = compare_line(
        "s", "", line_of("gain_rms", values), line_of("gain_rms", values + 1), {"gain_rms": 1}, {}
    )
    assert one.change == pytest.approx(0.5, rel=0.1)
    assert one.verdict == "same"


@pytest.mark.parametrize(("before", "after", "sign"), [(0.95, 0.85, 1), (0.85, 0.95, -1), (0.95, 1.0, 1)])
def test_coverage_is_best_at_its_nominal_value(before, after, sign):
    def hits(share):
        return [1.0] * round(200 * share) + [0.0] * round(200 * (1 - share))

    (one,) = compare_line(
        "s",
        "",
        line_of("gain_within", hits(before)),
        line_of("gain_within", hits(after)),
        {"gain_within": 1},
        {},
    )
    assert np.sign(one.change) == sign
    assert abs(one.change) > 3


def test_the_project_has_references_for_all_its_scenarios(project_root):
    if not any((project_root / "results" / "reference").glob("*.json")):
        pytest.skip("no reference is written yet: bench check --update --reason ... writes it")
    names = set(reference_sweeps())
    assert {path.stem for path in reference_folder().glob("*.json")} == names
    for name in names:
        assert load_reference(reference_folder() / f"{name}.json").reason
