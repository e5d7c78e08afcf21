"""Effects that leave an answer, since the others do as well."""

from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from bench.dataset.robot import load_robot
from bench.diagnosis.evidence import ResidualSumOfSquares, Samples
from bench.diagnosis.pruning import (
    cancelling_effect,
    superfluous_effect,
)
from bench.diagnosis.reason import Because, Reason
from bench.effects import CATALOGUE, EffectInstance
from bench.identification.decision import RULE
from bench.identification.result import Identification
from tests.shown import dataset_of, identification_of

NAMES = ("friction", "saturation")
MANY = Samples(np.full(2, 1e4), np.full(2, 1e4))


@pytest.fixture(scope="module")
def answer() -> Identification:
    """With a standard error of each gain."""
    return identification_of(dataset_of(load_robot("five_bar")))


def fits_with(answer: Identification, error: float, moved: float) -> Any:
    """Sets of effects: without the saturation both motors' errors are so much larger, and the left gain has moved by
    so many standard errors; without the friction errors are ten times as large.
    """
    gain = answer.drive_gains["left"]
    at = {joint: each.value for joint, each in answer.drive_gains.items()}

    def fits(names: frozenset[str]) -> Any:
        size = (1.0 if "saturation" in names else error) * (1.0 if "friction" in names else 10.0)
        residual = ResidualSumOfSquares(np.full((2, 2), size**2), 2 * len(names), RULE.prior * len(names))
        away = 0.0 if "saturation" in names else moved * gain.std
        return SimpleNamespace(residual=residual, gains={**at, "left": gain.value + away})

    return fits


@pytest.mark.parametrize(("error", "goes"), [(1.005, True), (1.1, False)])
def test_an_effect_that_the_others_do_without_goes(answer: Identification, error: float, goes: bool) -> None:
    out = superfluous_effect(fits_with(answer, error, 0.0), NAMES, MANY)
    assert out == ({"saturation": Reason(Because.NOT_NEEDED)} if goes else {})


@pytest.mark.parametrize(
    ("error", "excess", "goes"),
    [(1.08, 1.0, True), (1.08, 0.0, False), (1.5, 1.0, False)],
    ids=["it goes", "no more than noise is left", "it explains much"],
)
def test_what_is_improbable_beyond_noise_goes(
    answer: Identification, error: float, excess: float, goes: bool
) -> None:
    """A delay of a measured slide took a seventh of an error of 40 times the noise: one log had it, the next not."""
    out = superfluous_effect(fits_with(answer, error, 0.0), NAMES, MANY.beyond(excess))
    assert out == ({"saturation": Reason(Because.NOT_NEEDED)} if goes else {})


def test_without_effects_nothing_goes(answer: Identification) -> None:
    assert superfluous_effect(fits_with(answer, 1.0, 0.0), (), MANY) == {}


def torques(answer: Identification, **of: tuple[float, float]) -> Identification:
    """The answer with effects of these shares of the left motor's torque: as it goes, and across it."""
    gain = answer.drive_gains["left"].value
    traces = []
    for trace in answer.recordings:
        given = gain * np.where(trace.moving, trace.measured, 0.0)
        across = np.roll(given, len(given) // 2, axis=0)
        by_effect = {name: along * given + other * across for name, (along, other) in of.items()}
        for torque in by_effect.values():
            torque[:, 1:] = 0.0
        traces.append(replace(trace, by_effect=by_effect))
    return replace(answer, recordings=tuple(traces))


def added(*names: str) -> list[EffectInstance]:
    return [EffectInstance(CATALOGUE[name], "left", f"{name}:left") for name in names]


@pytest.mark.parametrize(
    ("of", "goes"),
    [
        ({"joint_spring": (4.0, 0.0)}, None),
        ({"joint_spring": (5.7, 0.0)}, "joint_spring"),
        ({"coulomb_friction": (1.2, 0.0)}, None),
        ({"coulomb_friction": (2.2, 0.0)}, "coulomb_friction"),
        ({"joint_spring": (3.0, 0.0), "constant_offset": (-3.0, 0.5)}, "constant_offset"),
        ({"joint_spring": (3.0, 0.0), "constant_offset": (-0.8, 0.0)}, None),
        ({"viscous_friction": (73.0, 0.0), "joint_spring": (-72.5, 0.0)}, "joint_spring"),
    ],
    ids=["spring", "large spring", "friction", "large friction", "cancel", "one is small", "both"],
)
def test_a_term_larger_than_what_the_motor_gives_is_no_answer(
    answer: Identification, of: dict[str, tuple[float, float]], goes: str | None
) -> None:
    """A spring may hold a weight; the motor has to give what friction takes."""
    out = cancelling_effect(torques(answer, **of), added(*of))
    assert out == ({goes: Reason(Because.CANCELS, ("left",))} if goes else {})
