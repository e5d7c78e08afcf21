"""The identification model of a robot: everything that depends on its geometry alone, computed once."""

from dataclasses import dataclass

import numpy as np

from bench.errors import BenchError
from bench.model.base import BaseParameters, base_parameters
from bench.model.geometry import Geometry, read_geometry
from bench.model.mobility import check_assembled, check_mobility
from bench.model.regressor import payload_transform
from bench.robot import Robot


@dataclass(frozen=True)
class IdentificationModel:
    """Geometry and base parameters; `payload` (10, 10) takes payload parameters to the body at the tool."""

    geometry: Geometry
    base: BaseParameters
    payload: np.ndarray | None

    @property
    def payload_columns(self) -> np.ndarray:
        """Columns of `projected_regressor` of the body that carries the tool, (10,)."""
        if self.geometry.tool is None:
            raise BenchError(f"robot {self.geometry.robot.name}: a payload needs [tool] site in robot.toml")
        return np.arange(10) + 10 * self.geometry.tool.joint


def build_model(robot: Robot) -> IdentificationModel:
    """Read the geometry, check home and that the loops determine every passive joint, find the base parameters."""
    geometry = read_geometry(robot)
    check_assembled(geometry)
    check_mobility(geometry)
    payload = None if geometry.tool is None else payload_transform(geometry.tool)
    return IdentificationModel(geometry, base_parameters(geometry), payload)
