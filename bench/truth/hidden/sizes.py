"""The size of an effect: parameters for a given share of the torque, for any robot."""

from collections.abc import Callable, Mapping
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from bench.basics.errors import BenchError
from bench.scenario.scenario import Scenario
from bench.scenario.tables import Hidden
from bench.truth.hidden import HIDDEN_EFFECTS, JointEffect
from bench.truth.hidden.base import HiddenEffect, JointMovement, Sizes, rms
from bench.truth.hidden.reference import Reference
from bench.truth.inverse import motor_torque
from bench.truth.machine import build_machine
from bench.truth.simulate import Simulation, simulate

Array = NDArray[np.float64]
DIGITS = 4  # significant digits of a parameter


def typical(effect: str, reference: Reference, share: float, joint: str | None = None) -> dict[str, float]:
    """Parameters of an effect whose torque is about `share` of the motor's torque, RMS over RMS.

    reference: the same motion without hidden effects; the rules are the same for all robots. joint: the joint of the
    effect; the share refers to the torque of its motor, or of all motors if it has none. None for an effect of the
    whole machine or in all passive joints; the share then refers to the torque of all motors. An effect of the drive
    counts as an equivalent torque: for a delay, from the change of the current during the delay; for a flexible
    drive, from the displacement of the joint.

    Raises BenchError for an unknown effect or joint, or a share that the effect cannot have.
    """
    if not (np.isfinite(share) and share > 0):
        raise BenchError(f"the share of an effect should be greater than 0, not {share!r}")
    kind = HIDDEN_EFFECTS.get(effect)
    if kind is None:
        raise BenchError(f"no effect {effect!r}; there are {', '.join(HIDDEN_EFFECTS)}")
    if issubclass(kind, JointEffect) and kind.sized is not JointEffect.sized:
        if joint is None:
            raise BenchError(f"{effect}: name a joint: one of {', '.join(reference.simulation.robot.driven)}")
        sizes = kind.sized(reference.movement(joint), share) or {}
    else:
        try:
            sizes = machine_sizes(kind, reference, joint, share)
        except BenchError as error:
            raise BenchError(f"{effect} with a share of {share:g}: {error}") from error
    return _rounded(sizes)


def _rounded(sizes: Sizes) -> Sizes:
    return {name: float(f"{value:.{DIGITS}g}") for name, value in sizes.items()}


def real_sizes(effect: str, reference: Reference, joint: str | None, sizes: Sizes) -> Sizes:
    """These parameters of an effect, no larger than a real machine has them; its share of the torque is then smaller.

    A play is at most half a degree or 0.1 mm: twice the 15 arc-min of a standard planetary gear (catalogue of
    Raydafon) and the 0.05 mm of a standard ball screw (PBC Linear), so that worn drives are in it. Reducers of robots
    are sold with 1 to 3 arc-min.
    """
    if effect != "backlash":
        return sizes
    j = _movement(reference, joint)
    widest = WIDEST_PLAY["slide" if j.slide else "hinge"]
    return sizes if sizes["play"] <= widest else _rounded(play_sizes(reference, j, widest))


WIDEST_PLAY = {"hinge": 8.7e-3, "slide": 1e-4}  # rad, m: see `real_sizes`
CLOSE = 0.02  # of the requested share
FURTHEST = np.log(100.0)  # step of a search, as a logarithm
ROTOR = 0.1  # of the effective inertia at the joint


def passive_spring_size(reference: Reference, effect: str, joint: str | None, share: float) -> Sizes:
    """A spring relaxed at the mean position of its joint; springs of all passive joints are relaxed at
    position zero.
    """
    q0 = 0.0
    if joint is not None:
        address = int(reference.simulation.machine.models[None].joint(joint).qposadr[0])
        q0 = float(np.mean(np.concatenate([s.pose[:, address] for s in reference.samples])))
    return _scaled(reference, effect, joint, None, share, lambda x: {"k": x, "q0": q0}, 0.1)


def base_tilt_size(reference: Reference, effect: str, _joint: str | None, share: float) -> Sizes:
    """A tilt about the axis with the larger effect on the motors."""
    keys = ("about_x", "about_y")
    felt = {key: _felt(reference, effect, None, None, {key: 0.02}) for key in keys}
    key = max(keys, key=lambda k: felt[k])
    return _scaled(reference, effect, None, None, share, lambda x: {key: x}, 0.02)


def platform_force_size(reference: Reference, effect: str, _joint: str | None, share: float) -> Sizes:
    """A constant horizontal force along x or y, whichever has the larger effect on the motors; along z if that is
    less than a fifth of the effect of a force along z.
    """
    felt = {key: _felt(reference, effect, None, None, {key: 1.0}) for key in ("fx", "fy", "fz")}
    level = max(("fx", "fy"), key=lambda k: felt[k])
    key = level if felt[level] > 0.2 * felt["fz"] else "fz"
    return _scaled(reference, effect, None, None, share, lambda x: {key: x}, 1.0)


def encoder_offset_size(reference: Reference, _effect: str, joint: str | None, share: float) -> Sizes:
    """The change of torque for a joint position shifted by the offset."""
    movement = _movement(reference, joint)
    offset = 0.01

    def felt(x: float) -> float:
        return _shifted(
            reference, movement, [np.full(len(movement.time), -x), *(np.zeros(len(movement.time)),) * 2]
        )

    solution = _solved(felt, offset, share, 1)
    if abs(solution) > movement.span:
        raise BenchError(f"the torque of joint {movement.joint} hardly depends on its zero")
    return {"offset": solution}


def drive_flexibility_size(reference: Reference, _effect: str, joint: str | None, share: float) -> Sizes:
    """The change of torque for a joint displaced by the deflection of the spring, without the rotor's inertia."""
    j = _movement(reference, joint)

    def felt(stiffness: float) -> float:
        return _shifted(reference, j, [-x / stiffness for x in (j.torque, j.torque_rate, j.torque_bend)])

    rotor = 0.0 if j.armature > 0 else ROTOR * j.inertia
    stiffness = _solved(felt, 100 * rms(j.torque) / j.span, share, -1)
    return _rotor({"stiffness": stiffness, "damping": 0.1 * np.sqrt(stiffness * j.inertia)}, rotor)


def backlash_size(reference: Reference, effect: str, joint: str | None, share: float) -> Sizes:
    """From simulations, compared with a rotor without play, since the changes of flank follow no simpler rule."""
    j = _movement(reference, joint)
    rotor = _rotor_of(j)
    without = _again(reference, "rotor_inertia", joint, {"Ia": rotor}) if rotor else reference.simulation
    i = without.robot.driven.index(j.joint)

    def felt(play: float) -> float:
        simulation = _again(reference, effect, joint, play_sizes(reference, j, play))
        pairs = zip(simulation.recordings, without.recordings, strict=True)
        return rms(np.concatenate([(a.current - b.current)[:, i] for a, b in pairs])) / rms(j.current)

    return play_sizes(reference, j, _solved(felt, 0.02 * j.span, share, 1))


def play_sizes(reference: Reference, j: JointMovement, play: float) -> Sizes:
    """Parameters of a play whose flanks deflect by a tenth of it, or more if the step requires less stiffness.

    Rotor and link swing on the flank against each other: with their reduced inertia, which is below that of the lighter
    one (a link of a wrist), and a tenth of the critical damping.
    """
    step, rotor = reference.simulation.scenario.settings.step, _rotor_of(j)
    light, heavy = sorted((rotor + j.armature, j.inertia - j.armature))
    reduced = heavy * light / (heavy + light) if light > 0 else heavy
    stiffness = min(10 * rms(j.torque) / play, 0.2 * reduced / step**2)
    damping = 0.2 * np.sqrt(stiffness * reduced)
    return _rotor({"play": play, "stiffness": stiffness, "damping": damping}, rotor)


def _rotor_of(j: JointMovement) -> float:
    """Inertia of the rotor that a joint without one in the MJCF gets."""
    return 0.0 if j.armature > 0 else ROTOR * j.inertia


def passive_load_friction_size(reference: Reference, effect: str, joint: str | None, share: float) -> Sizes:
    """From simulations, since bearing forces do not follow from the motion alone."""
    without = reference.simulation

    def felt(mu: float) -> float:
        pairs = zip(_again(reference, effect, joint, {"mu": mu}).recordings, without.recordings, strict=True)
        change = np.concatenate([a.current - b.current for a, b in pairs])
        return rms(change) / rms(np.concatenate([recording.current for recording in without.recordings]))

    return {"mu": _solved(felt, 1e-3, share, 1)}


def transmission_error_size(reference: Reference, _effect: str, joint: str | None, share: float) -> Sizes:
    """The change of torque for a joint that oscillates about its motion, with three periods over its span."""
    j = _movement(reference, joint)
    period = j.span / 3
    steepness = 2 * np.pi / period
    wave, slope = np.sin(steepness * j.position), steepness * np.cos(steepness * j.position)
    rate = slope * j.acceleration - steepness**2 * wave * j.velocity**2

    def felt(x: float) -> float:
        return _shifted(reference, j, [-x * values for values in (wave, slope * j.velocity, rate)])

    return {"a": 0.0, "b": _solved(felt, 1e-3 * period, share, 1), "period": period}


MACHINE_SIZES: Mapping[str, Callable[[Reference, str, str | None, float], Sizes]] = {
    "backlash": backlash_size,
    "base_tilt": base_tilt_size,
    "drive_flexibility": drive_flexibility_size,
    "encoder_offset": encoder_offset_size,
    "passive_load_friction": passive_load_friction_size,
    "passive_spring": passive_spring_size,
    "platform_force": platform_force_size,
    "transmission_error": transmission_error_size,
}
"""Rules for effects whose torques are not proportional to a single parameter."""


def machine_sizes(kind: type[HiddenEffect], reference: Reference, joint: str | None, share: float) -> Sizes:
    """Parameters for a share of the torque of `joint`, or of all motors."""
    if kind.name in MACHINE_SIZES:
        return MACHINE_SIZES[kind.name](reference, kind.name, joint, share)
    if kind.scaled is None:
        raise BenchError("no rule gives its size")
    name, start = kind.scaled
    actuated = joint if joint in reference.simulation.robot.joints else None
    return _scaled(reference, kind.name, joint, actuated, share, lambda x: {name: x}, start)


def _felt(
    reference: Reference, effect: str, joint: str | None, motor: str | None, parameters: Sizes
) -> float:
    """Relative change by the effect of the torque of a motor (of all, if None) in the same motion."""
    scenario = _with(reference, effect, joint, parameters)
    machine = build_machine(scenario)
    columns = slice(None) if motor is None else machine.robot.joints.index(motor)
    changes, torques = [], []
    for s in reference.samples:
        with_it = motor_torque(machine, s.payload, s.pose, s.q, s.qd, s.qdd)
        changes.append((with_it - s.torque)[:, columns])
        torques.append(s.torque[:, columns])
    return rms(np.concatenate(changes)) / rms(np.concatenate(torques))


def _with(reference: Reference, effect: str, joint: str | None, parameters: Sizes) -> Scenario:
    """The scenario of the reference with an effect."""
    scenario = reference.simulation.scenario
    hidden = Hidden(effect=effect, joint=joint, **parameters)
    return replace(scenario, settings=scenario.settings.model_copy(update={"hidden": (hidden,)}))


def _again(reference: Reference, effect: str, joint: str | None, parameters: Sizes) -> Simulation:
    trajectories = {recording.name: recording.trajectory for recording in reference.simulation.recordings}
    return simulate(_with(reference, effect, joint, parameters), trajectories)


def _shifted(reference: Reference, j: JointMovement, shifts: list[Array]) -> float:
    """Relative change of a joint's torque if its position, velocity and acceleration are shifted, (N,) each."""
    machine = reference.simulation.machine
    if j.joint not in machine.robot.joints:
        raise BenchError(
            f"the motor of joint {j.joint} is redundant: its torque does not follow from the motion"
        )
    i = machine.robot.joints.index(j.joint)
    changes, torques = [], []
    for s in reference.samples:
        moved = []
        for values, shift in zip((s.q, s.qd, s.qdd), shifts, strict=True):
            moved.append(values.copy())
            moved[-1][:, i] += shift[s.first + s.rows]
        moved_torque = motor_torque(machine, s.payload, s.pose, *moved)
        changes.append((moved_torque - s.torque)[:, i])
        torques.append(s.torque[:, i])
    return rms(np.concatenate(changes)) / rms(np.concatenate(torques))


def _scaled(
    reference: Reference,
    effect: str,
    joint: str | None,
    motor: str | None,
    share: float,
    parameters: Callable[[float], Sizes],
    start: float,
) -> Sizes:
    def felt(x: float) -> float:
        return _felt(reference, effect, joint, motor, parameters(x))

    return parameters(_solved(felt, start, share, 1))


def _solved(felt: Callable[[float], float], start: float, share: float, exponent: float) -> float:
    """x with felt(x) close to `share`, after at most four steps; felt varies roughly as x^exponent, which is
    re-estimated.
    """
    x, level = start, felt(start)
    for _ in range(4):
        if not level > 0:
            raise BenchError("the effect changes no motor torque in this motion")
        if abs(level / share - 1) < CLOSE:
            break
        before, x = (
            (x, level),
            x * float(np.exp(np.clip(np.log(share / level) / exponent, -FURTHEST, FURTHEST))),
        )
        level = felt(x)
        if level > 0 and level != before[1]:
            slope = np.log(level / before[1]) / np.log(x / before[0])
            exponent = float(np.clip(slope / exponent, 0.3, 3.0)) * exponent
    return x


def _movement(reference: Reference, joint: str | None) -> JointMovement:
    if joint is None:
        raise BenchError(f"name a joint: one of {', '.join(reference.simulation.robot.driven)}")
    return reference.movement(joint)


def _rotor(sizes: Sizes, inertia: float) -> Sizes:
    return sizes | {"rotor_inertia": inertia} if inertia > 0 else sizes
