"""The columns common to all models of a dataset, orthogonalised once; those of effects are compressed with them."""

from collections.abc import Hashable, Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from bench.dataset.payload import Payload
from bench.identification.compressed import Stack, stack_observations
from bench.identification.identifiability_of_effects import orthonormal
from bench.identification.layout import ParameterLayout
from bench.identification.observation import Observation
from bench.identification.tolerances import TOLERANCES


@dataclass(frozen=True)
class FixedColumns:
    """The stack of a model without effects, and for every motor an orthonormal basis (n, M, r) of its columns.

    triangles (n, r, p + 2): the columns [phi, kappa, current] in that basis. of: their source. spans: see `span`, by
    the columns.
    """

    stack: Stack
    bases: np.ndarray
    triangles: np.ndarray
    of: tuple[Hashable, ...]
    observations: tuple[Observation, ...]
    spans: dict[bytes, np.ndarray] = field(default_factory=dict, repr=False)

    def span(self, columns: np.ndarray, rows: int) -> np.ndarray:
        """An orthonormal basis (n, rows, b) of columns (k,) in factors with this number of rows per motor."""
        known = self.spans.get(columns.tobytes())
        if known is None:
            n, r, _ = self.triangles.shape
            known = orthonormal(self.triangles[:, :, columns].reshape(n * r, -1)).reshape(n, r, -1)
            self.spans[columns.tobytes()] = known
        return np.concatenate((known, np.zeros((len(known), rows - known.shape[1], known.shape[2]))), axis=1)


def fixed_columns(
    observations: Sequence[Observation], layout: ParameterLayout, payloads: Mapping[str, Payload]
) -> FixedColumns | None:
    """The orthogonalised columns of all models; None if they are too many to keep, or rows are fewer than columns."""
    stack = stack_observations(
        [replace(observation, effects=observation.effects[:, :, :0]) for observation in observations],
        replace(layout, effects=0),
        payloads,
    )
    samples, n, p = stack.phi.shape
    if samples < p + 2 or 8 * samples * n * (p + 2) > TOLERANCES.memory.fixed_bytes:
        return None
    bases, triangles = np.empty((n, samples, p + 2)), np.empty((n, p + 2, p + 2))
    for j in range(n):
        rows = np.column_stack((stack.phi[:, j], stack.kappa[:, j], stack.current[:, j]))
        bases[j], triangles[j] = np.linalg.qr(rows)
    made_of = _made_of(observations, layout, payloads)
    return FixedColumns(stack, bases, triangles, made_of, tuple(observations))


def fits(
    fixed: FixedColumns,
    observations: Sequence[Observation],
    layout: ParameterLayout,
    payloads: Mapping[str, Payload],
) -> bool:
    """Whether these observations have the same columns, effects aside."""
    return fixed.of == _made_of(observations, layout, payloads)


def stacked_with_fixed(fixed: FixedColumns, observations: Sequence[Observation]) -> Stack:
    """As `stack_observations`, of observations with other effects; factors have as many rows as a motor needs."""
    stack = fixed.stack
    effects = np.concatenate([observation.effects for observation in observations]) * stack.moving[:, :, None]
    n, p, e = stack.phi.shape[1], stack.phi.shape[2], effects.shape[2]
    shown = effects.any(axis=0)
    factors = np.zeros((n, p + 2 + int(shown.sum(axis=1).max(initial=0)), p + e + 2))
    factors[:, : p + 2, :p], factors[:, : p + 2, p + e :] = (
        fixed.triangles[:, :, :p],
        fixed.triangles[:, :, p:],
    )
    for j, basis in enumerate(fixed.bases):
        shown_columns = np.flatnonzero(shown[j])
        remainder = effects[:, j, shown_columns]
        for _ in range(2):  # the second time for the rounding errors of the first
            within = basis.T @ remainder
            remainder = remainder - basis @ within
            factors[j, : p + 2, p + shown_columns] += within.T
        triangle = np.asarray(np.linalg.qr(remainder, mode="r"))
        factors[j, p + 2 : p + 2 + len(triangle), p + shown_columns] = triangle.T
    phi = np.concatenate((stack.phi, effects), axis=2)
    return replace(stack, phi=phi, factors=factors)


def _made_of(
    observations: Sequence[Observation], layout: ParameterLayout, payloads: Mapping[str, Payload]
) -> tuple[Hashable, ...]:
    carried = tuple((name, index.tobytes(), id(payloads[name])) for name, index in layout.payloads.items())
    seen = (
        (id(observation.rigid), id(observation.payload), id(observation.redundant), observation.payload_name)
        for observation in observations
    )
    return layout.redundant, carried, *seen
