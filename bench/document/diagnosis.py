"""What a diagnosis found, as tables."""

from collections.abc import Sequence
from itertools import pairwise

from bench.diagnosis.result import Diagnosis, EffectVerdict
from bench.diagnosis.summary import effort_unit, error_share, motor_torques
from bench.document.numbers import effect_name, gain_change
from bench.document.table import PLAIN, Column, Mark, Table
from bench.identification.result import Identification, Quantity

FEW = 4  # alternatives named in a cell
ROUNDING = 1e-6  # of an evidence in nats, of a share


def step_labels(steps: Sequence[Sequence[str]]) -> list[str]:
    """What each model adds to the one before, as in "the model as it is", "+ Coulomb friction".

    steps: the effects of every model, by name or as they are asked for, with a place.
    """
    labels = ["the model as it is"]
    for before, after in pairwise(steps):
        added = dict.fromkeys(effect_name(one.partition(":")[0]) for one in after if one not in before)
        labels.append(f"+ {', '.join(added)}")
    return labels


def ladder_table(diagnosis: Diagnosis) -> Table:
    """Errors fitted and not fitted after each added effect, down to the noise, with bars for the latter."""
    steps, floor = diagnosis.ladder, diagnosis.unexplained.noise_floor
    judged = [one.identify if one.validate is None else one.validate for one in steps]
    values = [*judged, floor]
    largest = max((value for value in values if value), default=1.0)
    return Table(
        (
            Column("model", [*step_labels([one.effects for one in steps]), "noise of the currents"]),
            Column("fitted", [*(one.identify for one in steps), ""], "share"),
            Column("not fitted", [*(one.validate for one in steps), floor], "share"),
            Column("", [(value or 0.0) / largest for value in values], "bar", 1),
        ),
        (*[PLAIN] * len(steps), "weak"),
        (len(steps) - 1,),
    )


def ranking_table(diagnosis: Diagnosis, shown: Sequence[EffectVerdict] | None = None) -> Table:
    """A row for each effect: verdict, evidence, errors without and with it, how large, where, alternatives.

    Columns with nothing in them are left out.
    """
    rows = diagnosis.ranking if shown is None else shown
    absorbed = [one.verdict == "absorbed" for one in rows]
    sized = [one if one.size else None for one in rows]
    columns = (
        Column("effect", [one.effect for one in rows], "effect"),
        Column("verdict", [one.verdict for one in rows], "verdict"),
        Column(
            "evidence", _unless(absorbed, [_not_rounding(one.evidence) for one in rows]), "number", 0, ".1f"
        ),
        Column("without", [one.error_before for one in rows], "share", 3),
        Column("with it", _unless(absorbed, [one.error_after for one in rows]), "share"),
        Column("size", ["" if one is None else size_words(diagnosis, one) for one in sized]),
        Column(
            "of squared error",
            ["" if one is None else _taken(one) for one in sized],
            "share",
            5,
        ),
        Column("at", [_places(diagnosis, one) for one in rows], rank=2),
        Column("could as well be", [_few(one.alternatives) for one in rows], rank=4),
    )
    marks: tuple[Mark, ...] = tuple("strong" if one.effect in diagnosis.missing else "" for one in rows)
    return Table(tuple(one for one in columns if any(cell != "" for cell in one.cells)), marks)


def gains_before_after(before: Identification, after: Identification) -> Table:
    """Drive gains of the model as it is and with what is missing."""
    gains = list(after.drive_gains.values())
    moved = _before_after(
        "joint", [(one, before.drive_gains[one], gain) for one, gain in after.drive_gains.items()]
    )
    nominal = Column("nominal", [one.nominal for one in gains], "number", 1)
    from_nominal = Column("from nominal", [gain_change(one) for one in gains], "change", 2)
    return Table((*moved, nominal, from_nominal))


def parameters_before_after(diagnosis: Diagnosis, most: int | None = None) -> tuple[Table, int]:
    """Parameters of both models, and how many are left out: those that move least beside their deviation."""
    before = {one.name: one for one in diagnosis.before.parameters}
    both: list[tuple[str, Quantity, Quantity]] = [
        (one.name, before[one.name], one) for one in diagnosis.after.parameters if one.name in before
    ]
    every = len(both)
    if most is not None and every > most:
        both.sort(key=lambda row: -abs(row[2].value - row[1].value) / (row[2].std or 1.0))
        both = both[:most]
    return Table(tuple(_before_after("parameter", both))), every - len(both)


def size_words(diagnosis: Diagnosis, verdict: EffectVerdict) -> str:
    """RMS torque of an effect, the smallest and largest of its motors, and its share of the motor's own torque."""
    if not verdict.size:
        return ""
    torque = motor_torques(diagnosis.after)
    largest = max(verdict.size, key=lambda joint: verdict.size[joint])
    low, high = f"{min(verdict.size.values()):.2g}", f"{verdict.size[largest]:.2g}"
    text = high if low == high else f"{low}–{high}"
    share = f" ({100.0 * verdict.size[largest] / torque[largest]:.2g} %)" if torque.get(largest) else ""
    return f"{text} {effort_unit(diagnosis.after, largest)}{share}"


def _before_after(header: str, rows: Sequence[tuple[str, Quantity, Quantity]]) -> list[Column]:
    return [
        Column(header, [name for name, *_ in rows]),
        Column("before ± std", [before for _, before, _ in rows], "quantity"),
        Column("after ± std", [after for *_, after in rows], "quantity"),
        Column("change", [(before.value, after.value) for _, before, after in rows], "moved"),
        Column("unit", [after.unit for *_, after in rows], "unit", 1),
    ]


def _unless(absent: Sequence[bool], cells: Sequence[float | None]) -> list[float | None]:
    return [None if no else cell for no, cell in zip(absent, cells, strict=True)]


def _places(diagnosis: Diagnosis, one: EffectVerdict) -> str:
    """Where an effect shows, in few words: the sentence beside has them all."""
    motors = list(diagnosis.after.drive_gains)
    if list(one.actuators) == motors and len(motors) > 1:
        return "all motors"
    return f"{len(one.actuators)} joints" if len(one.actuators) > 3 else ", ".join(one.actuators)


def _few(alternatives: Sequence[str]) -> str:
    """The first of many effects: the sentence beside has them all."""
    names = [effect_name(one) for one in alternatives]
    if len(names) > FEW:
        return f"{', '.join(names[: FEW - 1])} and {len(names) - FEW + 1} more"
    return ", ".join(names)


def _taken(one: EffectVerdict) -> float | None:
    """The share of the squared error that an effect takes away."""
    share = error_share(one)
    return None if share is None else _not_rounding(share)


def _not_rounding(value: float) -> float:
    """Zero for what is left of a difference of equal numbers."""
    return value if abs(value) > ROUNDING else 0.0
