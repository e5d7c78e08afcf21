"""The currents of one or more models of the same recordings as one Parquet file, in full precision.

Columns: recording, time, KIND.JOINT for each of `MEASURED`, then for model k modelled.k.JOINT and, for each of its
effects, effect.k.NAME.JOINT.
"""

from collections.abc import Sequence
from pathlib import Path

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq

from bench.basics.errors import BenchError
from bench.basics.files.atomic import atomic_path
from bench.dataset.dataset import Dataset
from bench.identification.result import CurrentSeries

MEASURED = ("measured", "position", "velocity", "acceleration", "moving")


def write_series(path: Path, models: Sequence[Sequence[CurrentSeries]], joints: Sequence[str]) -> None:
    """Write the models' currents, whole or not at all. Raises ValueError if they are of different rows."""
    first = models[0]
    for model in models[1:]:
        for trace, other in zip(first, model, strict=True):
            same = all(np.array_equal(getattr(trace, kind), getattr(other, kind)) for kind in MEASURED)
            if trace.name != other.name or not same:
                raise ValueError(f"{other.name}: measured in other rows than {trace.name}")
    lengths = [len(trace.time) for trace in first]
    names = pa.array([trace.name for trace in first], pa.string())
    columns: dict[str, pa.Array] = {
        "recording": pa.DictionaryArray.from_arrays(np.repeat(np.arange(len(first)), lengths), names),
        "time": pa.array(np.concatenate([trace.time for trace in first])),
    }

    def add(name: str, blocks: Sequence[np.ndarray]) -> None:
        values = np.concatenate(blocks)
        for j, joint in enumerate(joints):
            columns[f"{name}.{joint}"] = pa.array(values[:, j])

    for kind in MEASURED:
        add(kind, [getattr(trace, kind) for trace in first])
    for k, model in enumerate(models):
        add(f"modelled.{k}", [trace.modelled for trace in model])
        for effect in model[0].by_effect:
            add(f"effect.{k}.{effect}", [trace.by_effect[effect] for trace in model])
    with atomic_path(path) as partial:
        pq.write_table(pa.table(columns), partial)


def read_series(
    path: Path, dataset: Dataset, effects: Sequence[Sequence[str]]
) -> tuple[tuple[CurrentSeries, ...], ...]:
    """The models' currents in the dataset's recordings. effects: names of each model's effects.

    Raises BenchError if the file cannot be read, or is of other recordings, joints or models.
    """
    try:
        table = pq.read_table(path)
    except OSError as error:
        raise BenchError(f"{path}: {error.strerror or 'not a Parquet file'}") from None
    except pa.ArrowException:
        raise BenchError(f"{path}: not a Parquet file") from None
    joints = dataset.robot.joints
    kinds = [*MEASURED, *(f"modelled.{k}" for k in range(len(effects)))]
    kinds += [f"effect.{k}.{name}" for k, names in enumerate(effects) for name in names]
    expected = ["recording", "time", *(f"{kind}.{joint}" for kind in kinds for joint in joints)]
    if sorted(table.column_names) != sorted(expected):
        raise BenchError(f"{path}: of other joints or models than this result")
    recording = np.asarray(table["recording"].cast(pa.string()), dtype=str)
    if set(recording.tolist()) != {logged.name for logged in dataset.recordings}:
        raise BenchError(f"{path}: of other recordings than this result")
    of_joints = {kind: [table[f"{kind}.{joint}"].to_numpy() for joint in joints] for kind in kinds}
    values = {kind: np.column_stack(columns) for kind, columns in of_joints.items()}
    time = table["time"].to_numpy()
    models = []
    for k, names in enumerate(effects):
        model = []
        for logged in dataset.recordings:
            rows, about = recording == logged.name, (logged.name, logged.use, logged.payload)
            measured = {kind: values[kind][rows] for kind in MEASURED}
            by_effect = {name: values[f"effect.{k}.{name}"][rows] for name in names}
            modelled = values[f"modelled.{k}"][rows]
            model.append(
                CurrentSeries(*about, time[rows], modelled=modelled, by_effect=by_effect, **measured)
            )
        models.append(tuple(model))
    return tuple(models)
