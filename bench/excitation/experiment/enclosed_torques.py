"""Torques of the motors in whole intervals of time, by Newton and Euler's recursion on balls.

From the platform and the outer links inwards, the forces of the bodies add up to those at every joint of the opened
tree; the loops' Jacobian maps these to the motors. Masses: the nominal base parameters, each as the standard parameter
that it represents. Source of the recursion: W. Khalil and E. Dombre, "Modeling, Identification and Control of Robots",
2002, chapter 9.
"""

import numpy as np

from bench.excitation.experiment.enclosed_loops import Enclosure
from bench.excitation.experiment.nominal import Nominal
from bench.identification.layout import payload_columns
from bench.model.balls import balls, dense_balls
from bench.model.body_rates import BodyRates, body_rates
from bench.model.geometry import Geometry
from bench.model.kinematics import ZERO, Link, link_of, rotation_of, turn_of
from bench.model.regressor import rotor_columns
from bench.model.scalars import (
    Matrix,
    Scalar,
    Vector,
    add,
    constant_vector,
    cross,
    dot,
    plus,
    plus_product,
    scaled,
    times,
    turned,
)

Wrench = tuple[Vector, Vector]  # force and moment about the origin of a joint frame, in its axes


def enclosed_torques(
    nominal: Nominal, payload: str | None, enclosure: Enclosure
) -> tuple[np.ndarray, np.ndarray]:
    """Sizes of the motors' torques in the intervals' middles and the largest in each, (K, n) both, N m or N."""
    geometry, motion = nominal.model.geometry, enclosure.motion
    links = [link_of(index, joint) for index, joint in enumerate(geometry.joints)]
    q = balls(motion.q.T, enclosure.q.T)
    v, a = balls(motion.v.T, enclosure.v.T), balls(motion.a.T, enclosure.a.T)
    bodies, rotors = _parameters(nominal, payload)
    rates = body_rates(links, constant_vector(geometry.gravity), q, v, a, ())
    tree = _at_joints(geometry, links, q, rates, bodies)
    torques: list[Scalar] = []
    joints = np.concatenate((geometry.active, geometry.redundant)).tolist()
    for j in range(len(geometry.active)):
        column = balls(motion.jacobian[:, :, j].T, enclosure.jacobian[:, :, j].T)
        torque = dot(column, tree)
        for joint, inertia in zip(joints, rotors, strict=True):
            torque = plus(torque, times(times(column[joint], a[joint]), inertia))
        torques.append(torque)
    middle, radius = dense_balls(torques, len(motion.time))
    return np.abs(middle).T, (np.abs(middle) + radius).T


def _parameters(nominal: Nominal, payload: str | None) -> tuple[np.ndarray, list[float]]:
    """Standard parameters (joints, 10) and inertias of the motors' rotors that are base parameters."""
    model = nominal.model
    first = 10 * len(model.geometry.joints)
    standard = np.zeros(first + len(rotor_columns(model.geometry)))
    standard[model.base.columns] = nominal.base
    bodies = standard[:first].reshape(-1, 10)
    if payload is not None and model.geometry.tool is not None and model.payload is not None:
        known = payload_columns(nominal.payloads[payload]).known
        bodies[model.geometry.tool.joint] += model.payload @ known
    return bodies, [float(inertia) for inertia in standard[first:]]


def _at_joints(
    geometry: Geometry,
    links: list[Link],
    q: list[Scalar],
    rates: dict[int, BodyRates],
    bodies: np.ndarray,
) -> list[Scalar]:
    """Torques and forces at all joints of the opened tree, nv."""
    tree: list[Scalar] = [0.0] * geometry.nv
    carried: dict[int, Wrench] = {}
    for link in reversed(links):
        wrench = _wrench(rates[link.index], [float(value) for value in bodies[link.index]])
        outer = carried.get(link.index, (ZERO, ZERO))
        force, moment = add(wrench[0], outer[0]), add(wrench[1], outer[1])
        if link.kind == "hinge":
            tree[link.v] = dot(link.axis, moment)
        elif link.kind == "slide":
            tree[link.v] = dot(link.axis, force)
        else:
            tree[link.v : link.v + 3] = list(moment if link.kind == "ball" else force)
            if link.kind == "free":
                tree[link.v + 3 : link.v + 6] = list(moment)
        if link.parent >= 0:
            before = carried.get(link.parent, (ZERO, ZERO))
            force, moment = _in_parent(link, q, force, moment)
            carried[link.parent] = add(before[0], force), add(before[1], moment)
    return tree


def _in_parent(link: Link, q: list[Scalar], force: Vector, moment: Vector) -> Wrench:
    arm = link.translation
    if link.kind == "slide":
        arm = add(arm, turned(link.rotation, scaled(link.axis, q[link.q])))
    elif link.kind == "hinge":
        rotation = turn_of(link, q[link.q])
        force, moment = turned(rotation, force), turned(rotation, moment)
    else:
        rotation = rotation_of(q[link.q : link.q + 4])
        force, moment = turned(rotation, force), turned(rotation, moment)
    if not link.aligned:
        force, moment = turned(link.rotation, force), turned(link.rotation, moment)
    return force, add(moment, cross(arm, force))


def _wrench(rates: BodyRates, parameters: list[float]) -> Wrench:
    """Inertial force m a + w' x c + w x (w x c) and moment I w' + w x I w + c x a, gravity in a."""
    mass, mx, my, mz, xx, xy, yy, xz, yz, zz = parameters
    moment: Vector = (mx, my, mz)
    inertia: Matrix = ((xx, xy, xz), (xy, yy, yz), (xz, yz, zz))
    w, turning, acceleration = rates.angular, rates.turning, rates.acceleration
    force = add(scaled(acceleration, mass), add(cross(turning, moment), _swept(w, moment)))
    rotational = add(turned(inertia, turning), cross(w, turned(inertia, w)))
    return force, add(rotational, cross(moment, acceleration))


def _swept(w: Vector, c: Vector) -> Vector:
    """w x (w x c) = w (w c) - c (w w)."""
    along, square = dot(w, c), dot(w, w)
    less = times(-1.0, square)
    return (
        plus_product(times(w[0], along), c[0], less),
        plus_product(times(w[1], along), c[1], less),
        plus_product(times(w[2], along), c[2], less),
    )
