"""Arguments of the API's functions: a dataset or a model, loaded or as a path."""

from pathlib import Path

from bench.basics.errors import BenchError
from bench.dataset.dataset import Dataset, load_dataset
from bench.diagnosis.split import dataset_of
from bench.identification.model_file import SavedModel
from bench.identification.model_file import save_model as write_model
from bench.identification.result import Identification

Data = Dataset | str | Path
"""A dataset, or the folder of one."""

Model = Identification | SavedModel | str | Path
"""An identified or a loaded model, or the file of one."""


def as_dataset(data: Data) -> Dataset:
    """The dataset itself, or the one loaded from the folder. Raises BenchError naming what is wrong with it."""
    return data if isinstance(data, Dataset) else load_dataset(data)


def dataset_behind(dataset: Dataset, result: Identification) -> Dataset:
    """The dataset with the recordings of a result, their ends held out if the result was judged on these.

    Raises BenchError naming the robot or the recording that differs, or if the result holds no currents.
    """
    folder, joints = dataset.folder, dataset.robot.joints
    cure = "give the dataset that the result was identified from, or save the result and give its file"
    if result.robot != dataset.robot.name or result.joints != tuple(joints):
        raise BenchError(
            f"{folder}: of {dataset.robot.name} ({', '.join(joints)}), but the result is of {result.robot} "
            f"({', '.join(result.joints)}): {cure}"
        )
    if not result.recordings:
        raise BenchError(f"{folder}: the result holds no currents: {cure}")
    parted = dataset_of(dataset, result.recordings)
    logged = {recording.name: recording for recording in parted.recordings}
    for trace in result.recordings:
        recording = logged.get(trace.name)
        if recording is None:
            names = ", ".join(recording.name for recording in dataset.recordings)
            raise BenchError(
                f"{folder}: there is no recording {trace.name!r}, which the result is of, among {names}: {cure}"
            )
        step = 1.0 / recording.rate
        if trace.time[0] < recording.time[0] - step or trace.time[-1] > recording.time[-1] + step:
            raise BenchError(f"{folder}: {trace.name!r} is not the recording that the result is from: {cure}")
    return parted


def save_model(result: Identification | SavedModel, path: str | Path, data: Data | None = None) -> Path:
    """Write an identified or loaded model as JSON, whole or not at all; return the path.

    data: the dataset that it was identified from, which the file names; by default the one that a loaded model names.
    Raises BenchError naming what cannot be written, or is no model.
    """
    if not isinstance(result, Identification | SavedModel):
        raise BenchError(
            f"save_model: a {type(result).__name__} is not a model; give a result of identify or load_model, or a "
            "diagnosis's `after`"
        )
    folder = as_dataset(data).folder if data is not None else None
    write_model(result, Path(path), folder)
    return Path(path)
