"""What the workbench's page carries is enough to find again what `bench identify` finds, in the shapes found."""

import json

import numpy as np
import pytest

from bench.dataset.dataset import load_dataset
from bench.effects import CATALOGUE, catalogue_for
from bench.identification.identify import identify
from bench.identification.model_file import apply_model, load_model, model_json
from bench.identification.prepare import prepare, with_effects
from bench.identification.problem import Problem, problem_of
from bench.identification.solve_only import solved_quickly
from bench.identification.summary import modelled_series
from bench.page.workbench import page_data as page_module
from bench.page.workbench.page_data import instances_of, page_data, with_command
from bench.page.workbench.page_files import script, style
from bench.page.workbench.system import diagnosed_model, set_apart
from tests.workbench_kit import ABSORBED, FOUND, diagnosis_of, write_dataset
from tests.workbench_sets import Carried, numbers

LAWS = (
    "coulomb_friction",
    "constant_offset",
    "current_delay",
    "geometric_error",
    "load_dependent_friction",
    "passive_viscous_friction",
    "presliding_hysteresis",
    "rotor_inertia",
    "stribeck_friction",
    "viscous_friction",
)
LINEAR = (
    (),
    FOUND,
    ("coulomb_friction",),
    ("coulomb_friction:left", "constant_offset:right"),
    ("constant_offset", "viscous_friction"),
    ("passive_viscous_friction", "viscous_friction:left"),
)
CURVED = (
    ("stribeck_friction",),
    ("load_dependent_friction", "viscous_friction:left"),
    ("presliding_hysteresis:left", "passive_viscous_friction"),
    ("coulomb_friction:left", "geometric_error:left_rod", "viscous_friction:left"),
    ("constant_offset", "coulomb_friction:left", "current_delay:left", "viscous_friction:left"),
)


@pytest.fixture(scope="module")
def dataset(tmp_path_factory):
    return load_dataset(write_dataset(tmp_path_factory.mktemp("bench") / "data"))


@pytest.fixture(scope="module")
def diagnosis(dataset):
    return diagnosis_of(dataset, names=LAWS)


@pytest.fixture(scope="module")
def carried(dataset, diagnosis):
    return json.loads(json.dumps(page_data(problem_of(dataset), diagnosis), allow_nan=False))


@pytest.fixture(scope="module")
def solver(carried):
    return Carried(carried)


@pytest.mark.parametrize("requests", LINEAR, ids=lambda one: "+".join(one) or "nothing")
def test_the_page_finds_what_identify_finds(dataset, solver, requests):
    expected = identify(prepare(problem_of(dataset, requests)))
    found = solver.fit(solver.keys(requests))
    assert found.fitted == pytest.approx(expected.error.identify, rel=5e-5)
    assert found.held_out == pytest.approx(expected.error.validate, rel=5e-5)
    for gain, other in zip(found.gains, expected.drive_gains.values(), strict=True):
        assert gain == pytest.approx(other.value, rel=5e-5)
    for key, values in found.values.items():
        effect, _, place = key.partition(":")
        known = expected.effect_parameters[effect][place or "robot"]
        for name, value in values.items():
            # four digits of what is known at all: a hundredth of its deviation where that is wider
            near = max(1e-4 * abs(known[name].value), 0.01 * known[name].std)
            assert value == pytest.approx(known[name].value, abs=near), (key, name)


@pytest.mark.parametrize("requests", CURVED, ids="+".join)
def test_shapes_and_what_follows_the_model_stay_as_found(dataset, diagnosis, carried, solver, requests):
    """The same from rows in place of products: effects in the shape that the page names, about the found model."""
    model = diagnosed_model(problem_of(dataset), diagnosis)
    keys = solver.keys(requests)
    instances = [
        one
        for one in instances_of(model, {name: CATALOGUE[name] for name in LAWS}, model.nearby())
        if one.request in keys
    ]
    for one in instances:
        told = {each["name"]: each["value"] for each in solver.places[one.request]["shape"]}
        assert told == one.effect.shape_values()
    prepared = with_effects(model.plain, instances, model.complete.present)
    _, expected = solved_quickly(prepared)
    found = solver.fit(keys)
    np.testing.assert_allclose(found.gains, expected.gains, rtol=1e-4)
    squares = [
        modelled_series(prepared, one, expected) for one in prepared.observations if one.use == "validate"
    ]
    left = sum(float((((one.measured - one.modelled) * one.moving) ** 2).sum()) for one in squares)
    whole = sum(float(((one.measured * one.moving) ** 2).sum()) for one in squares)
    assert found.held_out == pytest.approx(np.sqrt(left / whole), rel=2e-4)


def test_the_found_set_and_what_is_absorbed_are_told(carried):
    assert [":".join(one) for one in carried["found"]] == list(FOUND)
    effects = {one["name"]: one for one in carried["effects"]}
    assert list(effects) == [name for name in CATALOGUE if name in LAWS]
    assert all(not effects[name]["places"] for name in ABSORBED if name in effects)
    assert [one["place"] for one in effects["stribeck_friction"]["places"]] == ["left", "right"]
    assert effects["geometric_error"]["places"][0]["curved"]
    assert not effects["viscous_friction"]["places"][0]["curved"]


def test_deviations_are_those_of_the_models_that_were_fitted(diagnosis, carried):
    found, before = carried["deviations"]
    assert [":".join(one) for one in found["effects"]] == list(FOUND)
    assert found["gains"] == [one.std for one in diagnosis.after.drive_gains.values()]
    assert before == {"effects": [], "gains": [one.std for one in diagnosis.before.drive_gains.values()]}


def test_effects_that_there_is_no_room_for_are_named(dataset, diagnosis, monkeypatch):
    monkeypatch.setattr(page_module, "MOST_BYTES", 4000)
    data = page_data(problem_of(dataset), diagnosis)
    without = [one["name"] for one in data["effects"] if one["no_room"]]
    kept = [one["name"] for one in data["effects"] if one["places"]]
    assert without
    assert not set(without) & set(kept)
    assert {"coulomb_friction", "viscous_friction"} <= set(kept)  # what was found stays
    assert Carried(data).fit(set(FOUND)).held_out == pytest.approx(diagnosis.after.error.validate, rel=1e-3)


def test_the_model_that_was_found_is_carried_as_its_file_holds_it(carried, diagnosis, dataset, tmp_path):
    given = with_command(carried, "bench identify data", model_json(diagnosis.after, dataset.folder))
    (tmp_path / "model.json").write_text(json.dumps(given["model"], allow_nan=False))
    compared = apply_model(problem_of(dataset), load_model(tmp_path / "model.json"))
    assert compared.error.validate == pytest.approx(diagnosis.after.error.validate, rel=1e-6)


def test_curves_show_what_was_measured(dataset, carried):
    for recording, other in zip(
        carried["recordings"], identify(prepare(problem_of(dataset, FOUND))).recordings, strict=True
    ):
        assert (recording["name"], recording["rows"]) == (other.name, len(other.time))
        for j, motor in enumerate(recording["motors"]):
            low, high = numbers(motor["low"]), numbers(motor["high"])
            assert low.min() == pytest.approx(other.measured[:, j].min(), rel=1e-6)
            assert high.max() == pytest.approx(other.measured[:, j].max(), rel=1e-6)
            at = np.searchsorted(other.time, numbers(recording["time"]) - 1e-4)
            measured, modelled = numbers(motor["measured"]), numbers(motor["modelled"])
            np.testing.assert_allclose(measured, other.measured[at, j], rtol=1e-5)
            moving = np.isfinite(modelled)
            np.testing.assert_array_equal(moving, other.moving[at, j])
            np.testing.assert_allclose(modelled[moving], other.modelled[at, j][moving], atol=1e-4)


def test_a_page_stays_small(carried):
    assert len(json.dumps(carried)) < 600_000


def test_effects_of_the_user_are_carried_too(dataset, tmp_path):
    file = tmp_path / "fan.py"
    file.write_text(
        "from dataclasses import dataclass\n"
        "from bench.effects import ActuatorEffect, EffectParameter\n\n\n"
        "@dataclass(frozen=True)\n"
        "class FanTorque(ActuatorEffect):\n"
        '    name = "fan_torque"\n'
        '    parameters = (EffectParameter("c", "{effort}*s^3/{angle}^3", positive=True),)\n\n'
        "    def torque(self, joint):\n"
        "        return (joint.velocity**3)[:, None]\n"
    )
    catalogue = catalogue_for((), [file])
    diagnosis = diagnosis_of(dataset, names=("coulomb_friction", "fan_torque", "viscous_friction"))
    solver = Carried(page_data(Problem(dataset, catalogue), diagnosis))
    expected = identify(prepare(Problem(dataset, catalogue, ("coulomb_friction", "fan_torque"))))
    found = solver.fit(solver.keys(("coulomb_friction", "fan_torque")))
    assert found.held_out == pytest.approx(expected.error.validate, rel=5e-5)


def test_columns_set_apart_are_the_same_model():
    random = np.random.default_rng(7)
    before = random.normal(size=(60, 2, 7)) * np.array([1.0, 1e3, 1e-3, 5.0, 1.0, 1.0, 1.0])
    before[:, :, 5] = before[:, :, 0] + 0.02 * before[:, :, 5]  # near to the model's own
    columns, reference = before.copy(), np.ones(7)
    basis = set_apart(columns, reference, before.copy(), 4)
    for coordinates in (reference, random.normal(size=7)):
        parameters = np.append(basis @ coordinates, coordinates[4:])
        np.testing.assert_allclose(before @ parameters, columns @ coordinates, atol=1e-9)
    np.testing.assert_allclose(basis @ reference, np.ones(4), rtol=1e-9)
    rows = columns.reshape(-1, 7)
    np.testing.assert_allclose(rows[:, :4].T @ rows[:, :4], np.eye(4), atol=1e-9)
    assert np.abs(rows[:, :4].T @ rows[:, 5]).max() < 1e-9
    np.testing.assert_array_equal(columns[:, :, [4, 6]], before[:, :, [4, 6]])


def test_the_script_is_plain_and_asks_for_nothing():
    for text in (script(), style()):
        assert "://" not in text
        assert "</" not in text
    assert "window.Workbench = {start}" in script()
