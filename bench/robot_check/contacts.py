"""Geoms of an MJCF that MuJoCo lets collide: neither the model nor the simulated machine has contacts."""

from collections import Counter
from collections.abc import Iterator
from dataclasses import asdict, dataclass

import mujoco
import numpy as np

from bench.model.geometry import Geometry, to_mujoco
from bench.robot_check.machine import body_label
from bench.robot_check.outcome import Check, CheckCode


@dataclass(frozen=True)
class GeomPair:
    """Two geoms: their names, "" without one, their shapes and bodies. listed: whether a <pair> of the MJCF has both,
    which then collide whatever their contype.
    """

    geoms: tuple[str, str]
    shapes: tuple[str, str]
    bodies: tuple[str, str]
    listed: bool


def geom_pair(compiled: mujoco.MjModel, first: int, second: int) -> GeomPair:
    """Two geoms, by index."""
    listed = {*zip(compiled.pair_geom1.tolist(), compiled.pair_geom2.tolist(), strict=True)}
    geoms, shapes, bodies = zip(
        *(
            (
                compiled.geom(geom).name,
                mujoco.mjtGeom(int(compiled.geom_type[geom])).name.removeprefix("mjGEOM_").lower(),
                body_label(compiled, int(compiled.geom_bodyid[geom])),
            )
            for geom in (first, second)
        ),
        strict=True,
    )
    return GeomPair(geoms, shapes, bodies, (first, second) in listed or (second, first) in listed)


def active_contacts(data: mujoco.MjData) -> Iterator[tuple[int, tuple[int, int]]]:
    """Contacts that push, by index, each with its two geoms."""
    for index in range(data.ncon):
        contact = data.contact[index]
        first, second = sorted(contact.geom.tolist())
        if contact.efc_address >= 0 and first >= 0:  # a flexible body has no geoms
            yield index, (first, second)


def check_contacts(geometry: Geometry, poses: np.ndarray) -> list[Check]:
    """A note if geoms touch at home or at the closed poses (N, nq)."""
    compiled = geometry.robot.mjcf_model()
    data = mujoco.MjData(compiled)
    at_home, *others = (
        _touching(compiled, data, to_mujoco(geometry.joints, q[None])[0]) for q in (geometry.home, *poses)
    )
    often = Counter(pair for pairs in others for pair in pairs).most_common()
    pairs = list(dict.fromkeys([*at_home, *(pair for pair, _ in often)]))
    if not pairs:
        return []
    values = {
        "pairs": [asdict(geom_pair(compiled, *pair)) for pair in pairs],
        "at_home": bool(at_home),
        "touching": sum(bool(pairs) for pairs in others),
        "poses": len(others),
    }
    return [Check(CheckCode.GEOMS_TOUCH, "note", values)]


def _touching(compiled: mujoco.MjModel, data: mujoco.MjData, qpos: np.ndarray) -> list[tuple[int, int]]:
    data.qpos[:] = qpos
    mujoco.mj_fwdPosition(compiled, data)
    return list(dict.fromkeys(pair for _, pair in active_contacts(data)))
