"""The figures of a trial as a page of text."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass

from bench.trial.summary import FLOOR_FACTOR, GAIN_FACTOR, LARGE, NOTHING, Miss, TrialSummary
from bench.trial.target import NO, Figure, Share, Target

COUNTED = (
    f"Counted are cases in which each hidden effect makes an error of at least {LARGE:g} × the noise floor in a "
    "model that lacks it alone, on recordings that are not fitted."
)

WORDS = {
    Figure.ONE_FIRST: "one hidden effect: named first",
    Figure.ONE_UNDECIDED: "or openly undecided",
    Figure.TWO_EXACT: "two hidden effects: the set exactly",
    Figure.TWO_UNDECIDED: "or openly undecided",
    Figure.THREE_EXACT: "three: the set exactly",
    Figure.THREE_UNDECIDED: "or openly undecided",
    Figure.ALARM: "nothing hidden: any alarm",
    Figure.ALARM_NAMED: "an effect named",
    Figure.OUTSIDE_HONEST: "outside the catalogue: unexplained, no wrong name",
    Figure.OUTSIDE_UNEXPLAINED: "unexplained",
    Figure.OUTSIDE_NO_WRONG_NAME: "no wrong name with the verdict `missing`",
    Figure.GAIN_ERROR_MEDIANS: "gains after the found effects, over those of a model that was told: medians",
    Figure.GAIN_ERROR_RMS: "root mean squares",
    Figure.GAIN_ERROR_WITHIN: f"within {GAIN_FACTOR} of it",
    Figure.GAIN_ERROR_BEFORE: "largest gain error, root mean square: before",
    Figure.GAIN_ERROR_AFTER: "after",
    Figure.GAIN_ERROR_TOLD: "told",
    Figure.FLOOR_MEDIAN: "error not fitted after the ladder, over the noise floor: median",
    Figure.FLOOR_WITHIN: f"at most {FLOOR_FACTOR}",
    Figure.FLOOR_WITHIN_TOLD: "the same for a model that was told the effects",
    Figure.INTERVALS: "effect parameters: 95 % intervals that hold the truth",
}
MAIN = frozenset(
    {
        Figure.ONE_FIRST,
        Figure.TWO_EXACT,
        Figure.THREE_EXACT,
        Figure.ALARM,
        Figure.OUTSIDE_HONEST,
        Figure.GAIN_ERROR_MEDIANS,
        Figure.FLOOR_MEDIAN,
        Figure.INTERVALS,
    }
)
"""The other figures stand below one of these, and say more of it."""


@dataclass(frozen=True)
class Part:
    """A table under a title; rows of cells, one for each head. None of the rows is without cases."""

    title: str
    heads: tuple[str, ...]
    rows: Sequence[Sequence[object]]


def parts(summary: TrialSummary) -> list[Part]:
    """What there are cases of, as tables; what was not tried is left out."""
    found = [
        Part(
            "Figures, and what they must reach",
            ("figure", "reached", "must be", "kept", "cases", "95 % interval"),
            [target_cells(one) for one in summary.targets if one.reached is not None],
        ),
        Part(
            "What was named first, one effect hidden or none",
            ("hidden", "cases", "named first", "named instead", "openly undecided"),
            confusion_rows(summary),
        ),
        Part(
            "Absorbed: no data of this robot can show it, and the diagnosis says so",
            ("hidden", "cases", "nothing named beside"),
            [(name, one.of, one.count) for name, one in summary.absorbed.items()],
        ),
        Part(
            "Named first, by size of the effect",
            ("own error / noise floor", "cases", "named first", "or undecided"),
            [
                (size_text(one), one.first.of, percent(one.first), percent(one.first_undecided))
                for one in summary.misses
                if one.first.of
            ],
        ),
        Part(
            "Parameters of the found effects",
            ("effect", "parameter", "intervals", "hold the truth", "median deviation / std"),
            [
                (one.effect, one.parameter, one.within.of, percent(one.within), f"{one.deviation:.2f}")
                for one in summary.coverage
            ],
        ),
        Part("Cases that came to nothing", ("reason", "cases"), list(summary.failed.items())),
    ]
    return [part for part in found if part.rows]


def trial_markdown(summary: TrialSummary, notes: Mapping[str, str], pictures: Sequence[str] = ()) -> str:
    """Markdown tables; notes: how the trial was run. pictures: files beside the page."""
    blocks = [
        f"# Blind trial of the diagnosis: {summary.robot}",
        "\n".join(f"- {name}: {value}" for name, value in notes.items()),
        COUNTED,
    ]
    for part in parts(summary):
        blocks += [f"## {part.title}", table(part.heads, [_weighted(row) for row in part.rows])]
    blocks += [f"![{name}]({name})" for name in pictures]
    return "\n\n".join(block for block in blocks if block) + "\n"


def _weighted(row: Sequence[object]) -> list[object]:
    return [f"**{cell}**" if cell == NO else cell for cell in row]


def table(heads: Sequence[str], rows: Iterable[Sequence[object]]) -> str:
    """A Markdown table."""
    lines = [heads, ["---"] * len(heads), *rows]
    return "\n".join(f"| {' | '.join(str(cell) for cell in line)} |" for line in lines)


def target_cells(target: Target) -> tuple[str, str, str, str, str, str]:
    """Name, value, bound, whether it is reached, cases, interval."""
    bounds = []
    shown = f"{100.0 * target.value:.1f} %" if target.share else f"{target.value:.4g}"
    for word, bound in (("at least", target.least), ("at most", target.most)):
        if bound is not None:
            bounds.append(
                f"{word} {100.0 * bound:.0f} %" if target.share and bound < 1 else f"{word} {bound:g}"
            )
    name = WORDS[target.figure] if target.figure in MAIN else f"– {WORDS[target.figure]}"
    if target.share is None:
        return name, shown, " and ".join(bounds), target.verdict, "", ""
    if not target.share.of:
        return name, "", " and ".join(bounds), "", "0", ""
    low, high = target.share.interval
    return (
        name,
        shown,
        " and ".join(bounds),
        target.verdict,
        str(target.share.of),
        f"{100.0 * low:.1f} % to {100.0 * high:.1f} %",
    )


def confusion_rows(summary: TrialSummary) -> list[tuple[str, int, str, str, str]]:
    """Hidden effect, cases, share that is named first, what is named instead, cases openly undecided."""
    rows = []
    for hidden, named in summary.confusion.items():
        count = sum(named.values())
        others = ", ".join(f"{name} {n}" for name, n in named.items() if name != hidden)
        own = Share(named.get(hidden, 0), count)
        first = f"nothing named: {percent(own)}" if hidden == NOTHING else percent(own)
        rows.append((hidden, count, first, others, str(summary.undecided.get(hidden, "") or "")))
    return rows


def size_text(miss: Miss) -> str:
    """A class of sizes."""
    return f"above {miss.above:g}" if miss.below == float("inf") else f"{miss.above:g} to {miss.below:g}"


def percent(share: Share) -> str:
    """A share in percent; nothing of nothing."""
    return f"{100.0 * share.value:.0f} %" if share.of else ""
