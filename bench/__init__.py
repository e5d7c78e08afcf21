"""Drive gains and dynamic parameters of robots, from joint positions and current references.

The public names are imported when they are first used, so that `import bench` is quick.
"""

import importlib
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from bench.dataset import Dataset as Dataset
    from bench.dataset import load_dataset as load_dataset
    from bench.errors import BenchError as BenchError
    from bench.estimate.identify import identify as identify
    from bench.estimate.result import Identification as Identification
    from bench.recording import Recording as Recording
    from bench.robot import Robot as Robot
    from bench.robot import load_robot as load_robot
    from bench.show.tables import identification_report as identification_report

_HOME_OF = {
    "BenchError": "bench.errors",
    "Dataset": "bench.dataset",
    "Identification": "bench.estimate.result",
    "Recording": "bench.recording",
    "Robot": "bench.robot",
    "identification_report": "bench.show.tables",
    "identify": "bench.estimate.identify",
    "load_dataset": "bench.dataset",
    "load_robot": "bench.robot",
}
"""Public name -> the module that defines it; in step with the imports above, which type checkers read."""

__all__ = [
    "BenchError",
    "Dataset",
    "Identification",
    "Recording",
    "Robot",
    "identification_report",
    "identify",
    "load_dataset",
    "load_robot",
]


def __getattr__(name: str) -> Any:
    if name not in _HOME_OF:
        raise AttributeError(f"module 'bench' has no attribute {name!r}")
    value = getattr(importlib.import_module(_HOME_OF[name]), name)
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})
