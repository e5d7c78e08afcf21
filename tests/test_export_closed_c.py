"""The feed-forward in C where joints without a motor follow from loops and couplings, beside the one in Python."""

from dataclasses import replace

import numpy as np
import pytest

from bench.effects import CATALOGUE
from bench.effects.passive_joint import PassiveEffect
from bench.export.c_code import PASSIVE_LAWS, c_name, c_text
from bench.export.feedforward import Feedforward
from bench.model.model import build_model
from tests.c_kit import Closed, library
from tests.export_kit import identified
from tests.mechanisms import movement, robot_named
from tests.test_export_files import with_effects

FULL_SCALE = 1e-12
OPEN, SINGULAR, TOO_FAR, NOT_FINITE = 1, 2, 3, 4
ALL_THERE_IS = (
    "ball",
    "belted",
    "carried",
    "delta",
    "five_bar",
    "geared",
    "palletiser",
    "stewart",
    "tilted",
    "welded",
)
"""Robots that together have every kind of joint and of closure."""
EFFECTS = (
    ("coulomb_friction", "left", {"Fc": 0.3}),
    ("gain_saturation", "right", {"k": 0.02}),
    ("load_dependent_friction", "left", {"mu": 0.07}),
    ("passive_coulomb_friction", "left_elbow", {"Fc": 0.2}),
    ("passive_rotor_inertia", "right_elbow", {"Ia": 0.01}),
    ("passive_spring", "right_elbow", {"k": 0.5, "kq0": 0.1}),
    ("passive_viscous_friction", "left_elbow", {"Fv": 0.3}),
    ("rotor_inertia", "right", {"Ia": 0.02}),
)


def stand_in(robot):
    """A model of a robot that was never identified: random base parameters and gains."""
    built, random = build_model(robot), np.random.default_rng(11)
    return replace(
        identified("two_link"),
        robot=robot,
        model=built,
        base=random.normal(size=len(built.base.columns)),
        gains=random.uniform(2.0, 4.0, len(robot.joints)),
        effects=(),
    )


def closed(model, folder):
    """The compiled functions of a model."""
    geometry = model.model.geometry
    sizes = geometry.nq + len(geometry.passive) * len(geometry.active)
    return Closed(library(c_text(model)[0], folder), c_name(model.robot.name), sizes)


def home_of(model):
    geometry = model.model.geometry
    return geometry.home[geometry.active_configuration] + geometry.active_offset


@pytest.mark.parametrize("name", ALL_THERE_IS)
def test_c_is_python_to_rounding(name, tmp_path):
    model = stand_in(robot_named(name, tmp_path))
    fast, slow = closed(model, tmp_path), Feedforward(model)
    assert fast.started == 0
    _, *states = movement(model.model.geometry, samples=21)
    wanted = np.array([slow(*state) for state in zip(*states, strict=True)])
    found = [fast(*state) for state in zip(*states, strict=True)]
    assert {code for code, _ in found} == {0}
    off = np.array([currents for _, currents in found]) - wanted
    assert np.all(np.abs(off).max(axis=0) < FULL_SCALE * np.abs(wanted).max(axis=0))


@pytest.fixture(scope="module")
def five_bar():
    return identified("five_bar")


def test_effects_at_motors_and_in_passive_joints(five_bar, tmp_path):
    assert set(PASSIVE_LAWS) == {name for name, law in CATALOGUE.items() if isinstance(law, PassiveEffect)}
    model = with_effects(five_bar, *EFFECTS)
    assert c_text(model)[1] == ()
    fast, slow = closed(model, tmp_path), Feedforward(model)
    _, *states = movement(model.model.geometry, samples=21)
    for state in zip(*states, strict=True):
        wanted = slow(*state)
        code, found = fast(*state)
        assert code == 0
        assert found == pytest.approx(wanted, rel=1e-12, abs=1e-12)


def test_a_leap_is_followed_and_two_states_do_not_disturb_each_other(five_bar, tmp_path):
    first, still = closed(five_bar, tmp_path), np.zeros(2)
    (tmp_path / "other").mkdir()
    second = closed(five_bar, tmp_path / "other")
    away = home_of(five_bar) + np.array([0.8, -0.6])
    slow = Feedforward(five_bar)
    for fast, place in ((first, away), (second, home_of(five_bar)), (first, away)):
        code, found = fast(place, np.ones(2), still)
        assert code == 0
        assert found == pytest.approx(slow(place, np.ones(2), still), rel=1e-11)


@pytest.mark.parametrize(
    ("offset", "codes"),
    [((np.nan, 0.0), {OPEN}), ((1.8, -1.8), {OPEN, SINGULAR}), ((1e4, 0.0), {OPEN, SINGULAR, TOO_FAR})],
)
def test_what_cannot_be_reached_is_told_and_leaves_all_as_it_was(five_bar, tmp_path, offset, codes):
    fast, still = closed(five_bar, tmp_path), np.zeros(2)
    before = fast.state.copy()
    code, found = fast(home_of(five_bar) + np.array(offset), still, still)
    assert code in codes
    assert np.isnan(found).all()
    assert np.array_equal(fast.state, before)
    assert fast(home_of(five_bar), still, still)[0] == 0


def test_velocities_that_are_no_numbers_make_no_currents(five_bar, tmp_path):
    fast, still = closed(five_bar, tmp_path), np.zeros(2)
    before = fast.state.copy()
    code, found = fast(home_of(five_bar), np.array([np.nan, 0.0]), still)
    assert code == NOT_FINITE
    assert np.isnan(found).all()
    assert np.array_equal(fast.state, before)


def test_bounds_of_arrays_are_kept(tmp_path):
    model = stand_in(robot_named("ball", tmp_path))
    checked = library(
        c_text(model)[0], tmp_path, ("-O1", "-fsanitize=undefined", "-fno-sanitize-recover=all")
    )
    geometry = model.model.geometry
    fast = Closed(
        checked, c_name(model.robot.name), geometry.nq + len(geometry.passive) * len(geometry.active)
    )
    assert fast(home_of(model), np.ones(1), np.ones(1))[0] == 0
