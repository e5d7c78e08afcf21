"""Models on disk."""

from pathlib import Path

from bench.api.sources import Data, as_dataset
from bench.basics.errors import BenchError
from bench.identification.model_file import SavedModel
from bench.identification.model_file import save_model as write_model
from bench.identification.result import Identification


def save_model(result: Identification | SavedModel, path: str | Path, data: Data | None = None) -> Path:
    """Write a model, identified or loaded, as JSON, whole or not at all: the path.

    data: what it is from, for the file to name it; a loaded model knows it. Raises BenchError naming what cannot be
    written, or is no model.
    """
    if not isinstance(result, Identification | SavedModel):
        raise BenchError(
            f"save_model: a {type(result).__name__} is not a model; give a result of identify or load_model, or a "
            "diagnosis's `after`"
        )
    folder = as_dataset(data).folder if data is not None else None
    write_model(result, Path(path), folder)
    return Path(path)
