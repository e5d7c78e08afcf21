"""A feed-forward as C without dependencies: recursive Newton-Euler over constant tables; loops are closed by Newton's
method, and the torques of joints without a motor carried to the motors by virtual work.
"""

import re
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from string import Template

import numpy as np

from bench.basics.files.atomic import write_text_atomically
from bench.effects.laws.gain_saturation import LEAST as LEAST_SATURATED
from bench.effects.laws.gain_saturation import SOLVING
from bench.effects.laws.torque_ripple import LEAST as LEAST_RIPPLED
from bench.export.feedforward import chosen_effects
from bench.export.identified import EffectValues, IdentifiedModel, carried
from bench.model.bounds import CLOSURE
from bench.model.closure import closures_of, loop_rows
from bench.model.elimination import elimination_order
from bench.model.follow import make_follower
from bench.model.geometry import POWERS, Geometry
from bench.model.kinematics import frames_of
from bench.model.spin import idle_spins

MOST_ITERATIONS = 8  # of Newton's method, per pose
MOST_POSES = 512  # per call: if motors go far, poses between are closed, too
NEARLY = 1e-8  # m or rad: after a smaller correction the loops are closed to rounding
CLOSED = 1e-9  # m or rad: residual of closures that are not redundant
TEMPLATES = Path(__file__).with_name("c")


def table(values: np.ndarray | Sequence[object]) -> str:
    """The text between the braces of an array, of one dimension or two."""
    array = np.asarray(values)
    if array.ndim == 2:
        return ",\n    ".join("{" + table(row) + "}" for row in array)
    return ", ".join(repr(value) for value in array.tolist())


def passive_order(geometry: Geometry) -> tuple[int, ...]:
    """The passive velocities in the order of their elimination: those of the legs first."""
    closures = closures_of(geometry)
    _, rows = loop_rows(closures, frames_of(closures.links, np.ascontiguousarray(geometry.home[:, None])))
    passive = set(closures.passive)
    return elimination_order([{c: x for c, x in row.items() if c in passive} for row in rows])


def closure_tables(geometry: Geometry) -> dict[str, str]:
    """Values for the templates of closed robots."""
    spins, passive = idle_spins(geometry), passive_order(geometry)
    equations = closures_of(geometry).equations
    ends = [(loop.first, loop.second) for loop in geometry.loops]
    terms, factors = [], []
    for g, coupling in enumerate(geometry.couplings):
        for second, side in enumerate((coupling.first, coupling.second)):
            for joint, factor in side:
                place = geometry.joints[joint]
                terms.append((g, second, place.q.start, place.v.start))
                factors.append(factor)
    points = [np.concatenate([end.placement.translation for end in pair]) for pair in ends]
    turns = [np.concatenate([end.placement.rotation.ravel() for end in pair]) for pair in ends]
    given = [coupling.polynomial for coupling in geometry.couplings]
    polynomials = [np.pad(polynomial, (0, POWERS - len(polynomial))) for polynomial in given]
    repeating = equations > len(passive)
    return {
        "passives": str(len(passive)),
        "equations": str(equations),
        "loops": str(len(geometry.loops)),
        "gears": str(len(geometry.couplings)),
        "terms": str(len(terms)),
        "spins": str(len(spins)),
        "passive": table(passive),
        "home": table(geometry.home),
        "unit": table(make_follower(geometry).units),
        "weld": table([int(loop.kind == "weld") for loop in geometry.loops]),
        "end_joint": table([[end.joint for end in pair] for pair in ends]),
        "end_point": table(points),
        "end_rotation": table(turns),
        "powers": str(POWERS),
        "polynomial": table(polynomials),
        "term": table(terms),
        "factor": table(factors),
        "spin_joint": table([spin.joint for spin in spins]),
        "spin_axis": table([spin.axis for spin in spins]),
        "iterations": str(MOST_ITERATIONS),
        "poses": str(MOST_POSES),
        "nearly": repr(NEARLY),
        "slack": repr(CLOSURE.slack if repeating else CLOSED),
        "amplified": f"{CLOSURE.amplification:g}",
        "largest_correction": repr(CLOSURE.correction),
        "largest_step": repr(CLOSURE.step),
        "largest_turn": repr(CLOSURE.turn),
        "smallest_step": repr(CLOSURE.share),
    }


Law = Callable[[Mapping[str, str]], str]
"""C of a law: of x, s, b: position, velocity, acceleration; t: torque needed in addition to it; g: gain."""


def _wave(v: Mapping[str, str], periods: str) -> str:
    angle = f"{v['phase']} * {periods} * x"
    return f"({v['a']} * cos({angle}) + {v['b']} * sin({angle}))"


LAWS: dict[str, Law] = {
    "asymmetric_viscous_friction": lambda v: f"(s > 0 ? {v['Fv_plus']} : {v['Fv_minus']}) * s",
    "cogging_torque": lambda v: _wave(v, v["periods"]),
    "constant_offset": lambda v: v["c"],
    "coulomb_friction": lambda v: f"{v['Fc']} * sign(s)",
    "gain_saturation": lambda v: f"saturated(t / g, {v['k']}) * g * {v['k']}",
    "joint_spring": lambda v: f"{v['k']} * x - {v['kq0']}",
    "load_dependent_friction": lambda v: f"{v['mu']} * sign(t * s) * t / (1.0 - {v['mu']} * sign(t * s))",
    "position_dependent_friction": lambda v: f"sign(s) * {_wave(v, v['harmonic'])}",
    "quadratic_drag": lambda v: f"{v['c']} * s * fabs(s)",
    "rotor_inertia": lambda v: f"{v['Ia']} * b",
    "shear_thinning_friction": lambda v: f"{v['Fa']} * asinh(s / {v['va']})",
    "stribeck_friction": lambda v: (
        f"({v['Fc']} + {v['Fs']} * exp(-pow(fabs(s / {v['vs']}), {v['delta']}))) * sign(s)"
    ),
    "torque_ripple": lambda v: (
        f"-t * {_wave(v, v['periods'])} / fmax(1.0 + {_wave(v, v['periods'])}, {LEAST_RIPPLED!r})"
    ),
    "viscous_friction": lambda v: f"{v['Fv']} * s",
}
"""At a motor. Sorted by name."""

PASSIVE_LAWS: dict[str, Law] = {
    "passive_coulomb_friction": lambda v: f"{v['Fc']} * sign(s)",
    "passive_rotor_inertia": lambda v: f"{v['Ia']} * b",
    "passive_spring": lambda v: f"{v['k']} * x - {v['kq0']}",
    "passive_viscous_friction": lambda v: f"{v['Fv']} * s",
}
"""In a joint without a motor. Sorted by name."""


def motor_lines(model: IdentifiedModel, effects: Sequence[EffectValues]) -> str:
    """A line of C for each effect at its motor whose law is known."""
    lines = []
    for effect in effects:
        if effect.name not in LAWS:
            continue
        j = model.robot.joints.index(effect.place)
        turns = model.model.geometry.active_joints[j].kind != "slide"
        values = {**effect.instance.effect.shape_values(), **effect.values}
        values["phase"] = 1.0 if turns else 2.0 * np.pi
        target = "between" if effect.instance.effect.before_torque else "torque"
        state = f"double x = q[{j}], s = v[{j}], b = a[{j}], t = torque[{j}], g = gain[{j}]"
        unused = "(void)x; (void)s; (void)b; (void)t; (void)g;"
        lines.append(f"    {{ {state}; {unused} {target}[{j}] += {LAWS[effect.name](_numbers(values))}; }}")
    return "\n".join(lines)


def passive_lines(geometry: Geometry, passive: Sequence[int], effects: Sequence[EffectValues]) -> str:
    """Lines of C for each effect in a joint without a motor; passive: the velocities in the order of the code."""
    lines = []
    for effect in effects:
        joint = geometry.joints[geometry.joint_index(effect.place)]
        k = list(passive).index(joint.v.start)
        law = PASSIVE_LAWS[effect.name](_numbers(effect.values))
        lines.append(
            f"    {{ double x = pose[{joint.q.start}] + ({joint.offset!r}), s = rate[{joint.v.start}], "
            f"b = growth[{joint.v.start}];\n"
            "      (void)x; (void)s; (void)b;\n"
            f"      for (int i = 0; i < M; i++) torque[i] += here.amplification[{k}][i] * ({law}); }}"
        )
    return "\n".join(lines)


def _numbers(values: Mapping[str, float]) -> dict[str, str]:
    return {name: f"({float(value)!r})" for name, value in values.items()}


def c_name(robot: str) -> str:
    """The robot's name as that of C functions."""
    name = re.sub(r"\W", "_", robot, flags=re.ASCII)
    return name if not name[0].isdigit() else f"_{name}"


def c_text(model: IdentifiedModel, payload: str | None = None) -> tuple[str, tuple[str, ...]]:
    """The source, and what it lacks of the model. payload: name of the one that the robot carries.

    The bodies' tables have base parameters in place of the standard parameters of their name; all others are zero
    except for the payload's: the same torques with fewer numbers. Raises BenchError for a payload that is not
    sufficiently known.
    """
    geometry = model.model.geometry
    chosen = chosen_effects(model)
    balls = {joint.name for joint in geometry.joints if joint.kind == "ball"}
    passive = [
        effect for effect in chosen.in_passive if effect.name in PASSIVE_LAWS and effect.place not in balls
    ]
    left_out = list(chosen.left_out)
    for effect in (*chosen.at_motors, *chosen.between):
        left_out += [f"{effect.name} at {effect.place}"] if effect.name not in LAWS else []
    for effect in chosen.in_passive:
        left_out += [f"{effect.name} at {effect.place}: a ball joint"] if effect.place in balls else []
    units = ", ".join(f"{motor.joint} ({motor.gain_unit.split('/')[-1]})" for motor in model.robot.actuators)
    names = {
        "name": c_name(geometry.robot.name),
        "robot": _comment(geometry.robot.name),
        "currents": _comment(units),
        "load": "with no payload" if payload is None else f"with payload {_comment(payload)}",
        "left_out": "".join(f"\n * Not in it: {_comment(line)}." for line in left_out),
        **(closure_tables(geometry) if geometry.closed else {}),
        **_body_tables(model, payload),
        "effects": motor_lines(model, chosen.at_motors),
        "between": motor_lines(model, chosen.between),
    }
    parts = ["rigid_bodies", *(("closure_equations", "closing") if geometry.closed else ())]
    if geometry.closed:
        names["passive_effects"] = passive_lines(geometry, passive_order(geometry), passive)
    names |= {part: _filled(part, names) for part in parts}
    return _filled("closed" if geometry.closed else "tree", names), tuple(left_out)


def write_c(path: Path, model: IdentifiedModel, payload: str | None = None) -> tuple[str, ...]:
    """Write it, whole or not at all; returns what it lacks of the model."""
    text, left_out = c_text(model, payload)
    write_text_atomically(path, text)
    return left_out


def _filled(part: str, names: dict[str, str]) -> str:
    return Template((TEMPLATES / f"{part}.c.in").read_text(encoding="utf-8")).substitute(names)


def _body_tables(model: IdentifiedModel, payload: str | None) -> dict[str, str]:
    geometry = model.model.geometry
    joints, motors = geometry.joints, len(geometry.active)
    parameters = np.zeros(10 * len(joints) + motors)
    np.add.at(parameters, *carried(model, payload))
    return {
        "joints": str(len(joints)),
        "nq": str(geometry.nq),
        "nv": str(geometry.nv),
        "motors": str(motors),
        "balls": str(sum(joint.kind == "ball" for joint in joints)),
        "frees": str(sum(joint.kind == "free" for joint in joints)),
        "kind": ", ".join(joint.kind.upper() for joint in joints),
        "parent": table([joint.parent for joint in joints]),
        "at_q": table([joint.q.start for joint in joints]),
        "at_v": table([joint.v.start for joint in joints]),
        "motor_q": table(geometry.active_configuration),
        "motor_v": table(geometry.active),
        "offset": table(geometry.active_offset),
        "axis": table(np.array([joint.axis for joint in joints])),
        "rotation": table(np.array([joint.placement.rotation.ravel() for joint in joints])),
        "translation": table(np.array([joint.placement.translation for joint in joints])),
        "bodies": table(parameters[: 10 * len(joints)].reshape(-1, 10)),
        "rotors": table(parameters[10 * len(joints) :]),
        "gain": table(model.gains),
        "gravity": table(geometry.gravity),
        "solving": str(SOLVING),
        "least": repr(LEAST_SATURATED),
    }


def _comment(text: str) -> str:
    return text.replace("*/", "* /")
