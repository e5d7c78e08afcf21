"""Pieces of one computation in several processes: the same results, in the same order, as in one."""

import os
from dataclasses import replace

import pytest

from bench.basics.errors import BenchError
from bench.basics.mapper import IN_TURN
from bench.dataset.robot import load_robot
from bench.excitation.bounds import SEARCH
from bench.excitation.experiment import plan as module
from bench.excitation.experiment.plan import Aim, plan_experiment
from bench.excitation.experiment.request import ExperimentTable
from bench.studies.pooled import PooledMapper
from bench.studies.sweep.pool import Workers


def divided(shared, item):
    if item == 0:
        raise BenchError(f"{shared}: nothing is divided by {item}")
    return shared / item, os.getpid()


def broken(shared, item):
    return shared / item


@pytest.fixture(scope="module")
def two():
    with PooledMapper(Workers(2), start=0.0) as mapper:
        yield mapper


def test_results_come_in_order_from_two_processes(two):
    results = list(two.map(divided, 6.0, [1.0, 2.0, 3.0, 4.0]))
    assert [value for value, _ in results] == [6.0, 3.0, 2.0, 1.5]
    assert os.getpid() not in {process for _, process in results}
    assert next(two.map(divided, 8.0, [4.0, 2.0]))[0] == 2.0  # another shared value
    assert next(two.map(divided, 8.0, [4.0]))[1] == os.getpid()


def test_the_mistake_of_the_first_item_is_raised_and_a_fault_is_none(two):
    results = two.map(divided, 6.0, [2.0, 0, 0.0])
    assert next(results)[0] == 3.0
    with pytest.raises(BenchError, match=r"6\.0: nothing is divided by 0$"):
        next(results)
    with pytest.raises(RuntimeError, match="ZeroDivisionError"):
        list(two.map(broken, 6.0, [2.0, 0.0]))
    assert [value for value, _ in two.map(divided, 6.0, [3.0, 1.0])] == [2.0, 6.0]


@pytest.mark.parametrize(("workers", "start"), [(2, 1e6), (1, 0.0)])
def test_short_work_and_one_processor_start_none(workers, start):
    with PooledMapper(Workers(workers), start) as mapper:
        assert {process for _, process in mapper.map(divided, 6.0, [1.0, 2.0])} == {os.getpid()}


class Counting(Workers):
    """Counts the pools that are closed."""

    closed = 0

    def pool(self):
        pool = super().pool()
        close = pool.close

        def counted():
            Counting.closed += 1
            close()

        pool.close = counted
        return pool


def test_processes_end_with_it_also_after_a_mistake():
    with pytest.raises(BenchError), PooledMapper(Counting(2), start=0.0) as mapper:
        list(mapper.map(divided, 6.0, [1.0, 0]))
    assert Counting.closed == 1


def bits(plan):
    """All numbers of a plan."""
    motions = [
        (
            recording.trajectory.to_dict(),
            recording.proven.proof,
            recording.proven.tried.motion.q.tobytes(),
            recording.proven.tried.evidence.grams.tobytes(),
        )
        for recording in plan.recordings
    ]
    return motions, plan.value, plan.random, plan.sizes.tobytes()


def test_a_plan_is_the_same_to_the_last_bit_with_any_number_of_workers(two, monkeypatch):
    monkeypatch.setattr(module, "SEARCH", replace(SEARCH, random=4))
    quick = {"duration": 3.0, "harmonics": 2, "velocity": 4.0, "acceleration": 40.0, "payload": {"mass": 0.5}}
    alone, together = (
        plan_experiment(
            load_robot("five_bar"), ExperimentTable.model_validate(quick), Aim(steps=20), mapper=mapper
        )
        for mapper in (IN_TURN, two)
    )
    assert bits(alone) == bits(together)
