"""The force in a joint without a motor, perpendicular to its axis, as a function of the inertial parameters.

If the joint could also slide perpendicular to its axis, the force to prevent this would be that of its bearing. So the
bearing force is the projected row of two more motors: slides across the axis, at rest. No multiplier of a closure is
solved for (virtual work; Briot and Khalil, "Dynamics of Parallel Robots", 2015, chapter 8).
"""

from dataclasses import dataclass, replace
from functools import lru_cache
from typing import Literal

import numpy as np

from bench.model.base import base_parameters
from bench.model.bounds import MEMORY, RANDOM_POSES, RANKS
from bench.model.closure import loop_jacobian
from bench.model.geometry import Anchor, Geometry, Joint, Placement
from bench.model.guess import guessed_parameters
from bench.model.motion import Motion
from bench.model.regressor import projected_regressor
from bench.model.states import random_motion

SEED = 20120603  # of the poses at which the closures' influence is determined
ACROSS = 2  # directions at right angles to an axis


@dataclass(frozen=True, eq=False)
class Bearing:
    """A robot in which one joint can slide across its axis, too.

    geometry: with two slides before the joint, of former index `joint`, as its only motors except redundant ones; held:
    velocity indices that the closures determine; first: velocity index of the first slide.
    """

    geometry: Geometry
    joint: int
    first: int
    held: np.ndarray


@lru_cache(maxsize=MEMORY.joints)
def bearing_of(geometry: Geometry, joint: int) -> Bearing:
    """The robot with two slides across the axis of a hinge or slide (index), driven and at rest."""
    original = geometry.joints[joint]
    at, first = original.q.start, original.v.start
    slides = tuple(
        Joint(
            name=f"{original.name} across {k}",
            kind="slide",
            parent=original.parent if k == 0 else joint + k - 1,
            placement=original.placement if k == 0 else Placement(np.eye(3), np.zeros(3)),
            axis=axis,
            body=None,
            q=slice(at + k, at + k + 1),
            v=slice(first + k, first + k + 1),
            offset=0.0,
            limits=None,
        )
        for k, axis in enumerate(_across(original.axis))
    )
    before = tuple(geometry.joints[:joint])
    carried = replace(
        _later(original, joint), parent=joint + ACROSS - 1, placement=Placement(np.eye(3), np.zeros(3))
    )
    after = tuple(_later(other, joint) for other in geometry.joints[joint + 1 :])

    def moved(anchor: Anchor) -> Anchor:
        return replace(anchor, joint=_index(anchor.joint, joint))

    wider = replace(
        geometry,
        joints=(*before, *slides, carried, *after),
        loops=tuple(
            replace(loop, first=moved(loop.first), second=moved(loop.second)) for loop in geometry.loops
        ),
        couplings=tuple(
            replace(
                coupling,
                first=tuple((_index(k, joint), factor) for k, factor in coupling.first),
                second=tuple((_index(k, joint), factor) for k, factor in coupling.second),
            )
            for coupling in geometry.couplings
        ),
        home=np.insert(geometry.home, [at] * ACROSS, 0.0),
        active=first + np.arange(ACROSS),
        redundant=_places(geometry.redundant, first),
        tool=None if geometry.tool is None else moved(geometry.tool),
        body_frames={
            name: (_index(k, joint), placement) for name, (k, placement) in geometry.body_frames.items()
        },
    )
    return Bearing(wider, joint, first, _places(geometry.passive, first))


@dataclass(frozen=True, eq=False)
class HeldMotion:
    """A motion (N samples), and how its passive joints follow another displacement while motors are held.

    inverse (N, k, m): pseudo-inverse of the derivative of m closures by the velocities of k such joints; None without
    loops.
    """

    geometry: Geometry
    motion: Motion
    inverse: np.ndarray | None


def with_motors_held(geometry: Geometry, motion: Motion) -> HeldMotion:
    """The motion with what all of its bearings share."""
    if not geometry.closed:
        return HeldMotion(geometry, motion, None)
    closures = _closures(geometry, motion.q, geometry.passive)
    turned = closures.transpose(0, 2, 1)
    # far from singular: such poses are refused
    return HeldMotion(geometry, motion, np.linalg.solve(turned @ closures, turned))


def bearing_motion(bearing: Bearing, held: HeldMotion) -> Motion:
    """The motion with the slides at rest and the Jacobian by their velocities, motors held."""
    geometry, first, motion = bearing.geometry, bearing.first, held.motion
    q = _with_slides(bearing, motion.q)
    v, a = (np.insert(rates, [first] * ACROSS, 0.0, axis=1) for rates in (motion.v, motion.a))
    more = np.zeros((len(q), geometry.nv, ACROSS))
    more[:, first + np.arange(ACROSS), np.arange(ACROSS)] = 1.0
    if held.inverse is not None:
        opened = _closures(geometry, q, first + np.arange(ACROSS))
        more[:, bearing.held] = -held.inverse @ opened
    return Motion(motion.time, q, v, a, more)


def _not_followed(bearing: Bearing, held: HeldMotion) -> np.ndarray:
    """Share (N,) of the closure violation by a slide's speed that no other joint can compensate."""
    closures = _closures(bearing.geometry, _with_slides(bearing, held.motion.q))
    opened = closures[:, :, bearing.first : bearing.first + ACROSS]
    residual = opened - closures[:, :, bearing.held] @ (held.inverse @ opened)
    size = np.linalg.norm(opened, axis=(1, 2))
    return np.asarray(np.linalg.norm(residual, axis=(1, 2)) / np.where(size > 0.0, size, 1.0))


def _with_slides(bearing: Bearing, q: np.ndarray) -> np.ndarray:
    """Positions (N, nq) with the slides' zeros among them."""
    return np.insert(q, [bearing.geometry.joints[bearing.joint].q.start] * ACROSS, 0.0, axis=1)


def _closures(geometry: Geometry, q: np.ndarray, columns: np.ndarray | None = None) -> np.ndarray:
    """Derivative (N, m, k) of the closures by all or some of the velocities at positions (N, nq)."""
    return loop_jacobian(geometry, np.ascontiguousarray(q.T), columns).transpose(2, 0, 1)


def bearing_rows(bearing: Bearing, held: HeldMotion, columns: np.ndarray) -> np.ndarray:
    """Force (N, 2, p), N, along both slides for each parameter; columns: of `projected_regressor` without slides."""
    places, shown = _columns(bearing, held.motion.jacobian.shape[2], columns)
    rows = np.zeros((len(held.motion.time), ACROSS, len(columns)))
    rows[:, :, shown] = projected_regressor(bearing.geometry, bearing_motion(bearing, held), places[shown])
    return rows


def bearing_torques(bearing: Bearing, held: HeldMotion, other: int) -> np.ndarray:
    """Force (N, 2, d), N, along both slides for a unit torque or force in a joint without a motor (index).

    d: 1 of a hinge or slide, 3 of a ball joint.
    """
    joint = bearing.geometry.joints[_index(other, bearing.joint)]
    return np.asarray(bearing_motion(bearing, held).jacobian[:, joint.v].transpose(0, 2, 1))


@lru_cache(maxsize=MEMORY.joints)
def mass_on_axis(geometry: Geometry, joint: int) -> tuple[float, float]:
    """Part of the force in a joint (index) that base parameters do not determine, with equal bars as bodies: a mass on
    its axis, kg, which the motors cannot assign to one of its two bodies; and the unexplained share of the force at
    random states.
    """
    standard, base = guessed_parameters(geometry), base_parameters(geometry)
    bearing, states = bearing_of(geometry, joint), _states(geometry)
    rows = bearing_rows(bearing, states, np.arange(10 * len(geometry.joints)))
    force, of_mass = rows @ standard, rows[:, :, 10 * joint]
    residual = force - bearing_rows(bearing, states, base.columns) @ (base.grouping @ standard)
    square = float(np.vdot(of_mass, of_mass))
    mass = float(np.vdot(of_mass, residual)) / square if square > 0.0 else 0.0
    size = float(np.linalg.norm(force))
    return mass, float(np.linalg.norm(residual - mass * of_mass)) / (size or 1.0)


@lru_cache(maxsize=MEMORY.joints)
def undetermined_by(geometry: Geometry, joint: int) -> Literal["", "closures", "masses"]:
    """Why motion and torques do not determine the force in a joint (index): redundant closures, which could share it in
    any way; or masses, except one on its axis, that no motor can distinguish.
    """
    bearing = bearing_of(geometry, joint)
    if geometry.closed:
        residual = _not_followed(bearing, _states(geometry))
        if not np.all(residual < RANKS.reaction):
            return "closures"
    _, open_share = mass_on_axis(geometry, joint)
    return "" if open_share < RANKS.open else "masses"


@lru_cache(maxsize=MEMORY.joints)
def _states(geometry: Geometry) -> HeldMotion:
    return with_motors_held(geometry, random_motion(geometry, RANDOM_POSES.reaction_states, SEED))


def _across(axis: np.ndarray) -> np.ndarray:
    """Two unit vectors (2, 3) at right angles to an axis (3,) and to each other."""
    least = np.eye(3)[int(np.argmin(np.abs(axis)))]
    across = np.cross(axis, least)
    across /= np.linalg.norm(across)
    return np.stack((across, np.cross(axis, across) / np.linalg.norm(axis)))


def _index(other: int, joint: int) -> int:
    """Index of a joint with the slides before `joint`."""
    return other if other < joint else other + ACROSS


def _later(other: Joint, joint: int) -> Joint:
    """A joint that is behind the slides."""
    return replace(
        other,
        parent=_index(other.parent, joint),
        q=slice(other.q.start + ACROSS, other.q.stop + ACROSS),
        v=slice(other.v.start + ACROSS, other.v.stop + ACROSS),
    )


def _places(velocities: np.ndarray, first: int) -> np.ndarray:
    """Velocity indices with the slides before `first`."""
    return np.where(velocities < first, velocities, velocities + ACROSS).astype(int)


def _columns(bearing: Bearing, motors: int, columns: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Columns of `projected_regressor` in the robot with slides, of bodies, rotors and redundant motors' torques; and
    which of them a joint can bear: not the rotors of the `motors` held motors.
    """
    joints = len(bearing.geometry.joints)
    bodies = 10 * (joints - ACROSS)
    of_body = columns + 10 * ACROSS * (columns // 10 >= bearing.joint)
    behind = 10 * joints + ACROSS + columns - bodies - motors
    return np.where(columns < bodies, of_body, behind), (columns < bodies) | (columns >= bodies + motors)
