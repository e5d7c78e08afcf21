"""Is the robot assembled at home, and if not, which pose nearby is?"""

import numpy as np
import pinocchio as pin

from bench.model.closure import loop_jacobian, loop_residual
from bench.model.follow import SLACK
from bench.model.geometry import Geometry
from bench.model.tree import build_tree
from bench.robot_check.machine import to_mujoco
from bench.robot_check.report import Check, LoopLine, Verdict

ASSEMBLED = 1e-6  # m or rad: a wider gap is an error
EXACT = 1e-9  # m or rad: a wider gap is told
LONGEST_STEP = 0.2  # rad or m
ATTEMPTS = 200
DEPENDENT = 1e-7  # singular values below this share of the largest are left out of a step


def check_home(geometry: Geometry, loops: tuple[LoopLine, ...], source: str) -> Check:
    """Every loop closed in the home pose; `source` says where that pose comes from."""
    name = "home assembled"
    if not loops:
        return Check(name, "ok", f"no loops to close ({source})")
    widest = max(loops, key=lambda loop: max(loop.gap, loop.twist))
    gap = max(widest.gap, widest.twist)
    unit = "m" if widest.gap >= widest.twist else "rad"
    if gap < EXACT:
        return Check(name, "ok", f"widest gap {gap:.1e} {unit} ({source})" if gap else f"no gap ({source})")
    told = f"loop {widest.name!r} is open by {gap:.3g} {unit} ({source})"
    closed = closed_pose(geometry)
    if closed is None and gap < SLACK and _repeated(geometry):
        agree = f"{told}; loops that repeat one another disagree, least squares close them"
        return Check(name, "note", agree)
    if closed is None:
        return Check(name, _verdict(gap), f"{told}; no closed pose was found near it: check the lengths")
    qpos = " ".join(f"{value:.16g}" for value in to_mujoco(geometry, closed))
    return Check(
        name, _verdict(gap), f'{told}; closed with the motors held: <key name="home" qpos="{qpos}"/>'
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


def _verdict(gap: float) -> Verdict:
    return "note" if gap < ASSEMBLED else "failed"
