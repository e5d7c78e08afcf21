"""Proof that all limits are kept at every time, by intervals of time, cut if undecided."""

from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from bench.basics.errors import BenchError
from bench.excitation.bounds import PROOF
from bench.excitation.experiment.between_samples import Intervals, intervals_of, motor_balls
from bench.excitation.experiment.enclosed_loops import PoseSets, begins_at_home, enclosed, follows, pose_sets
from bench.excitation.experiment.nominal import Nominal
from bench.excitation.experiment.open_limits import Kept, Limit, margins
from bench.excitation.experiment.room import Room
from bench.model.geometry import Geometry
from bench.model.motion import Motion, blocks_of, joined, motion_near, motion_of
from bench.scenario.trajectory import FourierTrajectory

LOOPS: Limit = (Kept.LOOPS, "")


@dataclass(frozen=True)
class Proof:
    """Proof that a motion keeps all limits: number of intervals, and length of the shortest in seconds."""

    intervals: int
    shortest: float


@dataclass(frozen=True)
class Unproven:
    """A limit that could not be proven at a time, s; None if the loops could not be closed somewhere.

    where: the joint or the number of the box, "" for the whole robot; exceeded: whether it is exceeded there; why:
    message on loops that could not be closed.
    """

    limit: Kept
    where: str
    time: float | None
    exceeded: bool
    why: str = ""


@dataclass(frozen=True)
class _Looked:
    """Intervals, the motion in their middles, and their values of `Enclosure` and `PoseSets`; open, exceeded (K, L):
    limits that are not proven, and those not kept in the middle; parts (K,): number into which an open interval is cut.
    """

    intervals: Intervals
    motion: Motion
    strays: np.ndarray
    reach: np.ndarray
    limits: tuple[Limit, ...]
    open: np.ndarray
    exceeded: np.ndarray
    parts: np.ndarray


@dataclass(frozen=True)
class Promise:
    """A motion with all its limits, carrying a payload or None."""

    nominal: Nominal
    room: Room
    trajectory: FourierTrajectory
    payload: str | None


def prove(promise: Promise, *, around: float | None = None) -> Proof | Unproven:
    """Prove that the robot keeps its loops closed and clear of singular poses, its passive joints' ranges, the boxes of
    its tool and the torques of its motors at all times; or what could not be proven, and when.

    around, s: examine only times near it. Ranges, speeds and accelerations of the motors follow from the trajectory
    alone, see `between_samples`.
    """
    geometry, trajectory = promise.nominal.model.geometry, promise.trajectory
    intervals = intervals_of(trajectory, PROOF.rate)
    try:
        motion = motion_of(geometry, intervals.middle, *trajectory.evaluate(intervals.middle))
    except BenchError as error:  # out of reach, or through a singular pose
        return Unproven(*LOOPS, None, exceeded=True, why=str(error))
    amplified = np.abs(motion.jacobian).max(axis=(1, 2)) > promise.room.joint.amplification
    if geometry.closed and amplified.any():  # before any time is spent between samples
        return _amplified(geometry, motion, int(np.argmax(amplified)))
    if around is not None:
        chosen = np.flatnonzero(np.abs(intervals.middle - around) <= PROOF.around)
        intervals, motion = intervals.at(chosen), motion.at(chosen)
    known = _looked(promise, *_cut_ahead(promise, intervals, motion))
    while True:
        known = _followed(geometry, known)
        undecided = np.asarray(known.open.any(axis=1))
        if not undecided.any():
            return Proof(len(undecided), 2.0 * float(known.intervals.half.min()))
        if known.exceeded.any() or known.intervals.half.min() < PROOF.shortest * intervals.half.max():
            return _first(geometry, known)
        parts = known.parts[undecided]
        finer = known.intervals.at(undecided).cut(parts)
        near = known.motion.at(np.repeat(np.flatnonzero(undecided), parts))
        try:
            motion = motion_near(
                geometry, replace(near, time=finer.middle), *trajectory.evaluate(finer.middle)
            )
        except BenchError as error:
            return replace(_first(geometry, known), why=str(error))
        known = _merged(known, ~undecided, _looked(promise, finer, motion))


def _cut_ahead(promise: Promise, intervals: Intervals, motion: Motion) -> tuple[Intervals, Motion]:
    """Intervals, cut in advance if a few of them show that their loops would not be held."""
    geometry, few = promise.nominal.model.geometry, np.arange(0, len(intervals.half), PROOF.ahead)
    sampled = intervals.at(few)
    sets = pose_sets(geometry, sampled, motor_balls(promise.trajectory, sampled), motion.at(few))
    parts = np.append(np.where(sets.held, 1, _parts(sets)), 1)
    before = np.arange(len(intervals.half)) // PROOF.ahead
    parts = np.maximum(parts[before], parts[before + 1])
    finer = intervals.cut(parts)
    near = replace(motion.at(np.repeat(np.arange(len(parts)), parts)), time=finer.middle)
    try:
        return finer, motion_near(geometry, near, *promise.trajectory.evaluate(finer.middle))
    except BenchError:  # in which interval is determined later
        return intervals, motion


def _looked(promise: Promise, intervals: Intervals, motion: Motion) -> _Looked:
    """Results for intervals, one by one."""
    geometry = promise.nominal.model.geometry
    rates = bool(np.isfinite(promise.room.torque).any())
    parts = []
    for block in blocks_of(len(intervals.half), PROOF.together):
        in_block = Intervals(intervals.middle[block], intervals.half[block])
        motors, middles = motor_balls(promise.trajectory, in_block), motion.at(block)
        sets = pose_sets(geometry, in_block, motors, middles)
        held = sets.held
        enclosure = enclosed(
            geometry, in_block.at(held), motors.at(held), middles.at(held), sets.at(held), rates=rates
        )
        by_limit = margins(promise.nominal, promise.room, promise.payload, enclosure)
        strays = np.zeros_like(middles.v)
        strays[held] = enclosure.strays
        still, exceeded = np.zeros((2, len(held), 1 + len(by_limit)), dtype=bool)
        still[~held] = True
        for k, margin in enumerate(by_limit.values(), start=1):
            still[held, k] = ~(margin.least > 0.0)
            exceeded[held, k] = ~(margin.middle > 0.0)
        limits = (LOOPS, *by_limit)
        parts.append(_Looked(in_block, middles, strays, sets.reach, limits, still, exceeded, _parts(sets)))
    return _joined(parts)


def _parts(sets: PoseSets) -> np.ndarray:
    """Number of parts of an interval in which its loops are held, since the radius of I - C A_p is nearly proportional
    to its length; two if it is open for another reason.
    """
    ratio = np.nan_to_num(PROOF.more_parts * sets.excess, nan=PROOF.parts, posinf=PROOF.parts)
    return np.where(sets.held, 2, np.clip(np.ceil(ratio), 2, PROOF.parts)).astype(int)


def _followed(geometry: Geometry, known: _Looked) -> _Looked:
    """The same, with open loops if two intervals are held, but it is not proven that the first's motion continues in
    the second.
    """
    if not geometry.closed:
        return known
    q, still, held = known.motion.q, known.open.copy(), ~known.open[:, 0]
    apart = (
        ~follows(geometry, known.intervals, known.motion, known.strays, known.reach) & held[:-1] & held[1:]
    )
    still[:-1, 0] |= apart
    still[1:, 0] |= apart
    if known.intervals.middle[0] < 2.0 * known.intervals.half[0]:
        still[0, 0] |= not begins_at_home(geometry, q, known.reach)
    return replace(known, open=still)


ARRAYS = ("strays", "reach", "open", "exceeded", "parts")  # of `_Looked`, by interval


def _joined(parts: list[_Looked]) -> _Looked:
    """Parts concatenated."""
    middle, half = (
        np.concatenate([getattr(part.intervals, name) for part in parts]) for name in ("middle", "half")
    )
    arrays: dict[str, Any] = {
        name: np.concatenate([getattr(part, name) for part in parts]) for name in ARRAYS
    }
    motion = joined([part.motion for part in parts])
    return replace(parts[0], intervals=Intervals(middle, half), motion=motion, **arrays)


def _merged(known: _Looked, kept: np.ndarray, finer: _Looked) -> _Looked:
    """Those intervals that were kept and the finer ones, in order of time."""
    both = _joined([_at(known, kept), finer])
    return _at(both, np.argsort(both.intervals.middle, kind="stable"))


def _at(known: _Looked, chosen: np.ndarray) -> _Looked:
    arrays: dict[str, Any] = {name: getattr(known, name)[chosen] for name in ARRAYS}
    intervals, motion = known.intervals.at(chosen), known.motion.at(chosen)
    return replace(known, intervals=intervals, motion=motion, **arrays)


def _first(geometry: Geometry, known: _Looked) -> Unproven:
    """The first exceeded limit, else the first open one; see `_amplified`."""
    exceeded = bool(known.exceeded.any())
    which = known.exceeded if exceeded else known.open
    interval = int(np.argmax(which.any(axis=1)))
    limit, where = known.limits[int(np.argmax(which[interval]))]
    if limit is Kept.AMPLIFICATION:
        return replace(_amplified(geometry, known.motion, interval), exceeded=exceeded)
    return Unproven(limit, where, float(known.intervals.middle[interval]), exceeded)


def _amplified(geometry: Geometry, motion: Motion, sample: int) -> Unproven:
    """The finding that a joint, the fastest at a sample, moves too fast for the motors' speed there."""
    fastest = int(np.abs(motion.jacobian[sample]).max(axis=1).argmax())
    where = geometry.joint_at(fastest).name
    return Unproven(Kept.AMPLIFICATION, where, float(motion.time[sample]), exceeded=True)
