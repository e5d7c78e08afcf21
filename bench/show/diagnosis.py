"""A diagnosis in a terminal: the verdict in a few sentences, then what stands behind it."""

from collections.abc import Sequence
from itertools import pairwise

from rich.console import Console, RenderableType
from rich.table import Table
from rich.text import Text

from bench.diagnose.result import Diagnosis, EffectVerdict
from bench.diagnose.summary import effort_unit, motor_torques, reason, summary_sentences
from bench.effects.names import named_after
from bench.estimate.result import Quantity
from bench.show.columns import GAPS, Column, aligned_pair, table_of
from bench.show.comparison import sentences_list
from bench.show.numbers import GIVEN, effect_name, percent, pretty_unit, value_and_deviation
from bench.show.tables import effects_table

WIDTH = 100
BAR = 30  # columns of the longest bar
LEAST_BAR = 8
EIGHTHS = " ▏▎▍▌▋▊▉"
SHOWN = 4  # effects that the data do not support, shown beside those that they do
MOST_PARAMETERS = 12  # of those that move most


def diagnosis_report(diagnosis: Diagnosis, console: Console | None = None, *, verbose: bool = False) -> None:
    """Print verdict, ladder, ranking, reasons, and what moves, to fit the console's width.

    verbose: every effect of the catalogue and every parameter.
    """
    console = console or Console()
    width = console.width
    console.print()
    have = ", ".join(diagnosis.before.effects) or "rigid bodies only"
    facts = f"model with {have} · judged on {diagnosis.split}"
    console.print(Text.assemble((diagnosis.robot, "bold"), "  ", (facts, "dim")))
    console.print()
    for sentence in map(named_after, summary_sentences(diagnosis)):
        console.print(Text(sentence))
    _section(console, "Ladder: error after each added effect", ladder_table(diagnosis, width=width))
    shown, left_out = _shown(diagnosis.ranking, verbose)
    _section(console, "Ranking", ranking_table(diagnosis, shown, width=width))
    console.print(
        Text("evidence: nats on recordings that were not fitted; 10, odds of 20,000 to 1, are strong", "dim")
    )
    if diagnosis.missing:
        console.print(Text("size: RMS torque of the effect, in brackets as a share of the motor's", "dim"))
    if left_out:
        names = ", ".join(effect_name(one.effect) for one in left_out)
        console.print(Text(f"not supported, too: {names}", "dim"))
    told = [one for one in shown if verbose or not diagnosis.missing or one.verdict != "not supported"]
    _section(console, "Why", sentences_list([named_after(reason(diagnosis, one)) for one in told]))
    if diagnosis.missing:
        if diagnosis.after.gains_fitted:
            _section(console, "Drive gains, before and after", gains_before_after(diagnosis, width=width))
        moved, still = _moved(diagnosis, None if verbose else MOST_PARAMETERS)
        _section(console, "Dynamic parameters, before and after", _parameters(moved, width))
        if still:
            console.print(Text(f"{still} more move less", "dim"))
        _section(console, "Effects of the model", effects_table(diagnosis.after, width=width))
    notes = list(dict.fromkeys(diagnosis.after.notes))
    if notes:
        _section(console, "Notes", sentences_list(notes))
    console.print()


def ladder_table(diagnosis: Diagnosis, *, width: int = WIDTH) -> Table:
    """Errors fitted and not fitted after each added effect, down to the noise, with bars for the latter."""
    steps = diagnosis.ladder
    names = ["the model as it is"]
    names += [
        "+ " + ", ".join(effect_name(name) for name in after.effects if name not in before.effects)
        for before, after in pairwise(steps)
    ]
    judged = [one.validate if one.validate is not None else one.identify for one in steps]
    values = [*judged, diagnosis.unexplained.noise_floor]
    columns = [
        Column("", [*names, "noise of the currents"]),
        Column("fitted", [*(percent(one.identify) for one in steps), ""], "right"),
        Column("not fitted", [percent(value) for value in values], "right"),
    ]
    room = width - sum(column.width for column in columns) - 2 * len(columns)
    length = max(min(room, BAR), LEAST_BAR)
    largest = max((value for value in values if value), default=1.0)
    columns.append(Column("", [bar((value or 0.0) / largest, length) for value in values], rank=1))
    styles = [*([""] * len(steps)), "dim"]
    return table_of(columns, width, row_styles=styles, section_ends=[len(steps) - 1])


def ranking_table(
    diagnosis: Diagnosis, shown: Sequence[EffectVerdict] | None = None, *, width: int = WIDTH
) -> Table:
    """A row for each effect: verdict, evidence, errors without and with it, where, how large, alternatives."""
    rows = diagnosis.ranking if shown is None else shown
    strong = [one.effect in diagnosis.missing for one in rows]
    absorbed = [one.verdict == "absorbed" for one in rows]
    columns = [
        Column("effect", [effect_name(one.effect) for one in rows]),
        Column("verdict", [one.verdict for one in rows]),
        Column(
            "evidence",
            [
                "–" if no else f"{one.evidence:.1f}".replace("-0.0", "0.0")
                for one, no in zip(rows, absorbed, strict=True)
            ],
            "right",
        ),
        Column("without", [percent(one.error_before) for one in rows], "right", rank=3),
        Column(
            "with it",
            ["–" if no else percent(one.error_after) for one, no in zip(rows, absorbed, strict=True)],
            "right",
        ),
        Column("size", [size_words(diagnosis, one) for one in rows]),
        Column("at", [", ".join(one.actuators) for one in rows], rank=2),
        Column(
            "could as well be",
            [", ".join(effect_name(name) for name in one.alternatives) for one in rows],
            rank=4,
        ),
    ]
    told = [column for column in columns if any(column.cells)]
    return table_of(told, width, row_styles=["bold" if one else "" for one in strong], gaps=GAPS[:1])


def gains_before_after(diagnosis: Diagnosis, *, width: int = WIDTH) -> Table:
    """Drive gains of the model as it is and with what is missing."""
    before, after = diagnosis.before.drive_gains, diagnosis.after.drive_gains
    rows: list[tuple[str, Quantity, Quantity]] = [(joint, before[joint], after[joint]) for joint in after]
    nominal = Column("nominal", [f"{after[joint].nominal:.6g}" for joint in after], "right", rank=1)
    return _before_after("joint", rows, width, [nominal])


def size_words(diagnosis: Diagnosis, verdict: EffectVerdict) -> str:
    """RMS torque of an effect, the smallest and largest of its motors, and its share of the motor's own torque."""
    if not verdict.size:
        return ""
    torque = motor_torques(diagnosis.after)
    largest = max(verdict.size, key=lambda joint: verdict.size[joint])
    values = [verdict.size[joint] for joint in verdict.size]
    low, high = f"{min(values):.2g}", f"{max(values):.2g}"
    text = high if low == high else f"{low}–{high}"
    share = f" ({100.0 * verdict.size[largest] / torque[largest]:.2g} %)" if torque.get(largest) else ""
    return f"{text} {effort_unit(diagnosis.after, largest)}{share}"


def bar(share: float, length: int) -> str:
    """A bar of a share between 0 and 1 of `length` columns, to an eighth of a column; never quite empty."""
    eighths = max(round(8 * length * min(share, 1.0)), 1)
    return "█" * (eighths // 8) + EIGHTHS[eighths % 8].strip()


def _shown(
    ranking: Sequence[EffectVerdict], verbose: bool
) -> tuple[list[EffectVerdict], list[EffectVerdict]]:
    """Which verdicts are shown, and which are only named: those not supported but for the first few."""
    unsupported = [one for one in ranking if one.verdict == "not supported"]
    left_out = [] if verbose else unsupported[SHOWN:]
    return [one for one in ranking if one not in left_out], left_out


def _moved(diagnosis: Diagnosis, most: int | None) -> tuple[list[tuple[str, Quantity, Quantity]], int]:
    """Parameters of both models, those first that move most beside their deviation, and how many are left out."""
    before = {one.name: one for one in diagnosis.before.parameters}
    both: list[tuple[str, Quantity, Quantity]] = [
        (one.name, before[one.name], one) for one in diagnosis.after.parameters if one.name in before
    ]
    if most is None or len(both) <= most:
        return both, 0
    both.sort(key=lambda row: -abs(row[2].value - row[1].value) / (row[2].std or 1.0))
    return both[:most], len(both) - most


def _parameters(rows: Sequence[tuple[str, Quantity, Quantity]], width: int) -> Table:
    unit = Column("unit", [pretty_unit(after.unit) for *_, after in rows], rank=1)
    return _before_after("parameter", rows, width, [unit])


def _before_after(
    header: str, rows: Sequence[tuple[str, Quantity, Quantity]], width: int, more: Sequence[Column]
) -> Table:
    return table_of(
        [
            Column(header, [name for name, *_ in rows]),
            Column("before ± std", _with_std([before for _, before, _ in rows])),
            Column("after ± std", _with_std([after for *_, after in rows])),
            Column(
                "change",
                [_change(before.value, after.value) for _, before, after in rows],
                "right",
            ),
            *more,
        ],
        width,
    )


def _change(before: float, after: float) -> str:
    """How a value changed, in percent; the difference itself where it changed its sign or was zero."""
    if before * after > 0.0:
        return percent((after - before) / abs(before), signed=True)
    return f"{after - before:+.3g}"


def _with_std(quantities: Sequence[Quantity]) -> list[str]:
    pairs = [value_and_deviation(one.value, one.std) for one in quantities]
    both = aligned_pair([value for value, _ in pairs], [std for _, std in pairs], " ± ")
    return [text.replace(f"± {GIVEN}", f"  {GIVEN}") for text in both]


def _section(console: Console, title: str, part: RenderableType) -> None:
    console.print()
    console.print(Text(title, "bold"))
    console.print(part)
