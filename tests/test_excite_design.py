"""Designed trajectories do not depend on how their closures are found."""

import numpy as np
import pytest

from bench.dataset.payload import Payload
from bench.dataset.robot import load_robot
from bench.excitation import design
from bench.excitation.design import Movement, design_trajectories
from bench.excitation.limits import feasible_motion
from bench.scenario.scenario import home_position

DISC = Payload("disc", 0.5, np.array([0.0, 0.0, 0.02]), np.array([1e-3, 1e-3, 2e-3, 0.0, 0.0, 0.0]))


def movements(joints, fitted=True):
    """Two movements about home, the second one with a payload: without any, no motion gives the gains a scale."""
    limits = {"span": np.full(joints, 0.5), "velocity": np.full(joints, 3.0)}
    return [
        Movement(
            name=f"movement {seed}",
            fitted=fitted,
            payload=DISC if seed == 2 else None,
            center=home_position(load_robot("five_bar")),
            acceleration=np.full(joints, np.inf),
            harmonics=3,
            base_frequency=0.25,
            duration=6.0,
            ramp=1.0,
            seed=seed,
            **limits,
        )
        for seed in (1, 2)
    ]


@pytest.fixture
def five_bar():
    return load_robot("five_bar")


def coefficients(designed):
    return {name: np.concatenate((one.a, one.b)) for name, one in designed.trajectories.items()}


def test_closures_found_from_the_one_before_give_the_same_design(five_bar, monkeypatch):
    designed = design_trajectories(five_bar, movements(2))
    assert designed.condition < 1e3
    beside = coefficients(designed)
    asked = []

    def from_home(geometry, limits, trajectory, time, near=None):
        asked.append(near is not None)
        return feasible_motion(geometry, limits, trajectory, time)

    monkeypatch.setattr(design, "feasible_motion", from_home)
    alone = coefficients(design_trajectories(five_bar, movements(2)))
    assert any(asked)
    assert beside.keys() == alone.keys()
    for name in beside:
        np.testing.assert_array_equal(beside[name], alone[name])


def test_what_is_not_fitted_is_drawn(five_bar):
    designed = design_trajectories(five_bar, movements(2, fitted=False))
    assert list(designed.trajectories) == ["movement 1", "movement 2"]
    assert designed.condition == np.inf
