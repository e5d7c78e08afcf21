"""Deviations of gains hold what models that are as good make of them."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from bench.dataset.robot import load_robot
from bench.diagnosis import as_good
from bench.diagnosis.pruning import impossible_but_needed
from bench.diagnosis.reason import Because, Reason
from bench.diagnosis.search import Scored
from bench.effects import CATALOGUE, EffectInstance
from bench.identification.model_averaged import gains_model_averaged
from bench.identification.result import Quantity
from tests.shown import dataset_of, identification_of


@pytest.fixture(scope="module")
def result():
    return identification_of(dataset_of(load_robot("five_bar")))


def with_left(result, value):
    gains = {**result.drive_gains, "left": replace(result.drive_gains["left"], value=value)}
    return replace(result, drive_gains=gains)


def test_a_gain_that_moves_has_that_for_its_deviation(result):
    gain = result.drive_gains["left"]
    others = [with_left(result, gain.value + 20.0 * gain.std), with_left(result, gain.value - 5.0 * gain.std)]
    wide = gains_model_averaged(result, others)
    assert wide.std_from == "models"
    assert wide.drive_gains["left"].std == pytest.approx(20.0 * gain.std)
    assert wide.drive_gains["left"].value == gain.value
    assert wide.drive_gains["right"] == result.drive_gains["right"]
    times = np.array(
        [20.0 if (one.kind, one.place) == ("gain", "left") else 1.0 for one in result.covariance_rows]
    )
    assert np.allclose(wide.covariance, result.covariance * np.outer(times, times))


def test_deviations_never_become_smaller(result):
    gain = result.drive_gains["left"]
    assert gains_model_averaged(result, [with_left(result, gain.value + 0.5 * gain.std)]) is result
    assert gains_model_averaged(result, []) is result


def test_an_effect_left_out_at_a_cost_goes_with_its_reason(result):
    stribeck = EffectInstance(CATALOGUE["stribeck_friction"], "left", "stribeck_friction:left")
    values = {"Fc": Quantity(3.0, 0.1, "N*m"), "Fs": Quantity(-1.0, 0.1, "N*m")}
    whole = replace(result, effect_parameters={"stribeck_friction": {"left": values}})
    why = impossible_but_needed(whole, [stribeck])["stribeck_friction"]
    assert why == Reason(Because.IMPOSSIBLE, ("Fs", "left"))
    assert impossible_but_needed(whole, []) == {}
    likely = replace(whole, effect_parameters={"stribeck_friction": {"left": {**values, "Fs": values["Fc"]}}})
    assert impossible_but_needed(likely, [stribeck]) == {}


def test_models_that_are_as_good_have_one_effect_more_or_another_for_each_identified_one(monkeypatch):
    totals = {(0, 4): 100.0, (0, 4, 1): 130.0, (0, 4, 2): 120.0, (0, 4, 3): 110.0}
    totals |= {(4, 1): 50.0, (4, 2): 95.0, (4, 3): 99.0, (0, 1): 97.0, (0, 2): 92.0, (0, 3): 10.0}
    monkeypatch.setattr(
        as_good,
        "scored",
        lambda _, sets: [Scored(SimpleNamespace(chosen=chosen), 0.0, totals[chosen]) for chosen in sets],
    )
    monkeypatch.setattr(as_good, "close", lambda one, other: one.total - other.total < 10.0)
    best = Scored(SimpleNamespace(chosen=(0, 4)), 0.0, 100.0)
    last = SimpleNamespace(
        system=None,
        selection=SimpleNamespace(selected=best),
        proposals=[SimpleNamespace(absorbed=False, name="")] * 5,
        chosen=(0, 4),
    )
    assert list(as_good._as_good(last)) == [(0, 4, 1), (0, 4, 2), (4, 3), (0, 1)]
