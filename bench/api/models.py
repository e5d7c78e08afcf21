"""Models on disk."""

from pathlib import Path

from bench.api.sources import Data, as_dataset
from bench.identification.model_file import save_model as write_model
from bench.identification.result import Identification


def save_model(result: Identification, path: str | Path, data: Data | None = None) -> Path:
    """Write an identified model as JSON, whole or not at all; data: what it is from, for the file to name it."""
    folder = as_dataset(data).folder if data is not None else None
    write_model(result, Path(path), folder)
    return Path(path)
