"""The identification model of a robot: everything that depends only on its geometry, computed once."""

from dataclasses import dataclass
from functools import cached_property, lru_cache

import numpy as np

from bench.basics.errors import BenchError
from bench.dataset.robot import Robot
from bench.model.base import BaseParameters, base_parameters
from bench.model.bounds import MEMORY, RANDOM_POSES
from bench.model.geometry import Geometry, read_geometry
from bench.model.guess import guessed_parameters
from bench.model.mobility import check_assembled, check_mobility
from bench.model.regressor import payload_transform, projected_regressor, redundant_columns
from bench.model.states import random_motion

SEED = 20120602  # of the states at which identifiability is decided


@dataclass(frozen=True)
class IdentificationModel:
    """Geometry and base parameters; `payload` (10, 10) transforms payload parameters to the tool's body."""

    geometry: Geometry
    base: BaseParameters
    payload: np.ndarray | None

    @property
    def payload_columns(self) -> np.ndarray:
        """Columns of `projected_regressor` of the body that carries the tool, (10,)."""
        if self.geometry.tool is None:
            raise BenchError(f"robot {self.geometry.robot.name}: a payload needs [tool] site in robot.toml")
        return np.arange(10) + 10 * self.geometry.tool.joint

    @cached_property
    def guessed(self) -> np.ndarray:
        """Base parameters (nb,) of bars from joint to joint, for torques before a fit has better ones."""
        guessed = self.base.grouping @ guessed_parameters(self.geometry)
        guessed.setflags(write=False)
        return np.asarray(guessed)

    @cached_property
    def random_rows(self) -> tuple[np.ndarray, np.ndarray]:
        """Torque for each base parameter (s, n, nb) and each payload parameter (s, n, 10) at s random states.

        Noise-free and always the same, so decisions there never depend on data. Raises BenchError without a tool.
        """
        columns = np.concatenate((self.base.columns, self.payload_columns))
        rows = self._at_random(columns)
        nb = len(self.base.columns)
        return rows[:, :, :nb], rows[:, :, nb:] @ self.payload

    @cached_property
    def random_redundant(self) -> np.ndarray:
        """By how much a unit torque of each redundant motor relieves the others (s, n, r), likewise."""
        return self._at_random(redundant_columns(self.geometry))

    def _at_random(self, columns: np.ndarray) -> np.ndarray:
        return projected_regressor(
            self.geometry, random_motion(self.geometry, RANDOM_POSES.states, SEED), columns
        )


def build_model(robot: Robot) -> IdentificationModel:
    """Read the geometry, check home and mobility, determine the base parameters.

    A model is built once and kept while the files in the robot's folder do not change.
    """
    return _built(robot, _files(robot))


def _files(robot: Robot) -> tuple[tuple[str, int, int], ...]:
    """Every file of the robot's folder with its time of change and its size."""
    stats = [(str(path), path.stat()) for path in sorted(robot.folder.rglob("*")) if path.is_file()]
    return tuple((path, stat.st_mtime_ns, stat.st_size) for path, stat in stats)


@lru_cache(maxsize=MEMORY.geometries)
def _built(robot: Robot, _files: tuple[tuple[str, int, int], ...]) -> IdentificationModel:
    geometry = read_geometry(robot)
    check_assembled(geometry)
    check_mobility(geometry)
    payload = None if geometry.tool is None else payload_transform(geometry.tool)
    return IdentificationModel(geometry, base_parameters(geometry), payload)
