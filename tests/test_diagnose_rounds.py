"""A search goes from one converged model to a better one, whatever sets promise about the model of another."""

from dataclasses import dataclass, replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from bench.basics.deadline import NEVER
from bench.dataset.dataset import load_dataset
from bench.diagnosis import rounds
from bench.diagnosis.evidence import ResidualSumOfSquares, Samples
from bench.diagnosis.with_catalogue import diagnose_with_catalogue
from bench.identification.gauss_newton import run_away
from bench.identification.problem import problem_of
from bench.identification.tolerances import TOLERANCES

SYSTEM: Any = SimpleNamespace(samples=Samples(np.full(2, 400.0), np.full(2, 200.0)))


def left(fitted: float, judged: float, unknowns: int = 5, *, away: bool = False) -> ResidualSumOfSquares:
    """Two motors, the second of which has a hundredth of the first one's current."""
    squares = np.array([[fitted], [judged]]) * np.array([1.0, 1e-4])
    return ResidualSumOfSquares(squares, unknowns, 0.0, away)


@pytest.mark.parametrize(
    ("model", "more"),
    [
        (left(0.8, 0.8), True),
        (left(0.8, 1.5), True),  # fitted recordings count by how long they are
        (left(0.9, 1.4), False),
        (left(0.8, 0.8, unknowns=60), False),  # less than its unknowns cost
        (
            ResidualSumOfSquares(np.array([[1.0, 0.5e-4], [1.0, 0.5e-4]]), 5, 0.0),
            True,
        ),  # a small motor counts as much
    ],
)
def test_a_model_is_more_probable_by_what_it_leaves(model: ResidualSumOfSquares, more: bool) -> None:
    assert (model.weight(SYSTEM.samples) > left(1.0, 1.0).weight(SYSTEM.samples)) is more


@dataclass(frozen=True)
class FakeRound:
    """A set of effects with what its own model leaves, where it has one."""

    chosen: tuple[int, ...]
    model: ResidualSumOfSquares | None = None
    proposals: tuple[str, ...] = ("a", "b", "c", "d")

    @property
    def residual(self) -> ResidualSumOfSquares | None:
        return self.model

    @property
    def system(self) -> Any:
        return SYSTEM

    @property
    def names(self) -> set[str]:
        return {self.proposals[i] for i in self.chosen}


def again(
    monkeypatch: pytest.MonkeyPatch,
    leaves: dict[tuple[int, ...], ResidualSumOfSquares],
    promised: dict[tuple[int, ...], tuple[int, ...]],
    alike: tuple[tuple[int, ...], ...] = (),
) -> tuple[Any, list[tuple[int, ...]]]:
    """The round that a search from (0,) ends with, and the sets that were converged. promised: the best set of the
    system about another's model.
    """
    seen: list[tuple[int, ...]] = []

    def converge(_: object, here: FakeRound) -> FakeRound:
        seen.append(here.chosen)
        return replace(here, model=leaves[here.chosen])

    def judged(_: object, model: ResidualSumOfSquares, *__: object) -> FakeRound:
        here = next(key for key, value in leaves.items() if value is model)
        return FakeRound(promised[here], model)

    monkeypatch.setattr(rounds, "_converged", converge)
    monkeypatch.setattr(rounds, "round_about", judged)
    monkeypatch.setattr(rounds, "_best_machine", lambda _, here, *__: here)
    monkeypatch.setattr(rounds, "reshaped_proposals", lambda *_: ())
    monkeypatch.setattr(rounds, "with_set", lambda here, chosen: replace(here, chosen=chosen))
    monkeypatch.setattr(rounds, "_alike", lambda here, *_: [replace(here, chosen=key) for key in alike])
    progress: Any = SimpleNamespace(phase=lambda *_: None)
    base_model: Any = SimpleNamespace(with_proposals=lambda _, chosen: leaves[chosen], deadline=NEVER)
    start: Any = FakeRound((0,))
    return rounds._again(base_model, start, (), progress), seen


def test_what_is_worse_once_it_is_converged_does_not_take_the_place_of_a_set(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    leaves = {(0,): left(1.0, 1.0), (1, 2): left(1.5, 1.5)}
    found, seen = again(monkeypatch, leaves, {(0,): (1, 2)})
    assert (found.chosen, found.model) == ((0,), leaves[(0,)])
    assert seen == [(0,), (1, 2)]


def test_a_set_like_it_is_tried_where_the_best_is_worse(monkeypatch: pytest.MonkeyPatch) -> None:
    leaves = {(0,): left(1.0, 1.0), (1, 2): left(1.5, 1.5), (0, 3): left(0.5, 0.5)}
    found, seen = again(monkeypatch, leaves, {(0,): (1, 2), (0, 3): (0, 3)}, alike=((0, 3),))
    assert (found.chosen, found.model) == ((0, 3), leaves[(0, 3)])
    assert seen == [(0,), (1, 2), (0, 3)]


@pytest.mark.parametrize(("judged", "taken"), [(1.01, (1,)), (1.2, (0,))])
def test_a_smaller_set_is_taken_where_it_leaves_hardly_more(
    judged: float, taken: tuple[int, ...], monkeypatch: pytest.MonkeyPatch
) -> None:
    leaves = {(0,): left(1.0, 1.0, unknowns=8), (1,): left(judged, judged, unknowns=5)}
    found, _ = again(monkeypatch, leaves, {(0,): (1,), (1,): (1,)})
    assert found.chosen == taken


def test_a_model_with_a_gain_that_ran_away_does_not_take_the_place_of_one_without(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    leaves = {(0,): left(1.0, 1.0), (1,): left(0.2, 0.2, away=True)}
    found, _ = again(monkeypatch, leaves, {(0,): (1,)})
    assert found.chosen == (0,)


def test_a_gain_has_run_away_at_many_times_the_nominal_one_or_little_of_it() -> None:
    assert run_away(np.array([1.0, 1.1 * TOLERANCES.steps.runaway_factor]))
    assert run_away(np.array([1.0, 0.9 / TOLERANCES.steps.runaway_factor]))
    assert not run_away(np.array([10.0, 0.1]))


def test_where_all_gains_are_far_sets_are_compared_by_what_they_leave(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """As with a nominal gain in another unit."""
    leaves = {(0,): left(1.0, 1.0, away=True), (1,): left(0.2, 0.2, away=True)}
    found, _ = again(monkeypatch, leaves, {(0,): (1,), (1,): (1,)})
    assert found.chosen == (1,)


def test_a_nominal_gain_in_another_unit_hides_nothing(arm: Path) -> None:
    dataset = load_dataset(arm / "data")
    actuators = tuple(replace(each, gain=1e-3 * each.gain) for each in dataset.robot.actuators)
    found = diagnose_with_catalogue(
        problem_of(replace(dataset, robot=replace(dataset.robot, actuators=actuators)))
    )
    assert found.missing == ("viscous_friction",)
    for gain in found.after.drive_gains.values():
        assert 0.85 < 1e-3 * gain.value / gain.nominal < 1.15
