"""Tables of a diagnosis."""

from collections.abc import Sequence
from itertools import pairwise
from math import exp

from bench.diagnosis.reason_words import probability_text
from bench.diagnosis.result import Diagnosis, EffectVerdict
from bench.diagnosis.summary import effort_unit, error_share, motor_torques
from bench.document.layout import TEXT
from bench.document.numbers import gain_change
from bench.document.table import PLAIN, Column, Mark, Table
from bench.effects.display_names import spoken
from bench.effects.select import TAG
from bench.identification.decision import RULE
from bench.identification.result import Identification, Quantity

INDISTINGUISHABLE = (
    "indistinguishable: these data do not exclude the alternatives, which takes odds of "
    f"{float(f'{exp(RULE.undecided):.1g}'):,.0f} to 1; a probability of 0.99 is odds of 100 to 1"
)


def step_labels(steps: Sequence[Sequence[str]]) -> list[str]:
    """What each model adds to the one before, as in "the model as it is", "+ Coulomb friction".

    steps: the effects of every model, by name or as requested, with a place.
    """
    labels = ["the model as it is"]
    for before, after in pairwise(steps):
        added = dict.fromkeys(
            spoken(name if name.endswith(TAG) else name.partition(":")[0])
            for name in after
            if name not in before
        )
        labels.append(f"+ {', '.join(added)}")
    return labels


def ladder_table(diagnosis: Diagnosis) -> Table:
    """Errors on fitted and not fitted recordings after each added effect, and the noise, with bars of the errors."""
    steps, floor = diagnosis.ladder, diagnosis.unexplained.noise_floor
    errors = [step.reported for step in steps]
    values = [*errors, floor]
    largest = max((value for value in values if value), default=1.0)
    return Table(
        (
            Column("model", [*step_labels([step.effects for step in steps]), "noise of the currents"]),
            Column("fitted", [*(step.identify for step in steps), ""], "share"),
            Column("not fitted", [*(step.validate for step in steps), floor], "share"),
            Column("", [(value or 0.0) / largest for value in values], "bar", 1),
        ),
        (*[PLAIN] * len(steps), "weak"),
        (len(steps) - 1,),
    )


def ranking_table(diagnosis: Diagnosis, verdicts: Sequence[EffectVerdict] | None = None) -> Table:
    """A row for each effect: verdict, probability, evidence, errors without and with it, size, places, alternatives.

    Empty columns are omitted. verdicts: the rows, by default the whole ranking.
    """
    rows = diagnosis.ranking if verdicts is None else verdicts

    def absorbed(verdict: EffectVerdict) -> bool:
        return verdict.verdict == "absorbed"

    probabilities = [verdict.probability for verdict in rows]
    evidence = [None if absorbed(verdict) else _not_rounding(verdict.evidence) for verdict in rows]
    columns = (
        Column("effect", [verdict.effect for verdict in rows], "effect"),
        Column("verdict", [verdict.verdict for verdict in rows], "verdict"),
        Column("probability", ["" if each is None else probability_text(each) for each in probabilities]),
        Column("evidence", evidence, "number", 0, ".1f"),
        Column("without", [verdict.error_before for verdict in rows], "share", 3),
        Column("with it", [None if absorbed(verdict) else verdict.error_after for verdict in rows], "share"),
        Column("size", [size_words(diagnosis, verdict) if verdict.size else "" for verdict in rows]),
        Column("saves", [_taken(verdict) if verdict.size else "" for verdict in rows], "share", 5),
        Column("at", [_places(diagnosis, verdict) for verdict in rows], rank=2),
        Column("or", [_few(verdict.alternatives) for verdict in rows], rank=4),
    )
    marks: tuple[Mark, ...] = tuple(
        "strong" if verdict.effect in diagnosis.missing else "" for verdict in rows
    )
    return Table(tuple(column for column in columns if any(cell != "" for cell in column.cells)), marks)


def something_else_words(diagnosis: Diagnosis) -> str:
    """The probability that the machine has something that no model of the search contains, as a sentence."""
    return f"something else, of which no model here knows: probability {probability_text(diagnosis.something_else)}"


def sets_table(diagnosis: Diagnosis) -> Table:
    """A row for each of the most probable sets of effects: its probability, and the error on recordings not fitted."""
    rows = diagnosis.sets
    names = [" + ".join(spoken(name) for name in row.effects) or "nothing" for row in rows]
    columns = (
        Column("effects together", names),
        Column("probability", [row.probability for row in rows], "number", 0, ".2f"),
        Column("not fitted", [row.error for row in rows], "share"),
    )
    return Table(columns)


def without_logs_table(diagnosis: Diagnosis) -> Table:
    """A row for each omitted log: the effects that the other logs do not support, and the drive gains."""
    rows = diagnosis.without_logs
    gone = [", ".join(spoken(name) for name in row.gone) or "none" for row in rows]
    columns = [Column("without log", [row.log for row in rows]), Column("effects not supported", gone)]
    if any(row.gains for row in rows):
        columns += [
            Column(f"gain {joint}", [row.gains.get(joint) for row in rows], "number", 2, ".4g")
            for joint in diagnosis.after.joints
        ]
    return Table(tuple(columns))


def gains_before_after(before: Identification, after: Identification) -> Table:
    """Drive gains of the model as it is and with the missing effects."""
    gains = list(after.drive_gains.values())
    both = [(joint, before.drive_gains[joint], gain) for joint, gain in after.drive_gains.items()]
    nominal = Column("nominal", [gain.nominal for gain in gains], "number", 1)
    changes = [gain_change(gain) if gain.determined else "" for gain in gains]
    return Table((*_before_after("joint", both), nominal, Column("from nominal", changes, "change", 2)))


def parameters_before_after(diagnosis: Diagnosis, most: int | None = None) -> tuple[Table, int]:
    """Parameters of both models, and the number omitted: those that change least in units of their standard errors."""
    before = {parameter.name: parameter for parameter in diagnosis.before.parameters}
    both: list[tuple[str, Quantity, Quantity]] = [
        (parameter.name, before[parameter.name], parameter)
        for parameter in diagnosis.after.parameters
        if parameter.name in before
    ]
    every = len(both)
    if most is not None and every > most:
        both.sort(key=lambda row: -abs(row[2].value - row[1].value) / (row[2].std or 1.0))
        both = both[:most]
    return Table(tuple(_before_after("parameter", both))), every - len(both)


def size_words(diagnosis: Diagnosis, verdict: EffectVerdict) -> str:
    """RMS torque of an effect, from its smallest to its largest motor, and the share of the latter's torque.

    Torques of hinges and forces of slides are listed separately.
    """
    joints = sorted(verdict.size, key=lambda joint: verdict.size[joint])
    units = {joint: effort_unit(diagnosis.after, joint) for joint in joints}
    alike = [[joint for joint in joints if units[joint] == unit] for unit in sorted(set(units.values()))]
    return ", ".join(_span(diagnosis, verdict, several) for several in alike)


def _span(diagnosis: Diagnosis, verdict: EffectVerdict, joints: Sequence[str]) -> str:
    """The range of sizes of joints with one unit, in rising order, and the share at the last."""
    largest, torque = joints[-1], motor_torques(diagnosis.after)
    low, high = (f"{verdict.size[joint]:.2g}" for joint in (joints[0], largest))
    text = high if low == high else f"{low}–{high}"
    size = f"{text} {effort_unit(diagnosis.after, largest)}"
    if torque.get(largest):
        size += f" ({100.0 * verdict.size[largest] / torque[largest]:.2g} %)"
    return size.replace(" ", "\N{NO-BREAK SPACE}")


def _before_after(header: str, rows: Sequence[tuple[str, Quantity, Quantity]]) -> list[Column]:
    changes = [
        (before.value, after.value) if before.determined and after.determined else ""
        for _, before, after in rows
    ]
    return [
        Column(header, [name for name, *_ in rows]),
        Column("before ± std", [before for _, before, _ in rows], "quantity"),
        Column("after ± std", [after for *_, after in rows], "quantity"),
        Column("change", changes, "moved"),
        Column("unit", [after.unit for *_, after in rows], "unit", 1),
    ]


def _places(diagnosis: Diagnosis, verdict: EffectVerdict) -> str:
    """The places of an effect, abbreviated; with the probability of a place that is not certain."""
    motors, places = list(diagnosis.after.drive_gains), list(verdict.actuators)
    uncertain = {
        place: f"{place} ({probability:.2f})"
        for place, probability in verdict.places.items()
        if place in places and probability < TEXT.certain
    }
    if places == motors and len(motors) > 1:
        return ", ".join(("all motors", *uncertain.values()))
    if len(places) > 3:
        return ", ".join((f"{len(places)} joints", *uncertain.values()))
    return ", ".join(uncertain.get(place, place) for place in places)


def _few(alternatives: Sequence[str]) -> str:
    """The first of many effects, since the sentence on the verdict lists all."""
    names = [spoken(alternative) for alternative in alternatives]
    if len(names) > TEXT.alternatives:
        return f"{', '.join(names[: TEXT.alternatives - 1])} and {len(names) - TEXT.alternatives + 1} more"
    return ", ".join(names)


def _taken(verdict: EffectVerdict) -> float | None:
    """The share of the squared error that an effect removes."""
    share = error_share(verdict)
    return None if share is None else _not_rounding(share)


def _not_rounding(value: float) -> float:
    """The value, or zero if it is only rounding."""
    return value if abs(value) > TEXT.zero else 0.0
