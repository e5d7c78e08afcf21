"""The search of `bench excite`: derivatives beside difference quotients, and steps that keep what they promise."""

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest

from bench.basics.errors import BenchError
from bench.dataset.robot import load_robot
from bench.effects import CATALOGUE
from bench.excitation.bounds import FORECAST, LIMITS, SEARCH
from bench.excitation.experiment import descent
from bench.excitation.experiment import linearised as linear
from bench.excitation.experiment.covariance import RelativeErrors, Volume
from bench.excitation.experiment.descent import begun, best_near, descended
from bench.excitation.experiment.linearised import coefficient_sizes, linearised, moved
from bench.excitation.experiment.nominal import Equations, reference_sizes, seen
from bench.excitation.experiment.plan import Aim, nominal_machine, shape_of, started
from bench.excitation.experiment.request import ExperimentTable
from bench.excitation.experiment.room import room_of
from bench.model.motion import motion_of

STEP = 1e-4  # of the largest size of a coefficient
BOX = {"low": [-0.6, -0.6, -0.9], "high": [0.6, 0.6, 0.5]}


def search_of(robot, criterion="worst", **limits):
    """A search among few motions, and those at random."""
    quick = {"duration": 4.0, "harmonics": 3, "velocity": 4.0, "acceleration": 40.0, "payload": {"mass": 0.5}}
    table = ExperimentTable.model_validate(quick | limits)
    nominal = nominal_machine(load_robot(robot), table, ["viscous_friction"], CATALOGUE)
    room = room_of(nominal.model.geometry, table)
    begin = started(nominal, room, shape_of(room, table), (None, *nominal.payloads), Aim(criterion=criterion))
    return begin.search, begin.random


@pytest.fixture(scope="module")
def five_bar():
    return search_of("five_bar", workspace=[BOX], torque=30.0)


@pytest.fixture(scope="module", params=["worst", "d-optimal"])
def either(request, five_bar):
    return five_bar if request.param == "worst" else search_of("five_bar", request.param)


def changed(search, candidate, number, steps):
    """The candidate with one motion's coefficients changed, limits or not."""
    before = candidate[number]
    tried = search.tried(moved(before.trajectory, steps), search.loads[number], before.motion)
    assert tried is not None
    return (*candidate[:number], tried, *candidate[number + 1 :])


def test_slopes_of_errors_are_difference_quotients(either, monkeypatch):
    monkeypatch.setattr(linear, "SEARCH", replace(SEARCH, near=-np.inf))
    search, starts = either
    smaller = [
        search.tried(m.trajectory.scaled(0.7), load) for m, load in zip(starts[0], search.loads, strict=True)
    ]
    candidate = tuple(smaller)
    (about,), at = linearised(search, [candidate]), 0
    random = np.random.default_rng(3)
    for number, motion in enumerate(candidate):
        sizes = coefficient_sizes(search.room, motion.trajectory)
        direction = random.normal(size=sizes.shape)
        both = [changed(search, candidate, number, sign * STEP * direction * sizes) for sign in (1.0, -1.0)]
        plus, minus = (search.errors(search.fit(other)) for other in both)
        quotient = (plus - minus) / (2.0 * STEP)
        slope = about.errors.slopes[:, at : at + sizes.size] @ direction.ravel()
        np.testing.assert_allclose(slope, quotient, rtol=2e-3, atol=2e-3 * np.abs(quotient).max())
        assert about.mean[at : at + sizes.size] @ direction.ravel() == pytest.approx(
            quotient.mean(), rel=2e-3, abs=2e-3 * np.abs(quotient).max()
        )
        at += sizes.size


def test_slopes_of_limits_are_difference_quotients(five_bar, monkeypatch):
    """Ranges, speeds, accelerations, singular poses, amplification, box and torques, at every sample."""
    monkeypatch.setattr(linear, "SEARCH", replace(SEARCH, near=-np.inf))
    monkeypatch.setattr(linear, "LIMITS", replace(LIMITS, poses=10_000))
    search, starts = five_bar
    candidate = starts[0]
    sizes = coefficient_sizes(search.room, candidate[0].trajectory)
    smaller = -np.sign(np.stack((candidate[0].trajectory.a, candidate[0].trajectory.b)))
    other = changed(search, candidate, 0, STEP * smaller * sizes)
    before, after = (about.limits for about in linearised(search, [candidate, other]))
    slope = before.slopes[:, : sizes.size] @ smaller.ravel()
    off = np.abs((after.values - before.values) / STEP - slope)
    bends = (
        np.abs((after.slopes - before.slopes)[:, : sizes.size]).max(axis=1) > 0.1
    )  # another largest entry, or sign
    assert bends.mean() < 0.05
    assert off[~bends].max() < 2e-2 * np.abs(slope).max()
    assert np.median(off) < 1e-3 * np.abs(slope).max()


@pytest.mark.parametrize(("criterion", "share"), [("worst", 0.6), ("d-optimal", 0.75)])
def test_steps_never_get_worse_and_get_far_better(criterion, share):
    search, starts = search_of("two_link", criterion)
    assert isinstance(search.errors, RelativeErrors if criterion == "worst" else Volume)
    start = begun(search, starts[0])
    way = [start]
    for _ in range(8):
        way += descended(search, way[-1:], 1)
    merits = [place.merit for place in way]
    assert all(after <= before for before, after in pairwise(merits))
    assert search.value(way[-1].candidate) < share * search.value(start.candidate)


def test_no_steps_leave_the_best_start(five_bar):
    search, starts = five_bar
    assert best_near(search, starts, 0) is min(starts, key=lambda start: begun(search, start).merit)


def test_a_solver_that_fails_is_told_in_a_line(five_bar, monkeypatch):
    class Failed:
        x, message = None, "time limit reached"

    monkeypatch.setattr(descent, "linprog", lambda *_, **__: Failed)
    search, starts = five_bar
    with pytest.raises(BenchError, match="linear program failed: time limit reached"):
        descended(search, [begun(search, starts[0])], 1)


def equations_of(lengths, dependent=False):
    """Equations of 200 rows with unit noise and columns of these lengths; dependent: the last two are one column."""
    columns = np.linalg.qr(np.random.default_rng(5).normal(size=(200, len(lengths))))[0] * lengths
    if dependent:
        columns[:, -1] = columns[:, -2]
    return Equations(columns.T @ columns, columns.T @ columns)


def test_unknowns_of_small_effect_have_their_standard_errors():
    """Beside one that is known to 1e-6, unknowns with errors of 1 % to 100 times their size."""
    lengths = np.array([1e6, 1e2, 1.0, 1e-2, 1e-2])
    errors = RelativeErrors(np.ones(5), np.arange(5))
    fit = equations_of(lengths)
    np.testing.assert_allclose(np.exp(errors(fit)), 1.0 / lengths, rtol=1e-6)
    twice = Equations(2.0 * fit.normal, 2.0 * fit.score)
    np.testing.assert_allclose(errors(twice), errors(fit) - 0.5 * np.log(2.0))


def test_an_undetermined_combination_is_large_and_leaves_the_others():
    lengths = np.array([1e6, 1e2, 1.0, 1e-2, 1e-2])
    errors = RelativeErrors(np.ones(5), np.arange(5))(equations_of(lengths, dependent=True))
    np.testing.assert_allclose(np.exp(errors[:3]), 1.0 / lengths[:3], rtol=1e-6)
    np.testing.assert_allclose(np.exp(errors[3:]), FORECAST.open * np.sqrt(0.5), rtol=1e-6)


def test_centres_of_mass_at_the_joints_are_compared_to_what_such_bodies_can_have():
    nominal = nominal_machine(load_robot("stewart"), ExperimentTable(), [], CATALOGUE)
    units = np.array(nominal.model.base.units)
    largest = {unit: np.abs(nominal.base[units == unit]).max() for unit in ("kg", "kg*m^2")}
    rest = motion_of(nominal.model.geometry, np.zeros(1), *np.zeros((3, 1, len(nominal.gains))))
    balanced = replace(nominal, base=np.where(units == "kg*m", 1e-12, nominal.base))
    sizes = reference_sizes(balanced, [seen(nominal, rest, None)])[: len(units)]
    expected = FORECAST.smallest_size * np.sqrt(largest["kg"] * largest["kg*m^2"])
    np.testing.assert_allclose(sizes[units == "kg*m"], expected)
