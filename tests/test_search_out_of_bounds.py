"""An effect that a search added leaves the motors whose gain runs away beside it; nothing else does."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from bench.dataset.dataset import load_dataset
from bench.effects import CATALOGUE, EffectInstance
from bench.identification.nonlinear import converged, out_of_bounds, staying
from bench.identification.prepare import Prepared, prepare, with_effects
from bench.identification.problem import problem_of
from bench.identification.solution import Solution
from bench.identification.solve_only import solved_quickly
from tests.discover_kit import measured


def at(joint: str, name: str) -> EffectInstance:
    return EffectInstance(CATALOGUE[name], joint, f"{name}:{joint}")


@pytest.fixture(scope="module")
def loaded() -> tuple[Prepared, Solution]:
    """A five-bar with viscous friction told and friction by the load at both motors, and its solution."""
    names = [
        ("viscous_friction", "left"),
        ("load_dependent_friction", "left"),
        ("load_dependent_friction", "right"),
    ]
    prepared = with_effects(
        prepare(problem_of(measured({"effect": "viscous_friction", "Fv": 0.15}))),
        [at(joint, name) for name, joint in names],
    )
    return prepared, solved_quickly(prepared)[1]


def with_gains(solution: Solution, *times: float) -> Solution:
    return replace(solution, gains=solution.gains * np.array(times))


def test_it_leaves_the_motor_whose_gain_runs_away(loaded: tuple[Prepared, Solution]) -> None:
    prepared, solution = loaded
    assert staying(prepared, solution, 0) == [0, 1, 2]
    assert staying(prepared, with_gains(solution, 30.0, 1.0), 0) == [0, 2]
    assert staying(prepared, with_gains(solution, 1.0, 1e-3), 0) == [0, 1]


def test_it_leaves_the_motor_where_it_is_beyond_its_bound(loaded: tuple[Prepared, Solution]) -> None:
    prepared, solution = loaded
    theta = solution.theta.copy()
    theta[-1] = -0.8
    assert staying(prepared, replace(solution, theta=theta), 0) == [0, 1]


def test_what_was_told_stays_and_so_does_a_last_place(loaded: tuple[Prepared, Solution]) -> None:
    prepared, solution = loaded
    wild = with_gains(solution, 30.0, 30.0)
    assert len(out_of_bounds(prepared, wild)) == 2
    assert staying(prepared, wild, 2) == [0, 1]
    assert staying(prepared, wild, 0) == [0, 2]
    assert staying(prepared, wild, 3) == [0, 1, 2]


def test_a_searched_model_of_a_measured_arm_settles(measured_data: Path) -> None:
    """Beside friction by the load at the vertical axis, which carries none, its gain swings without end."""
    arm = prepare(problem_of(load_dataset(measured_data / "ur10e")))
    joints = arm.dataset.robot.joints
    names = ("viscous_friction", "coulomb_friction", "load_dependent_friction")
    whole = with_effects(arm, [at(joint, name) for name in names for joint in joints])
    searched = converged(whole, added_from=0)
    places = [each.joint for each in searched.effects if each.effect.name == "load_dependent_friction"]
    assert places == ["j2", "j3", "j4", "j5", "j6"]
    gains = solved_quickly(searched)[1].gains
    np.testing.assert_allclose(gains, arm.dataset.robot.nominal_gains, rtol=0.5)
    told = converged(whole)
    assert len(told.effects) == len(whole.effects)
