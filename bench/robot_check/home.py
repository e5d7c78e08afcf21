"""Is the robot assembled at home, and if not, which pose is?"""

from dataclasses import asdict

import numpy as np

from bench.model.closure import loop_jacobian, loop_residual
from bench.model.configuration import integrate, normalised
from bench.model.follow import SLACK
from bench.model.geometry import Geometry
from bench.model.mobility import column_scales, smallest_singular_values
from bench.model.passive_ranges import passive_ranges
from bench.robot_check.machine import to_mujoco
from bench.robot_check.outcome import Check, CheckCode, Verdict
from bench.robot_check.report import HomeSource, LoopLine

ASSEMBLED = 1e-6  # m or rad: a wider gap is an error
EXACT = 1e-9  # m or rad: a wider gap is reported
LONGEST_STEP = 0.2  # rad or m
ATTEMPTS = 200
STARTS = 60  # random ones
SEED = 20120606
DEPENDENT = 1e-7  # singular values below this share of the largest are omitted from a step


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
    """An assembled pose (nq,): from home with the motors held, else with all joints free, else from random starts.

    Of several the one counts that the motors hold best, those within the joint ranges first. None: no start closes.
    """
    every = np.arange(geometry.nv)
    home, random = geometry.home[:, None], _random_starts(geometry)
    for starts, free in (
        (home, geometry.passive),
        (home, every),
        (random, geometry.passive),
        (random, every),
    ):
        closed = _closed(geometry, starts, free)
        if len(closed):
            held = smallest_singular_values(geometry, closed)
            return np.asarray(closed[np.argmax(np.where(_within_ranges(geometry, closed), 1.0, 1e-3) * held)])
    return None


def _closed(geometry: Geometry, starts: np.ndarray, free: np.ndarray) -> np.ndarray:
    """The closed poses (K, nq) that Newton's method reaches from starts (nq, S), moving the velocities `free`."""
    q = starts
    for _ in range(ATTEMPTS):
        residual = loop_residual(geometry, q)
        jacobian = loop_jacobian(geometry, q)[:, free].transpose(2, 0, 1)
        step = np.zeros((geometry.nv, q.shape[1]))
        step[free] = -np.einsum("kfm,mk->fk", np.linalg.pinv(jacobian, rcond=DEPENDENT), residual)
        largest = np.abs(step).max(axis=0, initial=0.0)
        q = normalised(
            geometry, integrate(geometry, q, step * (LONGEST_STEP / np.maximum(largest, LONGEST_STEP)))
        )
        if largest.max() < EXACT:
            break
    return np.asarray(q[:, np.abs(loop_residual(geometry, q)).max(axis=0) < EXACT].T)


def _random_starts(geometry: Geometry) -> np.ndarray:
    """Poses (nq, STARTS): motors as at home, other joints anywhere in their ranges, or around home without any."""
    random = np.random.default_rng(SEED)
    velocities = (
        random.uniform(-1.0, 1.0, size=(geometry.nv, STARTS)) * (np.pi * column_scales(geometry))[:, None]
    )
    velocities[geometry.active] = 0.0
    q = integrate(geometry, np.repeat(geometry.home[:, None], STARTS, axis=1), velocities)
    for limit in passive_ranges(geometry):
        if np.isfinite(limit.low):
            q[limit.configuration] = random.uniform(limit.low, limit.high, size=STARTS)
    return normalised(geometry, q)


def _within_ranges(geometry: Geometry, q: np.ndarray) -> np.ndarray:
    """Whether each of the poses q (N, nq) keeps the ranges of all hinges and slides: (N,)."""
    within = np.ones(len(q), dtype=bool)
    for joint in geometry.joints:
        if joint.limits is not None and joint.kind in ("hinge", "slide"):
            at = q[:, joint.q.start] + joint.offset
            within &= (at >= joint.limits[0]) & (at <= joint.limits[1])
    return within


def _repeated(geometry: Geometry) -> bool:
    """Whether there are more equations than joints to close them."""
    return len(loop_residual(geometry, geometry.home[:, None])) > len(geometry.passive)
