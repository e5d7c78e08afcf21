"""The observation matrix's rows: Pinocchio's tree regressor, projected by the loop Jacobians (eqs. 1, 6).

Standard parameters of a body, in Pinocchio's order, about its joint frame: m [kg], mx my mz [kg m],
Ixx Ixy Iyy Ixz Iyz Izz [kg m2].
"""

import numpy as np
import pinocchio as pin

from bench.model.geometry import Anchor, Geometry
from bench.model.kinematics import ancestors
from bench.model.motion import Motion
from bench.model.tree import build_tree

PARAMETERS = ("m", "mx", "my", "mz", "Ixx", "Ixy", "Iyy", "Ixz", "Iyz", "Izz")
UNITS = ("kg", "kg*m", "kg*m", "kg*m", "kg*m^2", "kg*m^2", "kg*m^2", "kg*m^2", "kg*m^2", "kg*m^2")
BLOCK = 2048  # samples projected together


def projected_regressor(geometry: Geometry, motion: Motion, columns: np.ndarray | None = None) -> np.ndarray:
    """phi_st of equation 6 at every sample: (N, n, p), in N*m or N for each standard parameter.

    `columns` picks from the 10 parameters of every joint of the geometry (a joint without a body has columns
    too, see `body_columns`); all by default.
    """
    model = build_tree(geometry)
    data = model.createData()
    regressor = pin.computeJointTorqueRegressor
    tree = data.jointTorqueRegressor.T.reshape(-1)  # Pinocchio's own memory, column after column
    chosen = np.arange(10 * len(geometry.joints)) if columns is None else np.asarray(columns)
    supports = [_support(geometry, int(column) // 10) for column in chosen]
    entries = np.concatenate(
        [model.nv * column + support for column, support in zip(chosen, supports, strict=True)]
    )
    samples, n = len(motion.time), len(geometry.active)
    rows = np.empty((samples, n, len(chosen)))
    taken = np.empty((min(BLOCK, samples), len(entries)))
    for start in range(0, samples, BLOCK):
        block = slice(start, min(start + BLOCK, samples))
        for q, v, a, out in zip(motion.q[block], motion.v[block], motion.a[block], taken, strict=False):
            regressor(model, data, q, v, a)
            tree.take(entries, out=out, mode="clip")
        _project(motion.jacobian[block], taken[: block.stop - start], supports, rows[block])
    return rows


def _support(geometry: Geometry, joint: int) -> np.ndarray:
    """Velocity indices of the joints that carry a joint's body: no other feels its parameters."""
    return np.concatenate(
        [np.arange(geometry.joints[i].v.start, geometry.joints[i].v.stop) for i in ancestors(geometry, joint)]
    )


def _project(jacobian: np.ndarray, taken: np.ndarray, supports: list[np.ndarray], rows: np.ndarray) -> None:
    """rows (K, n, p) = jacobian (K, nv, n)' regressor; of that, `taken` (K, e) has the supports' entries."""
    weights, values = jacobian.transpose(2, 1, 0).copy(), taken.T.copy()
    at = 0
    for column, support in enumerate(supports):
        sums = weights[:, support[0]] * values[at]
        for i, index in enumerate(support[1:], start=1):
            sums += weights[:, index] * values[at + i]
        rows[:, :, column] = sums.T
        at += len(support)


def body_columns(geometry: Geometry) -> np.ndarray:
    """The columns of `projected_regressor` that belong to moving bodies."""
    return np.concatenate([np.arange(10 * joint, 10 * joint + 10) for joint, _ in geometry.bodies])


def parameter_names(geometry: Geometry) -> list[tuple[str, str]]:
    """Name and unit of every column of `projected_regressor`."""
    names = []
    for joint in geometry.joints:
        owner = joint.body or f"({joint.name})"
        names += [(f"{symbol}({owner})", unit) for symbol, unit in zip(PARAMETERS, UNITS, strict=True)]
    return names


def payload_transform(anchor: Anchor) -> np.ndarray:
    """(10, 10): standard parameters in the tool frame to those of the joint frame that carries the tool."""
    transform = np.empty((10, 10))
    for i, unit in enumerate(np.eye(10)):
        transform[:, i] = moved_parameters(unit, anchor.placement.rotation, anchor.placement.translation)
    return transform


def moved_parameters(parameters: np.ndarray, rotation: np.ndarray, translation: np.ndarray) -> np.ndarray:
    """Standard parameters (10,) of a frame, in that where it has this rotation and translation [m]."""
    mass, moment = parameters[0], rotation @ parameters[1:4]
    xx, xy, yy, xz, yz, zz = parameters[4:]
    inertia = rotation @ np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]]) @ rotation.T
    cross_terms = np.dot(moment, translation) * 2.0 * np.eye(3)
    cross_terms -= np.outer(moment, translation) + np.outer(translation, moment)
    inertia += cross_terms + mass * (
        np.dot(translation, translation) * np.eye(3) - np.outer(translation, translation)
    )
    first = moment + mass * translation
    return np.array(
        [
            mass,
            *first,
            inertia[0, 0],
            inertia[0, 1],
            inertia[1, 1],
            inertia[0, 2],
            inertia[1, 2],
            inertia[2, 2],
        ]
    )
