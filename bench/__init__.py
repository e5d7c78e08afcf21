"""Drive gains and dynamic parameters of robots, from joint positions and current references.

The public names are imported when they are first used, so that `import bench` is quick.
"""

import importlib
from importlib.metadata import PackageNotFoundError, version
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from bench.api.compare import ModelErrors as ModelErrors
    from bench.api.compare import compare as compare
    from bench.api.diagnose import diagnose as diagnose
    from bench.api.figures import figures as figures
    from bench.api.identify import identify as identify
    from bench.api.report import Report as Report
    from bench.api.report import report as report
    from bench.api.simulate import simulate as simulate
    from bench.api.sources import save_model as save_model
    from bench.basics.errors import BenchError as BenchError
    from bench.dataset.dataset import Dataset as Dataset
    from bench.dataset.dataset import load_dataset as load_dataset
    from bench.dataset.payload import Payload as Payload
    from bench.dataset.recording import Recording as Recording
    from bench.dataset.robot import Robot as Robot
    from bench.dataset.robot import load_robot as load_robot
    from bench.diagnosis.result import Diagnosis as Diagnosis
    from bench.identification.model_file import SavedModel as SavedModel
    from bench.identification.model_file import load_model as load_model
    from bench.identification.result import Identification as Identification

_HOME_OF = {
    "BenchError": "bench.basics.errors",
    "Dataset": "bench.dataset.dataset",
    "Diagnosis": "bench.diagnosis.result",
    "Identification": "bench.identification.result",
    "ModelErrors": "bench.api.compare",
    "Payload": "bench.dataset.payload",
    "Recording": "bench.dataset.recording",
    "Report": "bench.api.report",
    "Robot": "bench.dataset.robot",
    "SavedModel": "bench.identification.model_file",
    "compare": "bench.api.compare",
    "diagnose": "bench.api.diagnose",
    "figures": "bench.api.figures",
    "identify": "bench.api.identify",
    "load_dataset": "bench.dataset.dataset",
    "load_model": "bench.identification.model_file",
    "load_robot": "bench.dataset.robot",
    "report": "bench.api.report",
    "save_model": "bench.api.sources",
    "simulate": "bench.api.simulate",
}
"""Public name -> the module that defines it; in step with the imports above, which type checkers read."""

__all__ = [
    "BenchError",
    "Dataset",
    "Diagnosis",
    "Identification",
    "ModelErrors",
    "Payload",
    "Recording",
    "Report",
    "Robot",
    "SavedModel",
    "compare",
    "diagnose",
    "figures",
    "identify",
    "load_dataset",
    "load_model",
    "load_robot",
    "report",
    "save_model",
    "simulate",
]


def __getattr__(name: str) -> Any:
    if name == "__version__":
        try:
            return version("parabench")
        except PackageNotFoundError:
            raise AttributeError(
                "bench has no version: parabench is on the path, but not installed"
            ) from None
    if name not in _HOME_OF:
        raise AttributeError(f"module 'bench' has no attribute {name!r}")
    value = getattr(importlib.import_module(_HOME_OF[name]), name)
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return sorted(__all__)
