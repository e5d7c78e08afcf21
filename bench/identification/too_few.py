"""Why equations are too few for the unknowns, and what motion or sampling would be enough."""

from math import ceil

import numpy as np

from bench.basics.errors import BenchError
from bench.basics.plural import plural
from bench.basics.sentence import and_list, in_percent
from bench.dataset.recording import Recording
from bench.dataset.recording_checks import only_noise
from bench.identification.decision import RULE
from bench.identification.prepare import Prepared
from bench.identification.tolerances import TOLERANCES


def refuse_too_few_equations(prepared: Prepared, moving: np.ndarray, unknowns: int) -> None:
    """Raise BenchError if fewer than two rows (M, n) per unknown come from motion.

    It names joints at rest; else how long such motions, or how high their log rate, must be.
    """
    equations, needed = int(moving.sum()), TOLERANCES.statistics.equations * unknowns
    if equations >= needed:
        return
    are = "is" if equations == 1 else "are"
    said = (
        f"{prepared.dataset.folder}: {plural(equations, 'equation')} after decimation {are} too few for "
        f"{plural(unknowns, 'unknown')}, at least {needed} are needed"
    )
    raise BenchError(f"{said}: {_standing_still(prepared) or _too_little(prepared, moving, needed)}")


def _standing_still(prepared: Prepared) -> str:
    """Joints at rest in all fitted logs; "" if all move."""
    logs = _fitted(prepared)
    joints = prepared.dataset.robot.joints
    still = [joint for j, joint in enumerate(joints) if all(only_noise(log.position[:, j]) for log in logs)]
    if not still:
        return ""
    position = "its position shows" if len(still) == 1 else "their positions show"
    return (
        f"{and_list(still)} {'stands' if len(still) == 1 else 'stand'} still, {position} only noise from sample to "
        "sample; record motions that keep all joints moving"
    )


def _too_little(prepared: Prepared, moving: np.ndarray, needed: int) -> str:
    """Required duration or log rate of such a motion."""
    logs = _fitted(prepared)
    seconds, rate = sum(float(np.ptp(log.time)) for log in logs), logs[0].rate
    more = needed / max(int(moving.sum()), 1)
    shares = dict(zip(prepared.dataset.robot.joints, moving.mean(axis=0), strict=True))
    slow = [f"{joint} {in_percent(share, 2)}" for joint, share in shares.items() if share < RULE.most]
    few = f" (usable rows, away from standstill and reversals: {', '.join(slow)})" if slow else ""
    return (
        f"{seconds:.3g} s of log at {rate:.3g} Hz are too little{few}; record such motions for {ceil(more * seconds)} "
        f"s, or log them at {ceil(more * rate)} Hz"
    )


def _fitted(prepared: Prepared) -> list[Recording]:
    return [entry.recording for entry in prepared.measured if entry.recording.use == "identify"]
