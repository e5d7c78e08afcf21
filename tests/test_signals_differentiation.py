"""Finite differences: exact on polynomials, of the promised order on sines, right at the ends."""

import numpy as np
import pytest
from numpy.polynomial import Polynomial

from bench.basics.errors import BenchError
from bench.signals.differentiation import central_difference
from bench.signals.processing import estimate_motion, trim
from bench.signals.settings import FilterSettings

ORDERS = [2, 4, 6, 8]
DT = 0.1


@pytest.mark.parametrize("order", ORDERS)
def test_first_derivative_is_exact_for_polynomials_of_its_order(order: int) -> None:
    t = np.arange(30) * DT
    p = Polynomial(np.random.default_rng(order).standard_normal(order + 1))
    got = central_difference(p(t), DT, order)
    checked = slice(1, -1) if order == 2 else slice(None)  # order 2 has two-point ends, as diffcent
    np.testing.assert_allclose(got[checked], p.deriv()(t)[checked], rtol=1e-9, atol=1e-9)


def test_order_two_has_two_point_ends() -> None:
    x = np.array([1.0, 2.0, 4.0, 8.0, 16.0])
    np.testing.assert_allclose(central_difference(x, 0.5, 2), [2, 3, 6, 12, 16])


@pytest.mark.parametrize("order", ORDERS)
def test_error_on_a_sine_falls_with_the_order(order: int) -> None:
    def error(dt: float) -> float:
        t = np.arange(int(20 / dt)) * dt
        first = central_difference(np.sin(t), dt, order) - np.cos(t)
        return float(np.abs(first[20:-20]).max())

    coarse, fine = error(0.4), error(0.2)
    assert np.log2(coarse / fine) == pytest.approx(order, abs=0.15)
    promised = {2: 6, 4: 30, 6: 140, 8: 630}[order]
    assert fine == pytest.approx(0.2**order / promised, rel=0.1)


def test_columns_are_independent_and_the_input_is_kept() -> None:
    x = np.random.default_rng(5).standard_normal((40, 2, 3))
    before = x.copy()
    y = central_difference(x, DT, 8)
    assert y.shape == x.shape
    np.testing.assert_allclose(y[:, 1, 2], central_difference(x[:, 1, 2], DT, 8), atol=1e-12)
    np.testing.assert_array_equal(x, before)


def test_differences_name_what_is_wrong() -> None:
    with pytest.raises(BenchError, match="order 3"):
        central_difference(np.zeros(50), DT, 3)
    with pytest.raises(BenchError, match="8 samples are too few"):
        central_difference(np.zeros(8), DT, 8)
    with pytest.raises(BenchError, match="interval 0"):
        central_difference(np.zeros(50), 0.0, 2)


def test_motion_of_a_fourier_trajectory() -> None:
    rate = 1000.0
    t = np.arange(10_000) / rate
    w = 2 * np.pi * np.array([0.7, 1.3, 2.5])
    position = np.sin(w * t[:, None])
    settings = FilterSettings(position_cutoff=50.0, decimation=10, border=(200, 150))
    motion = estimate_motion(position, rate, settings)
    tt = trim(t, settings)[:, None]
    assert motion.position.shape == (9650, 3)
    np.testing.assert_allclose(motion.position, np.sin(w * tt), atol=1e-6)
    np.testing.assert_allclose(motion.velocity, w * np.cos(w * tt), atol=1e-5)
    np.testing.assert_allclose(motion.acceleration, -(w**2) * np.sin(w * tt), atol=1e-3)


def test_a_border_that_leaves_nothing_is_refused() -> None:
    with pytest.raises(BenchError, match="leaves nothing of 100 samples"):
        trim(np.zeros(100), FilterSettings(10.0, 1, border=(50, 50)))
