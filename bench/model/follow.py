"""Follow the loop closures continuously from an assembled pose, one node after the other.

Newton from a distant pose may land in another assembly mode; a predictor along the closures with short,
checked corrections cannot. Only few nodes of a trajectory are followed in this way (bench.model.motion).
"""

from dataclasses import dataclass

import numpy as np
import pinocchio as pin

from bench.model.geometry import Geometry
from bench.model.tree import build_tree, loop_constraints

CLOSED = 1e-10  # m or rad: a loop is closed
LARGEST_CORRECTION = 0.05  # m or rad: what a Newton correction may move after a prediction
SMALLEST_STEP = 2.0**-12  # share of the way to a target below which it counts as out of reach
MOST_ITERATIONS = 5


@dataclass(frozen=True)
class Follower:
    """Pinocchio's model of the opened tree with its loops; `data` is scratch space."""

    geometry: Geometry
    model: pin.Model
    data: pin.Data
    constraints: tuple[pin.ConstraintModel, ...]
    constraint_data: tuple[pin.ConstraintData, ...]

    def linearise(self, q: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Residual (m,) and Jacobian (m, nv) of the loops at q (nq,)."""
        pin.computeJointJacobians(self.model, self.data, q)
        residuals, jacobians = [], []
        for constraint, data in zip(self.constraints, self.constraint_data, strict=True):
            constraint.calc(self.model, self.data, data)
            residuals.append(np.asarray(data.constraint_position_error).ravel())
            jacobians.append(constraint.jacobian(self.model, self.data, data))
        return np.concatenate(residuals), np.vstack(jacobians)


def make_follower(geometry: Geometry) -> Follower:
    """A follower of the robot's loop closures, with Pinocchio's model of the opened tree."""
    model = build_tree(geometry)
    constraints = tuple(loop_constraints(geometry, model))
    return Follower(
        geometry, model, model.createData(), constraints, tuple(c.createData() for c in constraints)
    )


def _solve(matrix: np.ndarray, right: np.ndarray) -> np.ndarray:
    if matrix.shape[0] != matrix.shape[1]:
        matrix, right = matrix.T @ matrix, matrix.T @ right
    return np.linalg.solve(matrix, right)


def close(follower: Follower, q: np.ndarray) -> np.ndarray | None:
    """The closed pose (nq,) near q with the active joints held; None where Newton would go far or fail."""
    passive = follower.geometry.passive
    for _ in range(MOST_ITERATIONS):
        residual, jacobian = follower.linearise(q)
        if np.abs(residual).max() < CLOSED:
            return q
        step = np.zeros(follower.geometry.nv)
        try:
            step[passive] = _solve(jacobian[:, passive], -residual)
        except np.linalg.LinAlgError:
            return None
        if not np.abs(step).max() < LARGEST_CORRECTION:
            return None
        q = pin.integrate(follower.model, q, step)
    return None


def advance(follower: Follower, q: np.ndarray, target: np.ndarray) -> tuple[np.ndarray, float]:
    """Move the active joints of the closed pose q (nq,) straight to `target` (n,), closing the loops.

    Returns the last closed pose and the share of the way that was reached (1: the target).
    """
    geometry = follower.geometry
    passive, active = geometry.passive, geometry.active
    way = target - q[geometry.active_configuration]
    done, share = 0.0, 1.0
    while done < 1.0:
        share = min(share, 1.0 - done)
        step = np.zeros(geometry.nv)
        step[active] = share * way
        if len(passive):
            _, jacobian = follower.linearise(q)
            try:
                step[passive] = _solve(jacobian[:, passive], -jacobian[:, active] @ step[active])
            except np.linalg.LinAlgError:
                return q, done
        moved = close(follower, pin.integrate(follower.model, q, step)) if len(passive) else q
        if not len(passive):
            moved = pin.integrate(follower.model, q, step)
        if moved is None:
            share /= 2.0
            if share < SMALLEST_STEP:
                return q, done
            continue
        q = moved
        done = 1.0 if share >= 1.0 - done else done + share
        share *= 2.0
    return q, 1.0
