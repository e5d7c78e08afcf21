"""Measurements with known truth."""

from pathlib import Path

from bench.basics.progress import SILENT, Progress
from bench.dataset.dataset import Dataset, load_dataset
from bench.excitation.scenario import load_designed
from bench.truth.dataset import as_dataset, write_simulation
from bench.truth.simulate import Simulation
from bench.truth.simulate import simulate as run


def simulate(
    scenario: str | Path,
    output: str | Path | None = None,
    *,
    seed: int | None = None,
    progress: Progress = SILENT,
) -> Dataset:
    """Simulate a scenario; return the dataset that a real robot's controller would have logged, without the truth.

    scenario: a built-in name, or the path of a scenario file. output: a folder to write the dataset to, with its truth
    next to it; if omitted, nothing is written. seed: replaces the scenario's, for gains and noise. Raises BenchError
    naming what in the scenario cannot be simulated.
    """
    simulation = simulation_of(scenario, seed, progress)
    if output is None:
        return as_dataset(simulation)
    progress.phase("writing the recordings")
    write_simulation(simulation, Path(output))
    return load_dataset(output)


def simulation_of(scenario: str | Path, seed: int | None, progress: Progress) -> Simulation:
    """The simulation of a scenario with its truth, as the command line writes it."""
    loaded, trajectories = load_designed(scenario, None if seed is None else {"seed": seed}, progress)
    return run(loaded, trajectories, progress=progress)
