"""Checks of a log's signals: wrong units, limits, constant, stuck, spiked, clipped.

Each check looks at one column and returns the first finding or None. They are designed to stay silent on clean, noisy,
quantised and slow data: a signal is compared with itself, with a tolerance for its resolution (its smallest step). A
finding can still be a false alarm: accept = ["saturated"] skips a check for a recording.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import get_args

import numpy as np
import numpy.typing as npt

from bench.basics.files.recording_fault import Remedy
from bench.basics.joint_units import joint_units
from bench.basics.plural import and_more
from bench.dataset.joint_facts import JointFacts
from bench.dataset.names import Check

CHECKS: tuple[Check, ...] = get_args(Check)

DEGREES = 180.0 / np.pi
CENTI, MILLI = 100.0, 1000.0
LARGER: Mapping[str, tuple[tuple[float, str, Remedy], ...]] = {
    "hinge": ((DEGREES, "degrees", Remedy.FROM_DEGREES), (MILLI, "milliradians", Remedy.FROM_MILLIRADIANS)),
    "slide": (
        (MILLI, "millimetres", Remedy.FROM_MILLIMETRES),
        (CENTI, "centimetres", Remedy.FROM_CENTIMETRES),
        (MILLI**2, "micrometres", Remedy.FROM_MICROMETRES),
    ),
}
"""Units that a position may be in by mistake, likeliest first: number of them in one SI unit, name, remedy."""
SMALLER = {"hinge": (DEGREES, MILLI), "slide": (MILLI,)}
"""Factors by which a position is too small if it was scaled although it was in SI."""
FAR_BELOW = 10.0  # times a position, which is suspiciously small if home is farther
FULL_TURN = 2.0 * np.pi
LIMIT_SLACK = 0.05  # of a joint's range: stops are elastic, and an encoder's zero may be slightly off
FASTEST = {"hinge": 30.0, "slide": 20.0}  # rad/s, m/s: more is suspicious for a joint without a range
LARGEST_CURRENT = 500.0  # A or V
LARGEST_EFFORT = 1e5  # N·m or N, in a log of torques or forces

Array = npt.NDArray[np.float64]


@dataclass(frozen=True)
class Fault:
    """A fault of one column. `row` (0 is the first) is None for a fault of the whole column. remedy: its cure."""

    check: Check
    row: int | None
    what: str
    remedy: Remedy | None = None


@dataclass(frozen=True, eq=False)
class Channel:
    """values (N,); step, s, between samples; joint: of a position; effort: whether currents are torques or forces."""

    values: Array
    step: float
    joint: JointFacts | None = None
    effort: bool = False


def find(channel: Channel, accepted: frozenset[str] = frozenset()) -> list[Fault]:
    """The findings of all checks that are not accepted, at most one for each check.

    A finding of wrong units supersedes that of limits, since a signal in the wrong unit is beyond its limits as well.
    """
    catalogue = CURRENT_CHECKS if channel.joint is None else POSITION_CHECKS
    checked = (check(channel) for name, check in catalogue.items() if name not in accepted)
    findings = [finding for finding in checked if finding is not None]
    superseded = "limits" if any(finding.check == "units" for finding in findings) else ""
    return [finding for finding in findings if finding.check != superseded]


def constant(channel: Channel) -> Fault | None:
    """A signal that never changes, or a position with only noise."""
    values = channel.values
    span = np.ptp(values)
    if span == 0.0:
        return Fault("constant", None, f"is constant ({values[0]:g} throughout)")
    if channel.joint is not None and span < 1e-3 and only_noise(values):
        return Fault("constant", None, f"does not move: only noise within {span:.2g}")
    return None


def only_noise(values: Array) -> bool:
    """Whether values (N,) resemble white noise, whose differences have an RMS of √2 standard deviations."""
    return bool(np.sqrt(np.mean(np.diff(values) ** 2)) >= 0.5 * values.std())


def position_units(channel: Channel) -> Fault | None:
    """Degrees for radians, millimetres for metres: values far beyond the joint's range that lie in it once divided;
    or values too small that lie in it once multiplied, because a scale was given although they were in SI.

    A joint without a range is judged by its speed and its distance from home. A motor's position before its gear,
    which may turn far and fast, is not judged without a range.
    """
    joint, values = _joint(channel), channel.values
    right = "radians" if joint.kind == "hinge" else "metres"
    if joint.lower is None or joint.upper is None:
        factor, wrong, remedy = LARGER[joint.kind][0]
        suspicious, why = _far_without_range(joint, values, channel.step, factor)
        if joint.geared:
            return None
        if suspicious:
            return Fault("units", None, f"looks like {wrong}, {right} are expected: {why}", remedy)
        return _too_small_for_home(joint, values, right)
    span = joint.upper - joint.lower
    outside = np.maximum(joint.lower - values, values - joint.upper)
    why = f"up to {outside.max():.4g} outside of [{joint.lower:g}, {joint.upper:g}]"
    for factor, wrong, remedy in LARGER[joint.kind]:
        if outside.max() > span and _fits(values / factor, joint.lower, joint.upper):
            return Fault("units", None, f"looks like {wrong}, {right} are expected: {why}", remedy)
    for factor in SMALLER[joint.kind]:
        if outside.min() > LIMIT_SLACK * span and _fits(values * factor, joint.lower, joint.upper):
            return _too_small(factor, right, why)
    return None


def _fits(values: Array, lower: float, upper: float) -> bool:
    """Whether positions lie in a range extended by a tenth of its width at both ends."""
    slack = 0.1 * (upper - lower)
    return bool(lower - slack <= values.min() and values.max() <= upper + slack)


def _too_small_for_home(joint: JointFacts, values: Array, right: str) -> Fault | None:
    """Positions far below the home position that contain it, or nearly, once multiplied."""
    for factor in SMALLER[joint.kind]:
        low, high = factor * values.min(), factor * values.max()
        travel = high - low
        if np.abs(values).max() < abs(joint.home) / FAR_BELOW and low - travel <= joint.home <= high + travel:
            return _too_small(factor, right, f"at most {np.abs(values).max():.3g}, home is {joint.home:.3g}")
    return None


def _too_small(factor: float, right: str, why: str) -> Fault:
    what = f"looks {factor:.4g} times too small for {right}: {why} (is it in {right} already, and scaled?)"
    return Fault("units", None, what)


def _far_without_range(joint: JointFacts, values: Array, step: float, factor: float) -> tuple[bool, str]:
    lag = max(1, round(0.005 / step))
    speed = float(np.quantile(np.abs(values[lag:] - values[:-lag]), 0.99)) / (lag * step)
    distance = np.abs(values - joint.home)
    fast = speed > FASTEST[joint.kind]
    hint = "give the joint a range in the MJCF if it is right"
    if joint.kind == "slide":
        why = f"up to {distance.max():.4g} from home, {speed:.4g} per second ({hint})"
        return bool(fast or distance.max() > FASTEST["slide"]), why
    one_turn = bool(np.abs(values / factor).max() < 1.1 * FULL_TURN)
    far = distance.max() > 2 * FULL_TURN and (joint.in_loop or fast)
    why = f"up to {distance.max() / FULL_TURN:.3g} turns from home, {speed:.4g} rad/s ({hint})"
    return bool(one_turn and (far or distance.min() > FULL_TURN)), why


def limits(channel: Channel) -> Fault | None:
    """A position beyond the joint's range in the MJCF, by more than 5 % of that range."""
    joint, values = _joint(channel), channel.values
    if joint.lower is None or joint.upper is None:
        return None
    slack = LIMIT_SLACK * (joint.upper - joint.lower)
    outside = np.flatnonzero((values < joint.lower - slack) | (values > joint.upper + slack))
    if not outside.size:
        return None
    row = int(outside[0])
    unit = joint_units(joint.kind == "hinge").position
    what = f"{values[row]:g} {unit} is outside of the joint's range [{joint.lower:g}, {joint.upper:g}]"
    return Fault("limits", row, f"{what}{and_more(outside.size)}")


def current_units(channel: Channel) -> Fault | None:
    """Milliamperes or counts for amperes: no robot drive commands such values. Torques and forces may be larger."""
    large = np.quantile(np.abs(channel.values), 0.99)
    most, units = (LARGEST_EFFORT, "N·m or N") if channel.effort else (LARGEST_CURRENT, "A or V")
    if large <= most:
        return None
    what = f"reaches {large:.4g}: {units} are expected, it looks like thousandths"
    return Fault("units", None, what, Remedy.FROM_THOUSANDTHS)


def position_spikes(channel: Channel) -> Fault | None:
    """Isolated steps: a glitch (there and back), a lost count, or an angle wrapped at a full turn.

    A step counts if it exceeds eight times the 95th percentile of all steps, plus four times the resolution, and
    eight times every other step within six samples, except for one (the step back).
    """
    values = channel.values
    steps = np.abs(np.diff(values))
    floor = 8.0 * np.quantile(steps, 0.95) + 4.0 * resolution(values)
    large = np.flatnonzero(steps > floor)
    alone = [k for k in large.tolist() if _stands_alone(steps, k)]
    if not alone:
        return None
    row, k = alone[0] + 1, alone[0]
    jump = values[row] - values[k]
    back = k + 1 in large and abs(values[row + 1] - values[k]) < 0.5 * abs(jump)
    turns = jump / FULL_TURN
    wraps = _joint(channel).kind == "hinge" and round(turns) != 0 and abs(turns - round(turns)) < 0.05
    count = len(alone) // 2 if back else len(alone)
    what = "spikes" if back else "jumps"
    hint = ": an angle wrapped at a full turn? unwrap it" if wraps and not back else ""
    return Fault("spikes", row, f"{what} by {jump:.4g} from one sample to the next{hint}{and_more(count)}")


def _stands_alone(steps: Array, k: int) -> bool:
    around = np.sort(np.delete(steps[max(0, k - 6) : k + 7], min(k, 6)))
    return bool(around[-2] < steps[k] / 8.0)


def current_spikes(channel: Channel) -> Fault | None:
    """A single sample farther than five times the range of the others from their median: a corrupt number."""
    values = channel.values
    low, middle, high = np.quantile(values, (0.0025, 0.5, 0.9975))
    distance = np.abs(values - middle)
    far = np.flatnonzero(distance > 5.0 * (high - low))
    if not 0 < far.size <= max(2, values.size // 500):
        return None
    beside = np.maximum(np.append(distance[1:], 0.0), np.append(0.0, distance[:-1]))
    alone = [k for k in far.tolist() if beside[k] < distance[k] / 5.0]
    if not alone:
        return None
    return Fault("spikes", alone[0], f"spikes to {values[alone[0]]:.4g} for one sample{and_more(len(alone))}")


def frozen(channel: Channel) -> Fault | None:
    """A position that stops or restarts within one sample and repeats one value in between.

    Rest is no fault: a joint brakes before it rests. The change of speed where the value sticks must exceed six times
    the usual one in the rest of the recording, plus six times the resolution.
    """
    values = channel.values
    lag = max(1, round(0.004 / channel.step))
    starts, lengths = runs(values)
    long = lengths >= max(10, 3 * lag)
    if not long.any():
        return None
    first, last = starts[long], (starts + lengths - 1)[long]
    bend = np.zeros_like(values)
    bend[lag:-lag] = np.abs(values[2 * lag :] - 2.0 * values[lag:-lag] + values[: -2 * lag])
    edges = np.concatenate([first, last])
    elsewhere = np.ones(values.size, dtype=bool)
    for shift in range(-lag, lag + 1):
        elsewhere[np.clip(edges + shift, 0, values.size - 1)] = False
    usual = np.quantile(bend[elsewhere], 0.995) if elsewhere.any() else 0.0
    limit = 6.0 * usual + 6.0 * resolution(values)
    stuck = np.flatnonzero((bend[first] > limit) | (bend[last] > limit))
    if not stuck.size:
        return None
    row, count = int(first[stuck[0]]), int(lengths[long][stuck[0]])
    what = f"is stuck at {values[row]:g} for {count} samples though the joint is moving"
    return Fault("frozen", row, f"{what}{and_more(stuck.size)}")


def saturated(channel: Channel) -> Fault | None:
    """A current clipped at its largest or smallest value.

    The extreme value is held for at least five consecutive samples and twice as long as other values usually are. It
    occurs at least ten times, and five times as often as any of the four levels next to it. (A smooth peak of a
    quantised signal occurs at most 2.4 times as often.) A signal of fewer than 200 levels is too coarse to judge:
    friction alone holds it at one level.
    """
    values = channel.values
    level = resolution(values)
    if np.ptp(values) < 200 * level or level == 0.0:
        return None
    starts, lengths = runs(values)
    inside = (values[starts] != values.max()) & (values[starts] != values.min())
    usual = float(np.quantile(lengths[inside], 0.995)) if inside.any() else 1.0
    shortest = max(5.0, 2.0 * usual)
    for extreme, sign in ((values.max(), -1.0), (values.min(), 1.0)):
        held = (values[starts] == extreme) & (lengths >= shortest)
        if not held.any():
            continue
        depth = np.round(sign * (values - extreme) / level)
        counts = np.bincount(depth[depth < 5].astype(np.int64), minlength=5)
        if counts[0] >= 10 and counts[0] >= 5 * counts[1:5].max():
            what = f"is held at its extreme, {extreme:g}: {counts[0]} samples are clipped"
            return Fault("saturated", int(starts[held][0]), what)
    return None


def runs(values: Array) -> tuple[npt.NDArray[np.intp], npt.NDArray[np.intp]]:
    """Start and length of each run of equal samples in (N,) values, both (number of runs,)."""
    starts = np.concatenate([[0], np.flatnonzero(np.diff(values)) + 1])
    return starts, np.diff(np.concatenate([starts, [values.size]]))


def resolution(values: Array) -> float:
    """The smallest step of values (N,): the quantum of a quantised signal, tiny for others, 0 for a constant."""
    steps = np.abs(np.diff(values))
    large = steps[steps > 1e-9 * np.ptp(values)]
    return float(large.min()) if large.size else 0.0


def _joint(channel: Channel) -> JointFacts:
    if channel.joint is None:
        raise TypeError("this check is for positions")
    return channel.joint


_Function = Callable[[Channel], Fault | None]
POSITION_CHECKS: Mapping[str, _Function] = {
    "constant": constant,
    "frozen": frozen,
    "spikes": position_spikes,
    "units": position_units,
    "limits": limits,
}
CURRENT_CHECKS: Mapping[str, _Function] = {
    "constant": constant,
    "spikes": current_spikes,
    "units": current_units,
    "saturated": saturated,
}
