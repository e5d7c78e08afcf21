"""Ball joints whose dry friction opposes their angular velocity as a whole, wherever its axis points.

MuJoCo brakes each of a ball's three velocity coordinates by itself: up to 1.7 times as much about one axis as about
another, by how the ball's frame happens to be turned in its body. A ball and its socket have no such frame.
"""

from dataclasses import dataclass

import mujoco
import numpy as np
from numpy.typing import NDArray

from bench.basics.errors import BenchError
from bench.truth.assembly import REPEATED, loop_rows

Array = NDArray[np.float64]

SLOW = 1e-3  # rad/s: below, MuJoCo's friction constraint holds a joint rather than brakes it, see `harden_friction`
LARGEST_TURN = (
    0.5  # rad/s by dry friction within a step: at four times as much its direction begins to get lost
)


@dataclass(frozen=True, eq=False)
class BallFriction:
    """The dry friction of the B ball joints of R runs: where they are among the velocities, and their sizes N·m.

    dofs (3 B,); whole (B, 1); velocity: live (R, nv). shares (R, B, 3): of its size for each coordinate, when last a
    ball was not slow.
    """

    dofs: NDArray[np.signedinteger]
    whole: Array
    velocity: Array
    shares: Array

    def size(self) -> Array:
        """Size (R, 3 B) for each coordinate at this step: those of a ball together oppose its angular velocity."""
        turning = self.velocity[:, self.dofs].reshape(self.shares.shape)
        speed = np.sqrt((turning * turning).sum(axis=2, keepdims=True))
        np.divide(np.abs(turning), speed, out=self.shares, where=speed > SLOW)
        return (self.whole * self.shares).reshape(len(turning), -1)


def ball_joints(model: mujoco.MjModel) -> list[tuple[str, slice]]:
    """Name, empty where it has none, and velocity coordinates of every ball joint."""
    ball = int(mujoco.mjtJoint.mjJNT_BALL)
    starts = [(model.joint(j).name, int(model.jnt_dofadr[j])) for j in np.flatnonzero(model.jnt_type == ball)]
    return [(name, slice(start, start + 3)) for name, start in starts]


def balls_of(model: mujoco.MjModel, velocity: Array) -> BallFriction | None:
    """Of the ball joints with dry friction, None where no ball has any; velocity: live (R, nv)."""
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
    """Of dry friction (nv,) for a velocity (nv,): what it opposes, one for a whole joint."""
    along = np.sign(velocity)
    for _, dofs in ball_joints(model):
        speed = np.linalg.norm(velocity[dofs])
        along[dofs] = velocity[dofs] / speed if speed > 0.0 else 0.0
    return along


def refuse_too_light(model: mujoco.MjModel, home: Array) -> None:
    """Raise BenchError for a ball joint whose friction turns a body too fast in one step for its axis to be followed.

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
    """Accelerations (nv, nv) by torques in all joints, loops closed."""
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
