"""The least error of the currents is found from inner products as it is from the equations themselves."""

import numpy as np
import pytest

from bench.identification.compressed import Stack, compress
from bench.identification.current_error import REWEIGHTINGS, current_error, minimised, squared_errors
from bench.identification.least_squares import weighted_least_squares
from bench.identification.solution import NominalGains

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
    for _ in range(REWEIGHTINGS):
        theta, gains = minimised(stack.factors, theta, gains, weights, fit_gains)
        weights = weights_of(theta, gains)
    for to_the_last_digit, digits in ((True, 1e-7), (False, 1e-5)):
        found = current_error(stack, start, to_the_last_digit=to_the_last_digit)
        np.testing.assert_allclose(found.gains, gains, rtol=digits * noise)
        np.testing.assert_allclose(found.weights, weights, rtol=digits)
        np.testing.assert_allclose(stack.phi @ (found.theta - theta), 0.0, atol=10.0 * digits * noise)
