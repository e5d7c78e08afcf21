"""Effects in a simulation, one instant after the other, against their laws in the catalogue."""

import json
from dataclasses import dataclass, replace

import mujoco
import numpy as np
import pytest

from bench.basics.errors import BenchError
from bench.basics.files.sidecar_path import sidecar_path
from bench.effects import CATALOGUE, ActuatorEffect, EffectParameter, JointSignals
from bench.effects.laws.presliding_hysteresis import dahl_state
from bench.export.mjcf import write_mjcf
from bench.export.physical import physical_set
from bench.export.sidecar import sidecar, write_sidecar
from bench.twin import load_twin
from bench.twin.drive import drive_law_of
from bench.twin.laws import Instant, Memoryless, joint_law_of
from tests.export_kit import identified
from tests.test_export_files import with_effects

GAIN = 3.0
TIME = np.arange(4000) / 1000.0
POSITION = 0.8 * np.sin(3.0 * TIME)
VELOCITY = 2.4 * np.cos(3.0 * TIME)
NEEDED = 1.5 * np.sin(2.0 * TIME + 0.4)
SIMULATED = {
    "asymmetric_viscous_friction",
    "cogging_torque",
    "constant_offset",
    "coulomb_friction",
    "joint_spring",
    "position_dependent_friction",
    "presliding_hysteresis",
    "quadratic_drag",
    "shear_thinning_friction",
    "stribeck_friction",
    "thermal_friction_drift",
    "viscous_friction",
}


def signals(**given):
    base = {
        "time": TIME,
        "position": POSITION,
        "velocity": VELOCITY,
        "acceleration": -9.0 * POSITION,
        "current": NEEDED / GAIN,
        "gain": GAIN,
        "speed": 1.0,
        "rate": 1000.0,
        "band": 1000.0,
        "rotates": True,
        "needs": lambda: NEEDED,
    }
    return JointSignals(**(base | given))


def values_of(effect, value=0.1):
    return {one.name: value for one in effect.parameters}


def test_which_effects_follow_from_the_instant():
    found = {
        name
        for name, effect in CATALOGUE.items()
        if effect.place == "actuator" and joint_law_of(effect, values_of(effect), GAIN, True) is not None
    }
    assert found == SIMULATED


@pytest.mark.parametrize("name", sorted(SIMULATED - {"presliding_hysteresis"}))
def test_step_by_step_as_the_law_says(name):
    effect = CATALOGUE[name]
    values = dict(zip(values_of(effect), (0.3, 0.2), strict=False))
    law = joint_law_of(effect, values, GAIN, True)
    wanted = effect.torque(signals()) @ np.array(list(values.values()))
    for k in range(5, len(TIME), 97):
        smooth, dry = law.opposing(Instant(TIME[k], POSITION[k], VELOCITY[k], 0.0))
        assert dry >= 0.0
        assert smooth + dry * np.sign(VELOCITY[k]) == pytest.approx(wanted[k], abs=1e-9)


def test_presliding_step_by_step():
    effect = replace(CATALOGUE["presliding_hysteresis"], x0=0.05)
    law = joint_law_of(effect, {"Fc": 0.7}, GAIN, True)
    found = [law.opposing(Instant(t, q, v, 0.0))[0] for t, q, v in zip(TIME, POSITION, VELOCITY, strict=True)]
    assert np.array(found) == pytest.approx(0.7 * dahl_state(POSITION, 0.05), abs=1e-12)
    law = joint_law_of(effect, {"Fc": 0.7}, GAIN, True)
    assert law.opposing(Instant(0.0, 0.3, 0.0, 0.0)) == (0.0, 0.0)


def test_one_of_ones_own_that_needs_history_is_refused_and_one_that_does_not_is_not():
    @dataclass(frozen=True)
    class Remembering(ActuatorEffect):
        name = "remembering"
        law = symbols = shown_by = "x"
        parameters = (EffectParameter("c", "1"),)

        def torque(self, joint):
            return np.cumsum(joint.velocity)[:, None]

    class Cubic(Remembering):
        name = "cubic"

        def torque(self, joint):
            return (joint.velocity**3)[:, None]

    assert joint_law_of(Remembering(), {"c": 1.0}, GAIN, True) is None
    assert isinstance(joint_law_of(Cubic(), {"c": 1.0}, GAIN, True), Memoryless)


@pytest.mark.parametrize(
    ("name", "values", "near"),
    [
        ("current_delay", {"T": 0.004}, 1e-4),
        ("current_loop_lag", {"T": 0.004}, 3e-3),
        ("gain_saturation", {"k": 0.05}, 1e-6),
        ("torque_ripple", {"a": 0.1, "b": -0.05}, 1e-9),
        ("load_dependent_friction", {"mu": 0.1}, 1e-9),
    ],
)
def test_the_current_that_a_torque_needs_gives_that_torque(name, values, near):
    effect = CATALOGUE[name].about(values)
    _, law = drive_law_of(effect, values, True)
    current = (NEEDED + effect.torque(signals()) @ np.array(list(values.values()))) / GAIN
    given = [
        GAIN * law(i, Instant(t, q, v, i))
        for t, q, v, i in zip(TIME, POSITION, VELOCITY, current, strict=True)
    ]
    assert np.array(given)[50:-50] == pytest.approx(NEEDED[50:-50], abs=near * np.abs(NEEDED).max())


@pytest.fixture
def exported(tmp_path):
    """Writes a five-bar with these effects and returns its MJCF."""

    def write(*effects):
        physical = physical_set(with_effects(identified("five_bar"), *effects))
        write_sidecar(tmp_path / "x.xml", sidecar(physical, write_mjcf(tmp_path / "x.xml", physical)))
        return tmp_path / "x.xml"

    return write


def test_forces_of_the_user_and_of_the_twin_add_up(exported):
    twin = load_twin(exported(("cogging_torque", "left", {"a": 0.3, "b": 0.0})))
    twin.data.qfrc_applied[0] = 1.0
    for _ in range(3):
        twin.step([0.0, 0.0])
    cogging = 0.3 * np.cos(12.0 * twin.positions[0])
    twin.apply([0.5, 0.0])
    assert twin.data.qfrc_applied[0] == pytest.approx(1.0 - cogging, abs=1e-6)
    assert twin.data.ctrl.tolist() == [0.5, 0.0]
    with pytest.raises(BenchError, match="2 currents"):
        twin.step([0.0])


def test_stribeck_holds_a_joint_that_stands(exported):
    held = load_twin(
        exported(
            ("stribeck_friction", "left", {"Fc": 6.0, "Fs": 6.0}),
            ("stribeck_friction", "right", {"Fc": 6.0, "Fs": 6.0}),
        )
    )
    free = load_twin(exported())
    for twin in (held, free):
        for _ in range(400):
            twin.step([0.0, 0.0])
    home = held.model.key_qpos[0]
    assert np.abs(held.data.qpos - home).max() < 1e-3
    assert np.abs(free.data.qpos - home).max() > 0.02


def test_a_force_at_the_tool_does_the_work_of_its_law(exported):
    force = {"Fx": 2.0, "Fy": 0.0, "Fz": -3.0, "kx": 10.0, "ky": 0.0, "kz": 20.0}
    twin = load_twin(exported(("platform_force", "", force)))
    tool = twin.model.site("tool").id
    mujoco.mj_forward(twin.model, twin.data)
    home = twin.data.site_xpos[tool].copy()
    twin.data.qvel[:] = np.random.default_rng(2).normal(size=4)
    for _ in range(100):
        twin.step([0.0, 0.0])
    mujoco.mj_forward(twin.model, twin.data)
    twin.apply([0.0, 0.0])
    way = twin.data.site_xpos[tool] - home
    jacobian = np.zeros((3, 4))
    mujoco.mj_jacSite(twin.model, twin.data, jacobian, None, tool)
    wanted = np.array([2.0, 0.0, -3.0]) - np.array([10.0, 0.0, 20.0]) * way
    assert np.linalg.norm(way) > 1e-3
    assert twin.data.qfrc_applied == pytest.approx(jacobian.T @ wanted, rel=1e-9)


def test_what_cannot_be_simulated_is_refused_or_named(exported):
    path = exported(("encoder_offset", "left", {"offset": 0.01}))
    with pytest.raises(BenchError, match="encoder_offset at left"):
        load_twin(path)
    assert load_twin(path, partial=True).left_out == ("encoder_offset at left",)


def test_a_damaged_or_missing_file_is_one_line(exported):
    path = exported(("cogging_torque", "left", {"a": 0.3, "b": 0.0}))
    beside = sidecar_path(path)
    content = json.loads(beside.read_text())
    for broken, said in (
        ({**content, "format": 0}, "not a twin file"),
        ({key: value for key, value in content.items() if key != "motors"}, "damaged"),
        ({**content, "effects": [{**content["effects"][0], "effect": "magic"}]}, "magic"),
        ({**content, "effects": [{**content["effects"][0], "values": {"a": 1.0}}]}, "instead of"),
        ({**content, "effects": [{**content["effects"][0], "shape": {"teeth": 3}}]}, "damaged"),
    ):
        beside.write_text(json.dumps(broken))
        with pytest.raises(BenchError, match=said):
            load_twin(path)
    beside.unlink()
    with pytest.raises(BenchError, match="bench export"):
        load_twin(path)
