"""The observation matrix of a recording where its motion, gravity or geometry is another: kept, since effects ask
for the same change again whenever the model has new parameters.
"""

from collections.abc import Sequence
from dataclasses import replace
from hashlib import blake2b

import numpy as np

from bench.identification.filtered import Measured
from bench.model.geometry import Anchor, Geometry
from bench.model.model import IdentificationModel
from bench.model.motion import Motion, motion_of
from bench.model.regressor import projected_regressor


def perturbed_rows(
    model: IdentificationModel,
    measured: Measured,
    columns: np.ndarray,
    active: Sequence[np.ndarray | None],
    gravity: np.ndarray | None,
    geometry: Geometry | None,
    every: int,
) -> np.ndarray:
    """Rows (K, n, p) of some columns of the projected regressor at every so many-th sample, N*m or N.

    active: positions, velocities and accelerations (K, n) of the active joints, None where they are as measured;
    gravity (3,) m/s2 and geometry likewise. Raises BenchError where the loops cannot be closed.
    """
    key = (
        every,
        columns.tobytes(),
        *(None if one is None else _digest([one]) for one in active),
        None if gravity is None else gravity.tobytes(),
        None if geometry is None else geometry_key(geometry),
    )
    rows = measured.perturbed.get(key)
    if rows is not None:
        return rows
    if gravity is not None and geometry is None and all(one is None for one in active):
        rows = _turned(model, measured, columns, gravity, every)
    else:
        changed = model.geometry if geometry is None else geometry
        if gravity is not None:
            changed = replace(changed, gravity=gravity)
        rows = projected_regressor(changed, _motion(model, measured, changed, active, every), columns)
        measured.perturbed.keep(key, rows)
    return rows


def _turned(
    model: IdentificationModel, measured: Measured, columns: np.ndarray, gravity: np.ndarray, every: int
) -> np.ndarray:
    """Rows with another gravity, of which they are a linear function: from those with one m/s2 more each way."""
    own = model.geometry.gravity
    here = perturbed_rows(model, measured, columns, (None,) * 3, None, None, every)
    rows = here.copy()
    for axis, change in zip(np.eye(3), gravity - own, strict=True):
        if change:
            more = replace(model.geometry, gravity=own + axis)
            rows += change * (perturbed_rows(model, measured, columns, (None,) * 3, None, more, every) - here)
    return rows


def _motion(
    model: IdentificationModel,
    measured: Measured,
    changed: Geometry,
    active: Sequence[np.ndarray | None],
    every: int,
) -> Motion:
    step = slice(None, None, every)
    tree = measured.tree.at(step)
    if all(one is None for one in active) and _numbers(changed)[1:] == _numbers(model.geometry)[1:]:
        return tree
    logged = (measured.position, measured.velocity, measured.acceleration)
    given = [x[step] if one is None else one for x, one in zip(logged, active, strict=True)]
    return motion_of(changed, measured.time[step], *given, near=tree)


def _numbers(geometry: Geometry) -> list[bytes]:
    """Gravity first, then all that closures and regressor depend on and an effect may change."""
    anchors = [anchor for loop in geometry.loops for anchor in (loop.first, loop.second)]
    places: list[Anchor | None] = [*anchors, geometry.tool]
    found = [geometry.gravity.tobytes(), geometry.home.tobytes(), geometry.active_offset.tobytes()]
    for joint in geometry.joints:
        found += [joint.placement.rotation.tobytes(), joint.placement.translation.tobytes()]
        found += [joint.axis.tobytes(), repr((joint.kind, joint.parent)).encode()]
    for anchor in places:
        if anchor is not None:
            found += [anchor.placement.rotation.tobytes(), anchor.placement.translation.tobytes()]
    return found


def geometry_key(geometry: Geometry) -> bytes:
    """What tells a geometry from another, gravity included."""
    return _digest(_numbers(geometry))


def _digest(parts: Sequence[np.ndarray | bytes]) -> bytes:
    found = blake2b(digest_size=16)
    for part in parts:
        found.update(part if isinstance(part, bytes) else np.ascontiguousarray(part).tobytes())
    return found.digest()
