"""Rerun recordings read back with Rerun's own reader."""

import subprocess
import sys
from functools import lru_cache
from pathlib import Path

import numpy as np
from rerun.chunk import RrdReader


def batches(path, entity, static):
    """What an entity has, or with /** at the end of its name, it and those below it."""
    written = path.stat()
    chunks = _chunks(path, written.st_mtime_ns, written.st_size)[static]
    root, below, _ = entity.partition("/**")
    return [
        chunk.to_record_batch()
        for name, chunk in chunks
        if name == root or (below and name.startswith(f"{root}/"))
    ]


@lru_cache(maxsize=2)
def _chunks(path, _written, _size):
    """Names and chunks of a file as it is, which change and which are static; read once for many questions."""
    found = [(chunk.entity_path, chunk.is_static, chunk) for chunk in RrdReader(path).stream()]
    return [[(name, chunk) for name, static, chunk in found if static == wanted] for wanted in (False, True)]


def columns(path, entity):
    """Times [ns], and every component's values (N, ...), of an entity that changes in time."""
    found = batches(path, entity, static=False)
    assert found, entity
    times = np.concatenate([batch.column("time").to_numpy() for batch in found])
    names = [name for name in found[0].schema.names if ":" in name]
    values = {
        name.split(":")[1]: np.concatenate(
            [np.array([*batch.column(name).to_pylist(), None], dtype=object)[:-1] for batch in found]
        )
        for name in names
    }
    order = np.argsort(times, kind="stable")
    return times[order].astype(np.int64), {name: value[order] for name, value in values.items()}


def numbers(path, entity, component="scalars"):
    times, values = columns(path, entity)
    return times, np.array(values[component].tolist(), dtype=float)[:, 0]


def static_value(path, entity, component):
    (batch,) = batches(path, entity, static=True)
    return batch.column(component).to_pylist()[0]


def origins(path):
    """The entities at which the saved views look."""
    found = set()
    reader = RrdReader(path)
    (views,) = reader.blueprints()
    for chunk in reader.stream(store=views):
        batch = chunk.to_record_batch()
        for column in batch.schema.names:
            if column.endswith(":space_origin"):
                found.update(value for row in batch.column(column).to_pylist() for value in row or ())
    return found


def verified(path):
    program = Path(sys.executable).with_name("rerun")
    command = [str(program), "rrd", "verify", str(path)]
    return subprocess.run(command, capture_output=True, timeout=60, check=False).returncode == 0
