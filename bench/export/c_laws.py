"""Laws of effects as expressions of C."""

from collections.abc import Callable, Mapping, Sequence

import numpy as np

from bench.effects.laws.torque_ripple import LEAST as LEAST_RIPPLED
from bench.export.identified import EffectValues, IdentifiedModel
from bench.model.geometry import Geometry

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
