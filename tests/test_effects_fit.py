"""Every effect in a fit of measurements that do not have it: it changes nothing, and says so."""

from dataclasses import replace

import numpy as np
import pytest

from bench.basics.errors import BenchError
from bench.effects import CATALOGUE, places_in, select_effects
from bench.identification.identify import fit, identify
from bench.identification.model_json import to_json
from bench.identification.prepare import Prepared, prepare, with_effects, with_gains
from bench.identification.problem import problem_of
from bench.identification.result import Identification

MOST_DEVIATIONS = 4.5
ABSORBED = {("rotor_inertia", "Ia"), ("payload_mass_error", "dm")}
WITHOUT_COLUMN = {
    ("base_tilt", "tilt_x"),
    ("platform_force", "Fy"),
    ("platform_force", "ky"),
}  # out of the plane


@pytest.fixture(scope="module")
def prepared(five_bar_equations: Prepared) -> Prepared:
    return five_bar_equations


@pytest.fixture(scope="module")
def plain(prepared: Prepared) -> Identification:
    return fit(prepared)


def fitted_with(prepared: Prepared, *names: str) -> Identification:
    places = places_in(prepared.model.geometry, list(prepared.dataset.payloads))
    return fit(with_effects(prepared, select_effects(names, places)))


@pytest.mark.parametrize("name", CATALOGUE)
def test_an_effect_that_is_not_there_is_found_to_be_zero(
    name: str, prepared: Prepared, plain: Identification
) -> None:
    result = fitted_with(prepared, name)
    assert result.error.identify <= plain.error.identify * (1 + 1e-6)
    assert result.error.validate <= plain.error.validate * 1.02
    for joint, gain in result.drive_gains.items():
        assert gain.value == pytest.approx(plain.drive_gains[joint].value, rel=0.003)
    assert result.rank == result.unknowns
    shapes = {one.name for one in CATALOGUE[name].shape}
    for place, values in result.effect_parameters[name].items():
        for symbol, one in values.items():
            assert np.isfinite(one.value)
            if symbol in shapes:
                continue
            if (name, symbol) in ABSORBED | WITHOUT_COLUMN:
                assert (one.value, one.std) == (0.0, float("inf"))
                assert any(f"{symbol} of {name}" in note for note in result.notes)
            else:
                assert abs(one.value) < MOST_DEVIATIONS * one.std, (place, symbol)


def test_what_is_absorbed_leaves_the_model_as_it_is(prepared: Prepared, plain: Identification) -> None:
    result = fitted_with(prepared, "rotor_inertia", "payload_mass_error")
    before, after = to_json(plain), to_json(result)
    for old, new in zip(before["parameters"], after["parameters"], strict=True):
        assert new == {**old, "value": pytest.approx(old["value"]), "std": pytest.approx(old["std"])}
    for joint, old in before["drive_gains"].items():
        new = after["drive_gains"][joint]
        assert new == {**old, "value": pytest.approx(old["value"]), "std": pytest.approx(old["std"])}
    assert after["effect_parameters"]["rotor_inertia"]["left"]["Ia"]["std"] is None


def test_a_wrong_payload_mass_shows_where_the_gains_are_known(prepared: Prepared) -> None:
    payload = prepared.dataset.payloads["disc"]
    heavier = replace(payload, mass=payload.mass * 1.05, inertia=payload.inertia * 1.05)
    dataset = replace(prepared.dataset, payloads={"disc": heavier})
    gains = [gain.value for gain in fit(prepared).drive_gains.values()]
    motors = tuple(replace(one, gain=gain) for one, gain in zip(dataset.robot.actuators, gains, strict=True))
    dataset = replace(dataset, robot=replace(dataset.robot, actuators=motors))
    known = fit(with_gains(prepare(problem_of(dataset, ["payload_mass_error"])), False))
    found = known.effect_parameters["payload_mass_error"]["disc"]["dm"]
    assert found.value == pytest.approx(-0.05 * payload.mass, abs=4 * found.std)
    assert found.std < 0.1 * abs(found.value)


def test_several_effects_that_say_the_same_are_left_out_but_one(prepared: Prepared) -> None:
    result = fitted_with(prepared, "constant_offset", "joint_spring", "coulomb_friction", "stribeck_friction")
    assert result.rank == result.unknowns
    for place in ("left", "right"):
        assert np.isinf(result.effect_parameters["joint_spring"][place]["kq0"].std)
        assert np.isinf(result.effect_parameters["stribeck_friction"][place]["Fc"].std)
        assert np.isfinite(result.effect_parameters["constant_offset"][place]["c"].std)
        assert np.isfinite(result.effect_parameters["stribeck_friction"][place]["Fs"].std)


@pytest.mark.parametrize("method", ["ls", "wls", "tls", "wtls"])
def test_every_estimator_takes_effects_of_every_kind(method: str, prepared: Prepared) -> None:
    names = [
        "viscous_friction",
        "rotor_inertia",
        "base_tilt",
        "passive_viscous_friction",
        "payload_mass_error",
    ]
    result = identify(prepare(problem_of(prepared.dataset, names)), method)
    assert result.rank == result.unknowns
    assert result.error.validate < 0.0015


def test_essential_parameters_beside_an_effect_that_is_absorbed(prepared: Prepared) -> None:
    result = identify(
        prepare(problem_of(prepared.dataset, ["rotor_inertia", "viscous_friction"])), essential=True
    )
    assert np.isinf(result.effect_parameters["rotor_inertia"]["left"]["Ia"].std)
    assert result.effect_parameters["viscous_friction"]["left"]["Fv"].std < 1e-3


def test_an_effect_at_one_place_only(prepared: Prepared) -> None:
    result = fitted_with(prepared, "geometric_error:left_rod", "stribeck_friction:right")
    assert set(result.effect_parameters["geometric_error"]) == {"left_rod"}
    assert set(result.effect_parameters["stribeck_friction"]) == {"right"}
    with pytest.raises(BenchError, match=r"no body 'left_elbow'.*world, left_crank, left_rod"):
        fitted_with(prepared, "geometric_error:left_elbow")
