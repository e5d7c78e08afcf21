"""A plan in sentences."""

from collections.abc import Iterator

import numpy as np

from bench.basics.sentence import and_list, capital, in_percent
from bench.excitation.bounds import FORECAST, SEARCH
from bench.excitation.experiment.forecast import Enough, Expected, Forecast
from bench.excitation.experiment.plan import ExperimentPlan
from bench.excitation.experiment.proof_words import made_smaller
from bench.identification.decision import RULE
from bench.identification.finding_words import sentence
from bench.identification.scale_words import scale_sentence


def sentences(plan: ExperimentPlan, forecast: Forecast) -> list[str]:
    """The expected results, the best first."""
    lines = [_doubted(plan), _gains(forecast), _parameters(plan, forecast)]
    lines += _compared(plan, forecast)
    lines.append(_sizes(plan, forecast))
    lines += limiting(plan, forecast)
    if forecast.enough is not None:
        lines += enough(forecast.enough)
    if plan.room.assumed:
        lines.append(
            f"Assumed, because not given: {'; '.join(plan.room.assumed)}. Check them against the machine."
        )
    lines.append(_judged(plan))
    lines.append(_proven(plan))
    lines.append(
        f"Currents are predicted from {plan.nominal.source}; {_noise(plan)}. "
        "Effects that the model lacks, for example friction, add to the errors and to the currents."
    )
    return [line for line in lines if line]


def _doubted(plan: ExperimentPlan) -> str:
    """Why the model behind the plan is doubtful; "" if it is not."""
    doubts = plan.nominal.doubts
    if not doubts:
        return ""
    return (
        f"Do not use this plan: `bench identify` rejects the model that the recordings give. {sentence(doubts[0])} If "
        "effects are missing, name them with --with; `bench diagnose DATASET` lists them."
    )


def _compared(plan: ExperimentPlan, forecast: Forecast) -> list[str]:
    """The criterion, compared with random motions and existing recordings.

    The comparison is by all samples, the forecast by the rows that a fit will use.
    """
    lines = []
    worst = plan.aim.criterion == "worst"
    expected = max(forecast.unknowns[i].relative for i in plan.targets) if worst else plan.value
    if not np.isfinite(expected):
        return ["Some of the requested unknowns cannot be determined: motions are compared by the others."]
    if plan.random:
        what = "worst relative standard error" if worst else "mean axis of the error ellipsoid"
        median, best = (plan.random[name] for name in ("median", "best"))
        better = f"{median / plan.value:.2g} times better than" if plan.value else "compared with"
        lines.append(
            f"The {what} of the requested unknowns is {in_percent(expected, 2)}. With all samples, including those "
            f"near standstill, it is {in_percent(plan.value, 2)}: {better} the median of {SEARCH.random} random "
            f"motions inside the same limits ({in_percent(median, 2)}, the best of them {in_percent(best, 2)})."
        )
    if plan.before is not None:
        carried = plan.search.loads[0]
        lines.append(
            f"The existing recordings give {in_percent(plan.before, 2)}; with this motion, "
            f"{'unloaded' if carried is None else f'carrying {carried}'}, {in_percent(expected, 2)} is expected."
        )
    return lines


def limiting(plan: ExperimentPlan, forecast: Forecast) -> Iterator[str]:
    """What limits a forecast."""
    if not plan.nominal.gains_fitted:
        yield (
            "All masses and drive gains scale together: without a payload of known mass the gains stay nominal, and "
            "every parameter inherits their error. Weigh a payload, and plan with it."
            if plan.nominal.scale is None
            else scale_sentence(plan.nominal.scale)
        )
    for names in forecast.together:
        if len(names) == 1:
            yield f"{names[0]} stays undetermined: these motions do not excite it."
        else:
            yield f"{and_list(names)} stay undetermined: the motions determine only a combination of them."
    aimed = [forecast.unknowns[i] for i in plan.targets]
    weak = [expected.name for expected in aimed if RULE.loose < expected.relative < float("inf")]
    if weak:
        yield (
            f"Motions of this kind do not determine these unknowns, whose standard errors exceed "
            f"{in_percent(RULE.loose, 2)} of their size: {', '.join(weak)}."
        )
    if forecast.coarse:
        yield (
            "The encoder resolution matters: the standard errors are lower bounds, "
            "because quantisation is not white noise and the filters of the fit are then narrower."
        )


def _judged(plan: ExperimentPlan) -> str:
    """Recordings that are not fitted."""
    names = [recording.name for recording in plan.recordings if recording.use == "validate"]
    many = len(names) > 1
    return (
        f"Also record {and_list(names)}, {'other motions' if many else 'another motion'} inside the same limits, to "
        "judge the fit."
    )


def _proven(plan: ExperimentPlan) -> str:
    """The limits kept at all times, and those that made a motion smaller."""
    room = plan.room
    unranged = room.unranged
    parts = [f"ranges (assumed at {and_list(unranged)})" if unranged else "ranges", "speeds", "accelerations"]
    if plan.nominal.model.geometry.closed:
        parts.append("the distance from singular poses")
    if room.boxes:
        parts.append("the workspace")
    if np.isfinite(room.torque).any():
        parts.append("the limits of currents and torques")
    kept = (
        f"{capital(and_list(parts))} are proven to be kept at all times, also between the rows of the table."
    )
    smaller = [
        made_smaller(recording.name, recording.proven.given_way[0])
        for recording in plan.recordings
        if recording.proven.given_way
    ]
    return " ".join([kept, *smaller])


def _noise(plan: ExperimentPlan) -> str:
    noise = plan.nominal.noise
    current = (
        f"the assumed noise of each current is {in_percent(noise.ratio, 2)} of its RMS"
        if noise.current is None
        else f"the noise of the currents is the {'recorded' if noise.recorded else 'given'} one"
    )
    steps = "ideal encoders" if not noise.encoder.any() else "encoders with the given resolution"
    return f"{current}, {steps}, {noise.rate:g} samples per second"


def _gains(forecast: Forecast) -> str:
    gains = [expected for expected in forecast.unknowns if expected.kind == "gain"]
    if not gains:
        return ""
    listed = ", ".join(f"{gain.name} ± {in_percent(gain.relative, 2)}" for gain in gains)
    return f"Expected standard errors of the drive gains: {listed}."


def _parameters(plan: ExperimentPlan, forecast: Forecast) -> str:
    parameters = [forecast.unknowns[i] for i in plan.targets if forecast.unknowns[i].kind != "gain"]
    known = sorted(
        (parameter for parameter in parameters if parameter.std is not None),
        key=lambda parameter: -parameter.relative,
    )
    if not known:
        return ""
    listed = ", ".join(named(parameter) for parameter in known[: FORECAST.named])
    if len(parameters) <= FORECAST.named:
        return f"Expected standard {'errors' if len(parameters) > 1 else 'error'}: {listed}."
    return f"Of {len(parameters)} parameters the least certain: {listed}."


def _sizes(plan: ExperimentPlan, forecast: Forecast) -> str:
    """The reference sizes of relative standard errors of effects."""
    if all(forecast.unknowns[i].kind != "effect" for i in plan.targets):
        return ""
    return (
        "The unknown size of an effect's parameter is assumed to produce "
        f"{in_percent(FORECAST.effect_share, 2)} of a motor's RMS torque."
    )


def named(expected: Expected) -> str:
    """An unknown with its standard error."""
    return f"{expected.name} ± {expected.std:.2g} {expected.unit}"


def enough(needed: Enough) -> list[str]:
    """What suffices for the requested accuracy of the gains."""
    goal = in_percent(needed.accuracy, 2)
    lines = []
    if needed.expected is not None:
        if needed.expected <= needed.accuracy:
            lines.append(
                f"The planned payload and time are enough for gains within {goal} (one standard error)."
            )
        elif needed.seconds is not None:
            lines.append(
                f"With this payload the gains are within {goal} after {needed.seconds:.3g} s of each motion: repeat "
                "the motion."
            )
        else:
            lines.append(
                f"With this payload even {FORECAST.longest:g} times the recording time is not enough for gains "
                f"within {goal}."
            )
    if needed.mass is not None:
        lines.append(f"At this time a payload of {needed.mass:.2g} kg is enough for gains within {goal}.")
    else:
        lines.append(f"At this time no payload that the limits allow is enough for gains within {goal}.")
    return lines
