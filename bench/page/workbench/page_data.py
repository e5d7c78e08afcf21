"""What the workbench's page carries: equations of the fitted and of the judged recordings, and a thinned sample."""

from collections.abc import Collection, Mapping, Sequence
from typing import Any

import numpy as np

from bench.basics.joint_units import drive_unit
from bench.basics.plain_data import finite
from bench.basics.threads import on_one_thread
from bench.diagnosis.reason_words import reason_sentence
from bench.diagnosis.result import Diagnosis
from bench.effects import EffectInstance
from bench.effects.display_names import spoken
from bench.effects.effect import Effect
from bench.identification.problem import Problem
from bench.identification.result import Identification
from bench.page.workbench.diagnosed_model import DiagnosedModel, diagnosed_model
from bench.page.workbench.encode import doubles, floats, triangle
from bench.page.workbench.proposals import instances_of
from bench.page.workbench.room import carried_columns, without_room
from bench.page.workbench.sample import thinned
from bench.page.workbench.system import PageSystem, build

VERSION = 2


@on_one_thread
def page_data(problem: Problem, diagnosis: Diagnosis) -> dict[str, Any]:
    """Everything with which the page solves for any choice of effects in the identified shapes, ready for JSON.

    diagnosis: of this problem; its filters are used. Arrays are base64 of little-endian numbers; `triangle` holds
    the upper triangle of the factor R of [columns, modelled, error], row after row. basis: how the model's parameters
    follow from the coordinates by the columns. held_out: the share of every recording that is kept apart to judge on,
    zero where recordings are.
    """
    known = problem.catalogue
    model = diagnosed_model(problem, diagnosis)
    nearby = model.nearby()
    instances = instances_of(model, _usable(model, diagnosis, known), nearby)
    system = build(model, instances, nearby)
    without = without_room(system, _ranks(model, diagnosis))
    robot = model.plain.dataset.robot
    kept = carried_columns(system, without)
    listed = {instance.effect.name for instance in system.effects}
    listed |= {verdict.effect for verdict in diagnosis.ranking if verdict.effect in known}
    return {
        "version": VERSION,
        "robot": robot.name,
        "held_out": diagnosis.held_out,
        "fits_gains": model.fit_gains,
        "noise_floor": diagnosis.unexplained.noise_floor,
        "motors": [_motor(model, system, kept, j) for j in range(len(robot.actuators))],
        "rows": int(system.fitted.sum()),
        "own": system.starts[0],
        "columns": system.columns.shape[2],
        "parameters": _parameters(model, diagnosis),
        "reference": doubles(system.reference),
        "basis": _basis(system.basis),
        "effects": [_effect(model, system, diagnosis, without, name) for name in known if name in listed],
        "found": [[instance.effect.name, instance.joint] for instance in model.effects],
        "started": [list(pair) for pair in model.started],
        "deviations": _deviations(model, diagnosis),
        "recordings": thinned(model, system, kept),
    }


def with_command(data: dict[str, Any], command: str, model: dict[str, Any] | None = None) -> dict[str, Any]:
    """The page's data with the command that identifies without the effects that are ticked, and the model that was
    identified as its file holds it, to be downloaded.
    """
    return {**data, "command": command, "model": finite(model)}


def _usable(model: DiagnosedModel, diagnosis: Diagnosis, known: Mapping[str, Effect]) -> dict[str, Effect]:
    """What may be ticked: identified, or judged and not absorbed. The page changes nothing in what the model has."""
    given = {
        instance.effect.name for instance in model.plain.effects
    }  # columns of the model, as the rigid bodies' are
    fitted = {instance.effect.name for instance in model.effects}
    shown = {verdict.effect for verdict in diagnosis.ranking if verdict.verdict != "absorbed"}
    return {name: effect for name, effect in known.items() if name not in given and name in fitted | shown}


def _ranks(model: DiagnosedModel, diagnosis: Diagnosis) -> dict[str, int]:
    """How early an effect must have its place; those identified before all."""
    ranks = {verdict.effect: i for i, verdict in enumerate(diagnosis.ranking)}
    return ranks | {instance.effect.name: -1 for instance in model.effects}


def _motor(model: DiagnosedModel, system: PageSystem, kept: np.ndarray, j: int) -> dict[str, Any]:
    actuator = model.plain.dataset.robot.actuators[j]
    columns = np.flatnonzero(kept[j])
    rows = np.column_stack((system.columns[:, j, columns], system.modelled[:, j], system.error[:, j]))
    measured = system.measured[:, j]
    motor: dict[str, Any] = {
        "joint": actuator.joint,
        "nominal": actuator.gain,
        "unit": actuator.gain_unit,
        "gain": float(system.gains[j]),
        "held": not model.plain.gains.is_fitted[j],
        "columns": columns.tolist(),
    }
    for use, chosen in (("fitted", system.fitted), ("judged", ~system.fitted)):
        packed = ""
        if chosen.any():
            factor = np.zeros((rows.shape[1], rows.shape[1]))
            upper = np.linalg.qr(rows[chosen], mode="r")
            factor[: len(upper)] = upper
            packed = triangle(factor)
        motor[use] = {"triangle": packed, "squares": float((measured[chosen] ** 2).sum())}
    return motor


def _basis(basis: np.ndarray) -> dict[str, Any]:
    count = len(basis)
    others = count + np.flatnonzero(basis[:, count:].any(axis=0))
    return {
        "own": doubles(basis[:, :count]),
        "columns": others.tolist(),
        "others": floats(basis[:, others].T),
    }


def _parameters(model: DiagnosedModel, diagnosis: Diagnosis) -> list[dict[str, str]]:
    after = diagnosis.after
    rigid = [{"name": parameter.name, "unit": parameter.unit} for parameter in after.parameters]
    effects = [
        {"name": f"{name} of {spoken(instance.effect.name)} at {instance.place}", "unit": value.unit}
        for instance in model.plain.effects
        for name, value in after.effect_parameters[instance.effect.name][instance.place].items()
    ]
    return rigid + effects


def _deviations(model: DiagnosedModel, diagnosis: Diagnosis) -> list[dict[str, Any]]:
    """Standard deviations of the gains of the two models that the diagnosis fitted, with the effects that each has."""

    def of(result: Identification, effects: Sequence[tuple[str, str]]) -> dict[str, Any]:
        stds = [
            gain.std if np.isfinite(gain.std) else None
            for gain in (result.drive_gains[joint] for joint in result.joints)
        ]
        return {"effects": [list(effect) for effect in effects], "gains": stds}

    places = [(instance.effect.name, instance.joint) for instance in model.effects]
    return [of(diagnosis.after, places), of(diagnosis.before, model.started)]


def _effect(
    model: DiagnosedModel, system: PageSystem, diagnosis: Diagnosis, without: Collection[str], name: str
) -> dict[str, Any]:
    ranks = [effect_verdict.effect for effect_verdict in diagnosis.ranking]
    verdict = diagnosis.ranking[ranks.index(name)] if name in ranks else None
    places = [(i, instance) for i, instance in enumerate(system.effects) if instance.effect.name == name]
    return {
        "name": name,
        "rank": ranks.index(name) if name in ranks else -1,
        "verdict": None if verdict is None else verdict.verdict,
        "why": "" if verdict is None else reason_sentence(verdict),
        "no_room": name in without,
        "places": [] if name in without else [_place(model, system, i, instance) for i, instance in places],
    }


def _place(model: DiagnosedModel, system: PageSystem, i: int, instance: EffectInstance) -> dict[str, Any]:
    effect = instance.effect
    robot = model.plain.dataset.robot
    names = list(robot.joints)
    joint = names.index(instance.joint) if instance.joint in names else -1
    rotates = {
        geometry_joint.name: geometry_joint.kind != "slide"
        for geometry_joint in model.plain.model.geometry.joints
    }
    turning = rotates.get(instance.joint, True)
    drive = drive_unit(robot.actuators[joint].gain_unit) if joint >= 0 else "A"
    shape = effect.shape_values()
    return {
        "place": instance.joint,
        "start": system.starts[i],
        "stop": system.starts[i + 1],
        "curved": bool(effect.shape or effect.depends_on_model or effect.about_values()),
        "parameters": [
            {"name": parameter.name, "unit": parameter.unit_at(turning, drive)}
            for parameter in effect.parameters
        ],
        "shape": [
            {
                "name": parameter.name,
                "unit": parameter.unit_at(turning, drive),
                "value": float(shape[parameter.name]),
            }
            for parameter in effect.shape
        ],
    }
