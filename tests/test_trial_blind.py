"""A blind trial from end to end, small enough for every run of the tests; and its machinery."""

import json
from dataclasses import replace
from pathlib import Path

import pytest

from bench.basics.errors import BenchError
from bench.cli import main
from bench.effects.display_names import spoken
from bench.studies.sweep.journal import Journal, Row
from bench.studies.sweep.pool import Pool
from bench.studies.sweep.run_plan import Report
from bench.studies.sweep.table import read_table
from bench.studies.trial.cases import TrialPlan, draw_case
from bench.studies.trial.run_trial import TrialRequest, read_rows, run_trial
from bench.studies.trial.setup import Setup, make_setup
from bench.studies.trial.summary import LARGE
from bench.studies.trial.work import case_rows, trial_trajectories, undisturbed
from tests.sweep_stand_in import Inline

DURATION = 8.0
EFFECTS = ("load_dependent_friction", "torque_ripple")


def _silent(_: TrialPlan) -> Report:
    def report(_: Journal) -> None:
        return

    return report


def _no_pool() -> Pool:
    raise AssertionError("everything is there already")


@pytest.fixture(scope="module")
def setup() -> Setup:
    return make_setup("five_bar", duration=DURATION)


@pytest.fixture(scope="module")
def trial(setup: Setup, tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, list[Row]]:
    """The folder and the rows of a trial of EFFECTS."""
    folder = tmp_path_factory.mktemp("trial")
    return folder, run_trial(TrialRequest(setup, ("one",), 1, EFFECTS), folder, Inline, _silent)


def test_single_effects_are_named(trial: tuple[Path, list[Row]]) -> None:
    _, rows = trial
    assert [row["status"] for row in rows] == ["ok"] * len(EFFECTS)
    assert [row["hidden"] for row in rows] == list(EFFECTS)
    for row in rows:
        assert row["least_own_error_over_floor"] >= LARGE
        assert row["missing"].split(" + ")[0] == row["hidden"]
        assert row["first"]
        assert row["error_over_floor.after"] < row["error_over_floor.before"]
        assert json.loads(row["intervals"])


def test_an_empty_machine_raises_no_alarm_and_has_no_law(setup: Setup) -> None:
    setup = replace(setup, discover=True)
    trajectories = trial_trajectories(setup)
    reference = undisturbed(setup, trajectories)
    row = case_rows(setup, draw_case(setup, "nothing", 0), 0, trajectories, reference)[0]
    assert row["missing"] == ""
    assert row["laws"] == 0
    assert not row["unexplained"]


def test_a_finished_trial_is_not_run_again(setup: Setup, trial: tuple[Path, list[Row]]) -> None:
    folder, rows = trial
    assert run_trial(TrialRequest(setup, ("one",), 1, EFFECTS), folder, _no_pool, _silent) == rows
    with pytest.raises(BenchError, match="another trial"):
        run_trial(TrialRequest(setup, ("one",), 1, EFFECTS[:1]), folder, _no_pool, _silent)


def test_workers_give_the_same_rows_and_the_command_writes_them(
    trial: tuple[Path, list[Row]], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    effect = EFFECTS[0]
    options = ["--effects", effect, "--kinds", "one", "--seeds", "1", "--duration", str(DURATION)]
    assert main(["trial", "five_bar", *options, "--workers", "1", "-o", str(tmp_path)]) == 0
    told = capsys.readouterr().out
    step = told.splitlines()[-1]
    assert step.startswith(
        f"next: bench trial five_bar --effects {effect} --kinds one --duration {DURATION:g} --seeds 2 -o "
    )
    (row,) = read_rows(tmp_path / "five_bar")
    apart = {"commit": "", "drawn_from": effect}  # files may change while tests run; of two effects there
    assert row | apart == trial[1][0] | apart
    table = read_table(tmp_path / "five_bar.parquet")
    assert table["hidden"] == [effect]
    assert table["drawn_from"] == [effect]
    page = (tmp_path / "five_bar.md").read_text(encoding="utf-8")
    assert f"| {spoken(effect)} | 1 |" in page
    assert (tmp_path / "five_bar_confusion.png").is_file()
    kept = json.loads((tmp_path / "five_bar" / "one.json").read_text(encoding="utf-8"))
    assert kept["given"] == {"robot": "five_bar", "duration": DURATION}
    assert spoken(effect)[:12] in told


def test_a_wrong_request_is_one_line(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    for options, culprit in (
        (["--kinds", "four"], "four"),
        (["--effects", "nonsense"], "nonsense"),
        (["--effects", "viscous_friction", "--kinds", "outside"], "none of these effects"),
    ):
        assert main(["trial", "five_bar", *options, "-o", str(tmp_path / "x")]) == 2
        error = capsys.readouterr().err
        assert culprit in error
        assert error.count("\n") == 1
    assert not (tmp_path / "x").exists()


@pytest.mark.parametrize("quiet", [[], ["-q"]])
def test_a_scenario_that_no_case_can_use_is_refused_once_and_at_once(
    quiet: list[str], tmp_path: Path, project_root: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    scenario = tmp_path / "coarse.toml"
    text = (project_root / "scenarios" / "emps.toml").read_text(encoding="utf-8")
    scenario.write_text(text.replace("encoder_resolution = 1e-6\n", ""), encoding="utf-8")
    words = ["trial", "emps", "--scenario", str(scenario), "--kinds", "nothing", "-o", str(tmp_path / "out")]
    assert main([*words, *quiet]) == 2
    out, err = capsys.readouterr()
    assert out == ""
    assert err.count("\n") == 1
    assert "add `encoder_resolution = { axis = 1e-6 }` (m, from your data sheets)" in err
    assert not (tmp_path / "out").exists()


def test_that_all_came_to_nothing_is_said_where_all_else_is_quiet(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    failed = [{"kind": "nothing", "run": k, "status": "failed", "reason": "it diverges"} for k in range(3)]
    monkeypatch.setattr("bench.studies.trial.command.run_trial", lambda *_: failed)
    monkeypatch.setattr("bench.page.write_studies.write_trial_report", lambda _, page: page)
    words = ["trial", "five_bar", "--kinds", "nothing", "-q", "-o", str(tmp_path)]
    assert main(words) == 1
    out, err = capsys.readouterr()
    assert (out, err) == ("", "bench: all 3 datasets came to nothing: it diverges\n")
