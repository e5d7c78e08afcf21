"""The five-bar with mujoco.sysid: it predicts positions by simulation and varies gains and masses until these fit.

It receives what the measurements do not contain: the initial state, the controller with its gains, and all other masses
and inertias. The time step is either that of the simulated truth, so that the model is a copy of the truth, or the
log's, as for a real machine.
"""

import io
import time
from collections.abc import Callable
from contextlib import redirect_stdout
from importlib import import_module
from typing import Any

import numpy as np

from bench.benchmarks.peers.parabench import Answer
from bench.benchmarks.peers.problems import UNKNOWN_BODIES, PeerProblem
from bench.scenario.scenario import payload_truth

# available only in the environment of `make peers`
mujoco: Any = import_module("mujoco")
sysid: Any = import_module("mujoco.sysid")

START = 1.3  # factor of the initial masses; gains start at their nominal values


def solve(problem: PeerProblem, step: float) -> Answer:
    """Gains and the two masses by nonlinear least squares on the positions. step: time step, s."""
    simulation = problem.simulation
    machine, joints = simulation.machine, simulation.robot.joints
    parameters = sysid.ParameterDict()
    for i, joint in enumerate(joints):
        change = _gain_change(joint, machine.drive.kp[i], machine.drive.kv[i])
        parameters.add(sysid.Parameter(f"gain {joint}", 1.0, 0.5, 2.0, modifier=change))
    for body, mass in zip(UNKNOWN_BODIES[problem.robot], problem.masses, strict=True):
        parameters.add(
            sysid.Parameter(body, START * mass, 0.2 * mass, 5.0 * mass, modifier=_mass_change(body))
        )
    sequences = [_sequence(problem, index, step) for index in range(len(simulation.recordings))]
    residual = sysid.build_residual_fn(models_sequences=sequences)
    start = time.process_time()
    with redirect_stdout(io.StringIO()):
        optimum, result = sysid.optimize(parameters, residual, optimizer="mujoco", verbose=False)
    seconds = time.process_time() - start
    vector = optimum.as_vector()
    errors = np.concatenate([part.ravel() for part in residual(vector, optimum)[0]])
    jacobian = np.asarray(result.jac)
    variance = float(errors @ errors) / (len(errors) - len(vector))
    stds = np.sqrt(variance * np.diag(np.linalg.inv(jacobian.T @ jacobian)))
    nominal = simulation.robot.nominal_gains
    n = len(nominal)
    copy = step == simulation.scenario.settings.step
    name = f"mujoco.sysid, {1000 * step:g} ms step{', as the truth' if copy else ''}"
    return Answer(name, seconds, vector[:n] * nominal, stds[:n] * nominal, vector[n:], stds[n:])


Change = Callable[[Any, Any], None]
"""Puts a parameter of mujoco.sysid into an MjSpec."""


def _gain_change(joint: str, kp: float, kv: float) -> Change:
    def change(spec: Any, parameter: Any) -> None:
        ratio = float(parameter.value[0])
        motor = spec.actuator(f"motor {joint}")
        motor.gainprm[0], motor.biasprm[1], motor.biasprm[2] = ratio, -ratio * kp, -ratio * kv

    return change


def _mass_change(body: str) -> Change:
    def change(spec: Any, parameter: Any) -> None:
        spec.body(body).mass = float(parameter.value[0])

    return change


def _sequence(problem: PeerProblem, index: int, step: float) -> Any:
    simulation = problem.simulation
    recording = simulation.recordings[index]
    spec = _spec(problem, recording.table.payload, step)
    model = spec.compile()
    times = np.arange(0.0, recording.motion.time[-1] + step / 2, step)
    command = simulation.machine.drive.command(*recording.trajectory.evaluate(times))
    state = sysid.create_initial_state(model, recording.motion.qpos[0], recording.motion.qvel[0])
    # its predictions have the time after a step, but sensor values of the state before it
    positions = sysid.TimeSeries.from_names(recording.log.time + step, recording.log.position, model)
    name = recording.name
    return sysid.ModelSequences(name, spec, name, state, sysid.TimeSeries(times, command), positions)


def _spec(problem: PeerProblem, payload: str | None, step: float) -> Any:
    """The robot with motors, position sensors and payload, and with loops as stiff as in the truth."""
    simulation = problem.simulation
    robot, truth = simulation.robot, simulation.machine.models[None]
    spec = robot.mjcf_spec()
    for other in (*spec.actuators, *spec.sensors, *spec.keys):
        spec.delete(other)
    spec.compiler.fusestatic = False
    option = spec.option
    option.timestep, option.integrator = step, mujoco.mjtIntegrator.mjINT_EULER
    option.disableflags |= mujoco.mjtDisableBit.mjDSBL_EULERDAMP | mujoco.mjtDisableBit.mjDSBL_CONTACT
    option.solver, option.jacobian = mujoco.mjtSolver.mjSOL_NEWTON, mujoco.mjtJacobian.mjJAC_DENSE
    option.iterations, option.tolerance = 100, 1e-12
    for i, equality in enumerate(spec.equalities):
        equality.solref, equality.solimp = [max(0.002, 2 * step), 1.0], truth.eq_solimp[i]
    for i, joint in enumerate(robot.joints):
        motor = spec.add_actuator(name=f"motor {joint}", target=joint)
        motor.trntype, motor.gaintype = mujoco.mjtTrn.mjTRN_JOINT, mujoco.mjtGain.mjGAIN_FIXED
        motor.biastype = mujoco.mjtBias.mjBIAS_AFFINE
        drive = simulation.machine.drive
        motor.gainprm[0], motor.biasprm[1], motor.biasprm[2] = 1.0, -drive.kp[i], -drive.kv[i]
        spec.add_sensor(
            name=f"position {joint}",
            type=mujoco.mjtSensor.mjSENS_JOINTPOS,
            objtype=mujoco.mjtObj.mjOBJ_JOINT,
            objname=joint,
        )
    if payload is not None:
        known = payload_truth(payload, simulation.scenario.settings.payloads[payload])
        site = spec.site(robot.tool_site)
        body = site.parent.add_body(name="payload", pos=site.pos, quat=site.quat)
        body.explicitinertial = True
        body.mass, body.ipos, body.fullinertia = known.mass, known.center_of_mass, known.inertia
    return spec
