"""`make speed`: every figure beside the one of the last time; the history is in results/speed."""

import sys

from bench.speed import diagnosis, main_job, regressor, report
from bench.speed.figures import Figure, append_history, figures_table, last_values
from bench.speed.sweep import sweep_figures
from bench.sweep.console import table_console


def regressor_figures() -> list[Figure]:
    """The projected regressor over Pinocchio's own."""
    return [
        Figure(f"regressor over Pinocchio's, {robot}", regressor.measure(robot).ratio, "×", limit)
        for robot, limit in regressor.LIMITS.items()
    ]


def main_job_figures() -> list[Figure]:
    """Simulation over rollout, identification, and the design and simulation of a hexapod."""
    name = "simulate a hexapod, design included"
    figures = [Figure(name, main_job.hexapod_seconds(), "s", main_job.HEXAPOD_LIMIT)]
    for robot, limit in main_job.IDENTIFICATION_LIMITS.items():
        speed = main_job.measure(robot)
        figures += [
            Figure(f"simulation over mujoco.rollout, {robot}", speed.ratio, "×", main_job.SIMULATION_LIMIT),
            Figure(f"identify two recordings of 20 s, {robot}", speed.identification, "s", limit),
        ]
    return figures


def diagnosis_figures() -> list[Figure]:
    """Diagnosis of robots with two effects that their models lack."""
    return [
        Figure(f"diagnose two recordings of 24 s, {robot}", diagnosis.measure(robot), "s", limit)
        for robot, limit in diagnosis.LIMITS.items()
    ]


def report_figures() -> list[Figure]:
    """The page of a diagnosis of a robot with six motors: at first, and again from the diagnosis's folder."""
    first, again = report.measure()
    return [
        Figure("report of 60 s of six motors", first, "s", report.LIMIT),
        Figure("report of a finished diagnosis", again, "s", report.AGAIN_LIMIT),
    ]


MEASUREMENTS = (regressor_figures, main_job_figures, diagnosis_figures, report_figures, sweep_figures)


def main() -> int:
    """Measure, print, keep; 1 if a limit is not kept."""
    figures = [figure for measure in MEASUREMENTS for figure in measure()]
    table_console().print(figures_table(figures, last_values()))
    append_history(figures)
    return 0 if all(figure.kept for figure in figures) else 1


if __name__ == "__main__":
    sys.exit(main())
