"""Zeros of encoders, a tilt of the base and a length, identified together with the dynamics."""

import numpy as np
import pytest

from bench.dataset.robot import load_robot
from bench.effects import catalogue_for, places_in, select_effects
from bench.identification.finding import Code, Unknown
from bench.identification.identifiability_of_effects import collinear
from bench.identification.identify import identify
from bench.identification.prepare import prepare
from bench.identification.problem import problem_of
from bench.model.model import build_model
from bench.truth.dataset import as_dataset
from tests.export_kit import RICH
from tests.hidden_kit import STEP, run

TILT = {"effect": "base_tilt", "about_y": -0.015}


def test_zeros_tilt_and_a_length_are_found_together():
    hidden = (
        {"effect": "encoder_offset", "joint": "left", "offset": 0.012},
        {"effect": "encoder_offset", "joint": "right", "offset": -0.008},
        TILT,
        {"effect": "geometric_error", "joint": "left", "error": 0.002},
    )
    dataset = as_dataset(run("five_bar", *hidden, design={**RICH, "duration": 10.0}))
    result = identify(
        prepare(problem_of(dataset, ["encoder_offset", "base_tilt", "geometric_error:left_crank"]))
    )
    found = result.effect_parameters
    for quantity, true in (
        (found["encoder_offset"]["left"]["offset"], 0.012),
        (found["encoder_offset"]["right"]["offset"], -0.008),
        (found["base_tilt"]["robot"]["tilt_y"], -0.015),
        (found["geometric_error"]["left_crank"]["dl"], 0.002),
    ):
        assert quantity.value == pytest.approx(true, abs=3.5 * quantity.std)
        assert quantity.std < 0.5 * abs(true)
    assert not np.isfinite(found["base_tilt"]["robot"]["tilt_x"].std)  # gravity of a planar robot, scaled
    codes = [one.code for one in result.findings]
    assert Code.TAKEN_UP in codes
    assert Code.HARDLY_APART not in codes


def tilted():
    """At a finer step: what these two are told apart by lies at the edge of what the data tell."""
    return as_dataset(run("two_link", TILT, design=RICH, step=STEP / 2))


def test_the_zero_of_a_first_joint_and_a_tilt_are_told_only_together():
    result = identify(prepare(problem_of(tilted(), ["encoder_offset", "base_tilt"])))
    (finding,) = [one for one in result.findings if one.code in {Code.HARDLY_APART, Code.NOT_SETTLED}]
    assert {(one.effect, one.place) for one in finding.of} == {
        ("encoder_offset", "shoulder"),
        ("base_tilt", "robot"),
    }
    values = result.effect_parameters
    if finding.code == Code.NOT_SETTLED:
        assert not np.isfinite(values["encoder_offset"]["shoulder"]["offset"].std)
        assert not np.isfinite(values["base_tilt"]["robot"]["tilt_y"].std)
    else:
        assert finding.numbers["wider"] > 10.0
    assert any("measure it another way" in note and "at shoulder" in note for note in result.notes)
    alone = identify(prepare(problem_of(tilted(), ["base_tilt"])))
    tilt = alone.effect_parameters["base_tilt"]["robot"]["tilt_y"]
    assert tilt.value == pytest.approx(-0.015, abs=3.5 * tilt.std)


def test_a_combination_is_named_by_what_takes_part_in_it():
    model = build_model(load_robot("two_link"))
    effects = select_effects(
        ["encoder_offset", "base_tilt"], places_in(model.geometry, []), catalogue_for(()), []
    )
    rows = [
        Unknown("effect", one.name, instance.place, instance.effect.name)
        for instance in effects
        for one in instance.effect.parameters
    ]
    covariance = np.diag([1.0, 4.0, 0.0, 9.0])  # offsets of shoulder and elbow, tilt_x (not known), tilt_y
    assert collinear(effects, covariance, rows) == []
    covariance[0, 3] = covariance[3, 0] = -0.9999 * 3.0
    (finding,) = collinear(effects, covariance, rows)
    assert finding.of == (rows[0], rows[3])
    assert finding.numbers["wider"] == pytest.approx(100.0, rel=0.01)
