"""The evaluation at one commit: which cases, in which order, at what cost, and the page that is made from them."""

import json
import shutil
from dataclasses import replace
from functools import partial
from itertools import count
from pathlib import Path

import numpy as np
import pytest

from bench.basics.errors import BenchError
from bench.benchmarks.trust import one_case, others
from bench.benchmarks.trust.__main__ import main
from bench.benchmarks.trust.cells import AGAIN, AGAIN_EVERY, APART, TrustCase, TrustCells, changelog_number
from bench.benchmarks.trust.evaluation import Evaluation, read_evaluation
from bench.benchmarks.trust.overview import BEGIN, END, overview, readme_block, with_block
from bench.benchmarks.trust.page import page_text, write_page
from bench.benchmarks.trust.plan import Budget
from bench.benchmarks.trust.questions import QUESTIONS
from bench.benchmarks.trust.run import TABLE, TrustRequest, run_trust, setups_of
from bench.benchmarks.trust.tally import Tally
from bench.benchmarks.trust.work import FRESH, FROZEN, MORE_NOISE, Place, drawn_case, with_more_noise
from bench.dataset.robot import load_robot
from bench.excitation.experiment.plan import Aim, plan_experiment
from bench.excitation.scenario import designer
from bench.scenario.scenario import load_scenario, resolve_trajectories
from bench.studies.sweep.journal import Row
from bench.studies.sweep.pool import LocalPool
from bench.studies.trial.cases import SHARES, SHARES_OF, draw_case
from bench.studies.trial.setup import Setup
from bench.truth.simulate import simulate
from tests.hidden_kit import STEP
from tests.sweep_stand_in import Inline
from tests.trust_stand_in import TrustStandIn

FIRST = 5000
HOUR = 3600.0


@pytest.fixture(scope="module")
def cells() -> TrustCells:
    return TrustCells(setups_of(["two_link", "five_bar"]), FIRST)


def request(cells: TrustCells, hours: float) -> TrustRequest:
    return TrustRequest(cells.setups, "0.0, entry 5", cells.first, hours)


def silent(_tally, _budget):
    return lambda _journal: None


def run(cells, folder, hours, pool=Inline, **accidents):
    """A clock that goes on by a second whenever it is read."""
    work, now = TrustStandIn(cells, **accidents), partial(next, count())
    return read_evaluation(run_trust(request(cells, hours), folder, pool, silent, work=work, now=now))


@pytest.fixture(scope="module")
def whole(cells: TrustCells, tmp_path_factory: pytest.TempPathFactory) -> Evaluation:
    """All cases."""
    return run(cells, tmp_path_factory.mktemp("whole"), hours=1e6)


def test_every_entry_of_the_changelog_has_cases_of_its_own(tmp_path: Path, project_root: Path) -> None:
    path = tmp_path / "CHANGELOG.md"
    path.write_text(
        "# Changelog\n\n## Unreleased\n\n- More.\n  Of it.\n\n## 0.1.0 (2026)\n\n- First.\n- Second.\n"
    )
    number = changelog_number(path)
    assert (number.version, number.entries, number.first) == ("Unreleased", 3, 3 * APART)
    assert changelog_number(project_root / "CHANGELOG.md").first >= 100 * APART
    path.write_text("nothing")
    with pytest.raises(BenchError, match="no line"):
        changelog_number(path)
    with pytest.raises(BenchError, match="no changelog"):
        changelog_number(tmp_path / "none")


def test_a_single_effect_comes_small_and_large(cells: TrustCells) -> None:
    setup = cells.setups["two_link"]
    (cell,) = (
        cell
        for cell in cells.all
        if not cell.frozen and cell.robot == "two_link" and cell.question.kind == "one"
    )
    shares: dict[str, list[float]] = {}
    for number in cell.numbers:
        (hide,) = drawn_case(setup, "one", number).hides
        shares.setdefault(hide.effect, []).append(hide.share)
    for effect, sizes in shares.items():
        low, high = SHARES_OF.get(effect, SHARES)
        small, large = sorted(sizes)
        assert low <= small <= np.sqrt(low * high) * 1.001 <= large * 1.002
        assert large <= high
    assert drawn_case(setup, "one", 3) == draw_case(setup, "one", 3)
    assert drawn_case(setup, "two", cell.numbers[0]) == draw_case(setup, "two", cell.numbers[0])


def test_single_effects_come_once_each_before_any_comes_twice(cells: TrustCells) -> None:
    for cell in cells.all:
        if cell.question.kind == "one" and not cell.frozen:
            setup = cells.setups[cell.robot]
            hidden = [draw_case(setup, "one", number).effects[0] for number in cell.numbers]
            half = len(setup.catalogued)
            assert len(hidden) == 2 * half
            assert sorted(hidden[:half]) == sorted(hidden[half:]) == sorted(setup.catalogued)


def test_fresh_cases_begin_at_their_number_and_frozen_ones_at_none(cells: TrustCells) -> None:
    assert {cell.frozen for cell in cells.all} == {True, False}
    for cell in cells.all:
        assert len(set(cell.numbers)) == len(cell.numbers) > 0
        assert (min(cell.numbers) >= FIRST) is not cell.frozen
        for position in (0, len(cell.numbers) - 1):
            case = TrustCase(cell, position)
            assert cells.case_of_row(case.row) == case


def test_cases_go_where_the_interval_is_farthest_from_what_it_is_to_be(cells: TrustCells) -> None:
    tally = Tally(cells)
    first = [case for _ in range(4) for case in tally.next_block()]
    assert len({case.cell.index for case in first}) == len(cells.all)  # one of each before any second
    stand_in = TrustStandIn(cells)
    nothing = next(case for case in first if case.cell.question.kind == "nothing" and not case.cell.frozen)
    for case in first:
        if case is not nothing:
            tally.note(stand_in.row(case))
    following = tally.next_block()
    assert len({case.cell.robot for case in following}) == 1
    assert len({case.row for case in (*first, *following)}) == len(first) + len(following)


def test_a_robot_whose_cases_cost_more_gets_fewer(cells: TrustCells) -> None:
    tally, stand_in, cost = Tally(cells), TrustStandIn(cells), {"two_link": 1.0, "five_bar": 16.0}
    for _ in range(40):
        for case in tally.next_block():
            tally.note(stand_in.row(case) | {"seconds": cost[case.cell.robot]})
    finished = {
        robot: sum(tally[cell].finished for cell in cells.all if cell.robot == robot) for robot in cost
    }
    assert 2.0 < finished["two_link"] / finished["five_bar"] < 8.0


def test_the_budget_is_of_all_workers_and_counts_earlier_starts() -> None:
    clock = [100.0]
    budget = Budget(1.0, 1000.0, lambda: 2, lambda: clock[0])
    assert budget.seconds == HOUR - 500.0
    clock[0] += 3000.0
    assert budget.seconds == 100.0
    assert not budget.full(199.0)
    assert budget.full(200.0)


def test_all_is_run_once_and_the_page_has_all_of_it(cells: TrustCells, whole: Evaluation) -> None:
    evaluation = whole
    planned = sum(len(cell.numbers) for cell in cells.all)
    assert len(evaluation.rows) == planned == sum(cell.planned for cell in evaluation.cells)
    assert (
        len({(row["robot"], row["question"], row["set"], row["number"]) for row in evaluation.rows})
        == planned
    )
    again = [row for row in evaluation.rows if row["sure.noise"] is not None]
    assert {row["set"] for row in again} == {FRESH}
    assert {row["run"] % AGAIN_EVERY for row in again} == {0}
    page = page_text(evaluation, [])
    assert ", interval" not in page.partition("## Cost")[2].partition("## The frozen")[0]
    for question in QUESTIONS.values():
        assert question.title in page
    wrong = [
        row
        for row in evaluation.rows
        if not row["first"] and row["question"] == "one" and row["set"] == FRESH
    ]
    assert wrong
    for row in wrong:
        assert f"`{row['robot']}/one/{row['number']}`" in page


def test_a_small_budget_leaves_cases_out_and_the_page_says_so(cells: TrustCells, tmp_path: Path) -> None:
    evaluation = run(cells, tmp_path, hours=100.0 / HOUR)
    assert 10 <= len(evaluation.rows) < 300
    assert "interval" in page_text(evaluation, []).partition("## Cost")[2].partition("## The frozen")[0]
    more = run(
        cells, tmp_path, hours=(100.0 + 10.0 * len(evaluation.rows)) / HOUR
    )  # each took ten seconds, it says
    rows = {row["run"]: row for row in more.rows}
    assert all(rows[row["run"]] == row for row in evaluation.rows)  # kept, not run again
    assert len(more.rows) > len(evaluation.rows)
    written = write_page(tmp_path / TABLE)
    assert all(path.is_file() for path in written)
    assert {path.name for path in written} == {TABLE, "trust.md", "reliability.png", "coverage.png"}


def test_another_commit_or_plan_is_refused(cells: TrustCells, tmp_path: Path) -> None:
    run(cells, tmp_path, hours=1.0 / HOUR)
    with pytest.raises(BenchError, match="another evaluation"):
        run(replace(cells, first=FIRST + APART), tmp_path, hours=1.0 / HOUR)


def test_a_killed_worker_changes_nothing(cells: TrustCells, whole: Evaluation, tmp_path: Path) -> None:
    marks = tmp_path / "marks"
    marks.mkdir()
    there = run(cells, tmp_path / "there", 1e6, lambda: LocalPool(2), killed_once=(3, 2001), marks=marks)
    assert len(list(marks.iterdir())) == 2
    assert there.rows == whole.rows


def test_a_table_of_something_else_is_refused(tmp_path: Path) -> None:
    with pytest.raises(BenchError, match="is no table"):
        read_evaluation(tmp_path / "none.parquet")


def test_the_frozen_set_is_shown_apart(whole: Evaluation) -> None:
    fresh = replace(whole, rows=tuple(row for row in whole.rows if row["set"] != FROZEN))
    assert overview(fresh) == overview(whole)
    assert overview(fresh, frozen=True) != overview(whole, frozen=True)


def test_the_table_of_the_readme_has_no_blank_and_replaces_the_one_before(whole: Evaluation) -> None:
    block = readme_block(whole)
    table = [line.split("|")[1:-1] for line in block.splitlines() if line.startswith("|")]
    assert len(table) == 3 + len(QUESTIONS)
    assert {len(line) for line in table} == {2 + len(whole.robots)}
    assert all(cell.strip() for line in table[2:] for cell in line)
    text = with_block(f"before\n{BEGIN}\nold\n{END}\nafter\n", block)
    assert text == f"before\n{BEGIN}\n{block}\n{END}\nafter\n"
    assert with_block(text, block) == text
    with pytest.raises(BenchError, match="no <!-- evaluation -->"):
        with_block("nothing", block)


def test_more_noise_is_a_quarter_of_the_noise_and_always_the_same() -> None:
    scenario = load_scenario("two_link", {"design": {"duration": 4.0, "optimise": False}, "step": STEP})
    simulation = simulate(scenario, resolve_trajectories(scenario, designer))
    noisy, again = with_more_noise(simulation), with_more_noise(simulation)
    for before, after, same in zip(simulation.recordings, noisy.recordings, again.recordings, strict=True):
        added = after.log.current - before.log.current
        noise = before.log.current - before.current
        assert np.std(added, axis=0) == pytest.approx(MORE_NOISE * np.std(noise, axis=0), rel=0.1)
        assert (after.log.current == same.log.current).all()
        assert (after.log.position == before.log.position).all()


@pytest.mark.parametrize("name", ["five_bar", "five_bar/one", "five_bar/four/3", "five_bar/one/first"])
def test_a_case_without_a_number_is_refused(name: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["--case", name]) == 2
    assert "give ROBOT/QUESTION/NUMBER" in " ".join(capsys.readouterr())


def test_a_case_of_a_robot_folder_or_scenario_is_run(
    tmp_path: Path, project_root: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Its name is that of the robot or, as before `--also`, the folder itself."""
    ran = []

    def rows(setup: Setup, place: Place, *_: object) -> list[Row]:
        ran.append((setup.name, place["robot"]))
        return [{"hidden": "", "status": "failed", "reason": "not run"}]

    monkeypatch.setattr(one_case, "case_rows", rows)
    monkeypatch.setattr(one_case, "trial_trajectories", lambda _: None)
    monkeypatch.setattr(one_case, "hidden_text", lambda _: "nothing")
    folder = str(shutil.copytree(project_root / "robots" / "two_link", tmp_path / "copy"))
    scenario = tmp_path / "planned.toml"
    scenario.write_text(f'base = "two_link"\nrobot = "{folder}"\n')
    for name, also in ((folder, []), ("two_link", [str(scenario)]), ("two_link", [])):
        assert list(one_case.case_lines(f"{name}/nothing/3", also, tmp_path)) == [
            "hidden: nothing",
            "failed: not run",
        ]
    assert ran == [("two_link", folder), ("two_link", "two_link"), ("two_link", "two_link")]


def test_robots_of_other_people_join_where_they_are_present(
    tmp_path: Path, project_root: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """As copies without friction, with planned motions; a second call plans nothing."""
    given = shutil.copytree(project_root / "robots" / "two_link", tmp_path / "data" / "foreign" / "g1_ankle")
    file = load_robot(given).model_path
    file.write_text(file.read_text().replace("<joint ", '<joint frictionloss="0.1" damping="0.2" '))
    monkeypatch.setenv("PARABENCH_DATA", str(tmp_path / "data"))
    monkeypatch.setattr(others, "plan_experiment", partial(plan_experiment, aim=Aim(steps=1)))
    (scenario,) = others.scenarios_of_others(tmp_path / "prepared")
    (setup,) = setups_of([scenario]).values()
    model = load_robot(setup.content["robot"]).mjcf_model()
    assert not model.dof_frictionloss.any()
    assert not model.dof_damping.any()
    assert [recording["name"] for recording in setup.content["recordings"]][:2] == ["unloaded", "loaded"]
    monkeypatch.delattr(others, "plan_experiment")
    assert others.scenarios_of_others(tmp_path / "prepared") == [scenario]
    monkeypatch.setenv("PARABENCH_DATA", str(tmp_path))
    assert others.scenarios_of_others(tmp_path / "prepared") == []


@pytest.mark.slow
def test_real_machines_are_simulated_diagnosed_and_shown(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A case with nothing hidden and one with an effect, which the budget allows; with workers of this machine."""
    monkeypatch.setattr("bench.benchmarks.trust.tally.BLOCK", 2)
    request = TrustRequest(setups_of(["two_link"], duration=6.0), "0.0, entry 5", FIRST, 10.0 / HOUR)
    table = run_trust(request, tmp_path, lambda: LocalPool(2), silent, now=partial(next, count()))
    evaluation = read_evaluation(table)
    assert [row["question"] for row in evaluation.rows] == ["nothing", "one"]
    for row in evaluation.rows:
        assert row["status"] == "ok"
        assert row["seconds"] > 0.0
        assert json.loads(row["gains"])[0].keys() == {"joint", "truth", "value", "std"}
        assert all(0.0 <= p <= 1.0 for p in json.loads(row["probabilities"]).values())
        assert (row["sure.noise"] is not None) is (row["question"] in AGAIN)
    assert all(path.is_file() for path in write_page(table))
