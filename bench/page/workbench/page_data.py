"""The data of the workbench: equations of the fitted and of the held-out rows, and a sample of the recordings."""

import base64
from collections.abc import Collection, Mapping
from dataclasses import replace
from typing import Any

import numpy as np

from bench.basics.joint_units import drive_unit
from bench.basics.plain_data import finite
from bench.basics.progress import SILENT
from bench.basics.threads import on_one_thread
from bench.diagnosis.base_model import BaseModel
from bench.diagnosis.candidates import Proposal, propose
from bench.diagnosis.reason_words import reason_sentence
from bench.diagnosis.result import Diagnosis
from bench.diagnosis.round import Round, reshaped_proposals
from bench.diagnosis.rounds import system_about
from bench.diagnosis.search import Selection, score_set
from bench.effects import Effect, EffectInstance
from bench.effects.display_names import spoken
from bench.identification.perturbations import Nearby
from bench.identification.prepare import with_effects
from bench.identification.problem import Problem
from bench.page.workbench.system import DiagnosedModel, PageSystem, build, diagnosed_model

MOST_BYTES = 1_400_000  # of all triangular factors together
NUMBER = 4  # bytes
BYTES = 560_000  # of all quantised columns together, at two bytes per value
FEWEST, MOST = 60, 500  # rows of a recording
STEPS = 32767  # of a quantised column on either side of zero
VERSION = 2


def instances_of(
    model: DiagnosedModel, effects: Mapping[str, Effect], nearby: Nearby
) -> tuple[EffectInstance, ...]:
    """Instances of these effects wherever the recordings show them, shaped as a diagnosis about `model` judges them.

    In the order of `effects`; an effect that the model absorbs everywhere has no instance. nearby: of `model`.
    """
    base_model = BaseModel(model.plain, nearby)
    proposals = propose(base_model.context(with_effects(model.complete, model.plain.effects)), effects)
    if model.effects:
        proposals = _about_the_model(base_model, model, proposals)
    instances = [instance for each in proposals if not each.absorbed for instance in each.instances]
    names = list(effects)
    return tuple(sorted(instances, key=lambda instance: names.index(instance.name)))


def _about_the_model(
    base_model: BaseModel, model: DiagnosedModel, proposals: list[Proposal]
) -> list[Proposal]:
    """The proposals after the last round of a search, the one that identified the effects of `model`."""
    present = {instance.seat for instance in model.effects}
    some = []
    for proposal in proposals:
        kept = tuple(each for each in proposal.instances if (proposal.name, each.joint) not in present)
        if kept:
            some.append(replace(proposal, instances=kept))
    names = dict.fromkeys(instance.name for instance in model.effects)
    groups = [tuple(instance for instance in model.effects if instance.name == name) for name in names]
    every = [*(Proposal(each[0].effect.name, each, False, "") for each in groups), *some]
    system = system_about(base_model, model.complete, every)
    best = score_set(system, range(len(groups)))
    return reshaped_proposals(base_model, Round(model.complete, every, system, Selection(best, {})), SILENT)


def without_room(system: PageSystem, ranks: Mapping[str, int]) -> frozenset[str]:
    """The effects to omit so that the equations of all motors take at most `MOST_BYTES`.

    The lowest in rank are omitted first; identified effects, whose rank is negative, are kept.
    """
    names = sorted({instance.name for instance in system.effects}, key=lambda name: ranks[name])
    dropped: list[str] = []
    while names and ranks[names[-1]] >= 0 and _numbers(system, dropped) * NUMBER > MOST_BYTES:
        dropped.append(names.pop())
    return frozenset(dropped)


def carried_columns(system: PageSystem, without: Collection[str]) -> np.ndarray:
    """Which columns the page has for each motor (n, C): those that are not zero there, except effects in `without`."""
    kept = np.asarray(system.columns.any(axis=0))
    for start, stop, instance in zip(system.starts, system.starts[1:], system.effects, strict=False):
        if instance.name in without:
            kept[:, start:stop] = False
    return kept


def _numbers(system: PageSystem, without: Collection[str]) -> int:
    """The size of all motors' triangular factors: of fitted rows, and of held-out ones if there are any."""
    uses = 1 if system.fitted.all() else 2
    counts = carried_columns(system, without).sum(axis=1) + 2
    return uses * int((counts * (counts + 1) // 2).sum())


def thinned(model: DiagnosedModel, system: PageSystem, kept: np.ndarray) -> list[dict[str, Any]]:
    """Every recording at evenly spaced rows of the fit. kept (n, C): which columns each motor has.

    The measured current also has its smallest and largest value in the block of rows around each of these rows.
    """
    used = [np.flatnonzero(entry) for entry in kept]
    lengths = [len(observation.time) for observation in model.plain.observations]
    wanted = BYTES / (2 * sum(len(values) for values in used) * len(lengths))
    step = max(1, int(np.ceil(max(lengths) / min(max(wanted, FEWEST), MOST))))
    samples, start = [], 0
    for log in model.plain.observations:
        count = len(log.time)
        rows, edges = start + np.arange(step // 2, count, step), np.arange(0, count, step)
        motors = []
        for j, columns in enumerate(used):
            measured, modelled = log.current[:, j], (system.measured - system.error)[rows, j]
            moving = system.moving[rows, j]
            motors.append(
                {
                    "columns": columns.tolist(),
                    **quantised(system.columns[rows][:, j, columns]),
                    "modelled": floats(np.where(moving, modelled, np.nan)),
                    "measured": floats(measured[rows - start]),
                    "low": floats(np.minimum.reduceat(measured, edges)[: len(rows)]),
                    "high": floats(np.maximum.reduceat(measured, edges)[: len(rows)]),
                }
            )
        about = {"name": log.name, "use": log.use, "payload": log.payload_name, "rows": count, "step": step}
        samples.append({**about, "time": floats(log.time[rows - start]), "motors": motors})
        start += count
    return samples


def floats(values: np.ndarray) -> str:
    """Single-precision numbers in C order, as base64."""
    return _text(values, "<f4")


def doubles(values: np.ndarray) -> str:
    """Double-precision numbers in C order, as base64."""
    return _text(values, "<f8")


def triangle(factor: np.ndarray) -> str:
    """The upper triangle of a factor (c, c), row by row, in single precision, as base64."""
    return floats(factor[np.triu_indices(len(factor))])


def quantised(columns: np.ndarray) -> dict[str, str]:
    """Columns (T, c) as 16-bit integers, column by column, and their steps, 1 / STEPS of each column's largest size."""
    steps = np.abs(columns).max(axis=0, initial=0.0) / STEPS
    counts = np.rint(columns / np.where(steps > 0.0, steps, 1.0))
    return {"counts": _text(counts.T, "<i2"), "steps": floats(steps)}


def _text(values: np.ndarray, kind: str) -> str:
    return base64.b64encode(np.ascontiguousarray(values, dtype=kind).tobytes()).decode("ascii")


@on_one_thread
def page_data(problem: Problem, diagnosis: Diagnosis) -> dict[str, Any]:
    """The data with which the page solves for any choice of effects in the identified shapes, ready for JSON.

    diagnosis: of this problem; its filters are used. Arrays are base64 of little-endian numbers; `triangle` is the
    upper triangle of the factor R of [columns, modelled, error], row by row. basis: see `PageSystem`. held_out: the
    share of every recording that is held out, zero if whole recordings are.
    """
    known = problem.catalogue
    model = diagnosed_model(problem, diagnosis)
    nearby = model.nearby()
    instances = instances_of(model, _usable(model, diagnosis, known), nearby)
    system = build(model, instances, nearby)
    without = without_room(system, _ranks(model, diagnosis))
    robot = model.plain.dataset.robot
    kept = carried_columns(system, without)
    listed = {instance.name for instance in system.effects}
    listed |= {verdict.effect for verdict in diagnosis.ranking if verdict.effect in known}
    return {
        "version": VERSION,
        "robot": robot.name,
        "held_out": diagnosis.held_out,
        "fits_gains": model.plain.fit_gains,
        "noise_floor": diagnosis.unexplained.noise_floor,
        "motors": [_motor(model, system, kept, j) for j in range(len(robot.actuators))],
        "rows": int(system.fitted.sum()),
        "own": system.starts[0],
        "columns": system.columns.shape[2],
        "parameters": _parameters(model, diagnosis),
        "reference": doubles(system.reference),
        "basis": _basis(system.basis),
        "effects": [_effect(model, system, diagnosis, without, name) for name in known if name in listed],
        "found": [[instance.name, instance.joint] for instance in model.effects],
        "started": [list(pair) for pair in model.started],
        "deviations": _deviations(model, diagnosis),
        "recordings": thinned(model, system, kept),
    }


def with_command(data: dict[str, Any], command: str, model: dict[str, Any] | None = None) -> dict[str, Any]:
    """The page's data with the command that identifies the model without the selected effects, and the identified model
    in the form of its file, for download.
    """
    return {**data, "command": command, "model": finite(model)}


def _usable(model: DiagnosedModel, diagnosis: Diagnosis, known: Mapping[str, Effect]) -> dict[str, Effect]:
    """Effects that can be selected: identified, or judged and not absorbed; not those with a value per recording."""
    shown = {verdict.effect for verdict in diagnosis.ranking if verdict.verdict != "absorbed"}
    shown |= {instance.name for instance in model.effects}
    shown -= {instance.name for instance in model.plain.effects}  # their columns belong to the model
    return {name: effect for name, effect in known.items() if name in shown}


def _ranks(model: DiagnosedModel, diagnosis: Diagnosis) -> dict[str, int]:
    """Priority of each effect, by its place in the ranking; -1 for identified ones."""
    ranks = {verdict.effect: i for i, verdict in enumerate(diagnosis.ranking)}
    return ranks | {instance.name: -1 for instance in model.effects}


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
        {"name": f"{name} of {spoken(instance.name)} at {instance.place}", "unit": value.unit}
        for instance in model.plain.effects
        for name, value in after.effect_parameters[instance.name][instance.place].items()
    ]
    return rigid + effects


def _deviations(model: DiagnosedModel, diagnosis: Diagnosis) -> list[dict[str, Any]]:
    """Standard errors of the gains of the diagnosis's models, after and before, with the effects of each."""
    both = (
        (diagnosis.after, [instance.seat for instance in model.effects]),
        (diagnosis.before, model.started),
    )
    return [
        {
            "effects": [list(effect) for effect in effects],
            "gains": finite([result.drive_gains[joint].std for joint in result.joints]),
        }
        for result, effects in both
    ]


def _effect(
    model: DiagnosedModel, system: PageSystem, diagnosis: Diagnosis, without: Collection[str], name: str
) -> dict[str, Any]:
    ranks = [effect_verdict.effect for effect_verdict in diagnosis.ranking]
    verdict = diagnosis.ranking[ranks.index(name)] if name in ranks else None
    places = [(i, instance) for i, instance in enumerate(system.effects) if instance.name == name]
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
    slides = {joint.name for joint in model.plain.model.geometry.joints if joint.kind == "slide"}
    turning = instance.joint not in slides
    drive = drive_unit(robot.actuators[joint].gain_unit) if joint >= 0 else "A"
    shape = effect.shape_values()
    return {
        "place": instance.joint,
        "start": system.starts[i],
        "stop": system.starts[i + 1],
        "curved": bool(effect.shape or effect.depends_on_model or effect.about_values()),
        "parameters": [
            {"name": entry.name, "unit": entry.unit_at(turning, drive)} for entry in effect.parameters
        ],
        "shape": [
            {"name": entry.name, "unit": entry.unit_at(turning, drive), "value": float(shape[entry.name])}
            for entry in effect.shape
        ],
    }
