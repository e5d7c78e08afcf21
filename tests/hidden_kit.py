"""Short simulations with hidden effects, and what the motors have to supply at their true states."""

import functools
from types import SimpleNamespace

import mujoco
import numpy as np

from bench.scenario.scenario import load_scenario
from bench.truth.machine import build_machine
from bench.truth.simulate import simulate

SHORT = {"optimise": False, "duration": 2.0, "ramp": 0.5}
BRIEF = {**SHORT, "duration": 1.0}
STEP = 0.0005  # s, of the simulation: a law at a state does not ask for a finer one


def scenario(name, hidden=(), recordings=("free", "held"), **overrides):
    """A short scenario of a built-in robot; "free" without payload and "held" with one."""
    base = load_scenario(name)
    payload = next(iter(base.settings.payloads))
    tables = {
        "free": {"name": "free", "use": "identify", "design": {"seed": 1}},
        "held": {"name": "held", "use": "identify", "payload": payload, "design": {"seed": 2}},
    }
    changes = {"design": SHORT, "recordings": [tables[r] for r in recordings], "step": STEP}
    changes["hidden"] = list(hidden)
    return load_scenario(name, changes | overrides)


@functools.cache
def plain(name, recordings=("free", "held"), duration=SHORT["duration"], **overrides):
    """The simulation without hidden effects."""
    design = {**SHORT, "duration": duration}
    return simulate(scenario(name, recordings=recordings, design=design, **overrides), threads=1)


@functools.cache
def bare_machine(name):
    """The machine without hidden effects."""
    return build_machine(scenario(name))


def run(name, *hidden, every_step=False, **overrides):
    """The simulation of a short scenario with hidden effects; every_step: each step is logged."""
    if every_step:
        overrides["log_rate"] = 1.0 / STEP
    return simulate(scenario(name, hidden, **overrides), threads=1)


def measured_share(simulation, reference):
    """How much an effect changed the current references (n,), RMS over RMS, of the same recordings.

    Includes what the controller makes of it, so that it differs a little from the share of the torque.
    """
    without = reference.simulation.recordings
    change = [a.current - b.current for a, b in zip(simulation.recordings, without, strict=True)]
    current = np.concatenate([recording.current for recording in without])
    ratio = np.mean(np.concatenate(change) ** 2, axis=0) / np.mean(current**2, axis=0)
    return np.sqrt(ratio)


def needed(model, motion, dofs, samples, friction=0.0):
    """(len(samples), n): torque of the motors at the true states, loops eliminated.

    friction: (N, nv) opposing forces in the joints of `model`, to be supplied as well.
    """
    data = mujoco.MjData(model)
    nq, nv = model.nq, model.nv
    passive = np.setdiff1d(np.arange(nv), dofs)
    mass = np.zeros((nv, nv))
    friction = np.broadcast_to(friction, (len(motion.time), nv))
    torque = []
    for k in samples:
        data.qpos[:], data.qvel[:] = motion.qpos[k, :nq], motion.qvel[k, :nv]
        mujoco.mj_fwdPosition(model, data)
        mujoco.mj_fwdVelocity(model, data)
        mujoco.mj_fullM(model, data, mass)
        loops = data.efc_type == int(mujoco.mjtConstraint.mjCNSTR_EQUALITY)
        jacobian = np.asarray(data.efc_J).reshape(data.nefc, nv)[loops]
        force = mass @ motion.qacc[k, :nv] + data.qfrc_bias + friction[k]
        multipliers = np.linalg.lstsq(jacobian[:, passive].T, force[passive], rcond=None)[0]
        torque.append((force - jacobian.T @ multipliers)[dofs])
    return np.array(torque)


def states(simulation, name, friction=None, step=7, slowest=0.0):
    """The true states of each recording at some samples (S,), as namespaces with arrays (S, n).

    t (S, 1), q, v, a, torque, current (as logged), extra: what the motors gave beyond what the machine
    without hidden effects needs. slowest: samples at which a joint is slower are left out.
    friction: of a recording's motion, forces (N, nv) that the machine needs in addition.
    """
    machine = simulation.machine
    for recording in simulation.recordings:
        motion = recording.motion
        moving = (np.abs(motion.qvel[:, machine.dofs]) > slowest).all(axis=1)
        samples = np.flatnonzero(moving)[::step]
        model = bare_machine(name).models[recording.table.payload]
        forces = 0.0 if friction is None else friction(motion)
        rest = needed(model, motion, machine.dofs, samples, forces)
        yield SimpleNamespace(
            t=motion.time[samples, None],
            q=motion.qpos[samples][:, machine.addresses],
            v=motion.qvel[samples][:, machine.dofs],
            a=motion.qacc[samples][:, machine.dofs],
            torque=motion.torque[samples],
            current=recording.current[samples],
            extra=motion.torque[samples] - rest,
            gains=machine.drive.true_gains,
        )


CART = """
<mujoco><worldbody><body name="cart"><joint name="x" type="slide" axis="{axis}"/>
  <inertial pos="0 0 0" mass="4" diaginertia="1 1 1"/></body></worldbody></mujoco>
"""
CART_ROBOT = """
name = "cart"
model = "cart.xml"
actuators = [{ joint = "x", gain = 50.0, gain_unit = "N/A" }]
"""
CART_SCENARIO = """
robot = "."
[[recordings]]
name = "one"
use = "identify"
design = { span = 0.1, velocity_limit = 0.5, duration = 2.0, ramp = 0.5, base_frequency = 0.5 }
"""


def cart(folder, axis, *hidden, **overrides):
    """The simulation of a mass of 4 kg on a slide along an axis, one motor, nothing else; in a folder."""
    (folder / "cart.xml").write_text(CART.format(axis=axis))
    (folder / "robot.toml").write_text(CART_ROBOT)
    (folder / "cart.toml").write_text(CART_SCENARIO)
    return simulate(load_scenario(folder / "cart.toml", {"hidden": list(hidden)} | overrides))
