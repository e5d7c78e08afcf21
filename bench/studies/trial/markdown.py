"""The results of a trial as tables and as a page in Markdown."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from bench.document import numbers
from bench.document.markdown.tables import markdown
from bench.document.table import Column, Table
from bench.effects.display_names import spoken
from bench.studies.trial.summary import (
    LARGE,
    NOTHING,
    Miss,
    TrialSummary,
)
from bench.studies.trial.target import Attained, Share, Target

COUNTED = (
    f"We count only cases where leaving out any single hidden effect raises the error of recordings that were not "
    f"fitted to at least {LARGE:g} × the noise floor."
)

ANOTHER = 100.0  # standard errors: beyond, the fit ended at another solution, and the distance is meaningless

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


def targets_table(summary: TrialSummary) -> Table:
    """Every figure with cases and its bound; in bold if the bound is certainly missed."""
    tried = [target for target in summary.targets if target.reached is not None]
    heads = ("figure", "reached", "must be", "kept", "cases", "95 % interval")
    cells = zip(*map(target_cells, tried), strict=True) if tried else [()] * len(heads)
    columns = tuple(
        Column(head, cell, "sentence" if head in FOLDED else "text")
        for head, cell in zip(heads, cells, strict=True)
    )
    return Table(columns, tuple("strong" if target.kept is Attained.NO else "" for target in tried))


def confusion_table(summary: TrialSummary) -> Table:
    """Hidden effect, cases, share named first, effects named instead, cases explicitly undecided."""
    rows = []
    for hidden, named in summary.confusion.items():
        first_named = Share(named.get(hidden, 0), sum(named.values()))
        first = f"nothing named: {percent(first_named)}" if hidden == NOTHING else percent(first_named)
        others = ", ".join(f"{spoken(name)} {n}" for name, n in named.items() if name != hidden)
        rows.append((hidden, first_named.of, first, others, summary.undecided.get(hidden) or ""))
    effects, cases, named_first, instead, undecided = zip(*rows, strict=True) if rows else ((),) * 5
    return Table(
        (
            Column("hidden", effects, "effect"),
            Column("cases", cases, "number"),
            Column("named first", named_first, "number", format="s"),
            Column("named instead", instead, "sentence"),
            Column("openly undecided", undecided, "number"),
        )
    )


def absorbed_table(summary: TrialSummary) -> Table:
    """Absorbed effects, and the number of cases in which nothing else was named."""
    return Table(
        (
            Column("hidden", list(summary.absorbed), "effect"),
            Column("cases", [share.of for share in summary.absorbed.values()], "number"),
            Column("nothing else named", [share.count for share in summary.absorbed.values()], "number"),
        )
    )


def misses_table(summary: TrialSummary) -> Table:
    """Share of effects named first, by class of their error; classes without a case are omitted."""
    tried = [miss for miss in summary.misses if miss.first.of]
    return Table(
        (
            Column("error of the effect / noise floor", [size_text(miss) for miss in tried]),
            Column("cases", [miss.first.of for miss in tried], "number"),
            Column("named first", [percent(miss.first) for miss in tried], "number", format="s"),
            Column("or undecided", [percent(miss.first_undecided) for miss in tried], "number", format="s"),
        )
    )


def coverage_table(summary: TrialSummary) -> Table:
    """Share of the intervals of every parameter that contain the truth."""
    return Table(
        (
            Column("effect", [coverage.effect for coverage in summary.coverage], "effect"),
            Column("parameter", [coverage.parameter for coverage in summary.coverage]),
            Column("intervals", [coverage.within.of for coverage in summary.coverage], "number"),
            Column(
                "hold the truth",
                [percent(coverage.within) for coverage in summary.coverage],
                "number",
                format="s",
            ),
            Column(
                "median error / std (expected: 0.67)",
                [deviation_text(coverage.deviation) for coverage in summary.coverage],
                "number",
                format="s",
            ),
        )
    )


def deviation_text(deviation: float) -> str:
    """The median deviation of estimates in standard errors; no number beyond ANOTHER."""
    return f"over {ANOTHER:g}" if deviation > ANOTHER else f"{deviation:.2f}"


def failures_table(summary: TrialSummary) -> Table:
    """Reasons of failed cases, the most frequent first."""
    ranked = sorted(summary.failed.items(), key=lambda pair: -pair[1])
    return Table(
        (
            Column("reason", [reason for reason, _ in ranked], "sentence"),
            Column("cases", [count for _, count in ranked], "number"),
        )
    )


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
    bounds = []
    kept = "" if target.kept is None else target.kept.value
    value = f"{100.0 * target.value:.1f} %" if target.share else f"{target.value:.4g}"
    if target.figure.relative:
        value = numbers.percent(target.value)
    for word, bound in (("at least", target.least), ("at most", target.most)):
        if bound is not None:
            bounds.append(
                f"{word} {100.0 * bound:.0f} %" if target.share and bound < 1 else f"{word} {bound:g}"
            )
    name = target.figure.words if target.figure.main else f"– {target.figure.words}"
    if target.share is None:
        return name, value, " and ".join(bounds), kept, "", ""
    if not target.share.of:
        return name, "", " and ".join(bounds), "", "0", ""
    low, high = target.share.interval
    return (
        name,
        value,
        " and ".join(bounds),
        kept,
        str(target.share.of),
        f"{100.0 * low:.1f} % to {100.0 * high:.1f} %",
    )


def size_text(miss: Miss) -> str:
    """A class of sizes, as text."""
    return f"above {miss.above:g}" if miss.below == float("inf") else f"{miss.above:g} to {miss.below:g}"


def percent(share: Share) -> str:
    """A share in percent; empty without cases."""
    return f"{100.0 * share.value:.0f} %" if share.of else ""
