"""Sets of effects, solved from inner products, are what the rows themselves give."""

from dataclasses import replace
from itertools import combinations
from types import SimpleNamespace

import numpy as np
import pytest

from bench.diagnosis.batched_sets import solve_set, solve_sets
from bench.diagnosis.motor_products import combined, folded, motor_rows, products, summed
from bench.diagnosis.normal_equations import _orthonormal, _products, _triangle
from bench.diagnosis.system import Candidate, System
from bench.diagnosis.system import squared_errors as left_by
from bench.identification.compressed import compress
from bench.identification.current_error import minimum_on_factors, squared_errors
from bench.identification.solution import Solution

TRUE = np.array([3.3, 2.8])
OWN, ADDED = 5, 6


def rows_of(seed, noise):
    """Columns of a model, columns that it lacks, a known load and currents (M, n, ...)."""
    random = np.random.default_rng(seed)
    columns = random.standard_normal((600, 2, OWN + ADDED)) * 10.0 ** np.arange(-3, OWN + ADDED - 3)
    columns[:, :, OWN + 2] += 1e3 * columns[:, :, 1]  # all but taken up by the model
    columns[:, :, OWN + 5] = 2.0 * columns[:, :, OWN + 4]  # the same effect twice
    kappa = random.standard_normal((600, 2))
    theta = np.append(random.standard_normal(OWN), np.zeros(ADDED)) / 10.0 ** np.arange(-3, OWN + ADDED - 3)
    theta[OWN], theta[OWN + 1] = 1e-2, -2e-3
    current = (columns @ theta + kappa) / TRUE
    return columns, kappa, current + noise * current.std() * random.standard_normal(current.shape)


def by_motor(rows, cut):
    """Rows (M, n, C + 2) of two recordings, motor by motor."""
    return [
        [motor_rows([own[:, :-2]], own[:, -2:]) for own in part.swapaxes(0, 1)]
        for part in (rows[:cut], rows[cut:])
    ]


def system_of(columns, kappa, current, start):
    """The system of a model's columns and of those that it lacks, about a solution of the model."""
    torque = columns[:, :, :OWN] @ start.theta + kappa
    rows = np.concatenate((columns, torque[:, :, None], (current - torque / start.gains)[:, :, None]), axis=2)
    change, sizes = _orthonormal(_triangle(by_motor(rows, 200), OWN + ADDED, start), OWN)
    moving = np.ones(current.shape, dtype=bool)
    seen = [
        SimpleNamespace(use="identify", current=current[some], moving=moving[some])
        for some in (slice(100), slice(100, None))
    ]
    logs = [SimpleNamespace(recording=SimpleNamespace(log=log)) for log in ("first", "second")]
    prepared = SimpleNamespace(observations=seen, measured=logs)
    by_log = _products(prepared, {"identify": by_motor(rows, 100)}, change)
    products = summed([by_use["identify"] for by_use in by_log.values()], change.shape[1] + 3, 2)
    listed = tuple(Candidate((), np.array([OWN + i]), sizes[[i]]) for i in range(ADDED))
    return System(listed, OWN, start, products, products, 1.0)


@pytest.fixture(params=[1e-2, 1e-4, 1e-6])
def known(request):
    """A system of two motors, and the factors of its rows."""
    columns, kappa, current = rows_of(3, request.param)
    factors = compress(columns, kappa, current)
    weights = np.array([2.0, 0.5])
    own = factors[:, :, [*range(OWN), -2, -1]]
    theta, gains = minimum_on_factors(own, np.zeros(OWN), np.array([3.0, 3.0]), weights, True)
    return system_of(columns, kappa, current, Solution(theta, gains, weights, "current", True)), factors


def test_columns_that_are_zero_at_a_motor_are_left_out_and_change_nothing():
    random = np.random.default_rng(5)
    columns = random.standard_normal((40, 6))
    columns[:, [1, 4]] = 0.0
    ends, change, values = random.standard_normal((40, 2)), random.standard_normal((6, 5)), np.arange(8.0)
    rows = motor_rows([columns[:, :2], columns[:, 2:]], ends)
    whole = np.concatenate((columns, ends), axis=1)
    changed = np.concatenate((columns @ change, ends), axis=1)
    np.testing.assert_array_equal(rows.filled, [0, 2, 3, 5])
    np.testing.assert_allclose(products(rows, change), changed.T @ changed, rtol=1e-12, atol=1e-12)
    np.testing.assert_allclose(combined(rows, values), whole @ values, rtol=1e-12, atol=1e-12)
    before = random.standard_normal((9, 6))
    triangle = folded(before, rows, 0.5)
    under = np.concatenate((before, 0.5 * columns))
    np.testing.assert_allclose(triangle.T @ triangle, under.T @ under, rtol=1e-12, atol=1e-12)


@pytest.mark.parametrize("chosen", [(), (0,), (1,), (0, 1), (1, 2), (0, 1, 2, 3), (0, 4, 5)])
def test_a_set_is_solved_as_from_its_rows(known, chosen):
    system, factors = known
    picked = [*range(OWN), *(OWN + i for i in chosen), -2, -1]
    own = factors[:, :, picked]
    start = system.start
    theta, gains = minimum_on_factors(
        own, np.append(start.theta, np.zeros(len(chosen))), start.gains, start.weights, True
    )
    found = solve_set(system, chosen)
    np.testing.assert_allclose(found.gains, gains, rtol=1e-4)
    wanted = squared_errors(own, theta, gains)
    # products are rounded by a share of what the first model left: at a millionth of the current, not nothing
    first = squared_errors(own, np.append(start.theta, np.zeros(len(chosen))), start.gains)
    rounding = 8.0 * np.finfo(float).eps * first
    squares = start.weights**2
    np.testing.assert_allclose(found.fitted, wanted @ squares, rtol=1e-5, atol=float(rounding @ squares))
    left = left_by(system.fitted, found, start)
    np.testing.assert_array_less(np.abs(left - wanted), 1e-3 * wanted + rounding)


def test_an_order_makes_no_difference_and_nothing_is_solved_twice(known):
    system, _ = known
    assert solve_set(system, (3, 0, 1)) is solve_set(system, (0, 1, 3))


def test_sets_solved_side_by_side_are_those_solved_alone(known):
    system, _ = known
    sets = [one for size in (1, 2, 3) for one in combinations(range(ADDED), size)]
    alone = [solve_set(replace(system, solved={}), one) for one in sets]
    for found, wanted in zip(solve_sets(system, sets), alone, strict=True):
        assert found.chosen == wanted.chosen
        rounding = 8.0 * np.finfo(float).eps * solve_set(system, ()).fitted
        squares = [wanted.fitted, wanted.held_out]
        np.testing.assert_allclose([found.fitted, found.held_out], squares, rtol=1e-5, atol=rounding)
        np.testing.assert_allclose(found.gains, wanted.gains, rtol=1e-4)


@pytest.mark.parametrize("side_by_side", [False, True])
def test_a_gain_that_ran_away_comes_back_with_what_was_lacking(side_by_side):
    columns, kappa, current = rows_of(3, 1e-4)
    columns[:, 0, OWN] -= 2e2 * kappa[:, 0]  # a torque larger than the load, and against it
    current[:, 0] -= 1e-2 * 2e2 * kappa[:, 0] / TRUE[0]
    start = Solution(np.zeros(OWN), np.array([3.0, 3.0]), np.array([2.0, 0.5]), "current", True)
    system = system_of(columns, kappa, current, start)
    assert solve_set(system, ()).gains[0] > 10.0 * TRUE[0]
    sets = [(0, 1), (0, 1, 2)]
    found = (
        solve_sets(system, sets)
        if side_by_side
        else [solve_set(replace(system, solved={}), one) for one in sets]
    )
    for one in found:
        np.testing.assert_allclose(one.gains, TRUE, rtol=1e-3)
