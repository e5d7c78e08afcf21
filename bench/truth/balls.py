"""Ball joints with dry friction opposite to their angular velocity vector, for any direction of its axis.

MuJoCo brakes each of a ball's three velocity coordinates separately. The friction then differs by up to a factor of
1.7 between axes and depends on the arbitrary orientation of the ball's frame in its body, which a real ball and
socket do not have.
"""

from dataclasses import dataclass

import mujoco
import numpy as np
from numpy.typing import NDArray

from bench.basics.errors import BenchError
from bench.truth.assembly import REPEATED, loop_rows

Array = NDArray[np.float64]

SLOW = 1e-3  # rad/s: below it, the friction constraint holds a joint, see `harden_friction`
LARGEST_TURN = (
    0.5  # rad/s by dry friction within a step: at four times as much, its direction becomes inaccurate
)


@dataclass(frozen=True, eq=False)
class BallFriction:
    """The dry friction of B ball joints in R runs: their velocity indices and their sizes, N·m.

    dofs (3 B,); whole (B, 1); velocity: live (R, nv). shares (R, B, 3): share of the size for each coordinate, from
    the last step at which the ball was not slow.
    """

    dofs: NDArray[np.signedinteger]
    whole: Array
    velocity: Array
    shares: Array

    def size(self) -> Array:
        """Size (R, 3 B) of friction for each coordinate at this step; the three of a ball oppose its angular
        velocity.
        """
        turning = self.velocity[:, self.dofs].reshape(self.shares.shape)
        speed = np.sqrt((turning * turning).sum(axis=2, keepdims=True))
        np.divide(np.abs(turning), speed, out=self.shares, where=speed > SLOW)
        return (self.whole * self.shares).reshape(len(turning), -1)


def ball_joints(model: mujoco.MjModel) -> list[tuple[str, slice]]:
    """Name (empty if it has none) and velocity indices of every ball joint."""
    ball = int(mujoco.mjtJoint.mjJNT_BALL)
    starts = [(model.joint(j).name, int(model.jnt_dofadr[j])) for j in np.flatnonzero(model.jnt_type == ball)]
    return [(name, slice(start, start + 3)) for name, start in starts]


def balls_of(model: mujoco.MjModel, velocity: Array) -> BallFriction | None:
    """The friction of the ball joints with dry friction, None if no ball has any. velocity: live (R, nv)."""
    starts = [dofs.start for _, dofs in ball_joints(model) if model.dof_frictionloss[dofs.start] > 0.0]
    if not starts:
        return None
    return BallFriction(
        np.add.outer(starts, np.arange(3)).ravel(),
        model.dof_frictionloss[starts][:, None],
        velocity,
        np.ones((len(velocity), len(starts), 3)),
    )


def directions(model: mujoco.MjModel, velocity: Array) -> Array:
    """Directions (nv,) of velocities (nv,), which dry friction opposes: the sign, or for a ball the unit vector."""
    along = np.sign(velocity)
    for _, dofs in ball_joints(model):
        speed = np.linalg.norm(velocity[dofs])
        along[dofs] = velocity[dofs] / speed if speed > 0.0 else 0.0
    return along


def refuse_too_light(model: mujoco.MjModel, home: Array) -> None:
    """Raise BenchError for a ball joint whose friction or damping accelerates a light body too much in one step.

    home: pose (nq,) with all loops closed. A rod without inertia about its line is such a body.
    """
    step = float(model.opt.timestep)
    least = [  # kg·m²
        step * max(model.dof_frictionloss[dofs.start] / LARGEST_TURN, model.dof_damping[dofs.start])
        for _, dofs in ball_joints(model)
    ]
    if not any(least):
        return
    mobility = _mobility(model, home)
    for (name, dofs), inertia in zip(ball_joints(model), least, strict=True):
        if inertia * float(np.linalg.eigvalsh(mobility[dofs, dofs])[-1]) > 1.0:
            raise BenchError(
                f"ball joint {name!r}: what it carries is too light for its friction and a step of {step:g} s; give "
                f"the body an inertia, or the joint an armature, of {inertia:.1g} kg·m² (a rod: about its line), or "
                "use a smaller step"
            )


def _mobility(model: mujoco.MjModel, pose: Array) -> Array:
    """Accelerations (nv, nv) per unit torque in each joint, loops closed."""
    data = mujoco.MjData(model)
    data.qpos[:] = pose
    _, jacobian = loop_rows(model, data)
    free = np.eye(model.nv)
    if len(jacobian):
        _, sizes, rows = np.linalg.svd(jacobian)
        free = rows[int((sizes > REPEATED * sizes[0]).sum()) :].T
    mass = np.zeros((model.nv, model.nv))
    mujoco.mj_fullM(model, data, mass)
    return np.asarray(free @ np.linalg.solve(free.T @ mass @ free, free.T))
