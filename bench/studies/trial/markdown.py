"""The results of a trial as tables and as a page in Markdown."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

from bench.document import numbers
from bench.document.markdown.tables import markdown
from bench.document.table import Column, Mark, Table
from bench.effects.display_names import spoken
from bench.studies.trial.summary import LARGE, NOTHING, Miss, TrialSummary
from bench.studies.trial.target import Attained, Share, Target

COUNTED = (
    f"We count only cases where leaving out any single hidden effect raises the error of recordings that were not "
    f"fitted to at least {LARGE:g} × the noise floor."
)

ANOTHER = 100.0  # standard errors: beyond, the fit ended at another solution, and the distance is meaningless

HIDDEN, CASES = Column("hidden", (), "effect"), Column("cases", (), "number")
FOLDED = frozenset({"figure", "must be", "kept"})  # columns that may wrap


@dataclass(frozen=True)
class MarkdownPart:
    """A table with a title; every row has cases."""

    title: str
    table: Table


def parts(summary: TrialSummary) -> list[MarkdownPart]:
    """The tables that have rows."""
    rendered = [
        MarkdownPart("Figures, and what they must reach", targets_table(summary)),
        MarkdownPart("Named first, one effect hidden or none", confusion_table(summary)),
        MarkdownPart(
            "Absorbed: no data of this robot can show it, and the diagnosis says so", absorbed_table(summary)
        ),
        MarkdownPart("Named first, by size of the effect", misses_table(summary)),
        MarkdownPart("Parameters of the identified effects", coverage_table(summary)),
        MarkdownPart("Failed cases", failures_table(summary)),
    ]
    return [part for part in rendered if part.table.columns[0].cells]


def table_of(heads: Sequence[Column], rows: Iterable[Sequence[Any]], marks: Sequence[Mark] = ()) -> Table:
    """A table from its columns without cells and from rows of cells."""
    columns = list(zip(*rows, strict=True)) or [()] * len(heads)
    return Table(
        tuple(replace(head, cells=cells) for head, cells in zip(heads, columns, strict=True)), tuple(marks)
    )


def right(header: str) -> Column:
    """A column of texts at the right."""
    return Column(header, (), "number", format="s")


def targets_table(summary: TrialSummary) -> Table:
    """Every figure with cases and its bound; in bold if the bound is certainly missed."""
    tried = [target for target in summary.targets if target.reached is not None]
    heads = ("figure", "reached", "must be", "kept", "cases", "95 % interval")
    columns = [Column(head, (), "sentence" if head in FOLDED else "text") for head in heads]
    marks: list[Mark] = ["strong" if target.kept is Attained.NO else "" for target in tried]
    return table_of(columns, map(target_cells, tried), marks)


def confusion_table(summary: TrialSummary) -> Table:
    """Hidden effect, cases, share named first, effects named instead, cases explicitly undecided."""
    rows = []
    for hidden, named in summary.confusion.items():
        first_named = Share(named.get(hidden, 0), sum(named.values()))
        first = f"nothing named: {percent(first_named)}" if hidden == NOTHING else percent(first_named)
        others = ", ".join(f"{spoken(name)} {n}" for name, n in named.items() if name != hidden)
        rows.append((hidden, first_named.of, first, others, summary.undecided.get(hidden) or ""))
    instead, undecided = Column("named instead", (), "sentence"), Column("openly undecided", (), "number")
    return table_of([HIDDEN, CASES, right("named first"), instead, undecided], rows)


def absorbed_table(summary: TrialSummary) -> Table:
    """Absorbed effects, and the number of cases in which nothing else was named."""
    rows = [(name, share.of, share.count) for name, share in summary.absorbed.items()]
    return table_of([HIDDEN, CASES, Column("nothing else named", (), "number")], rows)


def misses_table(summary: TrialSummary) -> Table:
    """Share of effects named first, by class of their error; classes without a case are omitted."""
    rows = [
        (size_text(miss), miss.first.of, percent(miss.first), percent(miss.first_undecided))
        for miss in summary.misses
        if miss.first.of
    ]
    size = Column("error of the effect / noise floor", ())
    return table_of([size, CASES, right("named first"), right("or undecided")], rows)


def coverage_table(summary: TrialSummary) -> Table:
    """Share of the intervals of every parameter that contain the truth."""
    rows = [
        (each.effect, each.parameter, each.within.of, percent(each.within), deviation_text(each.deviation))
        for each in summary.coverage
    ]
    heads = [Column("effect", (), "effect"), Column("parameter", ()), Column("intervals", (), "number")]
    heads += [right("hold the truth"), right("median error / std (expected: 0.67)")]
    return table_of(heads, rows)


def deviation_text(deviation: float) -> str:
    """The median deviation of estimates in standard errors; no number beyond ANOTHER."""
    return f"over {ANOTHER:g}" if deviation > ANOTHER else f"{deviation:.2f}"


def failures_table(summary: TrialSummary) -> Table:
    """Reasons of failed cases, the most frequent first."""
    ranked = sorted(summary.failed.items(), key=lambda pair: -pair[1])
    return table_of([Column("reason", (), "sentence"), CASES], ranked)


def trial_markdown(summary: TrialSummary, notes: Mapping[str, str], pictures: Sequence[str] = ()) -> str:
    """Markdown tables; notes: how the trial was run. pictures: files next to the page."""
    blocks = [
        f"# Blind trial of the diagnosis: {summary.robot}",
        "\n".join(f"- {name}: {value}" for name, value in notes.items()),
        COUNTED,
    ]
    for part in parts(summary):
        blocks += [f"## {part.title}", markdown(part.table)]
    blocks += [f"![{name}]({name})" for name in pictures]
    return "\n\n".join(block for block in blocks if block) + "\n"


def target_cells(target: Target) -> tuple[str, str, str, str, str, str]:
    """Name, value, bound, whether the bound is kept, cases, interval."""
    share, figure = target.share, target.figure
    bound = " and ".join(
        f"{word} {100.0 * limit:.0f} %" if share and limit < 1 else f"{word} {limit:g}"
        for word, limit in (("at least", target.least), ("at most", target.most))
        if limit is not None
    )
    name = figure.words if figure.main else f"– {figure.words}"
    kept = "" if target.kept is None else target.kept.value
    if share is None:
        value = numbers.percent(target.value) if figure.relative else f"{target.value:.4g}"
        return name, value, bound, kept, "", ""
    if not share.of:
        return name, "", bound, "", "0", ""
    interval = " to ".join(f"{100.0 * end:.1f} %" for end in share.interval)
    return name, f"{100.0 * target.value:.1f} %", bound, kept, str(share.of), interval


def size_text(miss: Miss) -> str:
    """A class of sizes, as text."""
    return f"above {miss.above:g}" if miss.below == float("inf") else f"{miss.above:g} to {miss.below:g}"


def percent(share: Share) -> str:
    """A share in percent; empty without cases."""
    return f"{100.0 * share.value:.0f} %" if share.of else ""
