"""What limits an answer: what its data leave open, and what is impossible."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace
from math import exp, log
from types import MappingProxyType

import numpy as np

from bench.dataset.payload import Payload
from bench.dataset.recording import Recording
from bench.dataset.robot_locked import LockedJoint
from bench.effects import EffectInstance
from bench.identification.current_noise import relative_noise_in_band
from bench.identification.decision import RULE
from bench.identification.finding import Code, Finding, Unknown
from bench.identification.result import DriveGain, Identification, relative_error
from bench.identification.tolerances import TOLERANCES
from bench.signals.bounds import BANDS
from bench.signals.settings import FilterSettings

NO_PAYLOADS: Mapping[str, Payload] = MappingProxyType({})


def with_findings(
    result: Identification,
    unusable: tuple[str, ...],
    outside: Sequence[EffectInstance] = (),
    more: Sequence[Finding] = (),
    scale: Sequence[Finding] = (),
    payloads: Mapping[str, Payload] = NO_PAYLOADS,
) -> Identification:
    """The result with its findings.

    unusable: recordings that could not be used; outside: effects beyond their bounds. more: further findings.
    scale: why drive gains stay nominal. payloads: as they are declared.
    """
    doubt = runaway(result)
    alike = [] if a_thousand(result) else gains_alike(result, payloads)
    findings = alike if doubt is None else [*alike, doubt]
    findings += _beyond(outside)
    if unusable:
        findings.append(Finding(Code.PAYLOAD_NOT_DECLARED, unusable))
    findings += scale
    if result.redundant:
        findings.append(Finding(Code.REDUNDANT, result.redundant))
    findings += locked_findings(result.locked)
    if result.rank < result.unknowns:
        rank = {"rank": result.rank, "unknowns": result.unknowns}
        findings.append(Finding(Code.RANK_DEFICIENT, numbers=rank))
    apart = {instance.key for instance in outside}
    apart |= {
        (unknown.effect, unknown.place)
        for each in more
        if each.code == Code.NOT_SETTLED
        for unknown in each.of
    }
    taken_up = tuple(
        Unknown("effect", name, place, effect)
        for effect, places in result.effect_parameters.items()
        for place, values in places.items()
        for name, value in values.items()
        if not np.isfinite(value.std) and (effect, place) not in apart
    )
    if taken_up:
        findings.append(Finding(Code.TAKEN_UP, of=taken_up))
    findings += periods_not_whole(result)
    far = Code.GAIN_FAR if alike else None
    findings += [
        finding
        for finding in _implausible(result)
        if finding.code != far and finding not in findings and not _runs_away(finding, doubt)
    ]
    for j, joint in enumerate(result.joints):
        fitted = [recording for recording in result.recordings if recording.use == "identify"]
        reverses = any(np.ptp(np.sign(recording.velocity[:, j])) > 0 for recording in result.recordings)
        if not any(recording.moving[:, j].any() for recording in fitted):
            findings.append(Finding(Code.STANDS_STILL, (joint,)))
        elif not reverses:
            findings.append(Finding(Code.NEVER_REVERSES, (joint,)))
    loose = sum(parameter.relative_std > RULE.loose for parameter in result.parameters)
    if loose:
        numbers = {"count": loose, "of": len(result.parameters), "limit": RULE.loose}
        findings.append(Finding(Code.POORLY_DETERMINED, numbers=numbers))
    elif result.scaled_condition > TOLERANCES.findings.condition:
        findings.append(Finding(Code.ILL_CONDITIONED, numbers={"condition": result.scaled_condition}))
    return replace(result, findings=(*findings, *more))


def locked_findings(locked: Sequence[LockedJoint]) -> list[Finding]:
    """The joints that robot.toml locks, with their positions: one finding for hinges, one for slides."""
    by_unit = {
        unit: {joint.name: joint.value for joint in locked if joint.unit == unit} for unit in ("rad", "m")
    }
    return [
        Finding(Code.LOCKED, tuple(values), numbers=values, unit=unit)
        for unit, values in by_unit.items()
        if values
    ]


def _beyond(outside: Sequence[EffectInstance]) -> list[Finding]:
    """Effects so large that they cannot be distinguished from the drive gain."""
    places: dict[str, list[Unknown]] = {}
    for instance in outside:
        places.setdefault(instance.name, []).append(Unknown("effect", "", instance.place, instance.name))
    return [Finding(Code.NOT_FROM_GAIN, of=tuple(at)) for at in places.values()]


def unlike(result: Identification) -> Finding | None:
    """Whether recordings that were not fitted are modelled far worse than fitted ones; names the worst."""
    for finding in result.findings:
        if finding.code == Code.CHECKED_HAS_OTHER_VALUES:
            return finding
    fitted, checked = result.error.identify, result.error.validate
    if fitted is None or checked is None or checked <= TOLERANCES.findings.unlike * fitted:
        return None
    by_recording = result.error.by_recording
    worst = max(by_recording, key=lambda name: by_recording[name])
    carried = {recording.name: recording.payload for recording in result.recordings}.get(worst)
    names = (worst, carried) if carried else (worst,)
    return Finding(Code.CHECKED_UNLIKE_FITTED, names, numbers={"fitted": fitted, "checked": checked})


def with_other_values(result: Identification, effects: Sequence[str]) -> Identification:
    """With the reason why held-out recordings are modelled worse: effects have other values in them."""
    findings = [
        replace(finding, code=Code.CHECKED_HAS_OTHER_VALUES, names=(finding.names[0], *effects))
        if finding.code == Code.CHECKED_UNLIKE_FITTED
        else finding
        for finding in result.findings
    ]
    return replace(result, findings=tuple(findings))


def runaway(result: Identification) -> Finding | None:
    """Why an answer is not credible, whatever its error: a drive gain far off, or decided by rounding.

    If all gains are off by a thousand, a unit is wrong; the finding then asks for the unit.
    """
    for finding in result.findings:
        if finding.code == Code.NOISE_DECIDES:
            return finding
    doubtful = _doubtful_gain(result)
    if doubtful is not None:
        return doubtful
    for parameter in result.parameters:
        if parameter.value and not 0.0 < parameter.std < np.inf:
            unknown = (Unknown("parameter", parameter.name),)
            return Finding(
                Code.PARAMETER_WITHOUT_DEVIATION, (), unknown, {"value": parameter.value}, parameter.unit
            )
    if result.scaled_condition > TOLERANCES.findings.rounding_condition:
        return Finding(Code.ROUNDING_DECIDES, numbers={"condition": result.scaled_condition})
    return None


def _doubtful_gain(result: Identification) -> Finding | None:
    """Whether the gains have a wrong unit, are not determined, or one of them has run away."""
    thousand = a_thousand(result)
    if thousand is not None:
        return Finding(thousand)
    open_ = tuple(joint for joint, gain in result.drive_gains.items() if not gain.determined)
    if open_:
        unknowns, times = tuple(Unknown("gain", "gain", joint) for joint in open_), _times_noise(result)
        numbers = {"times": times} if times > RULE.much else {}
        return Finding(Code.GAIN_NOT_DETERMINED, of=unknowns, numbers=numbers)
    for joint, gain in result.drive_gains.items() if result.gains_fitted else ():
        if not 1.0 / RULE.gain_far <= gain.value / gain.nominal <= RULE.gain_far:
            return (_negative(result) or [_gain(Code.GAIN_RUNAWAY, joint, gain)])[0]
    return None


def _times_noise(result: Identification) -> float:
    """The error of the fitted recordings over that of noise, whose density is that of the errors near the end of the
    fit's band; 0 without either.
    """
    fitted = [series for series in result.recordings if series.use == "identify"]
    noise = relative_noise_in_band(fitted, result.settings)
    return (relative_error(fitted) or 0.0) / noise if noise > 0.0 else 0.0


def _runs_away(far: Finding, doubt: Finding | None) -> bool:
    """Whether a gain that is far off is the one that has run away."""
    runs = doubt is not None and doubt.code is Code.GAIN_RUNAWAY and doubt.names == far.names
    return runs and far.code is Code.GAIN_FAR


def _negative(result: Identification) -> list[Finding]:
    """The gains with an impossible sign, and whether that of a current explains it."""
    gains = result.drive_gains
    negative = [joint for joint, gain in gains.items() if gain.value < 0 and gain.determined]
    if not result.gains_fitted or not negative:
        return []
    if len(negative) == len(gains):
        return [Finding(Code.GAINS_NEGATIVE)]
    explained = [
        joint in result.joints and _error_turned(result, joint) < TOLERANCES.findings.explained
        for joint in negative
    ]
    return [
        Finding(Code.SIGN_REVERSED if turned else Code.GAIN_NEGATIVE, (joint,))
        for joint, turned in zip(negative, explained, strict=True)
    ]


def _gain(code: Code, joint: str, gain: DriveGain) -> Finding:
    return Finding(code, (joint,), (), {"value": gain.value, "nominal": gain.nominal}, gain.unit)


def _implausible(result: Identification) -> list[Finding]:
    """Impossible results: gains far off, all negative, or unlike recordings."""
    findings = []
    ratios = {joint: gain.value / gain.nominal for joint, gain in result.drive_gains.items()}
    thousand = a_thousand(result)
    error = result.error.identify
    if error is not None and error >= 1.0:
        findings.append(Finding(Code.NO_MODEL_IS_BETTER, numbers={"error": error}))
    findings += _negative(result)
    for joint, gain in result.drive_gains.items():
        deviation = abs(ratios[joint] - 1.0)
        far = gain.determined and ratios[joint] > 0.0 and deviation > TOLERANCES.findings.far_gain
        if result.gains_fitted and thousand is None and far:
            findings.append(_gain(Code.GAIN_FAR, joint, gain))
    strange = unlike(result)
    return findings if strange is None else [*findings, strange]


def _error_turned(result: Identification, joint: str) -> float:
    """Relative error of a joint's current with its sign reversed and the nominal drive gain."""
    j, gain = result.joints.index(joint), result.drive_gains[joint]
    error_squares = all_squares = 0.0
    for recording in result.recordings:
        if recording.use != "identify":
            continue
        moving = recording.moving[:, j]
        measured, modelled = (
            -recording.measured[moving, j],
            recording.modelled[moving, j] * gain.value / gain.nominal,
        )
        error_squares += float(((measured - modelled) ** 2).sum())
        all_squares += float(measured @ measured)
    return float(np.sqrt(error_squares / all_squares)) if all_squares else float("inf")


def a_thousand(result: Identification) -> Code | None:
    """Whether all gains are about a thousand times the nominal ones, or a thousandth of them: a wrong unit."""
    ratios = (
        [gain.value / gain.nominal for gain in result.drive_gains.values() if gain.fitted and gain.determined]
        if result.gains_fitted
        else []
    )
    if not ratios:
        return None
    near = TOLERANCES.findings.near_thousand
    for factor, code in ((1e3, Code.GAINS_A_THOUSAND), (1e-3, Code.GAINS_A_THOUSANDTH)):
        if all(factor / near < abs(ratio) < factor * near for ratio in ratios):
            return code
    return None


TURN = "1/turn"  # the unit of such a number, which only hinges have


def periods_not_whole(result: Identification) -> list[Finding]:
    """A finding for each effect and joint whose periods per turn are certainly no integer; names: effect, joint.

    Poles and teeth of a motor that turns with its joint, or an eccentric encoder on the joint, make a whole number of
    periods per turn; parts that turn faster or slower, behind a gear or a belt, need not.
    """
    findings = []
    for effect, places in result.effect_parameters.items():
        for place, values in places.items():
            for value in values.values():
                away = abs(value.value - round(value.value))
                if (
                    value.unit == TURN
                    and 0.0 < value.std < math.inf
                    and away > max(TOLERANCES.findings.whole_periods, RULE.certain * value.std)
                ):
                    numbers = {"periods": value.value, "std": value.std}
                    findings.append(Finding(Code.PERIODS_NOT_WHOLE, (effect, place), numbers=numbers))
    return findings


def short_recordings(recordings: Sequence[Recording], settings: FilterSettings) -> list[Finding]:
    """Fitted recordings of which the filter disturbs more than a twentieth at each end."""
    settling = BANDS.settling / settings.position_cutoff
    short = {
        recording.name: float(np.ptp(recording.time))
        for recording in recordings
        if recording.use == "identify"
        and settling > TOLERANCES.findings.disturbed * float(np.ptp(recording.time))
    }
    if not short:
        return []
    numbers = {
        "shortest": min(short.values()),
        "cutoff": settings.position_cutoff,
        "settling": BANDS.settling,
        "needed": settling / TOLERANCES.findings.disturbed,
    }
    return [Finding(Code.SHORT, tuple(short), numbers=numbers)]


def gains_alike(result: Identification, payloads: Mapping[str, Payload]) -> list[Finding]:
    """The payloads whose declared mass shifts all drive gains; none if gains differ, or are near nominal.

    Every gain is proportional to that mass. If the model leaves much of the current, a missing effect may move the
    gains instead, so the mass is not judged. numbers: least and greatest gain over the nominal one, the declared mass
    of the first payload, and the mass that makes the gains nominal on average.
    """
    bounds = TOLERANCES.findings
    gains = {joint: gain for joint, gain in result.drive_gains.items() if gain.fitted and gain.determined}
    ratios = [gain.value / gain.nominal for gain in gains.values()]
    carried = {series.payload for series in result.recordings if series.use == "identify"}
    weighed = [name for name, payload in payloads.items() if name in carried and payload.mass is not None]
    error = result.error.identify
    if not result.gains_fitted or len(ratios) < 2 or min(ratios) <= 0.0 or not weighed:
        return []
    if error is None or error > bounds.large_error or max(ratios) > bounds.alike_gains * min(ratios):
        return []
    common = exp(float(np.mean(np.log(ratios))))
    if abs(log(common)) <= log(bounds.common_gain):
        return []
    mass = payloads[weighed[0]].mass or 0.0
    numbers = {"least": min(ratios), "most": max(ratios), "mass": mass, "likely": mass / common}
    return [
        Finding(
            Code.GAINS_ALIKE,
            tuple(weighed),
            tuple(Unknown("gain", "gain", joint) for joint in gains),
            numbers,
            "kg",
        )
    ]
