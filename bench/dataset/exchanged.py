"""Two columns of positions that lie in each other's ranges: a log in which they are swapped."""

from collections.abc import Mapping, Sequence
from itertools import combinations

import numpy as np

from bench.dataset.joint_facts import JointFacts
from bench.dataset.recording_checks import LIMIT_SLACK, Array, Fault


def exchanged(positions: Mapping[str, Array], joints: Sequence[JointFacts]) -> dict[str, JointFacts]:
    """Joint -> the one in whose range its positions lie, of each two joints whose positions lie in each other's ranges
    and not in their joint's. positions: (N,) by joint, rad or m.
    """
    by_name: dict[str, JointFacts] = {}
    there = [joint for joint in joints if joint.name in positions]
    for first, second in combinations(there, 2):
        ours, theirs = positions[first.name], positions[second.name]
        if _inside(ours, first) or _inside(theirs, second):
            continue
        if _inside(ours, second) and _inside(theirs, first):
            by_name |= {first.name: second, second.name: first}
    return by_name


def exchange_fault(other: JointFacts) -> Fault:
    """What is said of a column that lies in another joint's range, whose column lies in this one's."""
    return Fault(
        "limits",
        None,
        f"lies in the range of {other.name}, [{other.lower:g}, {other.upper:g}], and position.{other.name} in the "
        "range of this joint: are the two columns swapped?",
    )


def without_exchange(findings: Sequence[Fault], other: JointFacts | None) -> list[Fault]:
    """Findings of a column, its unit and limits as one where it is swapped with that of another joint."""
    if other is None or not any(finding.check in ("units", "limits") for finding in findings):
        return list(findings)
    kept = [finding for finding in findings if finding.check not in ("units", "limits")]
    return [exchange_fault(other), *kept]


def _inside(values: Array, joint: JointFacts) -> bool:
    """Whether positions keep to a joint's range, as the check of limits has it; never where it has none."""
    if joint.lower is None or joint.upper is None or not values.size:
        return False
    slack = LIMIT_SLACK * (joint.upper - joint.lower)
    return bool(np.nanmin(values) >= joint.lower - slack and np.nanmax(values) <= joint.upper + slack)
