"""Splines and piecewise polynomials beside those of scipy."""

import numpy as np
import pytest
from scipy.interpolate import CubicSpline, PPoly, make_interp_spline

from bench.basics.interpolation import PiecewisePolynomial, cubic_spline, spline_at_every


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


@pytest.mark.parametrize(("every", "values", "count"), [(6, 40, 240), (5, 4, 16), (18, 9, 145), (1, 7, 7)])
def test_samples_between_even_values_are_those_of_the_spline(every, values, count):
    given = np.random.default_rng(every).normal(size=(values, 3, 2))
    expected = cubic_spline(np.arange(values) * 1.0 * every, given)(np.arange(count) * 1.0)
    np.testing.assert_allclose(spline_at_every(given, every, count), expected, rtol=1e-11, atol=1e-12)


def test_a_few_samples_need_no_piece_but_their_own():
    random = np.random.default_rng(3)
    t = np.cumsum(random.uniform(0.5, 1.5, 60))
    spline, at = (
        cubic_spline(t, random.normal(size=(60, 2))),
        np.sort(random.uniform(t[0] - 1.0, t[-1] + 1.0, 50)),
    )
    at = np.sort(np.concatenate((at, t)))
    for part in (slice(0, 1), slice(20, 33), slice(50, None), slice(0, 0)):
        np.testing.assert_array_equal(spline(at[part]), spline(at)[part])


def test_too_few_samples_are_refused():
    with pytest.raises(ValueError, match="through 3 samples"):
        cubic_spline(np.arange(3.0), np.arange(3.0))
