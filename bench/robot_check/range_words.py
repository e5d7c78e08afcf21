"""Joint ranges, at home and in motion, and couplings in words: the arguments are the values of a check."""

from collections.abc import Mapping, Sequence

from bench.basics.joint_units import written_position
from bench.basics.sentence import and_list
from bench.robot_check.bounds import PLAUSIBLE
from bench.robot_check.outcome import RangeConflict, RangeLeft


def without_rounding(position: float) -> float:
    """A joint's position as printed, rad or m: zero where closing the loops has moved it no further from zero."""
    return 0.0 if abs(position) < PLAUSIBLE.still else position


def home_key(qpos: Sequence[float]) -> str:
    """The keyframe home as an MJCF element, with all joint positions in MuJoCo's order."""
    return f'<key name="home" qpos="{" ".join(f"{written_position(value):.15g}" for value in qpos)}"/>'


def coupling_equation(
    coupling: str, first: Mapping[str, float], second: Mapping[str, float], polynomial: Sequence[float]
) -> str:
    """A coupling as an equation of joint positions, relative to qpos0."""
    left_side, right_side = (
        " + ".join(f"{factor:g} {joint}" for joint, factor in side.items()) for side in (first, second)
    )
    if tuple(polynomial) == (0.0, 1.0):
        return f"{coupling}: {left_side} = {right_side}"
    powers = [f"{c:g}" if k == 0 else f"{c:g} x^{k}" for k, c in enumerate(polynomial) if c]
    return f"{coupling}: {left_side} = {' + '.join(powers) or '0'}{f' with x = {right_side}' if right_side else ''}"


def outside_range(
    joint: str,
    home: float,
    unit: str,
    lower: float,
    upper: float,
    closed_qpos: Sequence[float] = (),
    contradictions: Sequence[RangeConflict] | None = None,
    outside: str | None = None,
) -> str:
    """A joint outside its range at home, with a pose within all ranges, or why there is none."""
    said = f"joint {joint!r} is at {home:.6g} {unit} at home, outside its range [{lower:g}, {upper:g}]"
    if len(closed_qpos):
        return f"{said}; this pose closes within all ranges: {home_key(closed_qpos)}"
    return said if contradictions is None else f"{said}; {_no_pose_inside(contradictions, outside or joint)}"


def at_range_end(
    joint: str,
    lower: float,
    upper: float,
    closed_qpos: Sequence[float] = (),
    contradictions: Sequence[RangeConflict] = (),
    outside: str | None = None,
) -> str:
    """A home without room for motions, with a pose that has some, or why there is none."""
    said = (
        f"home is at the end of the range of {joint!r}, {lower:.4g} to {upper:.4g}; bench excite starts its motions at "
        "home and needs room on both sides"
    )
    if len(closed_qpos):
        return f"{said}; this pose closes further inside: {home_key(closed_qpos)}"
    return f"{said}; {_no_pose_inside(contradictions, outside or joint)}"


def _no_pose_inside(contradictions: Sequence[RangeConflict], outside: str) -> str:
    """Why no pose is proposed; outside: a joint that is at or beyond the end of its range in the best one."""
    if not contradictions:
        return (
            f"no pose was reached with all joints inside their ranges: widen that of {outside!r} in the MJCF"
        )
    reasons = "; ".join(map(_contradicted, contradictions))
    return (
        f"no pose has all joints inside their ranges: {reasons}; in the MJCF, widen the range of a joint of each "
        "coupling, or correct the coupling"
    )


def _contradicted(contradiction: RangeConflict) -> str:
    equation = coupling_equation(
        contradiction["coupling"],
        contradiction["first"],
        contradiction["second"],
        contradiction["polynomial"],
    )
    ranges = and_list(
        [f"{each['lower']:.4g} to {each['upper']:.4g} of {each['joint']}" for each in contradiction["ranges"]]
    )
    return f"coupling {equation} contradicts the ranges {ranges}"


def ranges_left(joints: Sequence[RangeLeft]) -> str:
    """Joints that leave their ranges, by range."""
    by_range: dict[str, list[str]] = {}
    for joint in joints:
        motor = "redundant motor, " if joint["redundant"] else ""
        travel = " to ".join(f"{without_rounding(end):.3g}" for end in (joint["lowest"], joint["highest"]))
        ends = f"[{joint['lower']:.4g}, {joint['upper']:.4g}]"
        by_range.setdefault(ends, []).append(f"{joint['joint']!r} ({motor}{travel})")
    ranges = "; ".join(f"range {ends} of {', '.join(moved)}" for ends, moved in by_range.items())
    motors = "the other motors" if any(joint["redundant"] for joint in joints) else "the motors"
    count = f"{len(joints)} joints leave theirs" if len(joints) > 1 else "a joint leaves its own"
    return f"while {motors} move within their ranges, {count}, as the model has no end stops: {ranges}"
