"""Markdown of tables, an identification and a diagnosis."""

from collections.abc import Iterable, Sequence

from bench.diagnosis.result import Diagnosis
from bench.diagnosis.summary import reason, summary_sentences
from bench.document.diagnosis import ladder_table, ranking_table
from bench.document.identification import effects_table, errors_table, gains_table, parameters_table
from bench.document.numbers import Truth, settings_lines
from bench.document.table import Column, Table
from bench.effects.display_names import named_after, spoken
from bench.identification.result import Identification

BAR = "\\|"


def markdown(table: Table) -> str:
    """A table in Markdown, with strong rows and poor cells in bold; a | in a cell is escaped."""
    columns = [column for column in table.columns if column.kind != "bar"]
    strong = [mark == "strong" for mark in table.mark_of_rows]
    cells = [_cells(column) for column in columns]
    rows = [
        [f"**{first}**" if bold else first, *rest] for bold, first, *rest in zip(strong, *cells, strict=True)
    ]
    return rows_in_markdown([column.header for column in columns], rows)


def rows_in_markdown(heads: Sequence[str], rows: Iterable[Sequence[object]]) -> str:
    """Headers and rows of cells as a table in Markdown; a | in a cell is escaped."""
    lines: list[Sequence[object]] = [heads, ["---"] * len(heads), *rows]
    return "\n".join(f"| {' | '.join(str(cell).replace('|', BAR) for cell in line)} |" for line in lines)


def _cells(column: Column) -> list[str]:
    return [f"**! {text}**" if poor else text for text, poor in zip(column.texts, column.poor, strict=True)]


def diagnosis_markdown(diagnosis: Diagnosis) -> str:
    """Sentences on what is missing, the error after each added effect, and the verdicts with their reasons."""
    supported = [verdict for verdict in diagnosis.ranking if verdict.verdict != "not supported"]
    others = [spoken(verdict.effect) for verdict in diagnosis.ranking if verdict.verdict == "not supported"]
    parts = ["### What is missing", "\n\n".join(map(named_after, summary_sentences(diagnosis)))]
    parts += ["### Error after each added effect", markdown(ladder_table(diagnosis))]
    if supported:
        parts += ["### Ranking", markdown(ranking_table(diagnosis, supported))]
    if others:
        parts.append(f"Not supported: {', '.join(others)}.")
    if supported:
        parts.append("\n".join(f"- {named_after(reason(diagnosis, verdict))}" for verdict in supported))
    return "\n\n".join(parts) + "\n"


def summary_markdown(result: Identification, truth: Truth | None = None) -> str:
    """Gains, effects, errors, notes and settings, the first things to look at."""
    remark = "" if result.gains_fitted else " (nominal: not fitted)"
    effects = ", ".join(result.effects) if result.effects else "rigid bodies only"
    parts = [f"**{result.robot}**, estimator *{result.method}*, {effects}"]
    parts += [f"### Drive gains{remark}", markdown(gains_table(result, truth))]
    if result.effect_parameters:
        parts += ["### Effects", markdown(effects_table(result, truth))]
    errors = errors_table(result.recordings, result.joints)
    parts += ["### Error of the modelled current", markdown(errors)]
    if result.notes:
        parts += ["### Notes", "\n".join(f"- {note}" for note in result.notes)]
    parts += ["### Fit", "\n".join(f"- {line}" for line in settings_lines(result))]
    return "\n\n".join(parts) + "\n"


def parameters_markdown(result: Identification, truth: Truth | None = None) -> str:
    """Every base and payload parameter with its whole grouping."""
    text = f"### Dynamic parameters\n\n{markdown(parameters_table(result, truth, full=True))}\n"
    if result.left_out:
        text += f"\nLeft out, as the data do not need them: {', '.join(result.left_out)}.\n"
    return text
