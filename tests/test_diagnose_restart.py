"""Sets of effects are found though the model without them fits best with a gain that ran away."""

from dataclasses import replace

import numpy as np
import pytest

from bench.diagnosis.base_model import restarted
from bench.identification.compressed import Stack, compress
from bench.identification.current_error import minimum_on_factors, squared_errors
from bench.identification.solution import Solution

NOMINAL = np.array([3.0, 3.0])
TRUE = np.array([3.3, 2.8])


THETA = np.array([0.5, -1.0, 2.0])


def stack_of(factor):
    """Two motors whose currents follow three parameters exactly, in units of which the gains are so many times."""
    random = np.random.default_rng(4)
    phi, kappa = random.standard_normal((400, 2, 3)), random.standard_normal((400, 2))
    current = (phi @ THETA + kappa) / (factor * TRUE)
    return Stack(phi, kappa, current, np.ones((400, 2), bool), (0,), compress(phi, kappa, current))


@pytest.fixture
def stack():
    return stack_of(1.0)


def _solution(gains):
    return Solution(np.zeros(3), np.array(gains), np.ones(2), "current", True)


@pytest.mark.parametrize("gains", [(-2.0, 2.9), (3e8, 2.9), (0.01, 2.9)])
def test_steps_lead_to_the_truth_after_the_restart(stack, gains):
    def left(start):
        theta, found = minimum_on_factors(stack.factors, start.theta, start.gains, start.weights, True)
        return float(squared_errors(stack.factors, theta, found).sum())

    lost = _solution(gains)
    again = restarted(stack, lost, NOMINAL)
    np.testing.assert_array_equal(again.gains, [3.0, 2.9])
    assert left(again) < 1e-12


def test_what_did_not_run_away_stays(stack):
    near = _solution((3.6, 2.0))
    assert restarted(stack, near, NOMINAL) is near
    nominal = replace(_solution((-3.0, 2.0)), gains_fitted=False)
    assert restarted(stack, nominal, NOMINAL) is nominal


@pytest.mark.parametrize("factor", [1e-3, 1e3])
def test_gains_that_are_off_together_have_a_unit_in_common_and_stay(factor):
    """Where the model explains the currents: these are in another unit."""
    other = stack_of(factor)
    together = replace(_solution(factor * TRUE), theta=THETA)
    assert restarted(other, together, NOMINAL) is together
    apart = _solution(factor * np.array([3.3, 28.0]))
    np.testing.assert_array_equal(restarted(other, apart, NOMINAL).gains, NOMINAL)


def test_gains_that_are_off_together_in_a_model_that_explains_nothing_have_run_away(stack):
    """A five-bar with friction at all joints, in motions of a few degrees: both gains fell to a sixtieth."""
    lost = _solution(TRUE / 60.0)
    np.testing.assert_array_equal(restarted(stack, lost, NOMINAL).gains, NOMINAL)
