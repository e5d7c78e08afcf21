"""Where a model fails, in sentences."""

import math
from collections.abc import Iterator

from bench.basics.sentence import in_percent
from bench.effects.display_names import spoken
from bench.identification.decision import RULE
from bench.identification.wording import motor_words, with_error
from bench.residuals.bounds import NAMING
from bench.residuals.look_alikes import LookAlike
from bench.residuals.motor import Compared, relative_error_of, relative_noise
from bench.residuals.opposing_motion import Change
from bench.residuals.periods import SpectralLine
from bench.residuals.profile import Dependence
from bench.residuals.regions import Concentration, RegionKind, RegionPlace
from bench.residuals.residuals import MotorErrors, WhereItFails

MOST_LOOKS, MOST_NAMES = 2, 4
OVERLAPPING = (
    "Shares of one motor's squared error overlap: each describes the same error in another way, so they do not add up "
    "to 100 %."
)
CHANGES = {
    "warm-up": "friction changes while it moves, as during warm-up",
    "load": "friction changes with the load",
}


def where_sentences(where: WhereItFails) -> list[str]:
    """One sentence for every motor, and one for each finding about its error."""
    return [line for motor in where.motors for line in (level_sentence(motor), *finding_sentences(motor))]


def overlapping(where: WhereItFails) -> str:
    """How two shares of one motor's error overlap; "" if no motor has two."""
    for motor in where.motors:
        patterns = (*motor.concentrations, *motor.dependences, *motor.lines)
        if sum(not getattr(finding, "of_rest", False) for finding in patterns) > 1:
            return OVERLAPPING
    return ""


def whole_sentences(motor: MotorErrors) -> list[str]:
    """The size and the variables of one motor's error, as sentences with a capital letter and a full stop."""
    return [_whole(motor.joint, line) for line in (level_sentence(motor), *_followed(motor))]


def whole_alike(motor: MotorErrors) -> list[str]:
    """The effects that leave such errors, likewise, without their places."""
    return [_whole(motor.joint, _alike(motor.joint, rival)) for rival in motor.alike[:MOST_LOOKS]]


def _whole(joint: str, line: str) -> str:
    """A joint that begins a sentence keeps its name."""
    return f"{line}." if motor_words(joint) == joint else f"{line[0].upper()}{line[1:]}."


def level_sentence(motor: MotorErrors) -> str:
    """Size of a motor's error relative to the noise of its current."""
    size = f"{motor_words(motor.joint)}: error {in_percent(motor.error)}"
    noise = f"the noise of the current ({in_percent(motor.noise)})"
    if not motor.above_noise:
        return f"{size}, at {noise}: nothing to explain"
    times = ""
    if motor.noise > 0:
        ratio = motor.error / motor.noise
        times = f", {ratio:.3g} times {noise}" if ratio < 100.0 else f", {ratio:.0f} times {noise}"
    patterns = motor.concentrations or motor.dependences or motor.lines or motor.changes
    return f"{size}{times}" if patterns else f"{size}{times}, spread over the whole motion"


def finding_sentences(motor: MotorErrors) -> list[str]:
    """All findings about one motor's error, the strongest of each kind first."""
    return [*_followed(motor), *(alike_words(motor.joint, rival) for rival in motor.alike[:MOST_LOOKS])]


def _followed(motor: MotorErrors) -> list[str]:
    units = motor.units
    return [
        *(concentration_words(concentration) for concentration in motor.concentrations),
        *(dependence_words(dependence, units) for dependence in motor.dependences),
        *(line_words(line, units) for line in motor.lines),
        *(change_words(change, units[0]) for change in motor.changes),
    ]


def alike_words(joint: str, rival: LookAlike) -> str:
    """As in "motor left: Coulomb friction or Stribeck friction leaves such an error (atlas of effects, question 1)"."""
    return f"{_alike(joint, rival)} (atlas of effects, question {rival.question})"


def _alike(joint: str, rival: LookAlike) -> str:
    names = [spoken(name) for name in rival.effects[:MOST_NAMES]]
    more = len(rival.effects) - len(names)
    names += [f"{more} more"] if more else []
    listed = " or ".join([", ".join(names[:-1]), names[-1]] if len(names) > 1 else names)
    return f"{motor_words(joint)}: {listed} would cause such an error"


REGIONS: dict[RegionKind, str] = {
    RegionKind.REVERSALS: "at reversals",
    RegionKind.STANDSTILL: "near standstill",
    RegionKind.LOW_SPEED: "at low speed (below {})",
    RegionKind.HIGH_SPEED: "at high speed (above {})",
    RegionKind.LOW_ACCELERATION: "at low acceleration (below {})",
    RegionKind.HIGH_ACCELERATION: "at high acceleration (above {})",
    RegionKind.LOW_CURRENT: "at low current (below {})",
    RegionKind.HIGH_CURRENT: "at high current (above {})",
    RegionKind.FORWARDS: "moving forwards",
    RegionKind.BACKWARDS: "moving backwards",
    RegionKind.LOW_POSITION: "at positions below {}",
    RegionKind.MIDDLE_POSITION: "at positions between {}",
    RegionKind.HIGH_POSITION: "at positions above {}",
    RegionKind.START: "in the first fifth of the recordings",
    RegionKind.END: "in the last fifth of the recordings",
    RegionKind.UNLOADED: "without payload",
}


def region_words(where: RegionPlace) -> str:
    """Where in the motion, as in "at low speed (below 0.3 rad/s)"."""
    if where.part is RegionKind.PAYLOAD:
        return f"with payload {where.subject}"
    if where.part is RegionKind.RECORDING:
        return f"in {where.subject}"
    bounds = " and ".join(f"{bound:.3g}" for bound in where.bounds)
    return REGIONS[where.part].format(f"{bounds} {where.unit}")


def _percent(share: float) -> str:
    return f"{share:.0%}".replace("%", " %")


def concentration_words(concentration: Concentration) -> str:
    """As in "motor left, at reversals: 71 % of the squared error in 6 % of the time"."""
    error, time = _percent(concentration.error_share), _percent(concentration.time_share)
    at = f"{motor_words(concentration.joint)}, {region_words(concentration.where)}: {error}"
    if concentration.of_rest:
        return f"{at} of the remaining squared error in {time} of that time"
    return f"{at} of the squared error in {time} of the time"


def dependence_words(dependence: Dependence, units: tuple[str, str]) -> str:
    """The share of the error that follows a variable, and its range."""
    current, position = units
    share = _percent(dependence.error_share)
    rest = "remaining " if dependence.of_rest else ""
    head = f"{motor_words(dependence.joint)}: {share} of the {rest}squared error"
    if dependence.variable == "constant":
        return f"{head} is a constant offset of {dependence.low:+.2g} {current}"
    head += " follows"
    if dependence.variable == "direction":
        backwards, forwards = dependence.low, dependence.high
        if dependence.high_at <= dependence.low_at:
            backwards, forwards = forwards, backwards
        means = f"{backwards:+.2g} {current} backwards and {forwards:+.2g} {current} forwards"
        return f"{head} the direction of motion, on average {means}"
    units_of = {"time": "s", "position": position, "velocity": f"{position}/s", "current": current}
    unit = units_of.get(dependence.variable, f"{position}/s²")
    ends = [
        f"{mean:+.2g} {current} about {at:.2g} {unit}"
        for mean, at in ((dependence.low, dependence.low_at), (dependence.high, dependence.high_at))
    ]
    return f"{head} the {dependence.variable}, on average from {ends[0]} to {ends[1]}"


def line_words(line: SpectralLine, units: tuple[str, str]) -> str:
    """A line and its period."""
    share = _percent(line.error_share)
    size = f"with an amplitude of {line.amplitude:.2g} {units[0]}"
    if line.over == "time":
        frequency = with_error(line.frequency, line.resolution)
        return f"{motor_words(line.joint)}: {share} of the squared error oscillates at {frequency} Hz, {size}"
    period = f"every {with_error(1.0 / line.frequency, line.resolution / line.frequency / line.frequency)} {units[1]}"
    if units[1] == "rad":
        period += f", {with_error(math.tau * line.frequency, math.tau * line.resolution)} times per turn"
    period += ", as far as the travelled range shows"
    return f"{motor_words(line.joint)}: {share} of the squared error repeats {period}, {size}"


def change_words(change: Change, unit: str) -> str:
    """How an error that opposes the motion differs between two parts."""
    first, second = change.first, change.second
    return (
        f"{motor_words(first.joint)}: the error opposes the motion by {first.mean:+.2g} {unit} {first.part} and by "
        f"{second.mean:+.2g} {unit} {second.part}: {CHANGES[change.between]}"
    )


def remaining_errors(what: Compared) -> list[str]:
    """One sentence for every motor whose error is far above the noise of its current."""
    lines = []
    for joint, error, noise in _errors(what):
        if error > NAMING.unasked * noise > 0.0:
            times = f"{error / noise:.3g} times the noise of the current ({100.0 * noise:.3g} %)"
            lines.append(f"{motor_words(joint)}: error {100.0 * error:.3g} %, {times}")
    return lines


DIAGNOSE = "names the physical effect that the model lacks"
KEEP = "keeps the model"


def beyond_noise(what: Compared) -> bool:
    """Whether errors remain that noise does not explain."""
    return any(error > RULE.beyond_noise * noise for _, error, noise in _errors(what))


def _errors(what: Compared) -> Iterator[tuple[str, float, float]]:
    """Every motor with its error and its noise, relative to the current."""
    for joint in what.joints:
        series = what.of(joint)
        yield joint, relative_error_of(series) or 0.0, relative_noise(series)
