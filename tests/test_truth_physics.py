"""The simulated machine against physics: its own mass matrix, its control law, its loops, its hidden effects.

The equations of motion are checked here with the loops eliminated, from MuJoCo's mass matrix, bias and
constraint Jacobian at the true state; nothing of the identification takes part.
"""

import mujoco
import numpy as np
import pytest

from bench.dataset.catalogue import built_in_scenarios
from bench.scenario.scenario import load_scenario
from bench.truth.loops import loop_gaps
from bench.truth.machine import build_machine
from bench.truth.motion import MotionRun, Timing, simulate_motion
from bench.truth.simulate import simulate

SHORT = {"optimise": False, "duration": 4.0, "ramp": 0.5}


def short(name, **overrides):
    recordings = [
        {"name": "free", "use": "identify", "design": {"seed": 1}},
        {"name": "check", "use": "validate", "design": {"seed": 3}},
    ]
    base = load_scenario(name)
    if base.settings.payloads:
        payload = next(iter(base.settings.payloads))
        recordings.insert(1, {"name": "held", "use": "identify", "payload": payload, "design": {"seed": 2}})
    return load_scenario(name, {"design": SHORT, "recordings": recordings} | overrides)


def motor_torque_needed(model, motion, driven, samples, leading=None):
    """(len(samples), leading): what the first motors have to supply at the true states, beside redundant ones."""
    data = mujoco.MjData(model)
    leading = len(driven) if leading is None else leading
    dofs = driven[:leading]
    passive = np.setdiff1d(np.arange(model.nv), dofs)
    mass = np.zeros((model.nv, model.nv))
    needed = []
    for k in samples:
        data.qpos[:], data.qvel[:] = motion.qpos[k], motion.qvel[k]
        mujoco.mj_fwdPosition(model, data)
        mujoco.mj_fwdVelocity(model, data)
        mujoco.mj_fullM(model, data, mass)
        loops = data.efc_type == int(mujoco.mjtConstraint.mjCNSTR_EQUALITY)
        jacobian = np.asarray(data.efc_J).reshape(data.nefc, model.nv)[loops]
        force = mass @ motion.qacc[k] + data.qfrc_bias
        force[driven[leading:]] -= motion.torque[k, leading:]
        multipliers = np.linalg.lstsq(jacobian[:, passive].T, force[passive], rcond=None)[0]
        rest = force - jacobian.T @ multipliers
        assert np.abs(rest[passive]).max(initial=0.0) <= 1e-9 * np.abs(force).max()
        needed.append(rest[dofs])
    return np.array(needed)


def motor_torque_undetermined(model, recording, dofs, samples):
    """What forces within loops that repeat one another may do to the motors while the loops are open by a little.

    Equations that the passive joints do not tell apart leave their forces open. A motor that moves the whole loop
    feels them by the loop's opening alone: nothing in a plane that stands still.
    """
    data = mujoco.MjData(model)
    passive = np.setdiff1d(np.arange(model.nv), dofs)
    lever = 0.0
    for k in samples[::20]:
        data.qpos[:] = recording.motion.qpos[k]
        mujoco.mj_fwdPosition(model, data)
        loops = data.efc_type == int(mujoco.mjtConstraint.mjCNSTR_EQUALITY)
        jacobian = np.asarray(data.efc_J).reshape(data.nefc, model.nv)[loops]
        left, values, _ = np.linalg.svd(jacobian[:, passive])
        repeated = left[:, int((values > 1e-9 * values.max(initial=0.0)).sum()) :]
        lever = max(lever, np.abs(repeated.T @ jacobian[:, dofs]).max(initial=0.0))
    assert lever <= 2.0 * recording.loop_gap
    return lever * np.abs(recording.motion.torque).max()


@pytest.fixture(scope="module")
def five_bar():
    return simulate(short("five_bar"))


ROBOTS = [
    name
    for name in built_in_scenarios()
    if not name.endswith("_clean") and not load_scenario(name).settings.hidden
]


@pytest.mark.parametrize("name", ROBOTS)
def test_applied_torque_is_what_the_rigid_body_needs(name):
    simulation = simulate(short(name))
    machine = simulation.machine
    for recording in simulation.recordings:
        samples = np.arange(0, len(recording.motion.time), 7)
        model = machine.models[recording.table.payload]
        leading = machine.leading
        needed = motor_torque_needed(model, recording.motion, machine.dofs, samples, leading)
        applied = recording.motion.torque[samples, :leading]
        open_forces = motor_torque_undetermined(model, recording, machine.dofs[:leading], samples)
        assert np.abs(needed - applied).max() < 1e-12 * np.abs(applied).max() + open_forces


def test_applied_torque_follows_the_control_law_at_the_logged_state(five_bar):
    drive, dofs = five_bar.machine.drive, five_bar.machine.dofs
    for recording in five_bar.recordings:
        q, qd, _ = recording.trajectory.evaluate(recording.motion.time)
        current = (
            drive.kp * (q - recording.position) + drive.kv * (qd - recording.motion.qvel[:, dofs])
        ) / drive.nominal_gains
        scale = np.abs(recording.current).max()
        np.testing.assert_allclose(recording.current, current, rtol=0, atol=1e-12 * drive.kp.max() * scale)
        np.testing.assert_allclose(drive.true_gains * recording.current, recording.motion.torque, rtol=1e-15)


def test_velocity_and_acceleration_are_the_derivatives_of_position(five_bar):
    """To the half step by which explicit integration shifts the velocity."""
    motion, h = five_bar.recordings[0].motion, 1e-3
    q, step = motion.qpos, five_bar.scenario.settings.step
    velocity = (8 * (q[3:-1] - q[1:-3]) - (q[4:] - q[:-4])) / (12 * h)
    acceleration = (-q[4:] + 16 * q[3:-1] - 30 * q[2:-2] + 16 * q[1:-3] - q[:-4]) / (12 * h**2)
    largest = np.abs(motion.qacc).max()
    np.testing.assert_allclose(acceleration, motion.qacc[2:-2], atol=1e-5 * largest)
    shifted = motion.qvel[2:-2] + 0.5 * step * motion.qacc[2:-2]
    np.testing.assert_allclose(velocity, shifted, atol=1e-5 * np.abs(velocity).max())


@pytest.mark.parametrize("name", ["five_bar", "delta"])
def test_loops_stay_closed_for_ten_seconds(name, record_property):
    simulation = simulate(short(name, design=SHORT | {"duration": 10.0}))
    record_property("loop_gap_m", simulation.loop_gap)
    assert 0 < simulation.loop_gap < 1e-5


def test_starts_at_rest_in_the_loop_closed_pose(five_bar):
    for recording in five_bar.recordings:
        assert np.abs(recording.motion.qvel[0]).max() < 1e-6
        assert np.abs(recording.motion.qacc[0]).max() < 1e-3


def test_payload_is_the_given_rigid_body_in_the_tool_frame():
    inertia = (2e-3, 3e-3, 4e-3, 3e-4, -2e-4, 5e-4)
    payload = {"mass": 0.7, "center_of_mass": [0.01, -0.02, 0.03], "inertia": list(inertia)}
    scenario = load_scenario("five_bar", {"payloads": {"disc": payload}})
    machine = build_machine(scenario)
    model = machine.models["disc"]
    body = mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_BODY, "payload of the scenario")
    data = mujoco.MjData(model)
    data.qpos[:] = machine.home + np.array([0.1, 0.2, -0.3, 0.4])
    mujoco.mj_kinematics(model, data)
    rotation = data.site("tool").xmat.reshape(3, 3)
    assert model.body_mass[body] == 0.7
    expected = data.site("tool").xpos + rotation @ payload["center_of_mass"]
    np.testing.assert_allclose(data.xipos[body], expected, atol=1e-14)
    axes = data.ximat[body].reshape(3, 3)
    xx, yy, zz, xy, xz, yz = inertia
    tensor = np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
    world = axes @ np.diag(model.body_inertia[body]) @ axes.T
    np.testing.assert_allclose(world, rotation @ tensor @ rotation.T, atol=1e-15)
    # without payload the body weighs nothing and the robot is as its MJCF says
    assert machine.models[None].body_mass[body] == 0
    robot = scenario.robot.mjcf_model()
    assert machine.models[None].body_mass.sum() == pytest.approx(robot.body_mass.sum(), rel=1e-15)


LAWS = {
    "viscous_friction": ({"Fv": 0.15}, lambda v: 0.15 * v),
    "coulomb_friction": ({"Fc": 0.3}, lambda v: 0.3 * np.sign(v)),
    "constant_offset": ({"c": -0.2}, lambda v: -0.2 * np.ones_like(v)),
    "asymmetric_viscous_friction": (
        {"Fv_plus": 0.1, "Fv_minus": 0.25},
        lambda v: np.where(v > 0, 0.1 * v, 0.25 * v),
    ),
}


@pytest.mark.parametrize("effect", LAWS)
def test_hidden_effect_obeys_its_law_exactly(effect):
    parameters, law = LAWS[effect]
    scenario = short("five_bar", hidden=[{"effect": effect, "joint": "left", **parameters}])
    simulation = simulate(scenario)
    machine = simulation.machine
    for recording in simulation.recordings:
        velocity = recording.motion.qvel[:, machine.dofs]
        # the first sample of all may still stand
        moving = np.flatnonzero(np.abs(velocity[:, 0]) > 0.005)[::11]
        model = machine.models[recording.table.payload]
        needed = motor_torque_needed(model, recording.motion, machine.dofs, moving)
        extra = recording.motion.torque[moving] - needed
        np.testing.assert_allclose(extra[:, 0], law(velocity[moving, 0]), atol=1e-11)
        np.testing.assert_allclose(extra[:, 1], 0, atol=1e-11)


def test_coulomb_friction_holds_a_joint_at_standstill():
    still = {"optimise": False, "span": 1e-9, "velocity_limit": 1.0, "duration": 1.0, "ramp": 0.2}
    scenario = load_scenario(
        "five_bar",
        {
            "recordings": [{"name": "still", "use": "identify", "design": still}],
            "hidden": [{"effect": "coulomb_friction", "Fc": 50.0}],
        },
    )
    recording = simulate(scenario).recordings[0]
    assert np.abs(recording.motion.qvel).max() < 1e-3
    assert np.abs(recording.motion.torque).max() < 0.1  # the brake carries the weight, not the motor


def test_shorter_and_longer_runs_do_not_disturb_each_other(five_bar):
    machine, scenario = five_bar.machine, five_bar.scenario
    timing = Timing(scenario.settings.step, scenario.log_every, 500)
    runs = [
        MotionRun(r.name, r.table.payload, r.trajectory, 1000 + 500 * i)
        for i, r in enumerate(five_bar.recordings)
    ]
    together = simulate_motion(machine, runs, timing)
    for run, motion, recording in zip(runs, together, five_bar.recordings, strict=True):
        assert len(motion.time) == run.samples
        np.testing.assert_array_equal(motion.qpos, recording.motion.qpos[: run.samples])


CLOSURES = """
<mujoco>
  <worldbody>
    <body name="a" pos="0 0 1"><freejoint/><inertial pos="0 0 0" mass="1" diaginertia="1 1 1"/>
      <site name="sa" pos=".3 .1 -.2"/></body>
    <body name="b" pos="1 0 1"><freejoint/><inertial pos="0 0 0" mass="1" diaginertia="1 1 1"/>
      <site name="sb" pos="-.5 .2 .1"/></body>
  </worldbody>
  <equality>
    <connect body1="a" body2="b" anchor=".2 .3 .4"/>
    <weld body1="a" body2="b" anchor=".1 -.2 .3"/>
    <connect site1="sa" site2="sb"/>
    <weld site1="sa" site2="sb"/>
    <connect body1="a" anchor=".1 .1 .1"/>
  </equality>
</mujoco>
"""


def test_loop_gaps_are_those_that_mujoco_closes():
    model = mujoco.MjModel.from_xml_string(CLOSURES)
    rng = np.random.default_rng(0)
    qpos = rng.standard_normal((5, model.nq))
    qpos[:, 3:7] /= np.linalg.norm(qpos[:, 3:7], axis=1, keepdims=True)
    qpos[:, 10:14] /= np.linalg.norm(qpos[:, 10:14], axis=1, keepdims=True)
    gaps = loop_gaps(model, qpos)
    data = mujoco.MjData(model)
    for pose, found in zip(qpos, gaps, strict=True):
        data.qpos[:] = pose
        mujoco.mj_fwdPosition(model, data)
        expected = [
            np.linalg.norm(data.efc_pos[np.flatnonzero(data.efc_id[: data.nefc] == i)[:3]]) for i in range(5)
        ]
        np.testing.assert_allclose(found, expected, rtol=1e-12)
