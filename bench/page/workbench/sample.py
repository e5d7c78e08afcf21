"""A thinned sample of every recording, from which the page draws its curves."""

from typing import Any

import numpy as np

from bench.page.workbench.diagnosed_model import DiagnosedModel
from bench.page.workbench.encode import floats, quantised
from bench.page.workbench.system import PageSystem

BYTES = 560_000  # of all quantised columns together, at two bytes each
FEWEST, MOST = 60, 500  # rows of a recording


def thinned(model: DiagnosedModel, system: PageSystem, kept: np.ndarray) -> list[dict[str, Any]]:
    """Every recording at evenly spaced rows of the fit, with the columns that are kept for each motor (n, C).

    Of the measured current each stretch around such a row also has its smallest and largest value.
    """
    used = [np.flatnonzero(entry) for entry in kept]
    lengths = [len(observation.time) for observation in model.plain.observations]
    wanted = BYTES / (2 * sum(len(values) for values in used) * len(lengths))
    step = max(1, int(np.ceil(max(lengths) / min(max(wanted, FEWEST), MOST))))
    samples, start = [], 0
    for observation in model.plain.observations:
        rows = start + np.arange(step // 2, len(observation.time), step)
        edges = np.arange(0, len(observation.time), step)
        motors = []
        for j, columns in enumerate(used):
            measured, modelled = observation.current[:, j], (system.measured - system.error)[rows, j]
            moving = system.moving[rows, j]
            motors.append(
                {
                    "columns": columns.tolist(),
                    **quantised(system.columns[rows][:, j, columns]),
                    "modelled": floats(np.where(moving, modelled, np.nan)),
                    "measured": floats(measured[rows - start]),
                    "low": floats(np.minimum.reduceat(measured, edges)[: len(rows)]),
                    "high": floats(np.maximum.reduceat(measured, edges)[: len(rows)]),
                }
            )
        samples.append(
            {
                "name": observation.name,
                "use": observation.use,
                "payload": observation.payload_name,
                "rows": len(observation.time),
                "step": step,
                "time": floats(observation.time[rows - start]),
                "motors": motors,
            }
        )
        start += len(observation.time)
    return samples
