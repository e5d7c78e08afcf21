"""Desired motion to currents, in Python beside the model's own equations and in C beside Python."""

import shutil
from dataclasses import replace

import mujoco
import numpy as np
import pytest

from bench.basics.errors import BenchError
from bench.benchmarks.speed.feedforward import seconds_per_call
from bench.cli import main
from bench.dataset.robot import load_robot
from bench.effects import CATALOGUE
from bench.effects.passive_joint import PassiveEffect
from bench.export.c_code import LAWS, c_text
from bench.export.feedforward import Feedforward, chosen_effects
from bench.export.identified import declaring
from bench.export.mjcf import write_mjcf
from bench.export.physical import physical_set
from bench.identification.model_file import apply_model, load_model
from bench.identification.problem import problem_of
from bench.model.model import build_model
from bench.model.motion import motion_of
from tests.c_kit import compiled
from tests.export_kit import identified, identified_file, simulated
from tests.test_export_files import with_effects

FRICTION = [
    ("asymmetric_viscous_friction", "shoulder", {"Fv_plus": 0.2, "Fv_minus": 0.4}),
    ("cogging_torque", "elbow", {"a": 0.03, "b": -0.02}),
    ("constant_offset", "elbow", {"c": 0.1}),
    ("coulomb_friction", "shoulder", {"Fc": 0.3}),
    ("gain_saturation", "elbow", {"k": 0.02}),
    ("joint_spring", "elbow", {"k": 0.7, "kq0": 0.1}),
    ("load_dependent_friction", "shoulder", {"mu": 0.07}),
    ("position_dependent_friction", "shoulder", {"a": 0.1, "b": 0.05}),
    ("quadratic_drag", "elbow", {"c": 0.03}),
    ("rotor_inertia", "elbow", {"Ia": 0.004}),
    ("shear_thinning_friction", "elbow", {"Fa": 0.08}),
    ("stribeck_friction", "elbow", {"Fc": 0.05, "Fs": 0.1}),
    ("torque_ripple", "shoulder", {"a": 0.05, "b": 0.02}),
    ("viscous_friction", "elbow", {"Fv": 0.08}),
]


def states(count, motors):
    return np.random.default_rng(5).uniform(-1.5, 1.5, (count, 3, motors))


def test_every_law_in_c_is_tried_here():
    assert sorted(name for name, _, _ in FRICTION) == sorted(LAWS)


def test_python_gives_the_currents_of_the_model():
    dataset = simulated("two_link")
    saved = load_model(identified_file("two_link"))
    modelled = apply_model(problem_of(dataset), saved).recordings[0]
    forward = Feedforward(identified("two_link"))
    found = [
        forward(*one) for one in zip(modelled.position, modelled.velocity, modelled.acceleration, strict=True)
    ]
    off = (np.array(found) - modelled.modelled) * modelled.moving
    assert np.sqrt((off**2).mean()) < 0.02 * np.sqrt((modelled.modelled**2).mean())  # that one is low-passed


def test_closed_loops_follow_the_call_before():
    model = identified("five_bar")
    forward = Feedforward(model)
    home = model.model.geometry.home[model.model.geometry.active_configuration]
    way = np.linspace(0.0, 0.3, 30)[:, None] * np.array([1.0, -1.0])
    step_by_step = [forward(home + one, np.ones(2), np.zeros(2)) for one in way]
    again = Feedforward(model)(home + way[-1], np.ones(2), np.zeros(2))
    assert step_by_step[-1] == pytest.approx(again, rel=1e-9)


def test_friction_springs_and_rotors_of_passive_joints_reach_the_motors():
    plain = identified("five_bar")
    sprung = with_effects(
        plain,
        ("passive_viscous_friction", "left_elbow", {"Fv": 0.3}),
        ("passive_coulomb_friction", "left_elbow", {"Fc": 0.2}),
        ("passive_rotor_inertia", "left_elbow", {"Ia": 0.05}),
        ("passive_spring", "right_elbow", {"k": 0.5, "kq0": 0.1}),
    )
    assert {one.name for one in chosen_effects(sprung).in_passive} == {
        name for name, effect in CATALOGUE.items() if isinstance(effect, PassiveEffect)
    }
    home = plain.model.geometry.home[plain.model.geometry.active_configuration]
    state = home, np.array([0.7, -0.4]), np.array([2.0, 3.0])
    change = Feedforward(sprung)(*state) - Feedforward(plain)(*state)
    motion = motion_of(plain.model.geometry, np.zeros(1), *(values[None] for values in state))
    left, right = (
        plain.model.geometry.joints[plain.model.geometry.joint_index(f"{s}_elbow")] for s in ("left", "right")
    )
    rate = motion.v[0, left.v.start]
    inertia = 0.05 * motion.a[0, left.v.start]
    wanted = motion.jacobian[0, left.v.start] * (0.3 * rate + 0.2 * np.sign(rate) + inertia)
    wanted = wanted + motion.jacobian[0, right.v.start] * (0.5 * motion.q[0, right.q.start] - 0.1)
    assert change * plain.gains == pytest.approx(wanted, rel=1e-9)


def test_c_is_python_to_rounding(tmp_path):
    model = with_effects(identified("two_link"), *FRICTION)
    text, left_out = c_text(model)
    assert left_out == ()
    fast, slow = compiled(text, "two_link", tmp_path), Feedforward(model)
    for q, v, a in states(40, 2):
        wanted = slow(q, v, a)
        assert fast(q, v, a) == pytest.approx(wanted, rel=1e-12, abs=1e-12)


def test_with_a_payload_it_is_what_mujoco_needs_to_move_the_exported_bodies(tmp_path):
    physical = physical_set(declaring(identified("two_link"), simulated("two_link").payloads))
    (payload,) = simulated("two_link").payloads
    write_mjcf(tmp_path / "arm.xml", physical, payload)
    model = mujoco.MjModel.from_xml_path(str(tmp_path / "arm.xml"))
    data, loaded = mujoco.MjData(model), Feedforward(physical.model, payload)
    fast = compiled(c_text(physical.model, payload)[0], "two_link", tmp_path)
    for q, v, a in states(10, 2):
        data.qpos[:], data.qvel[:], data.qacc[:] = q, v, a
        mujoco.mj_inverse(model, data)
        wanted = data.qfrc_inverse / physical.model.gains
        assert loaded(q, v, a) == pytest.approx(wanted, rel=1e-5, abs=1e-6)
        assert fast(q, v, a) == pytest.approx(loaded(q, v, a), rel=1e-12, abs=1e-12)
        assert np.abs(Feedforward(physical.model)(q, v, a) - wanted).max() > 0.01


def test_a_payload_that_the_model_does_not_know_is_refused():
    with pytest.raises(BenchError, match="knows payload 'crate' in full"):
        Feedforward(identified("two_link"), "crate")


def test_c_of_a_skewed_robot_with_slides_and_zeros_elsewhere(tmp_path):
    (tmp_path / "arm.xml").write_text(
        """<mujoco><compiler angle="radian"/><worldbody>
        <body name="turret" pos=".1 .2 .3" quat="0.9 .1 .2 .3">
          <joint name="turn" axis="0 1 0.2" pos=".05 .02 0" ref="0.3"/>
          <geom size=".1" pos=".1 0 0"/>
          <body name="cart" pos=".1 .1 .1" quat="1 .2 .1 .4">
            <joint name="rail" type="slide" axis="1 1 0" ref="0.05" range="-.3 .3"/><geom size=".07" pos="0 .1 0"/>
            <body name="hand" pos="0 .1 .2"><joint name="roll" axis=".3 .1 1"/><geom size=".05" pos=".1 0 .1"/></body>
          </body></body></worldbody></mujoco>"""
    )
    toml = 'name = "arm"\nmodel = "arm.xml"\n'
    for joint, unit in (("roll", "N*m/A"), ("turn", "N*m/A"), ("rail", "N/A")):
        toml += f'[[actuators]]\njoint = "{joint}"\ngain = 2.0\ngain_unit = "{unit}"\n'
    (tmp_path / "robot.toml").write_text(toml)
    robot = load_robot(tmp_path)
    built = build_model(robot)
    random = np.random.default_rng(7)
    model = replace(
        identified("two_link"),
        robot=robot,
        model=built,
        base=random.normal(size=len(built.base.columns)),
        gains=np.array([2.0, 3.0, 4.0]),
        effects=(),
    )
    fast, slow = compiled(c_text(model)[0], "arm", tmp_path), Feedforward(model)
    for q, v, a in 0.1 * states(20, 3):
        wanted = slow(q, v, a)
        assert fast(q, v, a) == pytest.approx(wanted, rel=1e-12, abs=1e-12)


def test_what_needs_more_than_the_instant_is_named():
    rest = [
        ("current_delay", "shoulder", {"T": 0.001}),
        ("presliding_hysteresis", "elbow", {"Fc": 0.1}),
        ("thermal_friction_drift", "elbow", {"Fc": 0.1, "Fv": 0.1}),
    ]
    model = with_effects(identified("two_link"), *rest)
    assert Feedforward(model).left_out == tuple(f"{name} at {place}" for name, place, _ in rest)
    text, left_out = c_text(model)
    assert all(f"Not in it: {line}." in text for line in left_out)


def test_wrong_sizes_are_refused():
    with pytest.raises(BenchError, match="2 values each"):
        Feedforward(identified("two_link"))(np.zeros(3), np.zeros(2), np.zeros(2))


def test_the_command_writes_c_and_tells_what_is_lost(tmp_path, capsys):
    path = tmp_path / "forward.c"
    assert main(["export", str(identified_file("two_link")), "--to", "c", "-o", str(path)]) == 0
    assert "two_link_currents" in path.read_text()
    assert f"wrote {path}" in capsys.readouterr().out


@pytest.mark.parametrize("robot", ["five_bar", "two_link"])
def test_the_time_of_a_call_is_measured_beside_rnea(robot):
    if shutil.which("cc") is None:
        pytest.skip("no C compiler on this machine")
    found = seconds_per_call(identified(robot), calls=2000)
    assert list(found) == ["C", "pinocchio.rnea from Python", "Python"]
    assert all(seconds >= 0.0 for seconds in found.values())
