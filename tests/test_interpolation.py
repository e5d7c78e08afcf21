"""Splines and piecewise polynomials beside those of scipy."""

import numpy as np
import pytest
from scipy.interpolate import CubicSpline, PPoly, make_interp_spline

from bench.basics.interpolation import PiecewisePolynomial, cubic_spline


@pytest.mark.parametrize("shape", [(), (2,), (3, 2)])
@pytest.mark.parametrize("count", [4, 5, 200])
def test_the_spline_is_that_of_scipy(shape, count):
    random = np.random.default_rng(count)
    t = np.cumsum(random.uniform(0.5, 1.5, count))
    values = random.normal(size=(count, *shape))
    at = np.linspace(t[0] - 0.3, t[-1] + 0.3, 777)
    found = cubic_spline(t, values)(at)
    np.testing.assert_allclose(found, CubicSpline(t, values)(at), rtol=1e-9, atol=1e-9)
    np.testing.assert_allclose(found, make_interp_spline(t, values, k=3)(at), rtol=1e-8, atol=1e-8)


def test_a_cubic_is_met_everywhere():
    t = np.array([0.0, 0.1, 0.4, 1.0, 1.1])
    at = np.linspace(-0.5, 1.5, 50)
    polynomial = np.polynomial.Polynomial([1.0, -2.0, 0.5, 3.0])
    np.testing.assert_allclose(cubic_spline(t, polynomial(t))(at), polynomial(at), rtol=1e-12, atol=1e-12)


def test_pieces_are_those_of_scipy():
    random = np.random.default_rng(1)
    coefficients, knots = random.normal(size=(6, 9, 4)), np.cumsum(random.uniform(0.1, 1.0, 10))
    at = np.concatenate((knots, np.linspace(knots[0], knots[-1], 333)))
    found = PiecewisePolynomial(coefficients, knots)(at)
    np.testing.assert_allclose(found, PPoly(coefficients, knots)(at), rtol=1e-10, atol=1e-12)


def test_too_few_samples_are_refused():
    with pytest.raises(ValueError, match="through 3 samples"):
        cubic_spline(np.arange(3.0), np.arange(3.0))
