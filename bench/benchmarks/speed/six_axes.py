"""Cost of identifying a measured arm of six axes at 5 kHz, 9 s: the TX40 among the measured data."""

from pathlib import Path
from tempfile import TemporaryDirectory
from time import process_time

from bench.benchmarks.measured.machines import dataset_of
from bench.dataset.dataset import load_dataset
from bench.identification.identify import fit
from bench.identification.prepare import prepare
from bench.identification.problem import problem_of
from bench.identification.swapped_columns import swapped_columns

MACHINE = "tx40"
LIMIT = 2.0  # s


def measure(measured: Path) -> float:
    """Processor seconds to read the recording, identify and look for columns that were taken for each other.

    measured: folder of the measured data.
    """
    with TemporaryDirectory() as name:
        folder = dataset_of(MACHINE, measured, Path(name))
        start = process_time()
        dataset = load_dataset(folder)
        problem = problem_of(dataset)
        prepared = prepare(problem)
        swapped_columns(problem, fit(prepared), prepared)
        return process_time() - start
