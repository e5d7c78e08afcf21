"""Ball joints whose dry friction opposes their angular velocity as a whole, wherever its axis points.

MuJoCo brakes each of a ball's three velocity coordinates by itself: up to 1.7 times as much about one axis as about
another, by how the ball's frame happens to be turned in its body. A ball and its socket have no such frame.
"""

from __future__ import annotations

from dataclasses import dataclass

import mujoco
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

SLOW = 1e-3  # rad/s: below, MuJoCo's friction constraint holds a joint rather than brakes it, see `harden_friction`


@dataclass(frozen=True, eq=False)
class BallFriction:
    """The dry friction of one ball joint of R runs: where it is among the velocities, and its size N·m.

    velocity: live angular velocity (R, 3). shares (R, 3): of its size for each coordinate, when last it was not slow.
    """

    dofs: slice
    whole: float
    velocity: Array
    shares: Array

    def size(self) -> Array:
        """Size (R, 3) for each coordinate at this step: together they oppose the angular velocity."""
        speed = np.linalg.norm(self.velocity, axis=1, keepdims=True)
        np.divide(np.abs(self.velocity), speed, out=self.shares, where=speed > SLOW)
        return self.whole * self.shares


def ball_joints(model: mujoco.MjModel) -> dict[str, slice]:
    """The velocity coordinates of every ball joint, by name."""
    ball = int(mujoco.mjtJoint.mjJNT_BALL)
    starts = {
        model.joint(j).name: int(model.jnt_dofadr[j]) for j in range(model.njnt) if model.jnt_type[j] == ball
    }
    return {name: slice(start, start + 3) for name, start in starts.items()}


def balls_of(model: mujoco.MjModel, velocity: Array) -> tuple[BallFriction, ...]:
    """One for each ball joint with dry friction; velocity: live (R, nv)."""
    return tuple(
        BallFriction(
            dofs, float(model.dof_frictionloss[dofs.start]), velocity[:, dofs], np.ones((len(velocity), 3))
        )
        for dofs in ball_joints(model).values()
        if model.dof_frictionloss[dofs.start] > 0.0
    )


def directions(model: mujoco.MjModel, velocity: Array) -> Array:
    """Of dry friction (nv,) for a velocity (nv,): what it opposes, one for a whole joint."""
    along = np.sign(velocity)
    for dofs in ball_joints(model).values():
        speed = np.linalg.norm(velocity[dofs])
        along[dofs] = velocity[dofs] / speed if speed > 0.0 else 0.0
    return along
