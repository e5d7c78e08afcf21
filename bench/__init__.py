"""Drive gains and dynamic parameters of robots, from joint positions and current references.

The public names are imported when they are first used, so that `import bench` is quick.
"""

import importlib
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from bench.basics.errors import BenchError as BenchError
    from bench.dataset.dataset import Dataset as Dataset
    from bench.dataset.dataset import load_dataset as load_dataset
    from bench.dataset.recording import Recording as Recording
    from bench.dataset.robot import Robot as Robot
    from bench.dataset.robot import load_robot as load_robot
    from bench.diagnosis.result import Diagnosis as Diagnosis
    from bench.discovery.find import find_missing_effects as find_missing_effects
    from bench.document.terminal.comparison import where_report as where_report
    from bench.document.terminal.diagnosis import diagnosis_report as diagnosis_report
    from bench.document.terminal.identification import identification_report as identification_report
    from bench.identification.identify import identify as identify
    from bench.identification.result import Identification as Identification
    from bench.residuals.residuals import WhereItFails as WhereItFails
    from bench.residuals.residuals import where_it_fails as where_it_fails

_HOME_OF = {
    "BenchError": "bench.basics.errors",
    "Dataset": "bench.dataset.dataset",
    "Diagnosis": "bench.diagnosis.result",
    "Identification": "bench.identification.result",
    "Recording": "bench.dataset.recording",
    "Robot": "bench.dataset.robot",
    "WhereItFails": "bench.residuals.residuals",
    "diagnosis_report": "bench.document.terminal.diagnosis",
    "find_missing_effects": "bench.discovery.find",
    "identification_report": "bench.document.terminal.identification",
    "identify": "bench.identification.identify",
    "load_dataset": "bench.dataset.dataset",
    "load_robot": "bench.dataset.robot",
    "where_it_fails": "bench.residuals.residuals",
    "where_report": "bench.document.terminal.comparison",
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
