"""The answer in sentences."""

from collections.abc import Mapping
from pathlib import Path

from bench.basics.joint_units import units_of_gain
from bench.basics.sentence import and_list, capital, in_percent, or_list
from bench.effects.display_names import begun, spoken, telling_motions
from bench.excitation.bounds import DISCRIMINATION
from bench.excitation.discrimination.result import Discrimination, MotionFacts
from bench.identification.decision import RULE
from bench.identification.wording import motor_words

NATS = "one nat is odds of e, 2.7, to 1; ten are 22,000 to 1, which is certain"


def sentences(result: Discrimination) -> list[str]:
    """The evidence of the given data and of the new motion, and what is new in the motion."""
    return [*warnings(result), *_answer(result)]


def warnings(result: Discrimination) -> list[str]:
    """Doubts about the answer: a model that is known to be wrong."""
    doubt = (
        f"With either effect, the model's error is {_number(result.error_over_noise)} times the noise of the current: "
        "the model lacks another effect. Run bench diagnose first, and add its result by --with."
    )
    return [doubt] if result.model_is_wrong else []


def next_step(result: Discrimination, diagnose: str, folder: str | Path) -> str | None:
    """What to do with the answer in `folder`; None if there is nothing to do. diagnose: that command."""
    if result.model_is_wrong:
        return f"next: {diagnose}, then this command again with its result (--with EFFECT)"
    if result.motion is None:
        return None
    if result.given_tells:
        return f"next: {diagnose}"
    if not result.tells:
        return (
            f"next: {Path(folder) / 'trajectory.csv'} is the best motion, but not enough by itself: use a remedy "
            "above, then this command again"
        )
    return (
        f"next: record {Path(folder) / 'trajectory.csv'} twice, add both logs with bench import (how: "
        f"{Path(folder) / 'README.md'}), then {diagnose}"
    )


def length_unit(result: Discrimination, joint: str) -> str:
    """The unit of a motor's position: rad or m."""
    return units_of_gain(result.joints[joint]).position


def _answer(result: Discrimination) -> list[str]:
    names = [_spoken(effect) for effect in result.effects]
    remedies = or_list(telling_motions([effect.partition(":")[0] for effect in result.effects]))
    if result.absorbed:
        taken = and_list([_spoken(name) for name in result.absorbed])
        verdict = (
            f"No motion of this robot can distinguish {and_list(names)}: with these payloads, the parameters of the "
            f"model absorb {taken} completely in any motion."
        )
        return [verdict, *_against(result)]
    if not result.questions:
        verdict = f"No motion of this robot can distinguish {and_list(names)}: they have the same effect."
        return [verdict, *_against(result)]
    lines = [*_against(result), *(_imitated(result, name) for name in result.imitated)]
    if result.nothing:
        shown = and_list([f"{_number(nats)} nats ({_spoken(name)})" for name, nats in result.shown.items()])
        lines.append(
            f"Neither effect shows in these data: they explain {shown}; a verdict needs {RULE.prior:g} ({NATS}). "
            "No motion inside the limits would show effects as small as the fitted ones, so there is nothing to "
            f"distinguish. If you still suspect one of them, excite it first: {remedies}."
        )
        return lines
    if max(result.shown.values(), default=0.0) < RULE.prior:
        lines.append(
            "Neither effect is certain in these data: the following holds for effects as small as the fitted ones."
        )
    lines.append(
        f"The expected evidence of the given data, {result.given_seconds:.3g} s, is {_nats(result.given)}; a verdict "
        f"needs {RULE.prior:g} nats and errors that differ by {100 * RULE.material:.3g} % ({NATS})."
    )
    if result.given_tells:
        lines.append("That is enough: bench diagnose can distinguish them without a new motion.")
    if result.motion is None:
        return [*lines, f"The search found no motion inside the limits. Possible remedies: {remedies}."]
    seconds, carried = result.motion.trajectory.duration, result.motion.payload
    measured = result.questions[0].truth.prepared.measured
    loads = any(measurement.recording.payload for measurement in measured)
    carrying = f" with {carried}" if carried is not None else " without a payload" if loads else ""
    lines.append(
        f"This motion, {seconds:.3g} s{carrying}, raises that to {_nats(result.promised)}; the error of the "
        f"wrong model is then {in_percent(result.growth, 2)} larger than that of the right one."
    )
    if not result.tells:
        lines += _not_enough(result, remedies)
    return lines + motion_words(result)


def _against(result: Discrimination) -> list[str]:
    return [
        f"{begun(sign.effect)} would need a negative {sign.parameter}{f' at {sign.joint}' if sign.joint else ''} "
        "to explain the given data, which is impossible: this is evidence against it."
        for sign in result.impossible
    ]


def motion_words(result: Discrimination) -> list[str]:
    """Differences of the motion from the recordings."""
    if result.motion is None:
        return []
    moving = [joint for joint, facts in result.planned.items() if facts.high > facts.low]
    said_of = [f"{motor_words(moving[0])} moves alone"] if len(moving) == 1 < len(result.planned) else []
    for joint in moving:
        unit = length_unit(result, joint)
        said_of += _joint_words(joint, unit, result.recorded[joint], result.planned[joint])
    if result.motion.payload is not None:
        said_of.append(f"it carries the payload {result.motion.payload}")
    if not said_of:
        return ["It differs from the recorded motions only in its shape."]
    return [f"Differences from the recordings: {'; '.join(said_of)}."]


def _joint_words(joint: str, unit: str, old: MotionFacts, new: MotionFacts) -> list[str]:
    motor = motor_words(joint)
    words = []
    room = DISCRIMINATION.beyond * (old.high - old.low)
    if new.low < old.low - room or new.high > old.high + room:
        words.append(
            f"{motor} moves between {new.low:.3g} and {new.high:.3g} {unit} (recorded: {old.low:.3g} to "
            f"{old.high:.3g} {unit})"
        )
    speeds = f"{new.speed:.2g} {unit}/s (recorded: {old.speed:.2g} {unit}/s)"
    if new.speed * DISCRIMINATION.much < old.speed:
        words.append(f"{motor} moves slowly, at most {speeds}")
    elif new.speed > DISCRIMINATION.much * old.speed:
        words.append(f"{motor} moves faster, up to {speeds}")
    if new.turning * DISCRIMINATION.much < old.turning:
        words.append(f"it reverses slowly at {joint}")
    elif new.turning > DISCRIMINATION.much * old.turning:
        words.append(f"it reverses hard at {joint}")
    if new.reversals > DISCRIMINATION.much * old.reversals:
        words.append(f"{motor} reverses {new.reversals:.2g} times per second (recorded: {old.reversals:.2g})")
    return words


def _not_enough(result: Discrimination, remedies: str) -> list[str]:
    """Why evidence is too little, and what helps."""
    nats = min(result.promised.values())
    lines = ["The search found no motion inside these limits that distinguishes them with certainty."]
    if result.wider is not None and result.wider[1] > DISCRIMINATION.much * nats:
        factor, wide = result.wider
        lines.append(
            f"With speeds, accelerations and currents up to {factor:.3g} times the recorded ones "
            f"(--widen {factor:.3g}), a motion of the same length gives an expected {_number(wide)} nats."
        )
    if result.second is not None and result.second[1] > DISCRIMINATION.much * nats:
        mass, heavy = result.second
        lines.append(
            f"With a second payload of {mass:.3g} kg the same motion gives an expected {_number(heavy)} nats."
        )
    if len(lines) == 1:
        lines.append(f"Possible remedies: {remedies}; less noise; or --duration.")
    return lines


def _imitated(result: Discrimination, name: str) -> str:
    other = next(effect for effect in result.effects if effect != name)
    return (
        f"{capital(_spoken(other))} includes {_spoken(name)} as a special case: data can only give evidence for "
        f"{_spoken(other)}; without it, the simpler {_spoken(name)} is preferred."
    )


def _nats(values: Mapping[str, float]) -> str:
    return or_list([f"{_number(nats)} nats if {_spoken(name)} is true" for name, nats in values.items()])


def _spoken(request: str) -> str:
    name, _, where = request.partition(":")
    return f"{spoken(name)} at {where}" if where else spoken(name)


def _number(nats: float) -> str:
    return f"{nats:.0f}" if nats >= 100.0 else f"{nats:.2g}"
