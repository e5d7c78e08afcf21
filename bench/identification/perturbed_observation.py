"""The observation matrix of a recording with another motion, gravity or geometry. It is kept, since effects ask for the
same change whenever the model has new parameters. Large matrices are kept only for other gravities, which are few, and
other lengths: there is no room for those of all motions.
"""

from collections.abc import Hashable, Sequence
from dataclasses import dataclass, replace
from hashlib import blake2b

import numpy as np

from bench.effects.signals import UNCHANGED, Changed
from bench.identification.filtered import Measured
from bench.identification.tolerances import TOLERANCES
from bench.model.geometry import Anchor, Geometry
from bench.model.model import IdentificationModel
from bench.model.motion import Motion, motion_near, motion_of
from bench.model.regressor import projected_regressor


def perturbed_rows(
    model: IdentificationModel, measured: Measured, columns: np.ndarray, changed: Changed, every: int
) -> np.ndarray:
    """Rows (K, n, p), N*m or N, of some columns of the projected regressor, one per `every` samples.

    Raises BenchError where the loops cannot be closed.
    """
    motion, gravity, geometry = changed.motion, changed.gravity, changed.geometry
    reshaped = geometry is not None and not _same_lengths(geometry, model.geometry)
    kept = measured.reshaped if reshaped else measured.perturbed
    key = (columns.tobytes(), change_key(changed, every))
    rows = kept.get(key)
    if rows is not None:
        return rows
    if gravity is not None and geometry is None and motion is None:
        rows = _turned(model, measured, columns, gravity, every)
    else:
        other = model.geometry if geometry is None else geometry
        if gravity is not None:
            other = replace(other, gravity=gravity)
        rows = projected_regressor(other, _motion(model, measured, other, motion, every), columns)
        if geometry is not None or rows.nbytes <= TOLERANCES.memory.force_bytes:
            kept.keep(key, rows)
    return rows


def change_key(changed: Changed, every: int) -> Hashable:
    """Key of a change at one per `every` samples."""
    motion, gravity, geometry = changed.motion, changed.gravity, changed.geometry
    return (
        every,
        None if motion is None else _digest(motion),
        None if gravity is None else gravity.tobytes(),
        None if geometry is None else geometry_key(geometry),
    )


def _turned(
    model: IdentificationModel, measured: Measured, columns: np.ndarray, gravity: np.ndarray, every: int
) -> np.ndarray:
    """Rows with another gravity, in which they are linear: from those with 1 m/s2 more along each axis."""
    nominal = model.geometry.gravity
    unchanged = perturbed_rows(model, measured, columns, UNCHANGED, every)
    rows = unchanged.copy()
    for axis, change in zip(np.eye(3), gravity - nominal, strict=True):
        if change:
            more = Changed(geometry=replace(model.geometry, gravity=nominal + axis))
            rows += change * (perturbed_rows(model, measured, columns, more, every) - unchanged)
    return rows


def _motion(
    model: IdentificationModel,
    measured: Measured,
    geometry: Geometry,
    motion: tuple[np.ndarray, np.ndarray, np.ndarray] | None,
    every: int,
) -> Motion:
    step = slice(None, None, every)
    tree = measured.tree.at(step)
    if motion is None:
        if _same_lengths(geometry, model.geometry):
            return tree
        motion = measured.position[step], measured.velocity[step], measured.acceleration[step]
    return motion_of(geometry, measured.time[step], *motion, near=tree)


def motion_in(
    geometry: Geometry,
    unchanged: Geometry,
    near: Motion,
    position: np.ndarray,
    velocity: np.ndarray,
    acceleration: np.ndarray,
    shift: np.ndarray,
) -> Motion:
    """The motion `near` of the unchanged geometry in another one, with a constant shift (n,) of the active positions.

    position, velocity, acceleration (K, n): of the active joints without it. Raises BenchError if the loops cannot be
    closed.
    """
    if not shift.any() and _same_lengths(geometry, unchanged):
        return near
    return motion_near(geometry, near, position + shift, velocity, acceleration)


def _same_lengths(geometry: Geometry, other: Geometry) -> bool:
    """Whether loops close alike in both, gravity aside."""
    return _numbers(geometry)[1:] == _numbers(other)[1:]


def _numbers(geometry: Geometry) -> list[bytes]:
    """Gravity first, then all that closures and regressor depend on and an effect may change."""
    anchors = [anchor for loop in geometry.loops for anchor in (loop.first, loop.second)]
    places: list[Anchor | None] = [*anchors, geometry.tool]
    parts = [geometry.gravity.tobytes(), geometry.home.tobytes(), geometry.active_offset.tobytes()]
    for joint in geometry.joints:
        parts += [joint.placement.rotation.tobytes(), joint.placement.translation.tobytes()]
        parts += [joint.axis.tobytes(), repr((joint.kind, joint.parent)).encode()]
    for anchor in places:
        if anchor is not None:
            parts += [anchor.placement.rotation.tobytes(), anchor.placement.translation.tobytes()]
    return parts


def geometry_key(geometry: Geometry) -> bytes:
    """Key of a geometry, gravity included."""
    return _digest(_numbers(geometry))


def _digest(parts: Sequence[np.ndarray | bytes]) -> bytes:
    digest = blake2b(digest_size=16)
    for part in parts:
        digest.update(part if isinstance(part, bytes) else np.ascontiguousarray(part).tobytes())
    return digest.digest()


KEPT = np.float32  # small changes need no more digits


@dataclass(frozen=True)
class SmallChange:
    """K samples of n motors and p columns each; filled (c,): those of the n p that change, values (K, c)."""

    filled: np.ndarray
    values: np.ndarray
    shape: tuple[int, int]

    def rows(self, part: slice) -> np.ndarray:
        """The change at some of the samples, (P, n, p)."""
        values = self.values[part]
        rows = np.zeros((len(values), self.shape[0] * self.shape[1]), dtype=KEPT)
        rows[:, self.filled] = values
        return rows.reshape(-1, *self.shape)


def small_change(rows: np.ndarray) -> SmallChange:
    """The small change of all columns, from rows (K, n, p)."""
    samples, n, p = rows.shape
    flat = rows.astype(KEPT, order="C").reshape(samples, n * p)
    filled = np.flatnonzero(flat.any(axis=0))
    return SmallChange(filled, flat[:, filled], (n, p))
