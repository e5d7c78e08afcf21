"""References of redundant motors: their motion follows from the references of the others."""

from __future__ import annotations

from collections.abc import Callable
from functools import lru_cache
from typing import TYPE_CHECKING

import mujoco
import numpy as np
from numpy.typing import NDArray

from bench.basics.errors import BenchError
from bench.dataset.home_qpos import home_qpos
from bench.dataset.robot import Robot
from bench.scenario.trajectory import FourierTrajectory
from bench.truth.assembly import assembled, close_loops

if TYPE_CHECKING:
    from scipy.interpolate import BSpline

Array = NDArray[np.float64]
NODES = 0.01  # s between closed poses, which a quintic spline interpolates
KEPT = 32

Evaluated = tuple[Array, Array, Array]


def references(robot: Robot, trajectory: FourierTrajectory) -> Callable[[Array], Evaluated]:
    """Positions, velocities and accelerations (N, n) of all driven joints, as a function of times (N,).

    Joints that do not move independently follow the trajectory of the others with closed loops; outside of its
    duration they are at rest.
    """
    if not robot.redundant:
        return trajectory.evaluate
    spline = _followed(robot, trajectory)

    def evaluate(time: Array) -> Evaluated:
        motors = trajectory.evaluate(time)
        moving = ((time > 0) & (time < trajectory.duration))[:, None]
        inside = np.clip(time, 0.0, trajectory.duration)
        q, qd, qdd = (spline(inside, order) for order in range(3))
        more = q, qd * moving, qdd * moving
        return tuple(np.hstack(pair) for pair in zip(motors, more, strict=True))  # type: ignore[return-value]

    return evaluate


@lru_cache(maxsize=KEPT)
def _followed(robot: Robot, trajectory: FourierTrajectory) -> BSpline:
    """Positions of the redundant motors' joints along the trajectory."""
    from scipy.interpolate import make_interp_spline  # noqa: PLC0415 - slow to import, and rarely needed

    model = robot.mjcf_model()
    model.opt.jacobian = int(mujoco.mjtJacobian.mjJAC_DENSE)
    model.opt.disableflags |= int(mujoco.mjtDisableBit.mjDSBL_CONTACT) | int(
        mujoco.mjtDisableBit.mjDSBL_LIMIT
    )
    dofs, addresses = (
        np.array([getattr(model.joint(joint), name)[0] for joint in robot.driven])
        for name in ("dofadr", "qposadr")
    )
    m = len(robot.joints)
    home = home_qpos(model)
    time = np.linspace(0.0, trajectory.duration, max(8, int(np.ceil(trajectory.duration / NODES)) + 1))
    wanted = trajectory.evaluate(time)[0]
    data = mujoco.MjData(model)
    data.qpos[:] = assembled(model, home, dofs[:m], wanted[0])
    passive = np.setdiff1d(np.arange(model.nv), dofs[:m])
    positions = np.empty((len(time), len(dofs) - m))
    for k, position in enumerate(wanted):
        data.qpos[addresses[:m]] = position
        try:
            close_loops(model, data, passive)
        except BenchError:
            raise BenchError(
                f"the loops cannot be closed where the trajectory is at {time[k]:.2f} s"
            ) from None
        positions[k] = data.qpos[addresses[m:]]
    return make_interp_spline(time, positions, k=5)
