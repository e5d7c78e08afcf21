"""Hidden effects that change the machine itself: its loops, its geometry, its payload, its drives, its base."""

import re
from types import SimpleNamespace

import mujoco
import numpy as np
import pytest

from bench.dataset.catalogue import catalogue_folder
from bench.truth.dataset import as_dataset
from bench.truth.hidden.laws.geometric_error import GeometricError
from bench.truth.report import truth
from tests.hidden_kit import STEP, bare_machine, cart, needed, run, states

PASSIVE = {"five_bar": 0.08, "delta": 0.6}


def passive_dofs(machine):
    model = machine.models[None]
    hinges = [j for j in range(model.njnt) if model.jnt_type[j] == int(mujoco.mjtJoint.mjJNT_HINGE)]
    return np.setdiff1d(model.jnt_dofadr[hinges], machine.dofs)


@pytest.mark.parametrize("robot", PASSIVE)
def test_passive_viscous_friction_reaches_the_motors_through_the_loops(robot):
    size, dofs = PASSIVE[robot], passive_dofs(bare_machine(robot))

    def friction(motion):
        forces = np.zeros_like(motion.qvel)
        forces[:, dofs] = size * motion.qvel[:, dofs]
        return forces

    simulation = run(robot, {"effect": "passive_viscous_friction", "Fv": size})
    for s in states(simulation, robot, friction):
        np.testing.assert_allclose(s.extra, 0, atol=1e-11 * abs(s.torque).max())
    for s in states(simulation, robot):
        assert np.sqrt(np.mean(s.extra**2)) > 0.01 * np.sqrt(np.mean(s.torque**2))


@pytest.mark.parametrize("robot", PASSIVE)
def test_a_passive_spring_reaches_the_motors_through_the_loops(robot):
    joint = {"five_bar": "left_elbow", "delta": "rod_2b_pitch"}[robot]
    model, k, q0 = bare_machine(robot).models[None], 20 * PASSIVE[robot], 0.1
    address, dof = int(model.joint(joint).qposadr[0]), int(model.joint(joint).dofadr[0])

    def spring(motion):
        forces = np.zeros_like(motion.qvel)
        forces[:, dof] = k * (motion.qpos[:, address] - q0)
        return forces

    simulation = run(robot, {"effect": "passive_spring", "joint": joint, "k": k, "q0": q0})
    for s in states(simulation, robot, spring):
        np.testing.assert_allclose(s.extra, 0, atol=1e-11 * abs(s.torque).max())


@pytest.mark.parametrize("robot", PASSIVE)
def test_a_rotor_in_a_passive_joint_reaches_the_motors_through_the_loops(robot):
    joint = {"five_bar": "left_elbow", "delta": "rod_2b_pitch"}[robot]
    size, dof = 0.1 * PASSIVE[robot], int(bare_machine(robot).models[None].joint(joint).dofadr[0])

    def rotor(motion):
        forces = np.zeros_like(motion.qvel)
        forces[:, dof] = size * motion.qacc[:, dof]
        return forces

    simulation = run(robot, {"effect": "passive_rotor_inertia", "joint": joint, "Ia": size})
    for s in states(simulation, robot, rotor):
        np.testing.assert_allclose(s.extra, 0, atol=1e-11 * abs(s.torque).max())


@pytest.mark.parametrize("robot", PASSIVE)
def test_passive_coulomb_friction_of_one_joint(robot):
    joint = {"five_bar": "left_elbow", "delta": "rod_2b_pitch"}[robot]
    dof = int(bare_machine(robot).models[None].joint(joint).dofadr[0])

    def friction(motion):
        forces = np.zeros_like(motion.qvel)
        forces[:, dof] = PASSIVE[robot] * np.sign(motion.qvel[:, dof])
        return forces

    simulation = run(robot, {"effect": "passive_coulomb_friction", "joint": joint, "Fc": PASSIVE[robot]})
    sliding = [abs(r.motion.qvel[::7, dof]) > 0.05 for r in simulation.recordings]
    for s, slides in zip(states(simulation, robot, friction, slowest=-1.0), sliding, strict=True):
        assert slides.mean() > 0.5
        np.testing.assert_allclose(s.extra[slides], 0, atol=1e-10 * abs(s.torque).max())


def changed_robot(tmp_path, robot, *changes):
    """A copy of a built-in robot with its MJCF changed, (pattern, replacement) each exactly once."""
    folder = catalogue_folder("robots") / robot
    (tmp_path / "robot.toml").write_text((folder / "robot.toml").read_text())
    text = (folder / f"{robot}.xml").read_text()
    for pattern, replacement in changes:
        text, count = re.subn(pattern, replacement, text)
        assert count == 1, pattern
    (tmp_path / f"{robot}.xml").write_text(text)
    return {"robot": str(tmp_path)}


def same_movement(one, other, tolerance=1e-9):
    for a, b in zip(one.recordings, other.recordings, strict=True):
        np.testing.assert_allclose(a.motion.qpos, b.motion.qpos, atol=tolerance)
        np.testing.assert_allclose(a.current, b.current, atol=tolerance * 1e3)


GEOMETRY = {
    "left": (r'(<body name="left_rod" pos=")0.2 0 0', r"\g<1>0.203 0 0"),
    "right_elbow": (r'(<site name="right_tip" pos=")0.3 0 0', r"\g<1>0.303 0 0"),
}


@pytest.mark.parametrize("joint", GEOMETRY)
def test_geometric_error_is_a_longer_link_in_the_mjcf(joint, tmp_path):
    tuning = {
        "controller": {"kp": 200.0, "kv": 6.0},  # not from an inertia, which the length changes
        "step": STEP / 2,
    }
    error = {"effect": "geometric_error", "joint": joint, "error": 0.003}
    hidden, unchanged = run("five_bar", error, **tuning), run("five_bar", **tuning)
    known = run("five_bar", **tuning, **changed_robot(tmp_path, "five_bar", GEOMETRY[joint]))
    same_movement(hidden, known)
    for a, b in zip(hidden.recordings, unchanged.recordings, strict=True):
        assert np.abs(a.current - b.current).max() > 5e-3
    assert hidden.loop_gap < 1e-6


def test_geometric_error_of_a_link_that_carries_the_tool_takes_the_payload_along():
    """The rod with the tool: its payload moves out with the end of the loop."""
    simulation = run("five_bar", {"effect": "geometric_error", "joint": "left_elbow", "error": -0.004})
    model = simulation.machine.models["disc"]
    body = mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_BODY, "payload of the scenario")
    for place in (model.body_pos[body], model.site("left_tip").pos, model.site("tool").pos):
        np.testing.assert_allclose(place, [0.296, 0, 0], atol=1e-15)
    np.testing.assert_allclose(model.site("right_tip").pos, [0.3, 0, 0])


def test_geometric_error_of_a_delta_s_arm_moves_both_its_rods(tmp_path):
    simulation = run("delta", {"effect": "geometric_error", "joint": "motor_2", "error": 0.002})
    model = simulation.machine.models[None]
    np.testing.assert_allclose(model.body("rod_2a").pos, [0.422, -0.07, 0])
    np.testing.assert_allclose(model.body("rod_2b").pos, [0.422, 0.07, 0])
    np.testing.assert_allclose(model.body("rod_1a").pos, [0.42, -0.07, 0])
    assert simulation.loop_gap < 1e-5


ANCHORED = """
<mujoco>
  <default><joint axis="0 1 0"/></default>
  <worldbody>
    <body name="one"><joint name="a"/><inertial pos=".1 0 0" mass="1" diaginertia=".01 .01 .01"/>
      <body name="two" pos=".3 0 0"><joint name="b"/><inertial pos=".1 0 0" mass="1" diaginertia=".01 .01 .01"/>
        <body name="three" pos=".4 0 0"><joint name="c"/><inertial pos=".1 0 0" mass="1" diaginertia=".01 .01 .01"/>
    </body></body></body>
  </worldbody>
  <equality><{kind} body1="{first}" {second} anchor="{anchor}"/></equality>
  <keyframe><key name="home" qpos="0.8 0.9 0.7"/></keyframe>
</mujoco>
"""


@pytest.mark.parametrize(
    ("kind", "first", "second", "anchor"),
    [
        ("connect", "three", "", "0.5 0 0"),
        ("connect", "world", 'body2="three"', "1.2 0 0"),
        ("weld", "world", 'body2="three"', "0.5 0 0"),
    ],
)
def test_geometric_error_moves_anchors_that_stand_in_the_equality(kind, first, second, anchor):
    text = ANCHORED.format(kind=kind, first=first, second=second, anchor=anchor)
    before, model = (mujoco.MjModel.from_xml_string(text) for _ in range(2))
    draft = SimpleNamespace(robot=SimpleNamespace(tool_site=None))
    GeometricError("c", 0.01).adjust(model, draft)
    gap = []
    for m in (before, model):
        data = mujoco.MjData(m)
        mujoco.mj_fwdPosition(m, data)
        gap.append(data.efc_pos[:3].copy())
    # in the reference pose all links lie along x, and the loop is closed there
    np.testing.assert_allclose(gap[0], 0, atol=1e-15)
    np.testing.assert_allclose(np.abs(gap[1]), [0.01, 0, 0], atol=1e-15)


def test_base_tilt_is_gravity_turned_the_other_way(tmp_path):
    about_x, about_y = 0.1, -0.2
    simulation = run("five_bar", {"effect": "base_tilt", "about_x": about_x, "about_y": about_y})
    gravity = simulation.machine.models["disc"].opt.gravity
    # the base's axes after it was turned about y, then about the floor's x
    x = np.array([np.cos(about_y), np.sin(about_x) * np.sin(about_y), -np.cos(about_x) * np.sin(about_y)])
    y = np.array([0, np.cos(about_x), np.sin(about_x)])
    np.testing.assert_allclose(gravity, 9.81 * -np.array([x[2], y[2], np.cross(x, y)[2]]), atol=1e-14)
    turned = " ".join(map(repr, gravity.tolist()))
    known = run("five_bar", **changed_robot(tmp_path, "five_bar", ("<option", f'<option gravity="{turned}"')))
    same_movement(simulation, known)


@pytest.mark.parametrize("robot", ["five_bar", "delta"])
def test_platform_force_acts_at_the_tool_in_the_base_s_frame(robot):
    """By the principle of virtual work over the recorded movement, without any Jacobian."""
    force, k = np.array([3.0, -2.0, 4.0]), 25.0
    hidden = {"effect": "platform_force", "fx": 3.0, "fy": -2.0, "fz": 4.0, "k": k}
    simulation = run(robot, hidden, every_step=True, recordings=("free",))
    machine, motion = simulation.machine, simulation.recordings[0].motion
    model = bare_machine(robot).models[None]
    data = mujoco.MjData(model)

    def tool(qpos):
        data.qpos[:] = qpos
        mujoco.mj_kinematics(model, data)
        return data.site("tool").xpos.copy()

    home = tool(machine.home)
    samples = np.arange(501, len(motion.time) - 1, 25)
    place = np.array([[tool(motion.qpos[i + d]) for d in (-1, 0, 1)] for i in samples])
    lifted = needed(model, motion, machine.dofs, samples) - motion.torque[samples]
    acting = force - k * (place[:, 1] - home)
    speed = (place[:, 2] - place[:, 0]) / (2 * STEP)
    angles = motion.qpos[:, machine.addresses]
    rate = (angles[samples + 1] - angles[samples - 1]) / (2 * STEP)
    given, taken = (acting * speed).sum(axis=1), (lifted * rate).sum(axis=1)
    assert np.abs(given).max() > 0.1
    np.testing.assert_allclose(taken, given, atol=1e-4 * np.abs(given).max())


@pytest.mark.parametrize("robot", ["five_bar", "delta"])
def test_tool_drag_takes_the_power_of_its_speed_cubed(robot):
    """c |v|^3, whatever the direction; the robot's other bodies feel nothing of the fluid."""
    simulation = run(robot, {"effect": "tool_drag", "c": 2.0}, every_step=True, recordings=("free",))
    machine, motion = simulation.machine, simulation.recordings[0].motion
    model = bare_machine(robot).models[None]
    data = mujoco.MjData(model)

    def tool(qpos):
        data.qpos[:] = qpos
        mujoco.mj_kinematics(model, data)
        return data.site("tool").xpos.copy()

    samples = np.arange(501, len(motion.time) - 1, 25)
    place = np.array([[tool(motion.qpos[i + d]) for d in (-1, 1)] for i in samples])
    speed = np.linalg.norm(place[:, 1] - place[:, 0], axis=1) / (2 * STEP)
    added = motion.torque[samples] - needed(model, motion, machine.dofs, samples)
    angles = motion.qpos[:, machine.addresses]
    rate = (angles[samples + 1] - angles[samples - 1]) / (2 * STEP)
    wanted = 2.0 * speed**3
    assert wanted.max() > 0.1
    np.testing.assert_allclose((added * rate).sum(axis=1), wanted, atol=5e-3 * wanted.max())


def test_payload_mass_error_is_a_heavier_payload_of_the_same_shape():
    hidden = run("five_bar", {"effect": "payload_mass_error", "error": 0.1}, recordings=("held",))
    heavy = {"mass": 0.6, "center_of_mass": [0, 0, 0.02], "inertia": [1.2e-3, 1.2e-3, 2.4e-3, 0, 0, 0]}
    known = run("five_bar", recordings=("held",), payloads={"disc": heavy})
    same_movement(hidden, known)
    told = truth(hidden)["payloads"]["disc"]
    assert told["mass"] == pytest.approx(0.6)
    np.testing.assert_allclose(told["inertia"], heavy["inertia"])
    # what is declared is not touched
    assert as_dataset(hidden).payloads["disc"].mass == 0.5


def test_encoder_offset_is_in_the_log_and_in_what_the_controller_does():
    hidden = run("five_bar", {"effect": "encoder_offset", "joint": "left", "offset": 0.03})
    machine = hidden.machine
    for recording in hidden.recordings:
        true = recording.motion.qpos[:, machine.addresses]
        np.testing.assert_allclose(recording.position - true, [[0.03, 0]] * len(true), atol=1e-15)
        # the controller holds what it measures: the joint itself stands 0.03 off
        error = recording.motion.reference - recording.position
        assert np.abs(error).max() < 0.03
        q, qd, _ = recording.trajectory.evaluate(recording.motion.time)
        drive = machine.drive
        current = drive.kp * (q - recording.position) + drive.kv * (
            qd - recording.motion.qvel[:, machine.dofs]
        )
        np.testing.assert_allclose(recording.current, current / drive.nominal_gains, atol=1e-11)
    for s in states(hidden, "five_bar"):
        np.testing.assert_allclose(s.extra, 0, atol=1e-11)


def test_transmission_error_is_in_the_log_and_in_what_the_controller_does():
    wave = {"a": 2e-3, "b": -1e-3, "period": 0.4}
    hidden = run("five_bar", {"effect": "transmission_error", "joint": "left", **wave}, every_step=True)
    machine = hidden.machine
    for recording in hidden.recordings:
        motion, drive = recording.motion, machine.drive
        true = motion.qpos[:, machine.addresses]
        phase = 2 * np.pi * true[:, 0] / 0.4
        error = np.column_stack([2e-3 * np.cos(phase) - 1e-3 * np.sin(phase), 0 * phase])
        np.testing.assert_allclose(recording.position - true, error, atol=1e-15)
        # the velocity that the controller takes from its encoders, a step late
        rate = motion.qvel[1:, machine.dofs] + np.diff(error, axis=0) / STEP
        q, qd, _ = (part[1:] for part in recording.trajectory.evaluate(motion.time))
        current = drive.kp * (q - recording.position[1:]) + drive.kv * (qd - rate)
        np.testing.assert_allclose(recording.current[1:], current / drive.nominal_gains, atol=1e-9)
    for s in states(hidden, "five_bar", step=29):
        np.testing.assert_allclose(s.extra, 0, atol=1e-11 * abs(s.torque).max())


def drive_states(simulation, robot, joint):
    """Motor and joint coordinates, motor torque, and what the joint takes at all samples."""
    machine = simulation.machine
    i = machine.robot.joints.index(joint)
    for recording in simulation.recordings:
        motion = recording.motion
        model = bare_machine(robot).models[recording.table.payload]
        everything = np.arange(0, len(motion.time), 3)
        taken = needed(model, motion, machine.dofs, everything)[:, i]
        sides = ((machine.motor_addresses[i], machine.motor_dofs[i]), (machine.addresses[i], machine.dofs[i]))
        (qm, vm, am), (q, v, _) = (
            (motion.qpos[everything, p], motion.qvel[everything, d], motion.qacc[everything, d])
            for p, d in sides
        )
        np.testing.assert_array_equal(recording.position[everything, i], qm)
        yield qm, vm, am, q, v, motion.torque[everything, i], taken


def test_drive_flexibility_is_a_spring_and_the_rotor_s_inertia():
    hidden = {"effect": "drive_flexibility", "stiffness": 300.0, "damping": 0.2, "rotor_inertia": 0.004}
    for qm, vm, am, q, v, torque, taken in drive_states(run("five_bar", hidden), "five_bar", "right"):
        spring = 300 * (qm - q) + 0.2 * (vm - v)
        np.testing.assert_allclose(taken, spring, atol=1e-10)
        np.testing.assert_allclose(torque, 0.004 * am + spring, atol=1e-8)
        assert abs(qm - q).max() > 3e-3
        # at the start the spring already carries the weight
        assert abs(spring[1] / spring[0] - 1) < 1e-3


def test_drive_flexibility_takes_the_armature_of_the_mjcf_to_the_motor():
    simulation = run(
        "delta", {"effect": "drive_flexibility", "joint": "motor_1", "stiffness": 2e4, "damping": 20.0}
    )
    machine = simulation.machine
    model = machine.models[None]
    assert model.dof_armature[machine.dofs[0]] == 0
    assert model.dof_armature[machine.motor_dofs[0]] == 0.626175
    assert model.dof_armature[machine.dofs[1]] == 0.626175
    np.testing.assert_array_equal(machine.motor_dofs[1:], machine.dofs[1:])
    assert simulation.loop_gap < 1e-5
    for qm, vm, am, q, v, torque, _ in drive_states(simulation, "delta", "motor_1"):
        spring = 2e4 * (qm - q) + 20.0 * (vm - v)
        np.testing.assert_allclose(torque, 0.626175 * am + spring, atol=1e-6)


def test_backlash_carries_the_weight_on_one_flank():
    play = {"play": 0.01, "stiffness": 3000.0, "damping": 0.3, "rotor_inertia": 0.004}
    simulation = run("five_bar", {"effect": "backlash", "joint": "left", **play})
    for qm, vm, am, q, v, torque, taken in drive_states(simulation, "five_bar", "left"):
        apart = qm - q
        flank = 3000 * np.where(abs(apart) > 0.005, apart - np.sign(apart) * 0.005, 0)
        np.testing.assert_allclose(taken, flank + 0.3 * (vm - v), atol=1e-9)
        np.testing.assert_allclose(torque, 0.004 * am + taken, atol=1e-7)
        assert (apart < -0.005).all()  # gravity never lets go of this flank


def test_cogging_and_ripple_go_with_the_motor_where_it_turns_apart():
    flexible = {
        "effect": "drive_flexibility",
        "joint": "left",
        "stiffness": 300.0,
        "damping": 0.2,
        "rotor_inertia": 0.004,
    }
    cogging = {"effect": "cogging_torque", "joint": "left", "a": 0.2, "b": 0.0, "period": 0.05}
    for qm, vm, am, q, v, torque, _ in drive_states(run("five_bar", flexible, cogging), "five_bar", "left"):
        rest = torque - 0.004 * am - 300 * (qm - q) - 0.2 * (vm - v)
        np.testing.assert_allclose(rest, 0.2 * np.cos(2 * np.pi * qm / 0.05), atol=1e-7)
    ripple = {"effect": "torque_ripple", "joint": "left", "a": 0.2, "b": 0.0, "period": 0.05}
    simulation = run("five_bar", flexible, ripple)
    for recording in simulation.recordings:
        ratio = recording.motion.torque / recording.current / simulation.machine.drive.true_gains
        expected = 1 + 0.2 * np.cos(2 * np.pi * recording.position[:, 0] / 0.05)
        np.testing.assert_allclose(ratio[:, 0], expected, rtol=1e-12)


def test_a_slide_may_have_a_flexible_drive(tmp_path):
    """The rotor of a slide is a mass: the same equations in m and N."""
    spring = {"stiffness": 1e4, "damping": 20.0, "rotor_inertia": 0.5}
    motion = cart(tmp_path, "0 0 1", {"effect": "drive_flexibility", **spring}).recordings[0].motion
    (q, qm), (v, vm), (a, am) = motion.qpos.T, motion.qvel.T, motion.qacc.T
    spring = 1e4 * (qm - q) + 20 * (vm - v)
    np.testing.assert_allclose(spring, 4 * (a + 9.81), atol=1e-9)
    np.testing.assert_allclose(motion.torque[:, 0], spring + 0.5 * am, atol=1e-8)


def test_backlash_passes_no_torque_within_the_play(tmp_path):
    play = {"play": 2e-3, "stiffness": 5e4, "damping": 20.0, "rotor_inertia": 0.5}
    motion = cart(tmp_path, "1 0 0", {"effect": "backlash", **play}).recordings[0].motion
    (q, qm), (v, vm), (a, am) = motion.qpos.T, motion.qvel.T, motion.qacc.T
    apart = qm - q
    flank = 5e4 * np.where(abs(apart) > 1e-3, apart - np.sign(apart) * 1e-3, 0)
    np.testing.assert_allclose(4 * a, flank + 20 * (vm - v), atol=1e-9)
    np.testing.assert_allclose(motion.torque[:, 0], 0.5 * am + 4 * a, atol=1e-8)
    within = abs(apart) < 1e-3
    assert np.count_nonzero(within) > 20
    assert (apart < -1e-3).any()
    assert (apart > 1e-3).any()


def test_laws_of_a_slide_are_in_newtons(tmp_path):
    stribeck = {"effect": "stribeck_friction", "Fc": 2.0, "Fs": 1.0, "vs": 0.1}
    motion = cart(tmp_path, "1 0 0", stribeck).recordings[0].motion
    moving = abs(motion.qvel[:, 0]) > 0.02
    law = (2 + np.exp(-((motion.qvel / 0.1) ** 2))) * np.sign(motion.qvel)
    np.testing.assert_allclose((motion.torque - 4 * motion.qacc)[moving], law[moving], atol=1e-9)
