"""Results of a trial for laws outside the catalogue, as a table and a page."""

import json
from collections.abc import Callable, Sequence
from pathlib import Path

from bench.basics.files.atomic import write_text_atomically
from bench.document.markdown.tables import markdown
from bench.document.table import Column, Table
from bench.studies.sweep.journal import Row, names_in
from bench.studies.sweep.table import write_rows
from bench.studies.trial.markdown import percent, table_of
from bench.studies.trial.summary import LARGE
from bench.studies.trial.target import LAW_FACTOR, Share, share_of

NEAR = 0.1  # of the torque's RMS: largest error of a law that counts as identified


def unknown_table(rows: Sequence[Row], nothing: Sequence[Row] = ()) -> Table:
    """Shares of the cases that count, and their goals. nothing: cases without hidden effects."""
    done = [row for row in rows if row["status"] == "ok" and row["least_own_error_over_floor"] >= LARGE]
    alone = [row for row in done if len(names_in(row["hidden"])) == 1]
    with_known = [row for row in done if len(names_in(row["hidden"])) > 1]
    figures: list[tuple[str, Sequence[Row], Callable[[Row], object], str]] = [
        (
            f"one law alone: error not fitted at most {LAW_FACTOR:g} × the noise floor",
            alone,
            at_floor,
            "80 %",
        ),
        ("its torque within 10 % (RMS) of the truth's on recordings not fitted", alone, _near, "75 %"),
        ("its structure: the same variables, the same symmetry", alone, _structure, "70 %"),
        ("with one or two known effects: error at the floor", with_known, at_floor, ""),
        ("its torque within 10 %", with_known, _near, ""),
        ("with that of the known effects at its motor", with_known, lambda r: r["law.error"] <= NEAR, ""),
        ("its structure", with_known, _structure, ""),
        ("the law's torque within 10 %, and the known effects exactly", with_known, _both, "60 %"),
        ("a wrong effect of the catalogue with certainty", done, lambda r: r["wrong"], "at most 3 %"),
        ("a law at a motor that has none", done, lambda r: r.get("law.elsewhere"), ""),
        ("nothing hidden: a law claimed", _with_known(nothing), lambda r: r["laws"] > 0, "at most 1 %"),
    ]
    lines = []
    for name, some, rule, goal in figures:
        share = share_of(some, rule)
        lines.append((name, percent(share) or "–", goal, f"{share.count} of {share.of}", _interval(share)))
    heads = [Column("figure", (), "sentence"), Column("reached", ()), Column("goal", ()), Column("cases", ())]
    return table_of([*heads, Column("95 % interval", ())], lines)


def _with_known(nothing: Sequence[Row]) -> list[Row]:
    """Successful cases that record whether a law was claimed."""
    return [row for row in nothing if row["status"] == "ok" and row.get("laws") is not None]


def cases_table(rows: Sequence[Row]) -> Table:
    """Every case: the hidden effects and the result."""
    heads = [Column(head, (), "sentence") for head in ("hidden law", "beside", "found", "named")]
    heads += [Column(head, (), "number", 0, ".3g") for head in ("error over floor, before", "after")]
    cells = [
        (
            _numbers(row),
            ", ".join(names_in(row["hidden"])[1:]) or "–",
            _formula(row.get("law.found")),
            row.get("missing") or "–",
            *(row.get(f"error_over_floor.{name}") for name in ("before", "after")),
            _error(row),
        )
        for row in rows
    ]
    return table_of([*heads, Column("torque error", (), "number", 0, ".2g")], cells)


def _formula(formulas: str | None) -> str:
    """Laws as code, so that Markdown does not interpret their stars and bars."""
    return "–" if not formulas else ", ".join(f"`{entry}`" for entry in formulas.split(" | "))


def write_unknown(robot: str, rows: Sequence[Row], folder: Path, nothing: Sequence[Row] = ()) -> list[Path]:
    """Write ROBOT_unknown.md and .parquet; returns their paths, empty without such cases.

    nothing: the rows of cases without hidden effects.
    """
    if not rows:
        return []
    page, table = folder / f"{robot}_unknown.md", folder / f"{robot}_unknown.parquet"
    counted = (
        f"We count only cases whose hidden effects raise the error to at least {LARGE:g} × the noise floor: smaller "
        "ones cannot be expected to be identified."
    )
    commits = sorted({str(row["commit"]) for row in rows if row.get("commit")})
    text = [
        f"# Trial of {robot}: laws outside the catalogue",
        f"- datasets: {len(rows)}\n- commit: {', '.join(commits)}",
        counted,
        markdown(unknown_table(rows, nothing)),
        "## Every case",
        markdown(cases_table([row for row in rows if row["status"] == "ok"])),
    ]
    write_text_atomically(page, "\n\n".join(text) + "\n")
    write_rows(table, [*rows, *_with_known(nothing)])
    return [page, table]


def at_floor(row: Row) -> bool:
    """Whether the error after the diagnosis is close to the noise floor."""
    return float(row["error_over_floor.after"]) <= LAW_FACTOR


def _near(row: Row) -> bool:
    return float(_error(row)) <= NEAR


def _error(row: Row) -> float:
    """Relative error of the law's torque; rows of earlier versions only have the error including known effects."""
    alone = row.get("law.alone")
    return row.get("law.error", float("nan")) if alone is None else alone


def _structure(row: Row) -> bool:
    return bool(row["law.structure"])


def _both(row: Row) -> bool:
    return _near(row) and bool(row["exact_undecided"])


def _interval(share: Share) -> str:
    if not share.of:
        return "–"
    return " to ".join(f"{100.0 * end:.0f} %" for end in share.interval)


def _numbers(row: Row) -> str:
    values = json.loads(row.get("law") or "{}")
    return ", ".join(f"{name} {value:g}" for name, value in values.items())
