"""What a run costs beside its own work: the measurement, and that it does not grow with what is under way."""

import json

from bench.benchmarks.speed import scheduling
from bench.benchmarks.speed.scheduling import COST_LIMIT, GROWTH_LIMIT, Scheduling, figures_of, measure
from bench.studies.sweep.run_plan import Driver
from tests.sweep_stand_in import Inline, plan_of, run

SEEDS = 40
ONE = Scheduling("dask", 64, 10_000, 0.8, 2.0, 105.0, 1.5, 1577.0)


def test_cost_and_memory_have_limits():
    limits = {figure.name.partition(": ")[2]: figure.limit for figure in figures_of(ONE)}
    assert limits == {"driver's time a run": COST_LIMIT, "memory gained": GROWTH_LIMIT, "runs a second": None}


def test_the_numbers_are_kept(tmp_path, monkeypatch):
    monkeypatch.setattr(scheduling, "RESULT", tmp_path / "scheduling.json")
    monkeypatch.setattr(scheduling, "measure_all", lambda: [ONE])
    assert scheduling.scheduling_figures() == figures_of(ONE)
    (kept,) = json.loads((tmp_path / "scheduling.json").read_text())
    assert (kept["scheduler"], kept["workers"]) == (ONE.scheduler, ONE.workers)


def test_runs_without_work_are_measured():
    found = measure("inline", 1, Inline, 200)
    assert found.runs == 200
    assert found.driver > 0
    assert found.rate > 0
    assert found.row > 1000, "rows are as wide as those of real runs"


class OneByOne(Inline):
    """A pool with many slots whose tasks end one after the other."""

    slots = 500

    def outcomes(self):
        first, self.tasks = self.tasks[:1], self.tasks[1:]
        rest, self.tasks = self.tasks, first
        ended = super().outcomes()
        self.tasks = rest
        return ended


def test_a_finished_run_does_not_make_the_driver_look_at_all_that_wait(tmp_path, monkeypatch):
    looked, placed = [], Driver._placed

    def counted(self, one):
        looked.append(one)
        return placed(self, one)

    monkeypatch.setattr(Driver, "_placed", counted)
    plan = plan_of(tmp_path, seeds=SEEDS)
    finished = run(plan, tmp_path / "out", OneByOne)
    assert finished.runs == plan.size == 9 * 2 * SEEDS
    sets, motions = 9 * SEEDS, 3
    assert len(looked) <= sets * (2 + motions)
