"""Rows of effects that are kept: what is given back is what was computed, and memory is bounded."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from bench.effects import CATALOGUE, EffectInstance, RobotSignals
from bench.effects.body_length import lengths, with_length
from bench.effects.checked_columns import columns_at_motors
from bench.effects.row_cache import KeptRows
from bench.effects.signals import Changed
from bench.identification import effect_rows
from bench.model.motion import motion_of
from tests.effects_kit import moving_robot, rigid_torque


def test_rows_come_back_as_they_were_and_the_oldest_go_first() -> None:
    kept = KeptRows(most_bytes=2 * 8 * 100)
    rows = np.zeros((100, 2, 3))
    for i in range(3):
        rows[:, 1, 2] = i + 1.0
        kept.keep(i, rows)
    assert kept.get(0) is None
    for i in (1, 2):
        found = kept.get(i)
        assert found is not None
        np.testing.assert_array_equal(found[:, 1, 2], i + 1.0)
        assert found.shape == rows.shape

        assert np.count_nonzero(found) == 100


def test_rows_without_motors_come_back_too() -> None:
    kept, rows = KeptRows(), np.zeros((5, 8))
    rows[:, 3] = 2.0
    kept.keep("bearing", rows)
    np.testing.assert_array_equal(kept.get("bearing"), rows)


def test_effects_are_computed_once_for_a_model_and_again_for_another(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    robot, _, measured, _ = moving_robot("five_bar", tmp_path, samples=601)
    joint = next(iter(robot.joints))
    effects = [
        EffectInstance(CATALOGUE[name], joint, name) for name in ("viscous_friction", "encoder_offset")
    ]
    calls: list[str] = []

    def counted(one: EffectInstance, seen: RobotSignals) -> tuple[np.ndarray, np.ndarray]:
        calls.append(one.request)
        return columns_at_motors(one, seen)

    monkeypatch.setattr(effect_rows, "columns_at_motors", counted)
    first = effect_rows.effect_rows(robot, 10, effects)
    np.testing.assert_array_equal(effect_rows.effect_rows(robot, 10, effects[::-1])[:, :, ::-1], first)
    assert calls == ["viscous_friction", "encoder_offset"]
    assert robot.lasting is measured.kept


def test_another_gravity_or_length_gives_the_rows_of_that_robot(tmp_path: Path) -> None:
    robot, model, measured, present = moving_robot("five_bar", tmp_path, samples=601)
    turned = np.array([1.0, -2.0, -9.0])
    body = next(iter(lengths(model.geometry).values()))
    longer = with_length(model.geometry, body, 0.01)
    step = slice(None, None, 3)
    active = measured.position[step], measured.velocity[step], measured.acceleration[step]
    for _ in range(2):  # computed, then kept
        tree = motion_of(model.geometry, measured.time[step], *active)
        wanted = rigid_torque(model, present, replace(model.geometry, gravity=turned), tree)
        np.testing.assert_allclose(robot.torque(Changed(gravity=turned), 3), wanted, atol=1e-11)
        wanted = rigid_torque(model, present, longer, motion_of(longer, measured.time[step], *active))
        np.testing.assert_allclose(robot.torque(Changed(geometry=longer), 3), wanted, atol=1e-9)
