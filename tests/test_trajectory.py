"""Fourier trajectories: derivatives, smooth ends, limits, round trip, refusals."""

import json

import numpy as np
import pytest

from bench.basics.errors import BenchError
from bench.scenario.trajectory import FourierTrajectory, random_trajectory


@pytest.fixture
def trajectory():
    return random_trajectory(
        3, [0.4, -1.0], span=[0.5, 0.2], velocity_limit=3.0, harmonics=4, duration=8.0, ramp=0.7
    )


def test_derivatives_agree_with_finite_differences(trajectory):
    t = np.linspace(0.01, 7.99, 801)
    h = 1e-5
    before, here, after = (trajectory.evaluate(t + d) for d in (-h, 0, h))
    np.testing.assert_allclose((after[0] - before[0]) / (2 * h), here[1], atol=1e-7)
    np.testing.assert_allclose((after[1] - before[1]) / (2 * h), here[2], atol=1e-6)


def test_starts_and_stops_at_rest_in_the_center(trajectory):
    for t in (-1.0, 0.0, 8.0, 9.0):
        q, qd, qdd = trajectory.evaluate(t)
        np.testing.assert_array_equal(q, [[0.4, -1.0]])
        np.testing.assert_array_equal(qd, 0)
        np.testing.assert_array_equal(qdd, 0)
    # the jerk vanishes too: just after the start the acceleration grows with the square of time
    small, large = np.abs(trajectory.evaluate([1e-4, 2e-4])[2])
    assert (large < 4.2 * small).all()


def test_is_the_plain_series_between_the_ramps(trajectory):
    t = np.array([0.7, 3.3, 7.3])
    k_omega_t = np.outer(t, 2 * np.pi * 0.1 * np.arange(1, 5))
    series = np.sin(k_omega_t) @ trajectory.a.T + np.cos(k_omega_t) @ trajectory.b.T
    np.testing.assert_allclose(trajectory.evaluate(t)[0], trajectory.center + series, atol=1e-14)


@pytest.mark.parametrize("seed", range(5))
def test_limits_hold_and_one_of_them_is_reached(seed):
    limits = {"span": 0.6, "velocity_limit": 2.0, "acceleration_limit": 12.0}
    trajectory = random_trajectory(seed, [0.0, 0.0, 1.0], **limits, base_frequency=0.2)
    t = np.linspace(0, 20, 200_001)
    q, qd, qdd = trajectory.evaluate(t)
    used = np.array([np.abs(x).max(axis=0) for x in (q - trajectory.center, qd, qdd)])
    used /= np.array([[0.6], [2.0], [12.0]])
    assert (used <= 1.0).all()
    assert (used.max(axis=0) > 0.99).all()


def test_same_seed_same_trajectory_other_seed_another():
    one, same, other = (random_trajectory(s, [0.0], 1.0, 1.0) for s in (5, 5, 6))
    np.testing.assert_array_equal(one.a, same.a)
    assert not np.array_equal(one.a, other.a)


def test_round_trip_through_json_is_exact(trajectory):
    again = FourierTrajectory.from_dict(json.loads(json.dumps(trajectory.to_dict())))
    t = np.linspace(0, 8, 100)
    for x, y in zip(trajectory.evaluate(t), again.evaluate(t), strict=True):
        np.testing.assert_array_equal(x, y)


GOOD = {"center": [0.0], "a": [[1.0]], "b": [[0.0]], "base_frequency": 1.0, "duration": 4.0, "ramp": 1.0}


@pytest.mark.parametrize(
    ("change", "named"),
    [
        ({"ramp": 3.0}, "ramp"),
        ({"duration": -1.0}, "duration"),
        ({"a": [[1.0], [2.0]]}, "shapes"),
        ({"a": [["x"]]}, "lists of numbers"),
        ({"b": [[float("nan")]]}, "finite"),
        ({"speed": 1.0}, "speed"),
    ],
)
def test_a_mistake_is_named(change, named):
    with pytest.raises(BenchError, match=named):
        FourierTrajectory.from_dict(GOOD | change)


def test_a_missing_key_is_named():
    with pytest.raises(BenchError, match="ramp"):
        FourierTrajectory.from_dict({k: v for k, v in GOOD.items() if k != "ramp"})


def test_trajectories_are_compared_by_what_they_are():
    first, again, other = (random_trajectory(seed, [0.4, -1.0], 0.3, 2.0) for seed in (1, 1, 2))
    assert first is not again
    assert first == again
    assert hash(first) == hash(again)
    assert first != other
    assert first != "a trajectory"
