"""Whether the robot is assembled at home, and if not, a pose in which it is."""

from collections.abc import Collection, Iterator, Mapping
from dataclasses import replace
from typing import Any

import mujoco
import numpy as np

from bench.model.bounds import CLOSURE
from bench.model.closure import loop_jacobian, loop_residual
from bench.model.configuration import integrate, normalised
from bench.model.geometry import Geometry, Joint, from_mujoco, to_mujoco
from bench.model.mobility import column_scales, free_motions, smallest_singular_values
from bench.model.passive_ranges import passive_ranges
from bench.robot_check.bounds import PLAUSIBLE
from bench.robot_check.couplings import contradictions
from bench.robot_check.outcome import Check, CheckCode, Verdict
from bench.robot_check.report import LoopLine

ASSEMBLED = 1e-6  # m or rad: a wider gap is an error
EXACT = 1e-9  # m or rad: a wider gap is reported
LONGEST_STEP = 0.2  # rad or m
ATTEMPTS = 200
STARTS = 60  # random ones
SEED = 20120606
INSIDE = 0.2  # of a joint's range: margin at both ends of poses put into their ranges
MARGIN = 0.05  # of a joint's range, which planned motions keep free at both ends
DEPENDENT = 1e-7  # singular values below this share of the largest are omitted from a step


def check_home(geometry: Geometry, loops: tuple[LoopLine, ...], source: Mapping[str, int | None]) -> Check:
    """Whether every loop is closed in the home pose; `source`: where that pose comes from."""
    if not loops:
        return Check(CheckCode.HOME_WITHOUT_LOOPS, "ok", source)
    widest = max(loops, key=lambda loop: max(loop.gap, loop.twist))
    gap = max(widest.gap, widest.twist)
    opening = {"gap": gap, "unit": "m" if widest.gap >= widest.twist else "rad", **source}
    if gap < EXACT:
        return Check(CheckCode.HOME_CLOSED, "ok", opening)
    opening["loop"] = widest.name
    closed = closed_pose(geometry)
    if (
        closed is None
        and gap < CLOSURE.slack
        and len(loop_residual(geometry, geometry.home[:, None])) > len(geometry.passive)
    ):
        return Check(CheckCode.HOME_OPEN_AS_LOOPS_DISAGREE, "note", opening)
    verdict: Verdict = "note" if gap < ASSEMBLED else "failed"
    if closed is None:
        fixed_gaps = _fixed_gaps(geometry)
        return Check(CheckCode.HOME_OPEN_AND_NO_CLOSED_POSE, verdict, {**opening, "fixed_gaps": fixed_gaps})
    return Check(CheckCode.HOME_OPEN, verdict, {**opening, "closed_qpos": file_qpos(geometry, closed)})


def _fixed_gaps(geometry: Geometry) -> dict[str, list[float]]:
    """By loop, the part (x, y, z) of its gap at home that no joint changes, m in world axes, for example that of a
    planar loop drawn out of its plane.
    """
    poses = _random_starts(geometry)
    rates = loop_jacobian(geometry, poses)
    residual = loop_residual(geometry, geometry.home[:, None])[:, 0]
    gaps, row = {}, 0
    for loop in geometry.loops:
        directions, sizes, _ = np.linalg.svd(rates[row : row + 3].reshape(3, -1), full_matrices=False)
        still = directions[:, sizes <= DEPENDENT * sizes[0]]
        gap = still @ (still.T @ residual[row : row + 3])
        if np.abs(gap).max() > ASSEMBLED:
            gaps[loop.name] = np.where(np.abs(gap) > ASSEMBLED, gap, 0.0).round(9).tolist()
        row += loop.size
    return gaps


def with_pose_in_ranges(geometry: Geometry, ranges: Check) -> Check:
    """The check of the joint ranges at home; if it failed, with a closed pose within them, or why there is none."""
    if ranges.verdict != "failed" or not geometry.closed:
        return ranges
    closed = closed_pose(geometry)
    within = closed is not None and bool(_within_ranges(geometry, closed[None])[0])
    return replace(ranges, values={**ranges.values, **_pose_or_reason(geometry, closed, within)})


def home_at_range_end(geometry: Geometry) -> list[Check]:
    """A note if a joint is within MARGIN of the end of its range at home, or beyond, with a pose further inside, or why
    there is none.
    """
    joint = _at_end(geometry, geometry.home)
    if joint is None or joint.limits is None:
        return []
    low, high = joint.limits
    pose, inside = _pose_inside(geometry)
    reason = _pose_or_reason(geometry, pose, inside)
    values = {"joint": joint.name, "lower": low, "upper": high, **reason}
    return [Check(CheckCode.HOME_AT_RANGE_END, "note", values)]


def _pose_or_reason(geometry: Geometry, closed: np.ndarray | None, accepted: bool) -> dict[str, Any]:
    """The closed pose (nq,) if it is accepted; else the couplings that contradict the ranges, and a joint that is not
    inside its range in this pose.
    """
    if closed is not None and accepted:
        return {"closed_qpos": file_qpos(geometry, closed)}
    outside = None if closed is None else _at_end(geometry, closed)
    return {
        "contradictions": contradictions(geometry, _inside(geometry)),
        "outside": None if outside is None else outside.name,
    }


def file_qpos(geometry: Geometry, q: np.ndarray) -> list[float]:
    """A pose (nq,) as a keyframe of the MJCF, with the locked joints."""
    return geometry.robot.file_qpos(to_mujoco(geometry.joints, q[None])[0].tolist())


def _pose_inside(geometry: Geometry) -> tuple[np.ndarray | None, bool]:
    """A pose (nq,) from starts inside the ranges, and whether every joint is further than MARGIN from their ends."""
    if not geometry.closed:
        return _put_into_ranges(geometry, geometry.home[:, None])[:, 0], True
    best = _best(geometry, _starts_inside(geometry))
    return best, best is not None and _at_end(geometry, best) is None


def _starts_inside(geometry: Geometry) -> Iterator[tuple[np.ndarray, np.ndarray]]:
    """Poses (nq, S) from which to close the loops, and the velocities that may change: home with the motors, then home
    and random poses with all joints put into their ranges, the joints without a range moved first.
    """
    home, every = geometry.home[:, None], np.arange(geometry.nv)
    ranged = [joint for joint, _, _ in _ranged(geometry)]
    unlimited = np.setdiff1d(every, [joint.v.start for joint in ranged])
    motors = [joint for joint in ranged if joint.v.start in geometry.active]
    inside = _newton(geometry, _put_into_ranges(geometry, home), unlimited)
    for start in (_put_into_ranges(geometry, home, motors), inside):
        for free in (geometry.passive, every):
            yield start, free
    yield _newton(geometry, _put_into_ranges(geometry, _random_starts(geometry)), unlimited), every


def closed_pose(geometry: Geometry) -> np.ndarray | None:
    """An assembled pose (nq,), if possible inside the joint ranges; None if the loops close from no start.

    Starts, in this order: the keyframes if none is named home, with the motors held; home, home with the joints put
    into their ranges, and random poses, each with the motors held, then with all joints free; random poses put into the
    ranges, with all joints free. The answer is the first pose of the highest grade that any of them has.
    """
    return _best(geometry, _starts(geometry))


def _best(geometry: Geometry, starts: Iterator[tuple[np.ndarray, np.ndarray]]) -> np.ndarray | None:
    """The first of the closed poses (nq,) with the highest grade, from the first start that reaches it; of the poses
    from one start, the one with the largest smallest singular value. Joints that nothing holds make no pose singular.

    Grades: 0 nearly singular, 3 regular; 1 more within all joint ranges, 2 more further inside than MARGIN.
    """
    best: np.ndarray | None = None
    highest = -1
    loose = free_motions(geometry, _random_starts(geometry).T)
    for start, free in starts:
        poses = _turned_into_ranges(geometry, _closed(geometry, start, free))
        if not len(poses):
            continue
        held = smallest_singular_values(geometry, poses, loose)
        inside = np.array([_at_end(geometry, pose) is None for pose in poses])
        grades = 3 * (held > PLAUSIBLE.regular) + _within_ranges(geometry, poses) + inside
        index = int(np.lexsort((held, grades))[-1])
        if grades[index] > highest:
            best, highest = np.asarray(poses[index]), int(grades[index])
        if highest == 5:
            break
    return best


def _starts(geometry: Geometry) -> Iterator[tuple[np.ndarray, np.ndarray]]:
    """Poses (nq, S) from which to close the loops, and the velocities that may change."""
    every, home = np.arange(geometry.nv), geometry.home[:, None]
    compiled = geometry.robot.mjcf_model()
    if compiled.nkey and mujoco.mj_name2id(compiled, mujoco.mjtObj.mjOBJ_KEY, "home") < 0:
        yield from_mujoco(geometry.joints, compiled.key_qpos).T, geometry.passive
    inside, random = _put_into_ranges(geometry, home), _random_starts(geometry)
    for starts in (home, inside, random):
        for free in (geometry.passive, every):
            yield starts, free
    yield _put_into_ranges(geometry, random), every


def _closed(geometry: Geometry, starts: np.ndarray, free: np.ndarray) -> np.ndarray:
    """The closed poses (K, nq) that Newton's method reaches from starts (nq, S) along the velocities `free`."""
    q = _newton(geometry, starts, free)
    return np.asarray(q[:, np.abs(loop_residual(geometry, q)).max(axis=0) < EXACT].T)


def _newton(geometry: Geometry, q: np.ndarray, free: np.ndarray) -> np.ndarray:
    """Poses q (nq, S) moved along the velocities `free` until the loops are closed as far as these can close them."""
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
    return q


def _random_starts(geometry: Geometry) -> np.ndarray:
    """Poses (nq, STARTS): motors at home, other joints random in their ranges, or around home if they have none."""
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


def _ranged(geometry: Geometry) -> Iterator[tuple[Joint, float, float]]:
    """Hinges and slides with a range, and its ends in the model's coordinates."""
    for joint in geometry.joints:
        if joint.limits is not None and joint.kind in ("hinge", "slide"):
            yield joint, joint.limits[0] - joint.offset, joint.limits[1] - joint.offset


def _put_into_ranges(
    geometry: Geometry, q: np.ndarray, joints: Collection[Joint] | None = None
) -> np.ndarray:
    """Poses q (nq, S) with hinges and slides (all, or `joints`) at least INSIDE of their range away from its ends."""
    q = q.copy()
    for joint, low, high in _ranged(geometry):
        if joints is not None and all(joint is not other for other in joints):
            continue
        margin = INSIDE * (high - low)
        q[joint.q] = np.clip(q[joint.q], low + margin, high - margin)
    return q


def _turned_into_ranges(geometry: Geometry, q: np.ndarray) -> np.ndarray:
    """The poses q (N, nq) with hinges outside their range turned into it by whole turns, if that is possible."""
    q = q.copy()
    for joint, low, high in _ranged(geometry):
        if joint.kind == "hinge":
            at = q[:, joint.q.start]
            turned = at - 2.0 * np.pi * np.floor((at - low) / (2.0 * np.pi))
            q[:, joint.q.start] = np.where(((at < low) | (at > high)) & (turned <= high), turned, at)
    return q


def _within_ranges(geometry: Geometry, q: np.ndarray) -> np.ndarray:
    """Whether each of the poses q (N, nq) is within the ranges of all hinges and slides: (N,)."""
    within = np.ones(len(q), dtype=bool)
    for joint, low, high in _ranged(geometry):
        at = q[:, joint.q.start]
        within &= (at >= low) & (at <= high)
    return within


def _inside(geometry: Geometry) -> dict[int, tuple[float, float]]:
    """By the index of a joint with a range, the positions further than MARGIN from its ends."""
    numbers = {joint.name: number for number, joint in enumerate(geometry.joints)}
    margins = (
        (joint, low, high, MARGIN * (high - low) + PLAUSIBLE.end) for joint, low, high in _ranged(geometry)
    )
    return {numbers[joint.name]: (low + margin, high - margin) for joint, low, high, margin in margins}


def _at_end(geometry: Geometry, q: np.ndarray) -> Joint | None:
    """The first joint within MARGIN of an end of its range, or beyond it, at q (nq,)."""
    for number, (low, high) in _inside(geometry).items():
        joint = geometry.joints[number]
        if not low < q[joint.q.start] < high:
            return joint
    return None
