"""Is the robot assembled at home, and if not, which pose nearby is?"""

from dataclasses import asdict

import numpy as np
import pinocchio as pin

from bench.model.closure import loop_jacobian, loop_residual
from bench.model.follow import SLACK
from bench.model.geometry import Geometry
from bench.model.tree import build_tree
from bench.robot_check.machine import to_mujoco
from bench.robot_check.outcome import Check, CheckCode, Verdict
from bench.robot_check.report import HomeSource, LoopLine

ASSEMBLED = 1e-6  # m or rad: a wider gap is an error
EXACT = 1e-9  # m or rad: a wider gap is told
LONGEST_STEP = 0.2  # rad or m
ATTEMPTS = 200
DEPENDENT = 1e-7  # singular values below this share of the largest are left out of a step


def check_home(geometry: Geometry, loops: tuple[LoopLine, ...], source: HomeSource) -> Check:
    """Every loop closed in the home pose; `source` says where that pose comes from."""
    origin = asdict(source)
    if not loops:
        return Check(CheckCode.HOME_WITHOUT_LOOPS, "ok", origin)
    widest = max(loops, key=lambda loop: max(loop.gap, loop.twist))
    gap = max(widest.gap, widest.twist)
    opening = {"gap": gap, "unit": "m" if widest.gap >= widest.twist else "rad", **origin}
    if gap < EXACT:
        return Check(CheckCode.HOME_CLOSED, "ok", opening)
    opening["loop"] = widest.name
    closed = closed_pose(geometry)
    if closed is None and gap < SLACK and _repeated(geometry):
        return Check(CheckCode.HOME_OPEN_AS_LOOPS_DISAGREE, "note", opening)
    verdict: Verdict = "note" if gap < ASSEMBLED else "failed"
    if closed is None:
        return Check(CheckCode.HOME_OPEN_AND_NO_CLOSED_POSE, verdict, opening)
    return Check(
        CheckCode.HOME_OPEN, verdict, {**opening, "closed_qpos": to_mujoco(geometry, closed).tolist()}
    )


def closed_pose(geometry: Geometry) -> np.ndarray | None:
    """The pose (nq,) that Newton's method reaches from home, motors held; None if it does not close."""
    model, passive = build_tree(geometry), geometry.passive
    q = geometry.home
    for _ in range(ATTEMPTS):
        residual = loop_residual(geometry, q[:, None])[:, 0]
        step = np.zeros(geometry.nv)
        jacobian = loop_jacobian(geometry, q[:, None])[:, passive, 0]
        step[passive] = -np.linalg.lstsq(jacobian, residual, rcond=DEPENDENT)[0]
        largest = float(np.abs(step).max(initial=0.0))
        q = pin.integrate(model, q, step * min(1.0, LONGEST_STEP / max(largest, LONGEST_STEP)))
        if largest < EXACT:
            break
    return q if np.abs(loop_residual(geometry, q[:, None])).max() < EXACT else None


def _repeated(geometry: Geometry) -> bool:
    """Whether there are more equations than joints to close them."""
    return len(loop_residual(geometry, geometry.home[:, None])) > len(geometry.passive)
