"""What the workbench's page carries: equations of the fitted and of the judged recordings, and a thinned sample."""

from collections.abc import Mapping
from typing import Any

import numpy as np

from bench.basics.threads import on_one_thread
from bench.dataset.dataset import Dataset
from bench.diagnosis.result import Diagnosis
from bench.effects import catalogue_for
from bench.effects.display_names import spoken
from bench.effects.effect import Effect
from bench.workbench.encode import doubles, floats, short_triangle, triangle
from bench.workbench.found_model import FoundModel, found_models
from bench.workbench.reduce import Reduced
from bench.workbench.sample import thinned
from bench.workbench.system import System, build, coordinates_of
from bench.workbench.variants import shape_order

VERSION = 1


@on_one_thread
def page_data(
    dataset: Dataset, diagnosis: Diagnosis, catalogue: Mapping[str, Effect] | None = None
) -> dict[str, Any]:
    """Everything with which the page solves for any choice of effects, ready for JSON.

    diagnosis: of this dataset; its filters are used. catalogue: the effects by name, by default the built-in ones
    and the dataset's own. Arrays are base64 of little-endian numbers; `triangle` holds the upper triangle of the
    factor R of [columns, modelled, error], row after row, or see `short_triangle`. basis: where the columns are
    combined, how the model's parameters follow from those that stand for its own, and from others. whole: the same of
    all rows, fitted as `bench identify` does it, where a part of every recording is kept apart to judge on; None where
    recordings are. The rest then only judges.
    """
    known = dict(catalogue_for(dataset.effect_files) if catalogue is None else catalogue)
    model, whole = found_models(dataset, diagnosis, known)
    if whole is None:
        return _carried(model, diagnosis, known) | {"whole": None}
    judging = _carried(model, diagnosis, known, triangles=3, drawn=False)
    return judging | {"whole": _carried(whole, diagnosis, known, triangles=3)}


def _carried(
    model: FoundModel,
    diagnosis: Diagnosis,
    known: Mapping[str, Effect],
    *,
    triangles: int = 2,
    drawn: bool = True,
) -> dict[str, Any]:
    """One model's equations, and, where its curves are drawn, a sample of the recordings.

    triangles: how many the page carries of each motor.
    """
    verdicts = {one.effect: one for one in diagnosis.ranking}
    own = {one.effect.name for one in model.plain.effects}  # columns of the model, as the rigid bodies' are
    usable = [
        effect
        for name, effect in known.items()
        if name not in own
        and (
            name in {one.effect.name for one in model.effects}
            or (name in verdicts and verdicts[name].verdict != "absorbed")
        )
    ]
    system = build(model, usable, triangles)
    robot = model.plain.dataset.robot
    return {
        "version": VERSION,
        "robot": robot.name,
        "judged_on": model.judged_on,
        "fits_gains": model.fit_gains,
        "noise_floor": diagnosis.unexplained.noise_floor,
        "motors": [_motor(model, system, j) for j in range(len(robot.actuators))],
        "rows": int(system.fitted.sum()),
        "own": system.starts[0],
        "columns": system.columns.shape[2],
        "parameters": _parameters(model, diagnosis),
        "reference": doubles(system.reference),
        "basis": None if system.basis is None else _basis(system.basis),
        "effects": [
            _effect(model, system, diagnosis, name)
            for name in known
            if name in verdicts or known[name] in usable
        ],
        "found": [[one.effect.name, one.joint] for one in model.effects],
        "started": [list(one) for one in model.started],
        "recordings": thinned(model, system) if drawn else [],
    }


def _motor(model: FoundModel, system: System, j: int) -> dict[str, Any]:
    actuator = model.plain.dataset.robot.actuators[j]
    columns = np.flatnonzero(system.columns[:, j].any(axis=0))
    rows = np.column_stack((system.columns[:, j, columns], system.modelled[:, j], system.error[:, j]))
    measured = system.modelled[:, j] + system.error[:, j]
    found: dict[str, Any] = {
        "joint": actuator.joint,
        "nominal": actuator.gain,
        "unit": actuator.gain_unit,
        "gain": float(system.gains[j]),
        "columns": columns.tolist(),
    }
    for use, chosen in (("fitted", system.fitted), ("judged", ~system.fitted)):
        packed = None
        if chosen.any():
            factor = np.zeros((rows.shape[1], rows.shape[1]))
            upper = np.linalg.qr(rows[chosen], mode="r")
            factor[: len(upper)] = upper
            packed = triangle(factor) if system.basis is None else short_triangle(factor)
        found[use] = {
            "triangle": packed,
            "squares": float((measured[chosen] ** 2).sum()),
            "moving": int(system.moving[chosen, j].sum()),
        }
    return found


def _basis(basis: np.ndarray) -> dict[str, Any]:
    own = len(basis)
    others = own + np.flatnonzero(basis[:, own:].any(axis=0))
    return {"own": doubles(basis[:, :own]), "columns": others.tolist(), "others": floats(basis[:, others].T)}


def _parameters(model: FoundModel, diagnosis: Diagnosis) -> list[dict[str, str]]:
    after = diagnosis.after
    rigid = [{"name": one.name, "unit": one.unit} for one in after.parameters]
    effects = [
        {"name": f"{name} of {spoken(one.effect.name)} at {one.place}", "unit": value.unit}
        for one in model.plain.effects
        for name, value in after.effect_parameters[one.effect.name][one.place].items()
    ]
    return rigid + effects


def _effect(model: FoundModel, system: System, diagnosis: Diagnosis, name: str) -> dict[str, Any]:
    ranks = [one.effect for one in diagnosis.ranking]
    verdict = diagnosis.ranking[ranks.index(name)] if name in ranks else None
    parts = [(i, part) for i, part in enumerate(system.effects) if part.variants.instance.effect.name == name]
    return {
        "name": name,
        "rank": ranks.index(name) if name in ranks else -1,
        "verdict": None if verdict is None else verdict.verdict,
        "why": "" if verdict is None else verdict.why,
        "places": [_place(model, system, i, part) for i, part in parts],
    }


def _follows(system: System, part: Reduced) -> dict[str, Any] | None:
    """How the columns move with the present model: coordinates (m, c) by so many of the page's columns."""
    coordinates = coordinates_of(system, part)
    if coordinates is None:
        return None
    columns = np.flatnonzero(coordinates.any(axis=0))
    return {
        "count": len(coordinates),
        "columns": columns.tolist(),
        "coordinates": floats(coordinates[:, columns]),
    }


def _place(model: FoundModel, system: System, i: int, part: Reduced) -> dict[str, Any]:
    variants = part.variants
    instance, effect = variants.instance, variants.instance.effect
    robot = model.plain.dataset.robot
    names = list(robot.joints)
    joint = names.index(instance.joint) if instance.joint in names else -1
    rotates = {one.name: one.kind != "slide" for one in model.plain.model.geometry.joints}
    turning = rotates.get(instance.joint, True)
    drive = robot.actuators[joint].gain_unit.partition("/")[2] if joint >= 0 else "A"
    shape = None
    if effect.shape:
        free, others = shape_order(effect)
        shape = {
            "name": free.name,
            "unit": free.unit_at(turning, drive),
            "value": float(getattr(effect, free.name)),
            "others": [{"name": one.name, "unit": one.unit_at(turning, drive)} for one in others],
            "branches": [list(one) for one in variants.branches],
        }
    return {
        "place": instance.joint,
        "motor": joint,
        "start": system.starts[i],
        "stop": system.starts[i + 1],
        "drawn": part.drawn,
        "kind": variants.kind,
        "scale": variants.scale,
        "follows": _follows(system, part),
        "table": floats(part.tables[0]) if variants.follows and not variants.pieces else None,
        "needed": variants.follows == "needed",
        "approximate": variants.approximate,
        "windows": variants.windows,
        "curved": bool(effect.shape or effect.depends_on_model),
        "parameters": [
            {"name": one.name, "unit": one.unit_at(turning, drive), "positive": one.positive}
            for one in effect.parameters
        ],
        "shape": shape,
        "brackets": [[list(one) for one in branch] for branch in variants.brackets],
        "pieces": [
            {
                "nodes": piece.nodes.tolist(),
                "logarithmic": piece.logarithmic,
                "branch": piece.branch,
                "table": floats(table),
            }
            for piece, table in zip(variants.pieces, part.tables, strict=bool(variants.pieces))
        ],
    }
