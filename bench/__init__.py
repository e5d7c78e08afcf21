"""Drive gains and dynamic parameters of robots, from joint positions and current references.

The public names are imported when they are first used, so that `import bench` is quick.
"""

import importlib
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from bench.compare.where import WhereItFails as WhereItFails
    from bench.compare.where import where_it_fails as where_it_fails
    from bench.dataset import Dataset as Dataset
    from bench.dataset import load_dataset as load_dataset
    from bench.diagnose.result import Diagnosis as Diagnosis
    from bench.discover.find import find_missing_effects as find_missing_effects
    from bench.errors import BenchError as BenchError
    from bench.estimate.identify import identify as identify
    from bench.estimate.result import Identification as Identification
    from bench.recording import Recording as Recording
    from bench.robot import Robot as Robot
    from bench.robot import load_robot as load_robot
    from bench.show.comparison import where_report as where_report
    from bench.show.diagnosis import diagnosis_report as diagnosis_report
    from bench.show.tables import identification_report as identification_report

_HOME_OF = {
    "BenchError": "bench.errors",
    "Dataset": "bench.dataset",
    "Diagnosis": "bench.diagnose.result",
    "Identification": "bench.estimate.result",
    "Recording": "bench.recording",
    "Robot": "bench.robot",
    "WhereItFails": "bench.compare.where",
    "diagnosis_report": "bench.show.diagnosis",
    "find_missing_effects": "bench.discover.find",
    "identification_report": "bench.show.tables",
    "identify": "bench.estimate.identify",
    "load_dataset": "bench.dataset",
    "load_robot": "bench.robot",
    "where_it_fails": "bench.compare.where",
    "where_report": "bench.show.comparison",
}
"""Public name -> the module that defines it; in step with the imports above, which type checkers read."""

__all__ = [
    "BenchError",
    "Dataset",
    "Diagnosis",
    "Identification",
    "Recording",
    "Robot",
    "WhereItFails",
    "diagnosis_report",
    "find_missing_effects",
    "identification_report",
    "identify",
    "load_dataset",
    "load_robot",
    "where_it_fails",
    "where_report",
]


def __getattr__(name: str) -> Any:
    if name not in _HOME_OF:
        raise AttributeError(f"module 'bench' has no attribute {name!r}")
    value = getattr(importlib.import_module(_HOME_OF[name]), name)
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})
