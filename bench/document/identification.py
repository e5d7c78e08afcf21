"""Tables of an identification."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from bench.document.numbers import (
    USES,
    Truth,
    deviations_away,
    effect_key,
    flat_effects,
    gain_change,
    is_poor,
    off_by,
    other_terms,
)
from bench.document.table import Column, Mark, Table
from bench.identification.result import (
    CurrentSeries,
    ErrorSummary,
    Identification,
    ModelledRecording,
    Quantity,
    relative_error,
)


def gains_table(result: Identification, truth: Truth | None = None) -> Table:
    """Drive gains with standard errors and, if they were fitted, nominal values and the change from these."""
    joints, gains = list(result.drive_gains), list(result.drive_gains.values())
    against_nominal = (
        Column("nominal", [gain.nominal for gain in gains], "number"),
        Column("change", [gain_change(gain) if gain.determined else "" for gain in gains], "change"),
    )
    return Table(
        (
            Column("joint", joints),
            *_quantities(gains),
            *(against_nominal if result.gains_fitted else ()),
            *_truth(gains, joints, truth),
        )
    )


def parameters_table(
    result: Identification,
    truth: Truth | None = None,
    before: Identification | None = None,
    *,
    full: bool = False,
) -> Table:
    """Base and payload parameters with the other terms of their grouping or, if `full`, the whole grouping.

    before: another model, whose values are shown for comparison.
    """
    parameters = list(result.parameters)
    names = [parameter.name for parameter in parameters]
    columns = [Column("parameter", names), *_quantities(parameters), *_truth(parameters, names, truth)]
    if before is not None:
        old = {parameter.name: parameter for parameter in before.parameters}
        columns.append(Column("model as it is", [old.get(name) for name in names], "quantity"))
    others = [other_terms(parameter.name, parameter.grouping) for parameter in parameters]
    whole = Column("stands for", [parameter.grouping for parameter in parameters])
    columns.append(whole if full else Column("together with", others, "terms"))
    return Table(tuple(columns), tuple("poor" if is_poor(parameter) else "" for parameter in parameters))


def effects_table(result: Identification, truth: Truth | None = None) -> Table:
    """Parameters of the effects, by effect and place."""
    entries = flat_effects(result)
    quantities = [quantity for *_, quantity in entries]
    effects = [effect for effect, *_ in entries]
    keys = [effect_key(effect, joint, name) for effect, joint, name, _ in entries]
    return Table(
        (
            Column("effect", effects, "effect"),
            Column("at", [joint for _, joint, _, _ in entries]),
            Column("parameter", [name for _, _, name, _ in entries]),
            *_quantities(quantities),
            *_truth(quantities, keys, truth),
        ),
        tuple("poor" if is_poor(quantity) else "" for quantity in quantities),
    )


def errors_table(
    series: Sequence[CurrentSeries], joints: Sequence[str], noise: tuple[Sequence[float], float] | None = None
) -> Table:
    """Length of every recording, and its errors of the modelled current by motor, with totals of the fitted and the
    others.

    noise: relative, by motor and of all motors together.
    """
    groups: list[tuple[str, str, str, list[CurrentSeries]]] = []
    ends = []
    for use in (use for use in USES if any(trace.use == use for trace in series)):
        chosen = [trace for trace in series if trace.use == use]
        groups += [(entry.name, USES[use], entry.payload or "–", [entry]) for entry in chosen]
        if len(chosen) > 1:
            groups.append((f"all {USES[use]}", "", "", chosen))
        ends.append(len(groups) - 1)
    many, last = len(joints) > 1, noise is not None
    by_motor, of_all = noise or ((), 0.0)
    blank = [""] * last
    lengths = [sum(float(np.ptp(trace.time)) for trace in chosen) for *_, chosen in groups]
    rows = [sum(len(trace.time) for trace in chosen) for *_, chosen in groups]
    columns = [
        Column("recording", [name for name, *_ in groups] + ["noise of the currents"] * last),
        Column("use", [use for _, use, *_ in groups] + blank),
        Column("payload", [payload for _, _, payload, _ in groups] + blank),
        Column("length", [*lengths, *blank], "number", 2, ".3g", "s"),
        Column("rows", [*rows, *blank], "number", 3, "d"),
    ]
    for j, joint in enumerate(joints if many else ()):
        errors = [relative_error(chosen, j) for *_, chosen in groups]
        columns.append(Column(joint, [*errors, *by_motor[j : j + 1]], "share", 1))
    errors = [relative_error(chosen) for *_, chosen in groups] + [of_all] * last
    columns.append(Column("all" if many else "error", errors, "share"))
    marks: list[Mark] = ["strong" if len(chosen) > 1 else "" for *_, chosen in groups]
    marks += ["weak"] * last
    return Table(tuple(columns), tuple(marks), tuple(ends if last else ends[:-1]))


def kept_errors_table(error: ErrorSummary, recordings: Sequence[ModelledRecording]) -> Table:
    """Errors of a saved model in its recordings, and totals by use, as its file has them."""
    rows: list[tuple[str, str, str, float | None, Mark]] = []
    for use, total in (("identify", error.identify), ("validate", error.validate)):
        chosen = [recording for recording in recordings if recording.use == use]
        rows += [
            (entry.name, USES[use], entry.payload or "–", error.by_recording.get(entry.name), "")
            for entry in chosen
        ]
        if len(chosen) > 1:
            rows.append((f"all {USES[use]}", "", "", total, "strong"))
    heads = ("recording", "use", "payload")
    columns = [Column(head, [row[k] for row in rows]) for k, head in enumerate(heads)]
    errors = Column("error", [error for *_, error, _ in rows], "share")
    return Table((*columns, errors), tuple(mark for *_, mark in rows))


def motor_errors_table(series: Sequence[CurrentSeries], joints: Sequence[str]) -> Table:
    """Errors of the modelled current by motor, fitted and not fitted."""
    columns = [Column("joint", list(joints))]
    for use, name in USES.items():
        if chosen := [trace for trace in series if trace.use == use]:
            columns.append(Column(name, [relative_error(chosen, j) for j in range(len(joints))], "share"))
    return Table(tuple(columns))


def _quantities(quantities: Sequence[Quantity]) -> list[Column]:
    unit = Column("unit", [quantity.unit for quantity in quantities], "unit")
    if all(quantity.std == 0.0 for quantity in quantities):
        return [Column("value", [quantity.value for quantity in quantities], "number"), unit]
    deviations = Column("rel. std", quantities, "deviation", rank=1)
    return [Column("value ± std", quantities, "quantity"), deviations, unit]


def _truth(quantities: Sequence[Quantity], keys: Sequence[str], truth: Truth | None) -> list[Column]:
    """Columns of the true values and the deviations of the estimates from them; none if no truth is known."""
    known = [None if truth is None else truth.get(key) for key in keys]
    if all(value is None for value in known):
        return []
    pairs = list(zip(quantities, known, strict=True))
    return [
        Column("truth", ["" if t is None else replace(value, value=t) for value, t in pairs], "true"),
        Column("off by", ["" if t is None else off_by(value, t) for value, t in pairs], "change"),
        Column("in std", ["" if t is None else deviations_away(value, t) for value, t in pairs], "sigma"),
    ]
