"""A tilted base in an exported file: gravity along another direction, where the data tell what it then moves."""

from dataclasses import replace

import numpy as np

from bench.export.identified import EffectValues, IdentifiedModel
from bench.model.bounds import RANKS
from bench.model.regressor import projected_regressor
from bench.model.states import random_motion

SEED = 20121001
STATES = 40


def tilted(gravity: np.ndarray, tilt: EffectValues) -> np.ndarray:
    """Gravity (3,) as the tilted base feels it: Ry(-tilt_y) Rx(-tilt_x) g, see `BaseTilt`."""
    from scipy.spatial.transform import Rotation  # noqa: PLC0415 - slow to import, and seldom needed

    vertical = int(np.argmax(np.abs(gravity)))
    turned = gravity
    for axis, angle in (
        ((vertical + 1) % 3, tilt.values["tilt_x"]),
        ((vertical + 2) % 3, tilt.values["tilt_y"]),
    ):
        turned = Rotation.from_rotvec(-angle * np.eye(3)[axis]).apply(turned)
    return np.asarray(turned)


def still_determined(model: IdentifiedModel, gravity: np.ndarray) -> bool:
    """Whether the base parameters give all torques under another gravity, too.

    They do not where it moves masses that gravity never moved before: then the choice of bodies would decide.
    """
    geometry, base = model.model.geometry, model.model.base
    other = replace(geometry, gravity=gravity)
    motion = random_motion(geometry, STATES, SEED)
    count = 10 * len(geometry.joints)
    every = np.flatnonzero(np.any(base.grouping != 0.0, axis=0))
    carried = [10 * joint + k for joint, _ in geometry.bodies for k in range(10)]
    columns = np.array(sorted({*every.tolist(), *carried}))
    whole = projected_regressor(other, motion, columns).reshape(-1, len(columns))
    kept = base.columns[base.columns < count]
    rows = projected_regressor(other, motion, kept).reshape(-1, len(kept))
    follows = rows @ base.grouping[: len(kept)][:, columns]
    size = np.linalg.norm(whole, axis=0).max()
    return bool(np.linalg.norm(whole - follows, axis=0).max() < 10.0 * RANKS.slack * size)
