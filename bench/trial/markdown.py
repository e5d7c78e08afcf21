"""The figures of a trial as a page of text."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence

from bench.trial.summary import LARGE, Miss, Share, Target, TrialSummary

COUNTED = (
    f"Counted are cases in which each hidden effect makes an error of at least {LARGE:g} × the noise floor in a "
    "model that lacks it alone, on recordings that are not fitted."
)


def trial_markdown(summary: TrialSummary, notes: Mapping[str, str], pictures: Sequence[str] = ()) -> str:
    """Markdown tables; notes: how the trial was run. pictures: files beside the page."""
    parts = [
        f"# Blind trial of the diagnosis: {summary.robot}",
        "\n".join(f"- {name}: {value}" for name, value in notes.items()),
        COUNTED,
        table(("figure", "reached", "must", "", "cases", "95 %"), map(target_cells, summary.targets)),
        "## What was named first, one effect hidden",
        table(
            ("hidden", "cases", "named first", "named instead", "openly undecided"), confusion_rows(summary)
        ),
    ]
    if summary.absorbed:
        parts += [
            "## Absorbed: no data of this robot can show it, and the diagnosis says so",
            table(
                ("hidden", "cases", "nothing named beside"),
                [(name, one.of, one.count) for name, one in summary.absorbed.items()],
            ),
        ]
    parts += [
        "## Named first, by size of the effect",
        table(
            ("own error / noise floor", "cases", "named first", "or undecided"),
            [
                (size_text(one), one.first.of, percent(one.first), percent(one.first_undecided))
                for one in summary.misses
            ],
        ),
        "## Parameters of the found effects",
        table(
            ("effect", "parameter", "intervals", "hold the truth", "median deviation / std"),
            [
                (one.effect, one.parameter, one.within.of, percent(one.within), f"{one.deviation:.2f}")
                for one in summary.coverage
            ],
        ),
    ]
    if summary.failed:
        parts += [
            "## Cases that came to nothing",
            table(("reason", "cases"), list(summary.failed.items())),
        ]
    parts += [f"![{name}]({name})" for name in pictures]
    return "\n\n".join(part for part in parts if part) + "\n"


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
    verdict = "" if not bounds or target.reached is None else "yes" if target.reached else "**no**"
    if target.share is None:
        return target.name.strip(), shown, " and ".join(bounds), verdict, "", ""
    if not target.share.of:
        return target.name.strip(), "", " and ".join(bounds), "", "0", ""
    low, high = target.share.interval
    return (
        target.name.strip(),
        shown,
        " and ".join(bounds),
        verdict,
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
        rows.append((hidden, count, percent(own), others, str(summary.undecided.get(hidden, "") or "")))
    return rows


def size_text(miss: Miss) -> str:
    """A class of sizes."""
    return f"above {miss.above:g}" if miss.below == float("inf") else f"{miss.above:g} to {miss.below:g}"


def percent(share: Share) -> str:
    """A share in percent; nothing of nothing."""
    return f"{100.0 * share.value:.0f} %" if share.of else ""
