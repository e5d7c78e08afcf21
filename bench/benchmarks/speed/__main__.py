"""`make speed`: every figure with its last value; the history is in results/speed.

    python -m bench.benchmarks.speed [PART ...]

measures only the named parts.
"""

import sys
from collections.abc import Callable, Mapping

import click

from bench.benchmarks.speed import diagnosis
from bench.benchmarks.speed.figures import SpeedFigure, append_history, figures_table, last_values
from bench.benchmarks.speed.growth import growth_figures
from bench.benchmarks.speed.long_log import long_log_figures
from bench.benchmarks.speed.main_job import main_job_figures
from bench.benchmarks.speed.regressor import regressor_figures
from bench.benchmarks.speed.report import report_figures
from bench.benchmarks.speed.scheduling import scheduling_figures
from bench.benchmarks.speed.start_up import start_up_figures
from bench.benchmarks.speed.sweep import sweep_figures
from bench.studies.sweep.summary import table_console


def diagnosis_figures() -> list[SpeedFigure]:
    """Time, processor use and memory of diagnoses of small and large robots, and time of several at once."""
    figures, busy, memory = [], 0.0, 0.0
    for name, limit, cost in diagnosis.costs():
        figures.append(SpeedFigure(name, cost.seconds, "s", limit))
        busy = max(busy, cost.processor / cost.seconds)
        if "stewart" in name:
            memory = cost.megabytes
    identified = diagnosis.identification()
    identifying = identified.processor / identified.seconds
    return [
        *figures,
        SpeedFigure("peak memory of a hexapod's diagnosis", memory, "MB", diagnosis.MEGABYTES),
        SpeedFigure("processor time of a diagnosis over its time", busy, "×", diagnosis.BUSY),
        SpeedFigure("processor time of an identification over its time", identifying, "×", diagnosis.BUSY),
        SpeedFigure("three diagnoses at once over two", diagnosis.three_over_two(), "×", diagnosis.AT_ONCE),
    ]


MEASUREMENTS: Mapping[str, Callable[[], list[SpeedFigure]]] = {
    "start_up": start_up_figures,
    "regressor": regressor_figures,
    "main_job": main_job_figures,
    "long_log": long_log_figures,
    "growth": growth_figures,
    "diagnosis": diagnosis_figures,
    "report": report_figures,
    "sweep": sweep_figures,
    "scheduling": scheduling_figures,
}


@click.command()
@click.argument("parts", nargs=-1, type=click.Choice(list(MEASUREMENTS)), metavar="[PART]...")
def main(parts: tuple[str, ...]) -> None:
    """Measure all or some parts, print and keep their figures; exit code 1 if a limit is not kept."""
    figures = [figure for part in parts or MEASUREMENTS for figure in MEASUREMENTS[part]()]
    table_console().print(figures_table(figures, last_values()))
    append_history(figures)
    if not all(figure.kept for figure in figures):
        sys.exit(1)


if __name__ == "__main__":
    main()
