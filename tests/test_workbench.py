"""What the workbench's page carries is enough to find again what `bench identify` finds."""

import json

import numpy as np
import pytest

from bench.dataset.dataset import load_dataset
from bench.effects import CATALOGUE, catalogue_for
from bench.identification.identify import identify
from bench.workbench.page_data import page_data
from bench.workbench.page_files import script, style
from tests.workbench_kit import ABSORBED, FOUND, diagnosis_of, write_dataset
from tests.workbench_solver import Solver, numbers

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
SETS = (
    (),
    FOUND,
    ("coulomb_friction",),
    ("load_dependent_friction", "viscous_friction:left"),
    ("presliding_hysteresis:left", "passive_viscous_friction"),
    ("coulomb_friction:left", "geometric_error:left_rod", "viscous_friction:left"),
    ("constant_offset", "coulomb_friction:left", "current_delay:left", "viscous_friction:left"),
    ("stribeck_friction",),
)


@pytest.fixture(scope="module")
def dataset(tmp_path_factory):
    return load_dataset(write_dataset(tmp_path_factory.mktemp("bench") / "data"))


@pytest.fixture(scope="module")
def carried(dataset):
    return json.loads(json.dumps(page_data(dataset, diagnosis_of(dataset, names=LAWS)), allow_nan=False))


@pytest.fixture(scope="module")
def solver(carried):
    return Solver(carried)


@pytest.mark.parametrize("requests", SETS, ids=lambda one: "+".join(one) or "nothing")
def test_the_page_finds_what_identify_finds(dataset, solver, requests):
    expected = identify(dataset, requests)
    found = solver.fit({key for key in solver.places if {key, key.partition(":")[0]} & set(requests)})
    assert found.fitted == pytest.approx(expected.error.identify, rel=5e-5)
    assert found.judged == pytest.approx(expected.error.validate, rel=5e-5)
    for gain, other in zip(found.gains, expected.drive_gains.values(), strict=True):
        assert gain == pytest.approx(other.value, rel=5e-5)
    for key, values in found.effects.items():
        effect, _, place = key.partition(":")
        known = expected.effect_parameters[effect][place or "robot"]
        for name, value in values.items():
            # four digits of what is known at all: a hundredth of its deviation where that is wider
            near = max(1e-4 * abs(known[name].value), 0.01 * known[name].std)
            assert value == pytest.approx(known[name].value, abs=near), (key, name)


def test_the_found_set_and_what_is_absorbed_are_told(carried):
    assert [":".join(one) for one in carried["found"]] == list(FOUND)
    effects = {one["name"]: one for one in carried["effects"]}
    assert list(effects) == [name for name in CATALOGUE if name in LAWS]
    assert all(not effects[name]["places"] for name in ABSORBED if name in effects)
    assert [one["place"] for one in effects["stribeck_friction"]["places"]] == ["left", "right"]
    assert effects["geometric_error"]["places"][0]["follows"] is not None


def test_curves_show_what_was_measured(dataset, carried):
    for recording, other in zip(carried["recordings"], identify(dataset, FOUND).recordings, strict=True):
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
    assert len(json.dumps(carried)) < 1_800_000


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
    solver = Solver(page_data(dataset, diagnosis, catalogue))
    expected = identify(dataset, ["coulomb_friction", "fan_torque"], catalogue=catalogue)
    found = solver.fit({key for key in solver.places if key.startswith(("coulomb", "fan"))})
    assert found.judged == pytest.approx(expected.error.validate, rel=5e-5)


def test_the_script_is_plain_and_asks_for_nothing():
    for text in (script(), style()):
        assert "://" not in text
        assert "</" not in text
    assert "window.Workbench = {start}" in script()
