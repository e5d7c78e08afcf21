"""`make speed`: every figure with its last value; the history is in results/speed.

    python -m bench.benchmarks.speed [PART ...]

measures only the named parts.
"""

import sys
from collections.abc import Callable, Mapping

import click

from bench.benchmarks.measured_data import measured_data
from bench.benchmarks.speed import (
    diagnosis,
    first_words,
    growth,
    long_log,
    main_job,
    regressor,
    report,
    start_up,
)
from bench.benchmarks.speed.figures import SpeedFigure, append_history, figures_table, last_values
from bench.benchmarks.speed.scheduling import scheduling_figures
from bench.benchmarks.speed.sweep import sweep_figures
from bench.studies.sweep.summary import table_console


def regressor_figures() -> list[SpeedFigure]:
    """Time of the projected regressor over that of Pinocchio's regressor."""
    return [
        SpeedFigure(f"regressor over Pinocchio's, {robot}", regressor.times_pinocchio(robot), "×", limit)
        for robot, limit in regressor.LIMITS.items()
    ]


def main_job_figures() -> list[SpeedFigure]:
    """Time of a simulation over that of rollout, of an identification, and of a hexapod's design and simulation."""
    name = "simulate a hexapod, design included"
    figures = [SpeedFigure(name, main_job.hexapod_seconds(), "s", main_job.HEXAPOD_LIMIT)]
    for robot, limit in main_job.IDENTIFICATION_LIMITS.items():
        ratio, seconds = main_job.measure(robot)
        figures += [
            SpeedFigure(f"simulation over mujoco.rollout, {robot}", ratio, "×", main_job.SIMULATION_LIMIT),
            SpeedFigure(f"identify two recordings of 20 s, {robot}", seconds, "s", limit),
        ]
    return figures


def diagnosis_figures() -> list[SpeedFigure]:
    """Time, processor use and memory of diagnoses of small and large robots, and time of several at once."""
    figures, busy, memory = [], 0.0, 0.0
    for name, limit, cost in diagnosis.costs():
        figures.append(SpeedFigure(name, cost.seconds, "s", limit))
        busy = max(busy, cost.processor / cost.seconds)
        if "hexapod" in name:
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


def report_figures() -> list[SpeedFigure]:
    """Time to write the report of a diagnosis of a robot with six motors: first, and again from its folder."""
    first, again = report.measure()
    return [
        SpeedFigure("report of 60 s of six motors", first, "s", report.LIMIT),
        SpeedFigure("report of a finished diagnosis", again, "s", report.AGAIN_LIMIT),
    ]


def long_log_figures() -> list[SpeedFigure]:
    """Cost of identification from two logs of 20 minutes and, if its data are available, of a measured arm at 5 kHz."""
    seconds, gigabytes = long_log.measure()
    name = "identify a five-bar, two logs of 20 minutes at 1 kHz"
    figures = [
        SpeedFigure(name, seconds, "s", long_log.SECONDS_LIMIT),
        SpeedFigure(f"{name}, memory", gigabytes, "GB", long_log.MEMORY_LIMIT),
    ]
    measured = measured_data()
    if (measured / long_log.ARM).is_dir():
        name = "identify six axes, 45,000 samples at 5 kHz"
        figures.append(SpeedFigure(name, long_log.measured_arm_seconds(measured), "s", long_log.ARM_LIMIT))
    return figures


def growth_figures() -> list[SpeedFigure]:
    """Exponents of the cost; also writes its figure and numbers."""
    series = list(growth.measure())
    growth.keep(series)
    return [
        SpeedFigure(
            f"{grown.command} against {grown.of}, exponent",
            grown.exponent,
            "",
            growth.LINEAR if grown.of == "samples" else None,
        )
        for grown in series
    ]


def start_up_figures() -> list[SpeedFigure]:
    """Time from the start of a command until it reads its dataset, and until its first words on a terminal."""
    starts = [
        SpeedFigure(f"start of bench {command}", start_up.measure(command), "s", start_up.LIMIT)
        for command in start_up.COMMANDS
    ]
    silences = [
        SpeedFigure(f"bench {command} until its first words", seconds, "s", first_words.LIMIT)
        for command, seconds in first_words.measure_all()
    ]
    return [*starts, *silences]


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
