"""Cost of one diagnosis in a separate process.

Run as `python -m bench.benchmarks.speed.one_diagnosis PICKLE`.

The measuring process has a simulator, pages and figures in its memory, which are no part of a diagnosis.
"""

import json
import pickle
import subprocess
import sys
from collections.abc import Callable
from dataclasses import asdict, dataclass
from pathlib import Path
from tempfile import TemporaryDirectory
from time import perf_counter, process_time

from bench.benchmarks.speed.memory import peak_bytes
from bench.dataset.dataset import Dataset
from bench.diagnosis.with_catalogue import diagnose_with_catalogue
from bench.identification.identify import identify
from bench.identification.prepare import prepare
from bench.identification.problem import problem_of


@dataclass(frozen=True)
class Cost:
    """Wall and processor time of a diagnosis, s, and the peak memory of its process, MB.

    busy: processor time over wall time of an identification of the same dataset.
    """

    seconds: float
    processor: float
    megabytes: float
    busy: float


def cost_of(dataset: Dataset) -> Cost:
    """Diagnose a dataset in this process, then identify it."""
    seconds, processor = _times(lambda: diagnose_with_catalogue(problem_of(dataset)))
    megabytes = peak_bytes() / 1024.0**2
    identified, busy = _times(lambda: identify(prepare(problem_of(dataset))))
    return Cost(seconds, processor, megabytes, busy / identified)


def cost_alone(dataset: Dataset) -> Cost:
    """`cost_of` in a separate process."""
    with TemporaryDirectory() as folder:
        path = Path(folder) / "dataset.pickle"
        path.write_bytes(pickle.dumps(dataset))
        command = [sys.executable, "-m", "bench.benchmarks.speed.one_diagnosis", str(path)]
        answer = subprocess.run(command, check=True, capture_output=True, text=True)
    return Cost(**json.loads(answer.stdout))


def _times(work: Callable[[], object]) -> tuple[float, float]:
    """Wall and processor time, s."""
    wall, processor = perf_counter(), process_time()
    work()
    return perf_counter() - wall, process_time() - processor


if __name__ == "__main__":
    given = pickle.loads(Path(sys.argv[1]).read_bytes())  # written by cost_alone
    sys.stdout.write(json.dumps(asdict(cost_of(given))))
