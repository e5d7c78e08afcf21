"""What a search takes for small changes is what the changes are, to second order."""

from dataclasses import replace

import numpy as np
import pytest

from bench.effects import CATALOGUE, EffectInstance, effect_columns
from bench.effects.body_length import lengths
from bench.identification import observation_matrix
from bench.identification.effect_columns import robot_signals
from bench.identification.effect_rows import effect_rows
from bench.identification.perturbations import Nearby
from bench.identification.standstill import standstills
from bench.model.motion import motion_of
from tests.effects_kit import RATE, moving_robot

DECIMATION = 20
OFFSET = 0.02  # rad
VALUES = {
    "geometric_error": {"dl": 0.003},
    "encoder_offset": {"offset": 0.03},
    "backlash": {"b": 0.005},
    "base_tilt": {"tilt_x": 0.05, "tilt_y": -0.03},
    "drive_flexibility": {"C": 2e-4},
    "transmission_error": {"a": 0.02, "b": -0.01},
}


@pytest.fixture(scope="module", params=["five_bar", "delta", "two_link"])
def seen(request, tmp_path_factory):
    folder = tmp_path_factory.mktemp("robots")
    robot, model, measured, present = moving_robot(request.param, folder, samples=3001)
    return robot, Nearby(model, [measured]).signals(present, [robot])[0], model


@pytest.mark.parametrize("name", sorted(VALUES))
@pytest.mark.parametrize("share", [0.0, 1.0])
def test_columns_of_a_search_are_those_of_a_fit(seen, name, share):
    exact, near, model = seen
    values = {key: share * value for key, value in VALUES[name].items()}
    places = {"geometric_error": list(lengths(model.geometry)), "base_tilt": [""]}
    for joint in places.get(name, list(exact.joints)):
        one = EffectInstance(CATALOGUE[name].about(values), joint, name)
        wanted, found = (effect_rows(each, DECIMATION, [one]) for each in (exact, near))
        scale = np.sqrt((wanted**2).mean()) or 1.0
        assert np.sqrt(((found - wanted) ** 2).mean()) < 0.01 * scale, joint


@pytest.mark.parametrize("name", ["coulomb_friction", "rotor_inertia", "stribeck_friction"])
def test_effects_without_a_model_or_that_need_every_sample_are_the_same_to_the_last_digit(seen, name):
    exact, near, _ = seen
    one = EffectInstance(CATALOGUE[name], next(iter(exact.joints)), "")
    np.testing.assert_array_equal(effect_rows(near, DECIMATION, [one]), effect_rows(exact, DECIMATION, [one]))


@pytest.mark.parametrize("name", ["cogging_torque", "gain_saturation", "torque_ripple"])
def test_those_that_change_little_between_few_samples_are_seen_at_few_samples(seen, name):
    exact, near, _ = seen
    assert len(near.sparsely.time) < len(exact.time) / 4
    one = EffectInstance(CATALOGUE[name], next(iter(exact.joints)), "")
    gaps = standstills(exact.position, exact.velocity, np.zeros((len(exact.time), 0)), RATE, 100.0)
    wanted, found = (effect_rows(replace(each, gaps=gaps), DECIMATION, [one]) for each in (exact, near))
    assert wanted.shape == found.shape
    assert np.abs(wanted - found).max() > 0.0
    assert np.sqrt(((found - wanted) ** 2).mean()) < 0.01 * np.sqrt((wanted**2).mean())


def test_waves_too_fast_for_few_samples_are_not_taken_for_slow_ones(seen):
    exact, near, _ = seen
    joint = next(iter(exact.joints))
    swift = float(np.abs(exact.joints[joint].velocity).max())
    if not exact.joints[joint].rotates:
        swift *= 2.0 * np.pi
    folded = (
        2.0 * np.pi * near.sparsely.joints[joint].rate / swift
    )  # follows the few samples as if it stood still
    one = EffectInstance(CATALOGUE["cogging_torque"].__class__(periods=folded), joint, "")
    wanted, found = (effect_rows(each, DECIMATION, [one]) for each in (exact, near))
    assert np.sqrt(((found - wanted) ** 2).mean()) < 0.5 * np.sqrt((wanted**2).mean())


def test_columns_filtered_together_are_those_of_each_alone(seen):
    exact, *_ = seen
    names = ("viscous_friction", "stribeck_friction", "cogging_torque", "encoder_offset")
    every = [EffectInstance(CATALOGUE[name], joint, "") for name in names for joint in exact.joints]
    together = effect_rows(exact, DECIMATION, every)
    alone = np.concatenate([effect_rows(replace(exact), DECIMATION, [one]) for one in every], axis=2)
    assert effect_columns(every[0], exact).shape == (len(exact.time), len(exact.joints), 1)
    np.testing.assert_allclose(together, alone, atol=1e-9 * np.abs(alone).max())


def test_rows_of_a_robot_with_a_tool_are_the_regressor_s_own_and_no_copy(tmp_path, monkeypatch):
    made, regressor = [], observation_matrix.projected_regressor
    monkeypatch.setattr(
        observation_matrix, "projected_regressor", lambda *given: made.append(regressor(*given)) or made[-1]
    )
    _, model, measured, _ = moving_robot("delta", tmp_path, samples=3001)
    assert np.shares_memory(Nearby(model, [measured])._base_rows, made[0])


def test_torque_that_the_model_needs_with_an_offset_is_known_nearby(tmp_path):
    exact, near = with_offset("delta", tmp_path)
    for joint in exact.joints:
        wanted, found = (each.joints[joint].needed_torque for each in (exact, near))
        without = exact.refined(exact.coarse.torque)[:, list(exact.joints).index(joint)]
        assert np.abs(found - wanted).max() < 0.01 * np.abs(wanted - without).max()


@pytest.mark.parametrize("name", ["five_bar", "delta"])
def test_the_motion_with_an_offset_is_that_of_the_shifted_encoder(name, tmp_path):
    exact, _ = with_offset(name, tmp_path)
    shift = np.zeros(len(exact.joints))
    shift[0] = OFFSET
    wanted = motion_of(
        exact.geometry,
        exact.time,
        exact.position - shift,
        exact.velocity,
        exact.acceleration,
        near=exact.tree,
    )
    for part in ("q", "v", "a", "jacobian"):
        there, here = (getattr(tree, part) for tree in (wanted, exact.tree))
        assert np.abs(there - here).max() < 1e-5 * np.abs(there).max(), part


def with_offset(name, folder):
    """A moving robot whose first encoder is off, exactly and as a search sees it."""
    robot, model, measured, present = moving_robot(name, folder, samples=3001)
    joint = next(iter(robot.joints))
    offset = EffectInstance(CATALOGUE["encoder_offset"].about({"offset": OFFSET}), joint, "encoder_offset")
    present = replace(present, effects=((offset, np.array([OFFSET])),))
    exact = robot_signals(model, measured, present)
    return exact, Nearby(model, [measured]).signals(present, [exact])[0]
