"""What a program hands over: a dataset or a model that is loaded, or the path of one."""

from pathlib import Path

from bench.dataset.dataset import Dataset, load_dataset
from bench.identification.model_file import SavedModel, load_model
from bench.identification.result import Identification

Data = Dataset | str | Path
"""A dataset, or the folder of one."""

Model = Identification | SavedModel | str | Path
"""A model just identified, or the file of one."""


def as_dataset(data: Data) -> Dataset:
    """The dataset itself, or that of the folder. Raises BenchError naming what is wrong with it."""
    return data if isinstance(data, Dataset) else load_dataset(data)


def as_model(model: SavedModel | str | Path) -> SavedModel:
    """The saved model itself, or that of the file. Raises BenchError naming what is wrong with it."""
    return model if isinstance(model, SavedModel) else load_model(Path(model))
