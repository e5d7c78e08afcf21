"""Effects of a wished size: what the rules give, a simulation must show."""

import functools

import numpy as np
import pytest

from bench.basics.errors import BenchError
from bench.truth.hidden import HIDDEN_EFFECTS, JointEffect
from bench.truth.hidden.reference import Reference
from bench.truth.hidden.sizes import MACHINE_SIZES, real_sizes, typical
from bench.truth.inverse import motor_torque
from tests import hidden_kit
from tests.hidden_kit import BRIEF, SHORT, STEP, cart, measured_share

run = functools.partial(hidden_kit.run, design=BRIEF)
ONE = ("held",)  # the recording with the payload: a size is of a movement, and two take twice as long
# asked for by default; less where a robot's motors or controller would not stand it
SHARE = 0.03
SHARES = {"gain_saturation": 0.01, "current_loop_lag": 0.01, "current_delay": 0.01, "backlash": 0.01}
COARSE = 0.001  # s, of a simulation of which no more than a share is asked
SETTLE = 0.1  # s before its log
STIFF = {"backlash", "drive_flexibility"}  # springs that swing too fast for it
ROUGH = {"drive_flexibility", "torque_drift"}  # springs that swing; long waves in a second
SLOW = {"hysteretic_cable"}  # wound up over more than a second's way


@functools.cache
def reference_of(robot, duration=BRIEF["duration"], **overrides):
    """The movement of a robot in a simulation without hidden effects."""
    return Reference(hidden_kit.plain(robot, duration=duration, **overrides))


def entry(effect, robot):
    """The [[hidden]] entry without its parameters: an effect of the first motor, or of all joints."""
    kind = HIDDEN_EFFECTS[effect]
    if not issubclass(kind, JointEffect) or kind.where == "passive":
        return {"effect": effect}
    return {"effect": effect, "joint": {"five_bar": "left", "delta": "motor_1"}[robot]}


def with_rotor(simulate, hidden, reference):
    """The simulation of a hidden drive, and the one that differs by its rotor alone from nothing hidden."""
    inertia = hidden.get("rotor_inertia", 0.0)
    rotor = {"effect": "rotor_inertia", "joint": hidden["joint"], "Ia": inertia}
    return simulate(hidden), simulate(rotor) if inertia else reference.simulation


def share_of_current(simulation, without, motor=0):
    """RMS of the change of a motor's current, over the RMS of the current."""
    pairs = list(zip(simulation.recordings, without.recordings, strict=True))
    change = np.concatenate([(a.current - b.current)[:, motor] for a, b in pairs])
    return np.sqrt(np.mean(change**2) / np.mean(np.concatenate([b.current[:, motor] for _, b in pairs]) ** 2))


def test_every_effect_has_one_rule():
    for name, kind in HIDDEN_EFFECTS.items():
        own = issubclass(kind, JointEffect) and kind.sized is not JointEffect.sized
        assert own + (kind.scaled is not None) + (name in MACHINE_SIZES) == 1, name


@pytest.mark.parametrize("robot", ["five_bar", "delta"])
@pytest.mark.parametrize("effect", HIDDEN_EFFECTS)
def test_a_simulation_shows_the_share_that_was_asked_for(effect, robot):
    design, step = SHORT if effect in SLOW else BRIEF, STEP if effect in STIFF else COARSE
    recordings = ("free", "held") if effect == "payload_mass_error" else ONE
    brief = {"settle": SETTLE, "step": step, "recordings": recordings}
    reference = reference_of(robot, duration=design["duration"], **brief)
    simulated = functools.partial(run, robot, design=design, **brief)
    hidden = entry(effect, robot)
    share = SHARES.get(effect, SHARE)
    hidden |= typical(effect, reference, share, hidden.get("joint"))
    if "rotor_inertia" in hidden:
        found = share_of_current(*with_rotor(simulated, hidden, reference))
    elif "joint" in hidden:
        found = measured_share(simulated(hidden), reference)[0]
    else:
        weight = np.mean(reference.torque() ** 2, axis=0)
        found = np.sqrt(np.average(measured_share(simulated(hidden), reference) ** 2, weights=weight))
    low, high = (0.3, 3.0) if effect in ROUGH else (0.8, 1.25)
    assert low < found / share < high


@pytest.mark.parametrize("effect", ["viscous_friction", "base_tilt", "geometric_error", "drive_flexibility"])
def test_a_larger_share_is_a_stronger_effect(effect):
    reference = reference_of("five_bar", recordings=ONE, step=COARSE)
    joint = entry(effect, "five_bar").get("joint")
    small, large = (typical(effect, reference, share, joint) for share in (0.01, 0.04))
    key = {"drive_flexibility": "stiffness", "geometric_error": "error", "viscous_friction": "Fv"}.get(effect)
    ratio = large[key] / small[key] if key else sum(large.values()) / sum(small.values())
    assert ratio == pytest.approx(0.25 if effect == "drive_flexibility" else 4, rel=0.1)


def test_a_trial_hides_no_play_that_a_real_drive_cannot_have():
    reference = reference_of("five_bar", recordings=ONE, step=STEP)
    wide = typical("backlash", reference, 0.02, "left")
    real = real_sizes("backlash", reference, "left", wide)
    assert wide["play"] > real["play"] == 8.7e-3
    assert real["stiffness"] * real["play"] == pytest.approx(wide["stiffness"] * wide["play"], rel=0.01)
    assert real_sizes("backlash", reference, "left", real) == real
    assert real_sizes("coulomb_friction", reference, "left", {"Fc": 1e3}) == {"Fc": 1e3}


def test_an_offset_larger_than_the_movement_is_refused():
    """A turret about the vertical: its zero changes no torque, whatever the size."""
    reference = reference_of("palletiser", recordings=("free",))
    with pytest.raises(BenchError, match="the torque of joint motor_1 hardly depends on its zero"):
        typical("encoder_offset", reference, 0.01, "motor_1")
    assert 0 < typical("encoder_offset", reference, 0.01, "motor_2")["offset"] < 0.3


def test_a_position_dependent_friction_is_never_negative():
    for robot in ("five_bar", "delta"):
        reference = reference_of(robot, recordings=ONE, step=COARSE)
        for joint in reference.simulation.robot.joints:
            size = typical("position_dependent_friction", reference, 0.1, joint)
            q = reference.movement(joint).position * size.get("harmonic", 1.0)
            friction = size["a"] * np.cos(q) + size["b"] * np.sin(q)
            assert friction.min() > 0
            assert friction.max() > 1.5 * friction.min()


def test_a_slide_and_a_robot_without_passive_joints(tmp_path):
    reference = Reference(cart(tmp_path, "1 0 0"))
    effects = (
        "viscous_friction",
        "position_dependent_friction",
        "joint_spring",
        "cogging_torque",
        "backlash",
    )
    for effect in effects:
        hidden = {"effect": effect, "joint": "x", **typical(effect, reference, 0.02, "x")}
        found = share_of_current(*with_rotor(lambda *h: cart(tmp_path, "1 0 0", *h), hidden, reference))
        assert 0.8 < found / 0.02 < 1.25
    for effect, joint, told in (
        ("passive_viscous_friction", None, "the robot has no passive"),
        ("current_crosstalk", "x", "the robot has one motor only"),
        ("platform_force", None, "no \\[tool\\] site"),
        ("payload_mass_error", None, "the scenario has no payload"),
        ("base_tilt", None, None),
        ("viscous_friction", None, "name a joint: one of x"),
        ("backlash", None, "name a joint: one of x"),
        ("viscous_friction", "y", "no actuated joint 'y'; there are x"),
        ("magic", "x", "no effect 'magic'; there are"),
    ):
        if told is None:
            assert typical(effect, reference, 0.02, joint)["about_y"] > 0
            continue
        with pytest.raises(BenchError, match=told):
            typical(effect, reference, 0.02, joint)


def test_shares_that_an_effect_cannot_have_are_refused():
    reference = reference_of("five_bar", recordings=ONE, step=COARSE)
    for effect in ("gain_saturation", "current_loop_lag", "current_delay", "acceleration_dependent_friction"):
        with pytest.raises(BenchError, match="joint left: a share of 0\\.9 of its torque is too large"):
            typical(effect, reference, 0.9, "left")
    with pytest.raises(BenchError, match="greater than 0"):
        typical("viscous_friction", reference, 0.0, "left")
    with pytest.raises(BenchError, match="a reference has no hidden effects, this one has viscous_friction"):
        Reference(run("five_bar", {"effect": "viscous_friction", "Fv": 0.1}))


@pytest.mark.parametrize("robot", ["five_bar", "delta"])
def test_inverse_dynamics_gives_the_torque_of_the_simulation(robot):
    """From the movement of the motors alone: the loops bring in the rest."""
    hidden = {"effect": "passive_viscous_friction", "Fv": 0.1}
    simulation = run(robot, hidden, {"effect": "platform_force", "fx": 2.0, "k": 10.0})
    machine = simulation.machine
    for recording in simulation.recordings:
        motion = recording.motion
        rows = np.arange(5, len(motion.time), 97)
        near = motion.qpos[rows - 5]
        angle = motion.qpos[rows][:, machine.addresses]
        movement = (angle, motion.qvel[rows][:, machine.dofs], motion.qacc[rows][:, machine.dofs])
        torque = motor_torque(machine, recording.table.payload, near, *movement)
        # the simulation's loops give way by some 1e-7 m
        np.testing.assert_allclose(torque, motion.torque[rows], atol=5e-4 * np.abs(torque).max())


def test_sizes_do_not_depend_on_what_they_are_tried_with():
    reference = reference_of("five_bar", recordings=ONE, step=COARSE)
    before = reference.torque().copy()
    first = typical("geometric_error", reference, 0.02, "left")
    assert typical("geometric_error", reference, 0.02, "left") == first
    np.testing.assert_array_equal(reference.torque(), before)
