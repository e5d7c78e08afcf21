"""The bounded minimum beside that of scipy.optimize."""

import numpy as np
import pytest
from scipy.optimize import minimize_scalar

from bench.identification.bounded import minimum_between

FUNCTIONS = {
    "parabola": lambda x: (x - 0.3) ** 2,
    "at a bound": lambda x: x,
    "at the other": lambda x: -x,
    "flat": lambda x: 1.0,
    "sharp": lambda x: abs(x - 0.7123),
    "waves": lambda x: np.sin(7.0 * x) + 0.1 * x**2,
    "quartic": lambda x: (x - 1.1) ** 4,
    "exponential": lambda x: np.exp(x) - 2.0 * x,
}


@pytest.mark.parametrize("name", FUNCTIONS)
@pytest.mark.parametrize("bounds", [(-1.0, 2.0), (0.0, 1e-3), (0.5, 30.0)])
@pytest.mark.parametrize("tolerance", [1e-3, 1e-6])
def test_every_point_that_is_tried_is_that_of_scipy(name, bounds, tolerance):
    ours, theirs = [], []

    def noting(points):
        def noted(x):
            points.append(float(x))
            return float(FUNCTIONS[name](x))

        return noted

    place, value = minimum_between(noting(ours), *bounds, tolerance)
    result = minimize_scalar(noting(theirs), bounds=bounds, method="bounded", options={"xatol": tolerance})
    np.testing.assert_allclose(ours, theirs, rtol=1e-12)
    assert place == pytest.approx(result.x, rel=1e-12)
    assert value == pytest.approx(result.fun, rel=1e-12)
