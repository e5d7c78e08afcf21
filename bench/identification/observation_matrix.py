"""The observation matrix with the columns that models of all recordings share."""

import numpy as np

from bench.model.geometry import Geometry
from bench.model.model import IdentificationModel
from bench.model.motion import Motion
from bench.model.regressor import payload_transform, projected_regressor, redundant_columns


def machine_rows(model: IdentificationModel, geometry: Geometry, tree: Motion) -> np.ndarray:
    """Columns (K, n, nb + 10 + r) of the base parameters, of a payload in the tool frame, zero without a tool, and of a
    unit torque of each redundant motor.
    """
    base_columns, redundant = model.base.columns, redundant_columns(geometry)
    nb, tool = len(base_columns), geometry.tool
    load = np.zeros(0, dtype=int) if tool is None else model.payload_columns
    rows = projected_regressor(geometry, tree, np.concatenate((base_columns, load, redundant)))
    if tool is None:
        return np.insert(rows, [nb] * 10, 0.0, axis=2)
    loaded = rows[:, :, nb : nb + 10]
    loaded[:] = loaded @ payload_transform(tool)
    return rows
