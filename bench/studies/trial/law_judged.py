"""Discovered laws held against the one that was hidden."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path

import numpy as np

from bench.diagnosis.result import Diagnosis, Discovered
from bench.effects import EffectInstance
from bench.effects.user_file import effects_in
from bench.identification.effect_rows import effect_rows
from bench.identification.prepare import Prepared
from bench.signals.decimation import decimate
from bench.studies.sweep.journal import Row
from bench.studies.trial.unknown import LAW
from bench.truth.hidden.product_law import unit_torque
from bench.truth.simulate import Simulation

VARIABLES = {
    "direction": "velocity",
    "v": "velocity",
    "a": "acceleration",
    "tau": "load",
    "others": "load of others",
    "q": "position",
    "wave": "position",
    "T": "time",
}
"""What a hidden law goes by, by its numbers that are not zero."""


def law_columns(simulation: Simulation, diagnosis: Diagnosis, prepared: Prepared) -> Row:
    """How near a discovered law is to the hidden one: in torque, on recordings not fitted, and in structure.

    law.error: RMS of the difference over the RMS of the hidden law's torque, at its motor, where that moves.
    law.elsewhere: laws at motors that have none.
    """
    hidden = next(one for one in simulation.scenario.settings.hidden if one.effect == LAW)
    numbers = {name: float(value) for name, value in hidden.parameters.items()}
    joint = str(hidden.joint)
    here = [one for one in diagnosis.discovered if one.place == joint]
    row: Row = {
        "law": json.dumps(numbers),
        "law.found": " | ".join(f"{one.place}: {one.formula}" for one in diagnosis.discovered),
        "law.elsewhere": sum(one.place != joint for one in diagnosis.discovered),
        "law.error": 1.0,
        "law.structure": False,
    }
    if here:
        row["law.error"] = _torque_error(simulation, diagnosis, prepared, numbers, joint, here[0])
        row["law.structure"] = _alike(numbers, here[0])
    return row


def _torque_error(
    simulation: Simulation,
    diagnosis: Diagnosis,
    prepared: Prepared,
    numbers: Mapping[str, float],
    joint: str,
    found: Discovered,
) -> float:
    motor = simulation.robot.joints.index(joint)
    effect = effects_in(found.source, Path(f"{found.law}.py"))[found.law]
    values = diagnosis.after.effect_parameters[found.law][joint]
    shape = {one.name: values[one.name].value for one in effect.shape}
    instance = EffectInstance(replace(effect, **shape), joint, found.law)
    linear = np.array([values[one.name].value for one in effect.parameters])
    difference = squares = 0.0
    for signals, seen, rows in zip(prepared.signals, prepared.measured, prepared.observations, strict=True):
        if rows.use != "validate":
            continue
        ours = (effect_rows(signals, prepared.settings.decimation, [instance]) @ linear)[:, motor]
        truth, time = _true_torque(numbers, simulation, rows.name, motor)
        whole = np.interp(seen.time, time, truth)
        wanted = decimate(whole[:, None], prepared.settings.decimation)[:, 0]
        moving = rows.moving[:, motor]
        difference += float(((ours - wanted)[moving] ** 2).sum())
        squares += float((wanted[moving] ** 2).sum())
    return float(np.sqrt(difference / squares)) if squares else float("nan")


def _true_torque(
    numbers: Mapping[str, float], simulation: Simulation, name: str, motor: int
) -> tuple[np.ndarray, np.ndarray]:
    """Of the hidden law along the true motion of a recording (N,), and when (N,) s."""
    motion = next(one.motion for one in simulation.recordings if one.name == Path(name).stem)
    machine = simulation.machine
    torque = motion.torque[:, motor]
    dof = machine.dofs[motor]
    unit = unit_torque(
        numbers,
        motion.qpos[:, machine.addresses[motor]],
        motion.qvel[:, dof],
        motion.qacc[:, dof],
        torque,
        motion.torque.sum(axis=1) - torque,
        motion.time,
    )
    return numbers["c"] * unit, motion.time


def _alike(numbers: Mapping[str, float], found: Discovered) -> bool:
    """Whether the found law goes by the same variables, and opposes the motion if the hidden one does."""
    wanted = {variable for name, variable in VARIABLES.items() if numbers.get(name)}
    looks = [each for one in found.terms for each in one.looks_at]
    seen = {f"{one.what} of others" if one.motor else one.what for one in looks}
    odd = any(
        each.what == "velocity" and not each.motor and each.role in ("direction", "signed", "memory")
        for each in looks
    )
    return seen == wanted and odd == bool(numbers.get("direction"))
