"""Follow the loop closures continuously from an assembled pose, one node after the other.

Newton from a distant pose may land in another assembly mode; a predictor along the closures with short,
checked corrections cannot. Only few nodes of a trajectory are followed in this way (bench.model.motion).
"""

from dataclasses import dataclass

import numpy as np
import pinocchio as pin
from numpy.polynomial import Polynomial
from scipy.linalg.lapack import dgesv

from bench.basics.errors import BenchError
from bench.model.bounds import CLOSURE
from bench.model.geometry import Coupling, Geometry, Joint
from bench.model.spin import Spin, idle_spins

AXES = np.eye(3)


def build_tree(geometry: Geometry) -> pin.Model:
    """Every leg a tree, the platform a free body, no inertia: used for kinematics only.

    Joint i of the geometry is joint i + 1 of the model, with the same slices of q and v.
    """
    model = pin.Model()
    model.name = geometry.robot.name
    model.gravity.linear = geometry.gravity
    for joint in geometry.joints:
        placement = pin.SE3(joint.placement.rotation, joint.placement.translation)
        model.addJoint(joint.parent + 1, _joint_model(joint), placement, joint.name)
    return model


def _joint_model(joint: Joint) -> pin.JointModel:
    if joint.kind == "free":
        return pin.JointModelFreeFlyer()
    if joint.kind == "ball":
        return pin.JointModelSpherical()
    aligned = {
        "hinge": (pin.JointModelRX, pin.JointModelRY, pin.JointModelRZ),
        "slide": (pin.JointModelPX, pin.JointModelPY, pin.JointModelPZ),
    }[joint.kind]
    for axis, kind in zip(AXES, aligned, strict=True):
        if np.array_equal(joint.axis, axis):
            return kind()
    unaligned = pin.JointModelRevoluteUnaligned if joint.kind == "hinge" else pin.JointModelPrismaticUnaligned
    return unaligned(joint.axis)


def loop_constraints(geometry: Geometry, model: pin.Model) -> list[pin.ConstraintModel]:
    """The loop closures as Pinocchio's constraints, for cross-checks."""
    constraints = []
    for loop in geometry.loops:
        ends = []
        for anchor in (loop.first, loop.second):
            ends += [anchor.joint + 1, pin.SE3(anchor.placement.rotation, anchor.placement.translation)]
        kind = pin.PointAnchorConstraintModel if loop.kind == "connect" else pin.FrameAnchorConstraintModel
        constraints.append(kind(model, *ends))
    return constraints


@dataclass(frozen=True)
class Follower:
    """Pinocchio's model of the opened tree with its closures; `data` is scratch space.

    units (n,): travel of every motor that moves the fastest of its joints by 1 rad or 1 m at home, where a coupling
    is its gear, else 1. A motor-side position runs through many turns.
    """

    geometry: Geometry
    model: pin.Model
    data: pin.Data
    constraints: tuple[pin.ConstraintModel, ...]
    constraint_data: tuple[pin.ConstraintData, ...]
    passive: np.ndarray
    spins: tuple[Spin, ...]
    units: np.ndarray

    def linearise(self, q: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Residual (m,) and Jacobian (m, nv) of the closures at q (nq,)."""
        residuals, jacobians = [np.zeros(0)], [np.zeros((0, self.model.nv))]
        if self.constraints or self.spins:
            pin.computeJointJacobians(self.model, self.data, q)
        for constraint, data in zip(self.constraints, self.constraint_data, strict=True):
            constraint.calc(self.model, self.data, data)
            residuals.append(data.constraint_position_error.ravel())
            jacobians.append(constraint.jacobian(self.model, self.data, data))
        for coupling in self.geometry.couplings:
            gap, row = self._coupling(coupling, q)
            residuals.append(np.array([gap]))
            jacobians.append(row[None])
        for spin in self.spins:
            turning = pin.getJointJacobian(self.model, self.data, spin.joint + 1, pin.ReferenceFrame.LOCAL)[
                3:
            ]
            residuals.append(np.zeros(1))
            jacobians.append((spin.axis @ turning)[None])
        return np.concatenate(residuals), np.concatenate(jacobians)

    def _coupling(self, coupling: Coupling, q: np.ndarray) -> tuple[float, np.ndarray]:
        joints = self.geometry.joints
        polynomial = Polynomial(coupling.polynomial or (0.0,))
        argument = sum(factor * q[joints[joint].q.start] for joint, factor in coupling.second)
        gap = sum(factor * q[joints[joint].q.start] for joint, factor in coupling.first) - polynomial(
            argument
        )
        row = np.zeros(self.model.nv)
        for joint, factor in coupling.first:
            row[joints[joint].v.start] += factor
        for joint, factor in coupling.second:
            row[joints[joint].v.start] -= factor * polynomial.deriv()(argument)
        return float(gap), row


@dataclass(frozen=True)
class Pose:
    """A closed pose q (nq,) and, there, the passive velocities for the active ones (passive, n)."""

    q: np.ndarray
    amplification: np.ndarray


def make_follower(geometry: Geometry) -> Follower:
    """Pinocchio's model and scratch space, to be kept while a path is followed."""
    model = build_tree(geometry)
    constraints = tuple(loop_constraints(geometry, model))
    data = tuple(constraint.createData() for constraint in constraints)
    spins = idle_spins(geometry)
    units = np.ones(len(geometry.active))
    follower = Follower(
        geometry, model, model.createData(), constraints, data, geometry.passive, spins, units
    )
    geared = {joint for coupling in geometry.couplings for joint, _ in (*coupling.first, *coupling.second)}
    places = {geometry.joints[joint].v.start for joint in geared}
    chosen = np.array([int(index) in places for index in geometry.active])
    pose = close(follower, geometry.home) if chosen.any() else None
    if pose is not None:
        units[chosen] = 1.0 / np.abs(pose.amplification).max(axis=0)[chosen]
    return follower


def home_pose(follower: Follower) -> Pose:
    """The pose from which all others are followed. Raises BenchError if home is not assembled."""
    pose = close(follower, follower.geometry.home)
    if pose is None:
        raise BenchError(
            f"robot {follower.geometry.robot.name}: its loops are not closed at home, or home is singular"
        )
    return pose


def close(follower: Follower, q: np.ndarray, enough: float = CLOSURE.closed) -> Pose | None:
    """The closed pose near q (nq,) with the active joints held; None if Newton goes far or fails.

    Newton ends after the first correction smaller than `enough`.
    """
    active, passive = follower.geometry.active, follower.passive
    step = np.zeros(follower.model.nv)
    for _ in range(CLOSURE.followed):
        residual, jacobian = follower.linearise(q)
        matrix = jacobian[:, passive]
        right = np.empty((len(residual), 1 + len(active)))
        right[:, 0], right[:, 1:] = residual, jacobian[:, active]
        if len(matrix) > len(passive):
            matrix, right = matrix.T @ matrix, matrix.T @ right
        if len(matrix):
            *_, solved, singular = dgesv(matrix, right)
            if singular:
                return None
        else:
            solved = right
        step[passive] = -solved[:, 0]
        largest = _largest(step)
        if not largest < CLOSURE.correction:
            return None
        q = pin.integrate(follower.model, q, step)
        slack = CLOSURE.slack if len(jacobian) > len(passive) else 0.0
        if largest < enough and _largest(residual) < max(CLOSURE.open * enough, slack):
            return Pose(q, -solved[:, 1:])
    return None


def _largest(values: np.ndarray) -> float:
    """Largest absolute value, 0 without any; NaN if one is."""
    return max(values.max(), -values.min()) if values.size else 0.0


def advance(
    follower: Follower, pose: Pose, target: np.ndarray, enough: float = CLOSURE.closed
) -> tuple[Pose, float]:
    """Move the active joints of the pose straight to `target` (n,), closing the loops.

    Returns the last closed pose and the share of the way that was reached (1: the target).
    """
    geometry = follower.geometry
    way = target - pose.q[geometry.active_configuration]
    done, share = 0.0, 1.0
    step = np.zeros(geometry.nv)
    while done < 1.0:
        step[geometry.active] = way / follower.units
        step[follower.passive] = pose.amplification @ way
        share = min(share, 1.0 - done, CLOSURE.step / max(np.abs(step).max(), CLOSURE.step))
        step[geometry.active] = way
        moved = close(follower, pin.integrate(follower.model, pose.q, share * step), enough)
        if moved is None or _turned(pose, moved, share * way) > CLOSURE.turn:
            share /= 2.0
            if share < CLOSURE.share:
                return pose, done
            continue
        pose = moved
        done = 1.0 if share >= 1.0 - done else done + share
        share *= 2.0
    return pose, 1.0


def _turned(before: Pose, after: Pose, part: np.ndarray) -> float:
    """Change of the amplification over a step of the active joints, times that step [m or rad].

    On a smooth path it is about twice the correction. It is far more if the step has jumped over a singular pose into
    another assembly mode: the amplification then has the other sign along the step, although the correction may have
    been small.
    """
    change = np.abs(after.amplification - before.amplification) @ np.abs(part)
    return float(change.max(initial=0.0))
