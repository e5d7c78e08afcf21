"""Rows of effects that are kept: what is given back is what was computed, and memory is bounded."""

from pathlib import Path

import numpy as np
import pytest

from bench.effects import CATALOGUE, EffectInstance
from bench.effects.kept import KeptRows
from bench.estimate import observation
from tests.effects_kit import moving_robot


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


def test_effects_are_computed_once_for_a_model_and_again_for_another(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    robot, _, measured, _ = moving_robot("five_bar", tmp_path, samples=601)
    joint = next(iter(robot.joints))
    effects = [
        EffectInstance(CATALOGUE[name], joint, name) for name in ("viscous_friction", "encoder_offset")
    ]
    calls = []
    evaluate = observation.effect_columns
    monkeypatch.setattr(
        observation, "effect_columns", lambda one, seen: calls.append(one.request) or evaluate(one, seen)
    )
    first = observation.effect_rows(robot, 10, effects)
    np.testing.assert_array_equal(observation.effect_rows(robot, 10, effects[::-1])[:, :, ::-1], first)
    assert calls == ["viscous_friction", "encoder_offset"]
    assert robot.lasting is measured.kept
