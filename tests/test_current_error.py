"""The least error of the currents is found from inner products as it is from the equations themselves."""

from dataclasses import replace

import numpy as np
import pytest

from bench.identification.compressed import Stack, compress
from bench.identification.current_error import current_error, minimum_on_factors, squared_errors
from bench.identification.least_squares import weighted_least_squares
from bench.identification.solution import NominalGains
from bench.identification.solve_only import solved_from_products
from bench.identification.tolerances import TOLERANCES

TRUE = np.array([3.3, 2.8, 40.0])
NOMINAL = np.array([3.0, 3.0, 38.0])


def stack_of(noise: float) -> Stack:
    """Three motors, unlike columns of which two are all but the same, and one that is nothing."""
    random = np.random.default_rng(11)
    phi = random.standard_normal((500, 3, 8)) * 10.0 ** np.arange(-4, 4)
    phi[:, :, 3] = phi[:, :, 2] + 1e-5 * phi[:, :, 3]
    phi[:, :, 6] = 0.0
    theta = random.standard_normal(8) / 10.0 ** np.arange(-4, 4)
    kappa = random.standard_normal((500, 3))
    current = (phi @ theta + kappa) / TRUE
    current += noise * current.std(axis=0) * np.array([1.0, 5.0, 0.2]) * random.standard_normal(current.shape)
    return Stack(phi, kappa, current, np.ones((500, 3), bool), (0,), compress(phi, kappa, current))


@pytest.mark.parametrize("fit_gains", [True, False])
@pytest.mark.parametrize("noise", [0.1, 1e-3, 1e-5])
def test_steps_on_inner_products_lead_where_steps_on_the_equations_do(noise, fit_gains):
    stack = stack_of(noise)
    start = weighted_least_squares(stack, NominalGains(NOMINAL, fit_gains))

    def weights_of(theta, gains):
        return 1.0 / np.sqrt(squared_errors(stack.factors, theta, gains) / len(stack.current))

    theta, gains = start.theta, start.gains
    weights = weights_of(theta, gains)
    for _ in range(TOLERANCES.steps.reweightings):
        theta, gains = minimum_on_factors(stack.factors, theta, gains, weights, fit_gains)
        weights = weights_of(theta, gains)
    quickly = solved_from_products(stack, NominalGains(NOMINAL, fit_gains), NOMINAL)
    for found, digits in ((current_error(stack, start), 1e-7), (quickly, 1e-5)):
        np.testing.assert_allclose(found.gains, gains, rtol=digits * noise)
        np.testing.assert_allclose(found.weights, weights, rtol=digits)
        np.testing.assert_allclose(stack.phi @ (found.theta - theta), 0.0, atol=10.0 * digits * noise)


def test_a_start_far_away_leads_to_the_same_solution():
    stack = stack_of(0.1)
    gains = NominalGains(NOMINAL, fitted=True)
    found = solved_from_products(stack, gains, NOMINAL)
    for near in (NOMINAL * 1e7, NOMINAL * np.array([30.0, 1.0, 1.0]), NOMINAL / 1e3):
        other = solved_from_products(stack, gains, near)
        np.testing.assert_allclose(other.gains, found.gains, rtol=1e-6)
        np.testing.assert_allclose(stack.phi @ (other.theta - found.theta), 0.0, atol=1e-4)


def test_a_motor_whose_gain_runs_away_leaves_no_more_than_where_steps_on_the_equations_end():
    stack = stack_of(0.1)
    random = np.random.default_rng(5)
    current = stack.current.copy()
    current[:, 0] = 0.1 * random.standard_normal(
        len(current)
    )  # nothing of the model: the larger the gain the better
    stack = replace(stack, current=current, factors=compress(stack.phi, stack.kappa, current))
    gains = NominalGains(NOMINAL, fitted=True)
    exact = current_error(stack, weighted_least_squares(stack, gains))
    found = solved_from_products(stack, gains, NOMINAL)
    left = [np.log(squared_errors(stack.factors, each.theta, each.gains)).sum() for each in (found, exact)]
    assert abs(found.gains[0]) > 100.0 * NOMINAL[0]
    assert left[0] < left[1] + 1e-3


@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize("near", [NOMINAL, np.array([3.0, 3.0, -1e-9]), np.array([3.0, 3.0, 0.0])])
def test_a_motor_of_whose_gain_the_data_leave_nothing_does_not_stop_a_search(near):
    """Its torques are nothing but columns of its own: no gain, and none of these, explains them as well as any."""
    stack = stack_of(0.1)
    phi, kappa = stack.phi.copy(), stack.kappa.copy()
    phi[:, 2, :7], phi[:, :2, 7], kappa[:, 2] = 0.0, 0.0, 0.0
    stack = replace(stack, phi=phi, kappa=kappa, factors=compress(phi, kappa, stack.current))
    found = solved_from_products(stack, NominalGains(NOMINAL, fitted=True), near)
    assert np.isfinite(found.gains).all()
    assert np.isfinite(found.theta).all()
