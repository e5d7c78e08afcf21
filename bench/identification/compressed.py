"""The fitted recordings as one over-determined system, compressed by QR without loss."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from bench.dataset.payload import Payload
from bench.identification.layout import ParameterLayout, known_rows, regressor_rows
from bench.identification.observation import Observation
from bench.identification.tolerances import TOLERANCES
from bench.model.motion import blocks_of
from bench.signals.returning import Course


@dataclass(frozen=True)
class Stack:
    """All rows of the fit: diag(v) g = Phi theta + kappa (equation 11), M samples of n motors.

    Rows of a joint at standstill are zero and `moving` (M, n) is False there. phi (M, n, p) torque or force for each
    unit of theta; kappa (M, n) torque of the known payload parameters; current (M, n); starts: the first row of every
    recording. factors (n, r, p + 2): for every motor a few rows with the same inner products as its [phi, kappa,
    current]. courses: the motion of every recording, where known.
    """

    phi: np.ndarray
    kappa: np.ndarray
    current: np.ndarray
    moving: np.ndarray
    starts: tuple[int, ...]
    factors: np.ndarray
    courses: tuple[Course, ...] = ()

    @property
    def returns(self) -> tuple[float | None, ...]:
        """For every recording, the period of its motion in rows; None where it does not return."""
        if not self.courses:
            return (None,) * len(self.starts)
        return tuple(course.returns for course in self.courses)

    @property
    def scaled(self) -> bool:
        """Whether a known payload gives the scale, so that the drive gains can be identified."""
        return bool(np.any(self.kappa))


def stack_observations(
    observations: Sequence[Observation], layout: ParameterLayout, payloads: Mapping[str, Payload]
) -> Stack:
    """Stack the equations of several recordings."""
    moving = np.concatenate([observation.moving for observation in observations])
    phi = (
        np.concatenate([regressor_rows(observation, layout) for observation in observations])
        * moving[:, :, None]
    )
    kappa = np.concatenate([known_rows(observation, payloads) for observation in observations]) * moving
    current = np.concatenate([observation.current for observation in observations]) * moving
    lengths = [len(observation.time) for observation in observations]
    starts = tuple(int(start) for start in np.cumsum([0, *lengths[:-1]]))
    courses = tuple(observation.course for observation in observations)
    return Stack(phi, kappa, current, moving, starts, compress(phi, kappa, current), courses)


def compress(phi: np.ndarray, kappa: np.ndarray, current: np.ndarray) -> np.ndarray:
    """Triangular factors (n, p + 2, p + 2) of [phi, kappa, current], motor by motor."""
    samples, n, p = phi.shape
    factors = np.zeros((n, p + 2, p + 2))
    for rows in blocks_of(samples, TOLERANCES.memory.compressed_rows):
        part = np.concatenate((phi[rows], kappa[rows, :, None], current[rows, :, None]), axis=2)
        if rows.start:
            part = np.concatenate((factors.swapaxes(0, 1), part))
        factors = triangular_factors(part)
    return factors


def with_known(stack: Stack, columns: np.ndarray, values: np.ndarray) -> Stack:
    """The stack with the torque of some columns (k,) at values (k,) added to the known torque."""
    kappa = stack.kappa + stack.phi[:, :, columns] @ values
    factors = stack.factors.copy()
    factors[:, :, -2] += factors[:, :, columns] @ values
    return replace(stack, kappa=kappa, factors=factors)


def triangular_factors(columns: np.ndarray) -> np.ndarray:
    """Triangular factors (n, k, k) of columns (M, n, k), motor by motor."""
    size = columns.shape[2]
    factors = np.zeros((columns.shape[1], size, size))
    for j in range(columns.shape[1]):
        factor = np.linalg.qr(columns[:, j], mode="r")
        factors[j, : len(factor)] = factor
    return factors
