"""The true parameters of hidden effects under the names that the model gives them."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np

True_ = Mapping[str, float]
Conversion = Callable[[True_], float]


def _same(name: str, default: float | None = None) -> Conversion:
    return lambda p: p[name] if default is None else p.get(name, default)


MODEL_PARAMETERS: Mapping[str, Mapping[str, Conversion]] = {
    "asymmetric_viscous_friction": {"Fv_plus": _same("Fv_plus"), "Fv_minus": _same("Fv_minus")},
    "backlash": {"b": _same("play")},
    "base_tilt": {"tilt_x": _same("about_x", 0.0), "tilt_y": _same("about_y", 0.0)},
    "cogging_torque": {
        "a": _same("a"),
        "b": _same("b"),
        "periods": lambda p: 2 * np.pi / p["period"],  # in a turn of a hinge
    },
    "constant_offset": {"c": _same("c")},
    "coulomb_friction": {"Fc": _same("Fc")},
    "current_delay": {"T": _same("T")},
    "current_loop_lag": {"T": _same("T")},
    "drive_flexibility": {
        "C": lambda p: 1 / p["stiffness"],
        "CIa": lambda p: p.get("rotor_inertia", np.nan) / p["stiffness"],
    },
    "encoder_offset": {"offset": _same("offset")},
    "gain_saturation": {"k": _same("k")},
    "geometric_error": {"dl": _same("error")},
    "hysteretic_cable": {"F": _same("F"), "x0": _same("reach"), "n": _same("sharpness", 2.0)},
    "joint_spring": {"k": _same("k"), "kq0": lambda p: p["k"] * p["q0"]},
    "load_dependent_friction": {"mu": _same("mu")},
    "passive_coulomb_friction": {"Fc": _same("Fc")},
    "passive_spring": {"k": _same("k")},
    "passive_viscous_friction": {"Fv": _same("Fv")},
    "payload_mass_error": {"dm": _same("error")},
    "platform_force": {
        "Fx": _same("fx", 0.0),
        "Fy": _same("fy", 0.0),
        "Fz": _same("fz", 0.0),
        "kx": _same("k", 0.0),
        "ky": _same("k", 0.0),
        "kz": _same("k", 0.0),
    },
    "position_dependent_friction": {"a": _same("a"), "b": _same("b"), "harmonic": _same("harmonic", 1.0)},
    "presliding_hysteresis": {"Fc": _same("Fc"), "x0": lambda p: p["Fc"] / p["stiffness"]},
    "quadratic_drag": {"c": _same("c")},
    "rotor_inertia": {"Ia": _same("Ia")},
    "shear_thinning_friction": {"Fa": _same("Fa"), "va": _same("va")},
    "stribeck_friction": {
        "Fc": _same("Fc"),
        "Fs": _same("Fs"),
        "vs": _same("vs"),
        "delta": _same("delta", 2.0),
    },
    "thermal_friction_drift": {"Fc": _same("Fc", 0.0), "Fv": _same("Fv", 0.0), "T": _same("T")},
    "tool_drag": {"c": _same("c")},
    "torque_ripple": {
        "a": _same("a"),
        "b": _same("b"),
        "periods": lambda p: 2 * np.pi / p["period"],
    },
    "transmission_error": {
        "a": _same("a"),
        "b": _same("b"),
        "periods": lambda p: 2 * np.pi / p["period"],
    },
    "viscous_friction": {"Fv": _same("Fv")},
}
"""Effect -> the model's parameter -> its true value from the parameters of the hidden effect.

SI units on both sides; nan where the entry does not tell, as of a rotor whose inertia is the joint's in the MJCF.
Angles of hinges. For slides the periods are per metre, without 2 pi; see `true_values`.
"""


WITHOUT_TRUTH: Mapping[str, frozenset[str]] = {
    "backlash": frozenset({"r"}),
    "drive_flexibility": frozenset({"zeta"}),
    "passive_spring": frozenset(
        {"kq0"}
    ),  # of springs whose joints move alike, where they are counted from differs
}
"""Parameters of the model that stand for no parameter of the hidden effect."""


def true_values(effect: str, hidden: True_, *, slide: bool = False) -> dict[str, float]:
    """The model's parameters of an effect, as they truly are; empty for an effect that no model knows."""
    values = {name: float(rule(hidden)) for name, rule in MODEL_PARAMETERS.get(effect, {}).items()}
    if slide and "periods" in values:
        values["periods"] /= 2 * np.pi
    return {name: value for name, value in values.items() if np.isfinite(value)}


def as_logged(hidden: Sequence[Mapping[str, Any]]) -> list[dict[str, Any]]:
    """Hidden effects told in the positions that are logged, which a hidden encoder offset shifts.

    With the logged position p = q + offset, a cos(w q) + b sin(w q) and k (q - q0) have other a, b and q0 in p.
    """
    offsets = {one.get("joint"): one["offset"] for one in hidden if one["effect"] == "encoder_offset"}
    return [_shifted(dict(one), offsets.get(one.get("joint"), 0.0)) for one in hidden]


def _shifted(one: dict[str, Any], offset: float) -> dict[str, Any]:
    if not offset:
        return one
    if one["effect"] == "joint_spring":
        return one | {"q0": one["q0"] + offset}
    if one["effect"] in ("cogging_torque", "torque_ripple", "transmission_error"):
        angle = 2 * np.pi * offset / one["period"]
    elif one["effect"] == "position_dependent_friction":
        angle = one.get("harmonic", 1.0) * offset
    else:
        return one
    turned = complex(one["a"], one["b"]) * np.exp(1j * angle)
    return one | {"a": turned.real, "b": turned.imag}
