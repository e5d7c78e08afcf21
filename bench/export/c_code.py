"""A feed-forward as C without dependencies: recursive Newton-Euler over constant tables, for robots without loops."""

import re
from collections.abc import Callable, Mapping
from pathlib import Path
from string import Template

import numpy as np

from bench.basics.errors import BenchError
from bench.effects.laws.gain_saturation import LEAST as LEAST_SATURATED
from bench.effects.laws.gain_saturation import SOLVING
from bench.effects.laws.torque_ripple import LEAST as LEAST_RIPPLED
from bench.export.feedforward import chosen_effects
from bench.export.identified import EffectValues, IdentifiedModel
from bench.files.atomic import write_text_atomically
from bench.model.geometry import Geometry

TEMPLATE = Path(__file__).with_name("feedforward.c.in")


def c_text(model: IdentifiedModel) -> tuple[str, tuple[str, ...]]:
    """The source, and what of the model is not in it.

    The bodies' tables hold base parameters at the places of the standard parameters that they are named after, all
    others zero: the same torques with fewer numbers. Raises BenchError for loops, couplings, ball and free joints.
    """
    geometry = model.model.geometry
    _check_tree(geometry)
    chosen = chosen_effects(model)
    known = [effect for effect in (*chosen.at_motors, *chosen.between) if effect.name in LAWS]
    unknown = [
        f"{effect.name} at {effect.place}"
        for effect in (*chosen.at_motors, *chosen.between)
        if effect not in known
    ]
    left_out = (*chosen.left_out, *unknown)
    count = len(geometry.joints)
    parameters = np.zeros(10 * count + len(model.robot.joints))
    parameters[model.model.base.columns] = model.base
    driven = [geometry.joint_index(joint) for joint in model.robot.joints]
    name = re.sub(r"\W", "_", geometry.robot.name)
    units = ", ".join(
        f"{actuator.joint} ({actuator.gain_unit.split('/')[-1]})" for actuator in model.robot.actuators
    )
    text = Template(TEMPLATE.read_text(encoding="utf-8")).substitute(
        name=name if not name[0].isdigit() else f"_{name}",
        robot=_comment(geometry.robot.name),
        currents=_comment(units),
        left_out="".join(f"\n * Not in it: {_comment(line)}." for line in left_out),
        n=count,
        parent=_table([joint.parent for joint in geometry.joints]),
        slides=_table([int(joint.kind == "slide") for joint in geometry.joints]),
        driven=_table(driven),
        offset=_table([joint.offset for joint in geometry.joints]),
        axis=_table(np.array([joint.axis for joint in geometry.joints])),
        rotation=_table(np.array([joint.placement.rotation.ravel() for joint in geometry.joints])),
        translation=_table(np.array([joint.placement.translation for joint in geometry.joints])),
        bodies=_table(parameters[: 10 * count].reshape(count, 10)),
        rotors=_table(parameters[10 * count :]),
        gain=_table(model.gains),
        gravity=_table(geometry.gravity),
        solving=SOLVING,
        least=repr(LEAST_SATURATED),
        effects=_lines(model, [effect for effect in known if not effect.instance.effect.before_torque]),
        between=_lines(model, [effect for effect in known if effect.instance.effect.before_torque]),
    )
    return text, left_out


def write_c(path: Path, model: IdentifiedModel) -> tuple[str, ...]:
    """Write it, whole or not at all; returns what of the model is not in it."""
    text, left_out = c_text(model)
    write_text_atomically(path, text)
    return left_out


def _check_tree(geometry: Geometry) -> None:
    other = [joint.name for joint in geometry.joints if joint.kind not in ("hinge", "slide")]
    if geometry.closed or other:
        raise BenchError(
            f"robot {geometry.robot.name}: C is written for robots of hinges and slides without loops and couplings; "
            "bench.export.feedforward closes loops in Python"
        )


def _lines(model: IdentifiedModel, effects: list[EffectValues]) -> str:
    """A line of C for each effect at its motor."""
    geometry, lines = model.model.geometry, []
    for effect in effects:
        turns = geometry.joints[geometry.joint_index(effect.place)].kind != "slide"
        values = {**effect.instance.effect.shape_values(), **effect.values}
        j = model.robot.joints.index(effect.place)
        values["phase"] = 1.0 if turns else 2.0 * np.pi
        target = "between" if effect.instance.effect.before_torque else "torque"
        state = f"double x = q[{j}], s = v[{j}], b = a[{j}], t = torque[{j}], g = gain[{j}]"
        unused = "(void)x; (void)s; (void)b; (void)t; (void)g;"
        lines.append(f"    {{ {state}; {unused} {target}[{j}] += {LAWS[effect.name](_numbers(values))}; }}")
    return "\n".join(lines)


Law = Callable[[Mapping[str, str]], str]
"""C of a law: of x, s, b: position, velocity, acceleration; t: torque needed beside it; g: gain."""


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
"""Sorted by name."""


def _numbers(values: Mapping[str, float]) -> dict[str, str]:
    return {name: f"({float(value)!r})" for name, value in values.items()}


def _table(values: np.ndarray | list[int] | list[float]) -> str:
    array = np.asarray(values)
    if array.ndim == 2:
        return ",\n    ".join("{" + _table(row) + "}" for row in array)
    return ", ".join(repr(value) for value in array.tolist())


def _comment(text: str) -> str:
    return text.replace("*/", "* /")
