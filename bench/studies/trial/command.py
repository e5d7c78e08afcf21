"""The command `bench trial`: run, judge, show."""

import time
from collections.abc import Sequence
from contextlib import ExitStack
from dataclasses import dataclass, replace
from pathlib import Path

from rich.console import Console
from rich.text import Text

from bench.basics.errors import BenchError
from bench.basics.files.atomic import write_text_atomically
from bench.basics.plural import plural
from bench.document.layout import TEXT
from bench.document.terminal.tables import printed
from bench.studies.sweep.journal import Row
from bench.studies.sweep.pool import ON_ALL_CORES, Workers
from bench.studies.sweep.progress import ShownProgress, duration_text, progress_console, shown_progress
from bench.studies.sweep.run_plan import Report
from bench.studies.sweep.summary import table_console
from bench.studies.sweep.table import write_rows
from bench.studies.trial.cases import KINDS, Kind, TrialPlan, chosen_effects
from bench.studies.trial.charts import write_trial_figures
from bench.studies.trial.markdown import COUNTED, parts, trial_markdown
from bench.studies.trial.realise import check_scenario
from bench.studies.trial.run_trial import TrialRequest, run_trial
from bench.studies.trial.setup import Setup, make_setup
from bench.studies.trial.summary import TrialSummary, summarised
from bench.studies.trial.unknown_page import unknown_table, write_unknown


@dataclass(frozen=True)
class Drawn:
    """The datasets of a trial: effects and kinds (empty: all), `seeds` of each kind, from number `first`.

    discover: search for laws even if nothing remains unexplained.
    """

    effects: Sequence[str] = ()
    kinds: Sequence[str] = ()
    seeds: int = 3
    first: int = 0
    discover: bool = False


def run_command(
    robot: str,
    folder: Path,
    drawn: Drawn,
    *,
    scenario: str | None = None,
    duration: float | None = None,
    workers: Workers = ON_ALL_CORES,
    quiet: bool = False,
) -> int:
    """Run a trial; table, page and figures go to `folder` under the robot's name. Returns the exit code."""
    console = table_console()
    workers.warm_up()
    setup = replace(make_setup(robot, scenario, duration), discover=drawn.discover)
    asked = {"robot": robot, "scenario": scenario, "duration": duration}
    given = {name: value for name, value in asked.items() if value is not None}
    request = TrialRequest(setup, _kinds(drawn.kinds), drawn.seeds, tuple(drawn.effects), given, drawn.first)
    _check(setup, request)
    start = time.monotonic()

    bars = progress_console(quiet)
    bars.quiet = quiet or not bars.is_terminal  # a log only lists finished kinds
    shown: list[ShownProgress] = []
    with ExitStack() as stack:

        def progress(plan: TrialPlan) -> Report:
            stack.close()  # the bar of the previous kind
            console.print(f"[bold]{setup.name}[/], {plan.kind}: {plural(plan.size, 'dataset')}")
            shown.append(stack.enter_context(shown_progress(bars, plan.size)))
            return shown[-1]

        def phase(name: str) -> None:
            shown[-1].phase(name)

        try:
            rows = run_trial(request, folder / setup.name, workers.pool, progress, phase)
        except KeyboardInterrupt:
            console.print("Stopped. Finished datasets are kept: the same command goes on with the others.")
            raise
    summary, paths = write_results(setup.name, rows, folder, scenario_seconds(setup))
    console.print()
    show(summary, console)
    unknown = [row for row in rows if row["kind"] == "unknown"]
    if unknown:
        nothing = [row for row in rows if row["kind"] == "nothing"]
        console.print(printed(unknown_table(unknown, nothing), min(console.width, TEXT.width)))
    console.print(f"\n{plural(len(rows), 'dataset')} in {duration_text(time.monotonic() - start)}")
    for path in paths:
        console.print(str(path), soft_wrap=True)
    if not rows or any(row["status"] == "ok" for row in rows):
        return 0
    reason = max(summary.failed, key=lambda text: summary.failed[text])
    said = f"bench: all {plural(len(rows), 'dataset')} came to nothing: {reason}"
    Console(stderr=True, highlight=False).print(said, markup=False, soft_wrap=True)
    return 1


def write_results(
    robot: str, rows: Sequence[Row], folder: Path, seconds: float
) -> tuple[TrialSummary, list[Path]]:
    """Write ROBOT.parquet, ROBOT.md and the figures; returns the summary and the files."""
    unknown = [row for row in rows if row["kind"] == "unknown"]
    rows = [row for row in rows if row["kind"] != "unknown"]
    nothing = [row for row in rows if row["kind"] == "nothing"]
    written = write_unknown(robot, unknown, folder, nothing)
    summary = summarised(robot, rows)
    if unknown and not rows:
        return summary, written
    table = folder / f"{robot}.parquet"
    write_rows(table, rows)
    figures = write_trial_figures(summary, rows, folder)
    page = folder / f"{robot}.md"
    names = [path.name for path in figures]
    write_text_atomically(page, trial_markdown(summary, _notes(rows, seconds), names))
    return summary, [page, table, *figures, *written]


def show(summary: TrialSummary, console: Console) -> None:
    """Print the tables of a summary."""
    width = min(console.width, TEXT.width)
    for i, part in enumerate(parts(summary)):
        console.print(Text(part.title, "bold"))
        console.print(printed(part.table, width), width=width)
        if summary.small and i == 0:
            few = f"this is not so in {plural(summary.small, 'case')}"
            console.print(Text(f"{COUNTED[:-1]}; {few}.", "dim"), width=width)
        console.print()


def scenario_seconds(setup: Setup) -> float:
    """Duration of the longest designed motion, s; 0 if none is designed."""
    durations = [
        float({**setup.content.get("design", {}), **recording["design"]}.get("duration", 0.0))
        for recording in setup.content["recordings"]
        if isinstance(recording.get("design"), dict)
    ]
    return max(durations, default=0.0)


def _kinds(kinds: Sequence[str]) -> tuple[Kind, ...]:
    for kind in kinds:
        if kind not in KINDS:
            raise BenchError(f"trial: no kind {kind!r}; there are {', '.join(KINDS)}")
    return tuple(kind for kind in KINDS if not kinds or kind in kinds)


def _check(setup: Setup, request: TrialRequest) -> None:
    """Raise BenchError before the start for requests and scenarios that would fail in a case."""
    for kind in request.kinds:
        chosen_effects(setup, kind, request.effects)
    if not request.plans:
        raise BenchError("trial: none of these effects is of the requested kinds")
    for plan in request.plans:
        check_scenario(setup, plan.case(plan.first))


def _notes(rows: Sequence[Row], seconds: float) -> dict[str, str]:
    counts = {kind: sum(row["kind"] == kind for row in rows) for kind in KINDS}
    notes = {"datasets": ", ".join(f"{kind} {count}" for kind, count in counts.items() if count)}
    if seconds:
        notes["recordings"] = f"up to {seconds:g} s each"
    done = [row for row in rows if row["status"] == "ok"]
    for name in ("commit", *(key for key in (done[0] if done else {}) if key.startswith("version."))):
        values = sorted({str(row[name]) for row in done})
        notes[name.removeprefix("version.")] = ", ".join(values)
    return notes
