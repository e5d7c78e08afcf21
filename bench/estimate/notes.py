"""What limits an answer, in words that say what to do."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from bench.effects import EffectInstance
from bench.effects.names import spoken
from bench.effects.select import ROBOT, TAG
from bench.estimate.result import Identification

LOOSE = 0.3  # relative deviation above which a parameter says little
ILL_CONDITIONED = 1e3
HOPELESS_CONDITION = 1e7  # beyond it, digits of the data that are rounding decide
FAR = 2.0  # times the nominal gain, or its half: makers are wrong by a tenth
UNLIKE = 3.0  # times the fitted error: recordings that were not fitted are another machine, load or unit
NEAR = 3.0  # times a thousand, or a thousandth: a gain as far off has a wrong unit behind it
BETTER = 0.5  # relative error of a current with its sign reversed, from which on that is likely
SUSPICIOUS_GAIN = 0.5  # of the nominal gain: makers are wrong by a tenth


def notes_on(
    result: Identification, left_aside: tuple[str, ...], outside: Sequence[EffectInstance] = ()
) -> Identification:
    """The result with its notes.

    left_aside: recordings that could not be used; outside: effects beyond their bounds.
    """
    notes = _beyond(outside)
    apart = {(one.effect.name, one.place) for one in outside}
    if left_aside:
        notes.append(
            f"Left aside: {', '.join(left_aside)}. Their payload is not declared in full, and no fitted recording "
            "carries it."
        )
    if not result.gains_fitted:
        notes.append(
            "No fitted recording carries a payload of known mass: the drive gains stay at their nominal "
            "values, and every parameter is wrong by the same share as the gain that scales it."
        )
    if result.rank < result.unknowns:
        notes.append(
            f"The data determine only {result.rank} of {result.unknowns} unknowns: move all joints together, "
            "with larger and faster movements, or record an unloaded and a loaded trajectory."
        )
    if result.scaled_condition > ILL_CONDITIONED:
        notes.append(
            f"The scaled observation matrix has a condition number of {result.scaled_condition:.0f}: some "
            "parameters cannot be told apart well; a more exciting trajectory helps."
        )
    absorbed = [
        f"{name} of {effect}" + ("" if place == ROBOT else f" at {place}")
        for effect, places in result.effect_parameters.items()
        for place, values in places.items()
        for name, one in values.items()
        if not np.isfinite(one.std) and (effect, place) not in apart
    ]
    if absorbed:
        notes.append(
            f"These data cannot show {', '.join(absorbed)}: other parameters of the model do the same, and take "
            "up the effect."
        )
    doubt = runaway(result)
    if doubt is not None:
        notes.insert(0, f"This answer is not to be believed. {doubt}")
    notes += _implausible(result)
    for j, joint in enumerate(result.drive_gains):
        reverses = any(np.ptp(np.sign(one.velocity[:, j])) > 0 for one in result.recordings)
        if not reverses:
            notes.append(
                f"Joint {joint} never reverses: move it through zero velocity to tell friction apart."
            )
    loose = sum(parameter.relative_std > LOOSE for parameter in result.parameters)
    if loose:
        notes.append(
            f"{loose} of {len(result.parameters)} parameters are poorly determined (deviation above "
            f"{_percent(LOOSE)} of the value); `bench identify --essential` leaves out what does not matter."
        )
    return replace(result, notes=tuple(notes))


def _beyond(outside: Sequence[EffectInstance]) -> list[str]:
    """What is said of effects that would be so large that they are another name for the drive gain."""
    places: dict[str, list[str]] = {}
    for one in outside:
        places.setdefault(one.effect.name, []).append(one.place)
    return [
        f"These data cannot tell {spoken(name)} at {', '.join(at)} from the drive gain there: it is left out, and the "
        "gain is what it would be without it. Record a payload that loads that joint more."
        for name, at in places.items()
    ]


def unlike(result: Identification) -> str | None:
    """What to look at where recordings that were not fitted are modelled far worse than those that were."""
    fitted, checked = result.error.identify, result.error.validate
    if fitted is None or checked is None or checked <= UNLIKE * fitted:
        return None
    by_recording = result.error.by_recording
    worst = max(by_recording, key=lambda name: by_recording[name])
    carried = {one.name: one.payload for one in result.recordings}.get(worst)
    own = [one.removesuffix(TAG) for one in result.effects if one.endswith(TAG)]
    if own:
        return (
            f"Recordings that were not fitted are modelled far worse ({_percent(checked)}) than those that were "
            f"({_percent(fitted)}), {worst} worst: there {', '.join(own)} may have yet another value."
        )
    load = f"the payload {carried}" if carried else "no payload"
    return (
        f"Recordings that were not fitted are modelled far worse ({_percent(checked)}) than those that were "
        f"({_percent(fitted)}), {worst} worst: it is declared to carry {load}; check that and its columns, or move the "
        "fitted recordings over the same range."
    )


def runaway(result: Identification) -> str | None:
    """Why an answer is not to be believed, whatever its error: a drive gain far off, or what rounding has decided."""
    for joint, gain in result.drive_gains.items() if result.gains_fitted else ():
        if not 1.0 / FAR <= gain.value / gain.nominal <= FAR:
            return (
                f"The drive gain of {joint} came out at {gain.value:.3g} {gain.unit.replace('*', '·')}, where "
                f"{gain.nominal:.3g} is nominal: no drive is that far from its sheet, if that is right."
            )
    for one in result.parameters:
        if one.value and not 0.0 < one.std < np.inf:
            return (
                f"{one.name} came out at {one.value:.3g} {one.unit} with no deviation that is known: the data do not "
                "tell it."
            )
    if result.scaled_condition > HOPELESS_CONDITION:
        return (
            f"The scaled observation matrix has a condition number of {result.scaled_condition:.0e}: rounding decides "
            "what some parameters are."
        )
    return None


def _implausible(result: Identification) -> list[str]:
    """What cannot be so: gains far off, all negative, or recordings unlike each other."""
    notes = []
    ratios = {joint: gain.value / gain.nominal for joint, gain in result.drive_gains.items()}
    thousand = _a_thousand(list(ratios.values())) if result.gains_fitted else None
    if thousand is not None:
        notes.append(thousand)
    error = result.error.identify
    if error is not None and error >= 1.0:
        notes.append(
            f"The error is {_percent(error)} of the current, more than with no model at all: columns may be swapped, a "
            "sign wrong, or the robot another one."
        )
    negative = [joint for joint, gain in result.drive_gains.items() if gain.value < 0]
    if result.gains_fitted and len(negative) < len(ratios):
        notes += [_negative(result, joint) for joint in negative]
    for joint, gain in result.drive_gains.items():
        far = joint not in negative and abs(ratios[joint] - 1.0) > SUSPICIOUS_GAIN
        if result.gains_fitted and thousand is None and far:
            notes.append(
                f"The drive gain of {joint} came out at {gain.value:.3g} {gain.unit.replace('*', '·')}, far from its "
                f"nominal {gain.nominal:.3g}: a physical effect is missing in the model, or the payload is not as "
                "declared."
            )
    if result.gains_fitted and len(negative) == len(ratios):
        notes.append(
            "All drive gains came out negative, which cannot be: the recordings with and without payload are "
            "probably swapped in dataset.toml, or the currents' sign is."
        )
    strange = unlike(result)
    return notes if strange is None else [*notes, strange]


def _negative(result: Identification, joint: str) -> str:
    """What a negative drive gain of one joint means: a sign, where all is well with the other sign."""
    told = f"The drive gain of {joint} came out negative, which cannot be: "
    if _error_turned(result, joint) < BETTER:
        return (
            f"{told}the sign of current.{joint}, or of position.{joint}, is probably reversed (`bench import ... "
            f"--scale current.{joint}=-1`), or its column is that of another motor."
        )
    return (
        f"{told}with the sign of current.{joint} reversed its current is not explained either. The payload is probably "
        "not as declared or mounted another way, an effect is missing, or its column is that of another motor."
    )


def _error_turned(result: Identification, joint: str) -> float:
    """Relative error of a joint's current with its sign reversed and the nominal drive gain."""
    j, gain = list(result.drive_gains).index(joint), result.drive_gains[joint]
    left = all_squares = 0.0
    for one in result.recordings:
        if one.use != "identify":
            continue
        moving = one.moving[:, j]
        measured, modelled = -one.measured[moving, j], one.modelled[moving, j] * gain.value / gain.nominal
        left += float(((measured - modelled) ** 2).sum())
        all_squares += float(measured @ measured)
    return float(np.sqrt(left / all_squares)) if all_squares else float("inf")


def _a_thousand(ratios: list[float]) -> str | None:
    """Whether all gains are about a thousand times the nominal ones, or a thousandth of them: a wrong unit."""
    for factor, what in (
        (1e3, "a thousand times the nominal ones: is the payload's mass in grams? It must be in kg"),
        (
            1e-3,
            "a thousandth of the nominal ones: is the payload's mass in tonnes, or are the currents in mA?",
        ),
    ):
        if all(factor / NEAR < abs(ratio) < factor * NEAR for ratio in ratios):
            return f"The drive gains came out at about {what}."
    return None


def _percent(share: float) -> str:
    return f"{100.0 * share:.3g} %"
