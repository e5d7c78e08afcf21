"""The observation matrix's rows: the tree's regressor, projected by the loop Jacobians (eqs. 1, 6).

Standard parameters of a body, in Pinocchio's order, about its joint frame: m [kg], mx my mz [kg m],
Ixx Ixy Iyy Ixz Iyz Izz [kg m2].
"""

from collections.abc import Iterator, Sequence
from functools import lru_cache

import numpy as np

from bench.model.body_rates import BodyRates, body_rates
from bench.model.bounds import MEMORY
from bench.model.geometry import Anchor, Geometry
from bench.model.kinematics import IDENTITY as AXES
from bench.model.kinematics import ZERO, Link, ancestors, link_of
from bench.model.motion import Motion, blocks_of
from bench.model.scalars import (
    Rows,
    Scalar,
    Vector,
    add,
    constant_vector,
    cross,
    dot,
    plus,
    plus_product,
    scaled,
    subtract,
    times,
)

PARAMETERS = ("m", "mx", "my", "mz", "Ixx", "Ixy", "Iyy", "Ixz", "Iyz", "Izz")
UNITS = ("kg", "kg*m", "kg*m", "kg*m", "kg*m^2", "kg*m^2", "kg*m^2", "kg*m^2", "kg*m^2", "kg*m^2")
PRODUCTS = ((0, 0), (0, 1), (1, 1), (0, 2), (1, 2), (2, 2))  # axes of the products of inertia, in order


def projected_regressor(geometry: Geometry, motion: Motion, columns: np.ndarray | None = None) -> np.ndarray:
    """phi_st of equation 6 at every sample: (N, n, p), in N*m or N for each standard parameter.

    `columns` picks from the 10 parameters of every joint of the geometry (a joint without a body has columns
    too, see `body_columns`), which are the default, from the rotors behind them, see `rotor_columns`, and from the
    torques of redundant motors behind these, see `redundant_columns`. A
    parameter's column is the power of its inertial force and moment on the velocities that unit speed of each
    motor gives its body.
    """
    bodies = 10 * len(geometry.joints)
    chosen = np.arange(bodies) if columns is None else np.asarray(columns)
    wanted: dict[int, list[tuple[int, int]]] = {}
    others: list[tuple[int, int]] = []
    for place, column in enumerate(chosen.tolist()):
        if column < bodies:
            wanted.setdefault(column // 10, []).append((place, column % 10))
        else:
            others.append((place, column - bodies))
    entries = tuple((joint, tuple(of_joint)) for joint, of_joint in wanted.items())
    samples, n = len(motion.time), len(geometry.active)
    rows = np.empty((n, len(chosen), samples))
    for block in blocks_of(samples, MEMORY.block) if entries else []:
        q = np.ascontiguousarray(motion.q[block].T)
        rates = _scalars(motion.v[block].T) + _scalars(motion.a[block].T)
        for j in range(n):
            rates += _scalars(motion.jacobian[block, :, j].T)
        for j, place, value in _block(geometry, entries, q, rates):
            rows[j, place, block] = value
    joints = np.concatenate((geometry.active, geometry.redundant))
    for place, motor in others:
        joint = joints[motor if motor < len(joints) else motor - len(geometry.redundant)]
        turned = motion.jacobian[:, joint, :].T
        rows[:, place] = turned * motion.a[:, joint] if motor < len(joints) else -turned
    return rows.transpose(2, 0, 1)


_Entries = tuple[tuple[int, tuple[tuple[int, int], ...]], ...]  # by joint: place among the columns, parameter


def _block(
    geometry: Geometry, entries: _Entries, q: Rows, rates: list[Scalar]
) -> Iterator[tuple[int, int, Scalar]]:
    """Motor, index and value of every entry, for the rates v, a and those of each motor's unit speed (nv each)."""
    links = _links(geometry, tuple(joint for joint, _ in entries))
    v, a, *motors = (rates[k : k + geometry.nv] for k in range(0, len(rates), geometry.nv))
    moving = body_rates(links, constant_vector(geometry.gravity), q, v, a, motors)
    for joint, of_joint in entries:
        yield from _of_body(moving[joint], of_joint)


@lru_cache(maxsize=MEMORY.geometries)
def _links(geometry: Geometry, joints: tuple[int, ...]) -> tuple[Link, ...]:
    """The constants of these joints and of all that carry them."""
    moving = sorted({index for joint in joints for index in ancestors(geometry, joint)})
    return tuple(link_of(index, geometry.joints[index]) for index in moving)


def _scalars(values: np.ndarray) -> list[Scalar]:
    """Rows (k, N) as scalars: floats if all samples are zero or all are one."""
    rows = np.ascontiguousarray(values)
    low, high = rows.min(axis=1), rows.max(axis=1)
    return [
        float(least) if least == most and least in (0.0, 1.0) else row
        for row, least, most in zip(rows, low, high, strict=True)
    ]


def _of_body(rates: BodyRates, entries: Sequence[tuple[int, int]]) -> Iterator[tuple[int, int, Scalar]]:
    """Motor, index and value of the entries (column index, parameter) of one body.

    With mass m, first moments c and inertia I about the frame: force m a + w' x c + w x (w x c), moment
    I w' + w x I w + c x a.
    """
    w, turning, a = rates.angular, rates.turning, rates.acceleration
    parameters = {parameter for _, parameter in entries}
    square = dot(w, w) if parameters & {1, 2, 3} else 0.0
    swept = {}
    for k in sorted(parameters & {1, 2, 3}):
        axis = AXES[k - 1]
        swept[k] = subtract(add(cross(turning, axis), scaled(w, w[k - 1])), scaled(axis, square))
    for j, twist in enumerate(rates.twists):
        angular, linear = twist.angular, twist.linear
        lever = cross(a, angular) if swept else ZERO
        about = cross(angular, w) if max(parameters) > 3 else ZERO
        for place, parameter in entries:
            if parameter == 0:
                value = dot(linear, a)
            elif parameter < 4:
                value = plus(lever[parameter - 1], dot(linear, swept[parameter]))
            else:
                value = _inertial(angular, turning, about, w, *PRODUCTS[parameter - 4])
            yield j, place, value


def _inertial(angular: Vector, turning: Vector, about: Vector, w: Vector, k: int, m: int) -> Scalar:
    """The column of the inertia's element k, m."""
    value = plus_product(times(angular[k], turning[m]), about[k], w[m])
    if k == m:
        return value
    return plus_product(plus_product(value, angular[m], turning[k]), about[m], w[k])


def body_columns(geometry: Geometry) -> np.ndarray:
    """The columns of `projected_regressor` that belong to moving bodies."""
    return np.concatenate([np.arange(10 * joint, 10 * joint + 10) for joint, _ in geometry.bodies])


def rotor_columns(geometry: Geometry) -> np.ndarray:
    """The columns (n + r,) of all motors' rotors: Ia, inertia of rotor and gear seen at the joint, times q''.

    A rotor turns with its motor, not with a body; its weight belongs to the body that carries it.
    """
    return 10 * len(geometry.joints) + np.arange(len(geometry.active) + len(geometry.redundant))


def redundant_columns(geometry: Geometry) -> np.ndarray:
    """The columns (r,) of the redundant motors: by how much a unit torque or force relieves the others."""
    return rotor_columns(geometry)[-1] + 1 + np.arange(len(geometry.redundant))


def parameter_names(geometry: Geometry) -> list[tuple[str, str]]:
    """Name and unit of every column of `projected_regressor` that is a parameter, those of the rotors last."""
    names = []
    for joint in geometry.joints:
        owner = joint.body or f"({joint.name})"
        names += [(f"{symbol}({owner})", unit) for symbol, unit in zip(PARAMETERS, UNITS, strict=True)]
    for actuator in geometry.robot.motors:
        slides = geometry.joints[geometry.joint_index(actuator.joint)].kind == "slide"
        names.append((f"Ia({actuator.joint})", "kg" if slides else "kg*m^2"))
    return names


def payload_transform(anchor: Anchor) -> np.ndarray:
    """(10, 10): standard parameters in the tool frame to those of the joint frame that carries the tool."""
    transform = np.empty((10, 10))
    for i, unit in enumerate(np.eye(10)):
        transform[:, i] = moved_parameters(unit, anchor.placement.rotation, anchor.placement.translation)
    return transform


def moved_parameters(parameters: np.ndarray, rotation: np.ndarray, translation: np.ndarray) -> np.ndarray:
    """Standard parameters (10,) of a frame, in one where it has this rotation and translation [m]."""
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
