"""The columns of a log as the page shows them, and guesses of their meaning."""

from pathlib import Path
from typing import Any

import numpy as np

from bench.dataset.logs.columns import GROUPS, glimpse
from bench.dataset.logs.guess import guesses
from bench.dataset.logs.log_file import LogFile, Reading
from bench.dataset.logs.ros_bag import is_bag, joint_topics
from bench.dataset.logs.units import stated_units, units_of
from bench.dataset.robot import Robot

POINTS = 160  # of a column's thumbnail


def look_at(path: str, robot: Robot, topic: str | None = None, skip_rows: int = 0) -> dict[str, Any]:
    """The columns of the log in a file; see `columns_of`. Raises BenchError if it cannot be read.

    The answer has `topics`: those of a ROS bag that hold joint states; if there are several and `topic` is None, it has
    no columns. skip_rows: lines to skip at the top of a text file.
    """
    topics = joint_topics(Path(path)) if is_bag(Path(path)) else ()
    if len(topics) > 1 and topic is None:
        return {"topics": topics}
    return {**columns_of(glimpse(Path(path), Reading(skip_rows, topic=topic)), robot), "topics": topics}


def columns_of(log: LogFile, robot: Robot) -> dict[str, Any]:
    """Every column of a log with its thumbnail; for each column of a recording, guesses of its source and its units.

    stated: units that the log itself states, which an import uses unless others are given. units: the first is SI.
    """
    names = [*log.vectors, *log.texts]
    stated = stated_units(log.units)
    columns = [{"name": name, **_seen(log.vectors.get(name, np.empty(0)))} for name in names]
    needs = ["time", *(f"{kind}.{joint}" for kind in GROUPS for joint in robot.driven)]
    return {
        "robot": robot.name,
        "needs": needs,
        "columns": columns,
        "stated": stated,
        "guesses": guesses(names, robot, stated, log.vectors),
        "units": {column: units_of(column, robot) for column in needs},
        "notes": list(log.notes),
    }


def _seen(values: np.ndarray) -> dict[str, Any]:
    """Range, and at most `POINTS` evenly spaced values."""
    known = values[np.isfinite(values)]
    rows = np.unique(np.linspace(0, max(values.size - 1, 0), min(POINTS, values.size)).astype(int))
    return {
        "low": float(known.min()) if known.size else None,
        "high": float(known.max()) if known.size else None,
        "picture": [float(value) if np.isfinite(value) else None for value in values[rows]],
    }
