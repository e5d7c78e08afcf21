"""`make speed`: every figure beside the one of the last time; the history is in results/speed."""

import sys
from time import perf_counter

from rich.console import Console

from bench.diagnose.diagnose import diagnose
from bench.excite.scenario import designer
from bench.scenario import load_scenario, resolve_trajectories
from bench.speed import main_job, regressor
from bench.speed.figures import Figure, append_history, figures_table, last_values
from bench.speed.sweep import sweep_figures
from bench.truth.dataset import as_dataset
from bench.truth.simulate import simulate


def regressor_figures() -> list[Figure]:
    """The projected regressor over Pinocchio's own."""
    return [
        Figure(f"regressor over Pinocchio's, {robot}", regressor.measure(robot).ratio, "×", limit)
        for robot, limit in regressor.LIMITS.items()
    ]


def main_job_figures() -> list[Figure]:
    """Simulation over rollout, and identification."""
    figures = []
    for robot, limit in main_job.IDENTIFICATION_LIMITS.items():
        speed = main_job.measure(robot)
        figures += [
            Figure(f"simulation over mujoco.rollout, {robot}", speed.ratio, "×", main_job.SIMULATION_LIMIT),
            Figure(f"identify two recordings of 20 s, {robot}", speed.identification, "s", limit),
        ]
    return figures


def diagnosis_figures() -> list[Figure]:
    """Diagnosis of a five-bar with friction that the model lacks."""
    hidden = [{"effect": "viscous_friction", "Fv": 0.1}, {"effect": "coulomb_friction", "Fc": 0.2}]
    scenario = load_scenario("five_bar", {"hidden": hidden})
    dataset = as_dataset(simulate(scenario, resolve_trajectories(scenario, designer)))
    start = perf_counter()
    diagnose(dataset)
    return [Figure("diagnose four recordings of 20 s, five_bar", perf_counter() - start, "s")]


MEASUREMENTS = (regressor_figures, main_job_figures, diagnosis_figures, sweep_figures)


def main() -> int:
    """Measure, print, keep; 1 if a limit is not kept."""
    figures = [figure for measure in MEASUREMENTS for figure in measure()]
    Console().print(figures_table(figures, last_values()))
    append_history(figures)
    return 0 if all(figure.kept for figure in figures) else 1


if __name__ == "__main__":
    sys.exit(main())
