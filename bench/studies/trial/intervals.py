"""Estimated parameters of hidden effects compared with the truth."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import MISSING, fields
from typing import Any

import numpy as np

from bench.effects import CATALOGUE
from bench.identification.result import Identification
from bench.identification.summary import ROBOT
from bench.studies.trial.realise import Entry, hidden_places
from bench.studies.trial.setup import Setup, where
from bench.truth.hidden import HIDDEN_EFFECTS
from bench.truth.hidden.base import rms
from bench.truth.simulate import Simulation

True_ = Mapping[str, float]
Conversion = Callable[[True_], float]


OTHERWISE: Mapping[str, Mapping[str, Conversion]] = {
    "backlash": {"b": lambda p: p["play"]},
    "base_tilt": {"tilt_x": lambda p: p["about_x"], "tilt_y": lambda p: p["about_y"]},
    "cogging_torque": {"periods": lambda p: 2 * np.pi / p["period"]},  # per turn of a hinge
    "drive_flexibility": {
        "C": lambda p: 1 / p["stiffness"],
        "CIa": lambda p: (p["rotor_inertia"] or np.nan) / p["stiffness"],
    },
    "geometric_error": {"dl": lambda p: p["error"]},
    "hysteretic_cable": {"x0": lambda p: p["reach"], "n": lambda p: p["sharpness"]},
    "joint_spring": {"kq0": lambda p: p["k"] * p["q0"]},
    "payload_mass_error": {"dm": lambda p: p["error"]},
    "platform_force": {
        "Fx": lambda p: p["fx"],
        "Fy": lambda p: p["fy"],
        "Fz": lambda p: p["fz"],
        "kx": lambda p: p["k"],
        "ky": lambda p: p["k"],
        "kz": lambda p: p["k"],
    },
    "presliding_hysteresis": {"x0": lambda p: p["Fc"] / p["stiffness"]},
    "torque_ripple": {"periods": lambda p: 2 * np.pi / p["period"]},
    "transmission_error": {"periods": lambda p: 2 * np.pi / p["period"]},
}
"""Effect -> parameter of the model -> its true value from the parameters of the hidden effect, if name or value
differ.

SI units on both sides; nan if the entry does not contain the value, such as the inertia of a rotor that is the
joint's armature in the MJCF. Periods are for hinges; for slides they are per metre, without 2 pi, see `true_values`.
"""

SAME = 0.03  # of the RMS speed: joints whose rates differ by less move alike, even if a length is wrong


def true_values(effect: str, hidden: True_, *, slide: bool = False) -> dict[str, float]:
    """The true values of a model's parameters of an effect; empty for an effect that no model contains."""
    if effect not in CATALOGUE or effect not in HIDDEN_EFFECTS:
        return {}
    parameters = {
        field.name: field.default for field in fields(HIDDEN_EFFECTS[effect]) if field.default is not MISSING
    } | {**hidden}
    known = CATALOGUE[effect]
    names = [*(parameter.name for parameter in known.parameters), *(shape.name for shape in known.shape)]
    values = {name: float(parameters[name]) for name in names if name in parameters}
    values |= {name: float(rule(parameters)) for name, rule in OTHERWISE.get(effect, {}).items()}
    if slide and "periods" in values:
        values["periods"] /= 2 * np.pi
    return {name: value for name, value in values.items() if np.isfinite(value)}


def as_logged(hidden: Sequence[Mapping[str, Any]]) -> list[dict[str, Any]]:
    """Hidden effects in terms of the logged positions, which a hidden encoder offset shifts.

    With the logged position p = q + offset, a cos(w q) + b sin(w q) and k (q - q0) have different a, b and q0.
    """
    offsets = {entry.get("joint"): entry["offset"] for entry in hidden if entry["effect"] == "encoder_offset"}
    return [_shifted(dict(entry), offsets.get(entry.get("joint"), 0.0)) for entry in hidden]


def _shifted(entry: dict[str, Any], offset: float) -> dict[str, Any]:
    if not offset:
        return entry
    if entry["effect"] == "joint_spring":
        return entry | {"q0": entry["q0"] + offset}
    if entry["effect"] in ("cogging_torque", "torque_ripple", "transmission_error"):
        angle = 2 * np.pi * offset / entry["period"]
    elif entry["effect"] == "position_dependent_friction":
        angle = entry.get("harmonic", 1.0) * offset
    else:
        return entry
    turned = complex(entry["a"], entry["b"]) * np.exp(1j * angle)
    return entry | {"a": turned.real, "b": turned.imag}


def moving_alike(simulation: Simulation, joints: Sequence[str]) -> dict[str, str]:
    """For each joint the first joint that moves like it or opposite to it, such as the rods of a parallelogram; else
    itself.

    The motors see only the sum of the friction in such joints.
    """
    model = simulation.machine.models[None]
    every = np.concatenate([recording.motion.qvel for recording in simulation.recordings])
    rates = {joint: every[:, int(model.joint(joint).dofadr[0])] for joint in joints}

    def alike(a: str, b: str) -> bool:
        nearer = min(rms(rates[a] - rates[b]), rms(rates[a] + rates[b]))
        return a == b or nearer <= SAME * rms(rates[b])

    return {joint: next(first for first in joints if alike(first, joint)) for joint in joints}


def intervals(
    setup: Setup, hidden: Sequence[Entry], result: Identification, alike: Mapping[str, str]
) -> list[Mapping[str, Any]]:
    """Estimate, standard error and truth of the parameters of hidden effects that the model contains.

    alike: see `moving_alike`; the true values of passive joints that move alike are summed.
    """
    true: dict[tuple[str, str, str], float] = {}
    for effect, place, entry in hidden_places(setup, as_logged(hidden)):
        numbers = {name: value for name, value in entry.items() if name != "effect"}
        for name, value in true_values(effect, numbers, slide=place in setup.slides).items():
            key = (effect, alike.get(place, place) if where(effect) == "passive" else place, name)
            true[key] = true.get(key, 0.0) + value if where(effect) == "passive" else value
    rows: list[Mapping[str, Any]] = []
    for effect in dict.fromkeys(effect for effect, _, _ in true):
        for place, values in result.effect_parameters.get(effect, {}).items():
            at = "" if place == ROBOT else place
            for name, quantity in values.items():
                truth = true.get((effect, alike.get(at, at) if where(effect) == "passive" else at, name))
                if truth is not None and 0 < quantity.std < np.inf:
                    rows.append(
                        {"effect": effect, "at": at, "parameter": name}
                        | {"truth": truth, "value": quantity.value, "std": quantity.std}
                    )
    return rows
