"""The catalogue of effects: folder, mapping and documentation in step; the contract of every class."""

import json
import math
import re
from dataclasses import FrozenInstanceError, fields, replace

import pytest

from bench.effects import CATALOGUE, Effect
from bench.effects.user_file import effect_fault

FORMATS = {  # the names that other programs rely on
    *("viscous_friction", "asymmetric_viscous_friction", "coulomb_friction", "constant_offset"),
    *("stribeck_friction", "quadratic_drag", "load_dependent_friction", "position_dependent_friction"),
    *(
        "presliding_hysteresis",
        "thermal_friction_drift",
        "passive_viscous_friction",
        "passive_coulomb_friction",
    ),
    *(
        "rotor_inertia",
        "cogging_torque",
        "torque_ripple",
        "gain_saturation",
        "current_delay",
        "current_loop_lag",
    ),
    *("drive_flexibility", "backlash", "joint_spring", "base_tilt", "platform_force", "payload_mass_error"),
    *("geometric_error", "encoder_offset", "passive_spring", "transmission_error"),
    *("hysteretic_cable", "shear_thinning_friction", "tool_drag"),
    "passive_load_friction",
    "passive_rotor_inertia",
}
UNIT = re.compile(r"1|1/(turn|A\^2|V\^2|m)|[A-Za-z]+([*/^(][A-Za-z0-9()*/^]+)?")


@pytest.fixture(params=CATALOGUE, ids=str)
def effect(request: pytest.FixtureRequest) -> Effect:
    return CATALOGUE[request.param]


def test_the_mapping_is_sorted_complete_and_named_as_promised() -> None:
    assert list(CATALOGUE) == sorted(CATALOGUE)
    assert set(CATALOGUE) >= FORMATS


def test_every_law_is_called_as_its_file() -> None:
    for name, effect in CATALOGUE.items():
        assert name == effect.name
        assert type(effect).__module__ == f"bench.effects.laws.{name}"


def test_a_class_is_sound_frozen_and_documented(effect: Effect) -> None:
    assert effect_fault(effect) is None
    text = " ".join((type(effect).__doc__ or "").split())
    assert "Source: " in text
    assert "Valid " in text
    assert effect.law.endswith(".")
    text = f"{effect.law} {effect.symbols} {text}"
    for one in (*effect.parameters, *effect.shape):
        symbol = (
            "N: periods" if one.name == "periods" else "h: harmonic" if one.name == "harmonic" else one.name
        )
        assert symbol in text, f"{one.name} is not explained"
    with pytest.raises(FrozenInstanceError):
        effect.some_name = 1.0  # type: ignore[attr-defined]


def test_special_cases_are_effects_with_no_more_parameters(effect: Effect) -> None:
    for name in effect.contains:
        smaller = CATALOGUE[name]
        count = len(effect.parameters) + len(effect.shape)
        assert len(smaller.parameters) + len(smaller.shape) < count
        assert smaller.place == effect.place


@pytest.mark.parametrize("drive", ["A", "V"])
@pytest.mark.parametrize("rotates", [True, False])
def test_units_are_filled_in(effect: Effect, rotates: bool, drive: str) -> None:
    for one in (*effect.parameters, *effect.shape):
        unit = one.unit_at(rotates, drive)
        assert UNIT.fullmatch(unit), unit
        assert ("rad" not in unit and "turn" not in unit) or rotates or effect.place == "robot"


def test_shape_values_survive_a_round_trip_through_json(effect: Effect) -> None:
    values = {one.name: 1.25 * one.candidates[-1] for one in effect.shape}
    shaped = replace(effect, **values)
    again = replace(effect, **json.loads(json.dumps(shaped.shape_values())))
    assert again == shaped
    assert shaped.shape_values() == values
    assert (shaped != effect) == bool(values)


def test_linearising_changes_only_the_fields_named_like_linear_parameters(effect: Effect) -> None:
    values = {one.name: 0.02 * (i + 1) for i, one in enumerate(effect.parameters)}
    about = effect.about(values)
    own = {field.name for field in fields(effect)}
    for one in effect.parameters:
        assert one.name not in own or getattr(about, one.name) == values[one.name]
    assert about.shape_values() == effect.shape_values()
    assert (about != effect) == bool(own & set(values))


def test_candidates_rise_and_brackets_hold_them(effect: Effect) -> None:
    for parameter in effect.shape:
        assert list(parameter.candidates) == sorted(set(parameter.candidates))
        assert all(value >= 0 and math.isfinite(value) for value in parameter.candidates)
        for low, value, high in effect.brackets(parameter, ()):
            assert low <= value <= high
            # a compliance of zero swings nothing; a search for play begins at values from the motor's error
            fixed = parameter.discrete or effect.name in ("drive_flexibility", "backlash")
            assert (low == high) == fixed
