"""Reasons of verdicts, and what remains, in sentences."""

from collections.abc import Callable, Mapping

from bench.basics.sentence import and_list, in_percent, or_list, say
from bench.diagnosis.reason import Because, Doubt
from bench.diagnosis.result import Diagnosis, EffectVerdict, Remainder, Unexplained
from bench.effects.display_names import begun, spoken
from bench.identification.decision import RULE
from bench.identification.tolerances import TOLERANCES

DOUBTS: Mapping[Doubt, str] = {
    Doubt.MUCH_LEFT: "a large error remains that no effect of the catalogue explains, and this effect may only "
    "imitate its cause",
    Doubt.BESIDE_A_LAW: "a law at the same motor explains far more, and this effect may only compensate for an "
    "inexact form of the law",
}


def reason_sentence(verdict: EffectVerdict) -> str:
    """Why an effect has its verdict, a sentence."""
    doubts = [DOUBTS[doubt] for doubt in verdict.why.doubts]
    words = WORDS[verdict.why.because]
    said = _filled(words, verdict) if isinstance(words, str) else words(verdict)
    return f"{'; '.join([said, *doubts])}."


def probability_text(probability: float) -> str:
    """A probability with two digits, but never as 0 or 1."""
    least = TOLERANCES.report.near_certain
    if probability < least:
        return f"< {least:g}"
    return f"> {1.0 - least:g}" if probability > 1.0 - least else f"{probability:.2f}"


def less_probable(verdict: EffectVerdict) -> str:
    """How the less probable side of an indistinguishable pair is qualified; "" if neither side is improbable.

    For an identified effect, its alternatives, in whose sets it is not; for another, that effect itself.
    """
    if verdict.probability is None:
        return ""
    named = verdict.why.because is Because.EXPLAINS
    probability = 1.0 - verdict.probability if named else verdict.probability
    return f"less probable ({probability_text(probability)})" if probability <= 1.0 - RULE.sure else ""


def validated_on(diagnosis: Diagnosis) -> str:
    """The data of errors and evidence."""
    if not diagnosis.held_out:
        return "recordings that were not fitted"
    return f"the last {100.0 * diagnosis.held_out:.0f} % of every recording, not fitted"


def unexplained_words(unexplained: Unexplained, *, searched: bool = True) -> str:
    """The error that remains with the identified effects, and the noise; without capital letter and full stop.

    searched: whether all effects of the catalogue were tried.
    """
    floor, encoders = (f"{100.0 * noise:.3g} %" for noise in (unexplained.noise_floor, unexplained.encoders))
    error = f"{100.0 * unexplained.error:.3g} %"
    if unexplained.what == Remainder.NOISE:
        below = unexplained.error * RULE.beyond_noise < unexplained.noise_floor
        where = "below" if below else "at"
        return f"the remaining error ({error}) is {where} the noise floor of the currents ({floor})"
    if unexplained.what == Remainder.NOISE_AND_ENCODERS:
        return (
            f"the remaining error ({error}) is explained by the noise of the currents ({floor}) and of the encoders "
            f"({encoders})"
        )
    noise = f"the noise floor of the currents is {floor}"
    if unexplained.encoders > 0.1 * unexplained.noise_floor:
        noise += f", that of the encoders {encoders}"
    if unexplained.repeats is not None:
        noise += f", and the logs are repeatable to {100.0 * unexplained.repeats:.3g} %"
    variables = ", ".join(unexplained.depends_on) or "no variable that was tested"
    varies = f"the remaining error is {error} of the current ({noise}), and it depends on {variables}"
    return (
        f"{varies}: no effect of the catalogue explains it"
        if searched and unexplained.significant
        else varies
    )


def _explains(verdict: EffectVerdict) -> str:
    at = f" at {', '.join(verdict.actuators)}" if verdict.actuators else ""
    said = (
        f"With {spoken(verdict.effect)}{at} the error of recordings that were not fitted falls "
        f"from {in_percent(verdict.error_before)} to {in_percent(verdict.error_after)} of the current"
    )
    others, less = _alternatives(verdict), less_probable(verdict)
    if verdict.alternatives and less:
        return f"{said}; {others} in its place is {less}, but these data do not exclude it"
    return f"{said}; these data cannot distinguish it from {others}" if verdict.alternatives else said


def _as_good(verdict: EffectVerdict) -> str:
    others, less = (
        _alternatives(verdict) if verdict.alternatives else "the chosen effects",
        less_probable(verdict),
    )
    name = begun(verdict.effect)
    if less:
        return f"{name} in place of {others} is {less}, but these data do not exclude it"
    return f"{name} would explain the data as well as {others}: these recordings cannot distinguish them"


def _filled(template: str, verdict: EffectVerdict) -> str:
    """A template filled with the names of a verdict's reason, the effect `begun` and `spoken`, errors `before` and
    `after`; if any, its places `at` and alternatives `others`.
    """
    _, *place = verdict.why.names or ("",)
    return say(
        template,
        names=verdict.why.names,
        begun=begun(verdict.effect),
        spoken=spoken(verdict.effect),
        before=verdict.error_before,
        after=verdict.error_after,
        others=_alternatives(verdict) if verdict.alternatives else "the chosen effects",
        at=f" at {and_list(verdict.why.names)}" if verdict.why.names else "",
        place="".join(f" at {name}" for name in place),
        by="".join(f", mainly {name}," for name in verdict.why.names),
    )


def _alternatives(verdict: EffectVerdict) -> str:
    return or_list([spoken(name) for name in verdict.alternatives])


VALIDATED = " on recordings that were not fitted ({before:%} to {after:%})"

WORDS: Mapping[Because, str | Callable[[EffectVerdict], str]] = {
    Because.EXPLAINS: _explains,
    Because.AS_GOOD: _as_good,
    Because.AS_GOOD_AS_A_LAW: "{begun} would explain the data as well as the discovered law{at}: these recordings "
    "cannot distinguish them",
    Because.GAINS_NOTHING: "Adding {spoken} improves nothing" + VALIDATED,
    Because.GAINS_LITTLE: "Adding {spoken} improves the error too little to be certain" + VALIDATED,
    Because.TAKEN_UP: "The parameters of the model{by} absorb {spoken} completely: no data of this robot with these "
    "payloads can show it",
    Because.IMPOSSIBLE: "{begun} would need a negative {names[0]}{place} to explain the data, which is physically "
    "impossible: the cause is a similar effect",
    Because.CANCELS: "{begun} would need a torque at {names[0]} larger than all that the motor gives, which other "
    "terms of the model would have to cancel",
    Because.USUAL: "{begun} is in the model although these recordings do not prove it: without it, recordings that "
    "were not fitted are explained worse than with viscous and Coulomb friction and an offset alone",
    Because.WORSE_THAN_USUAL: "With {spoken}, recordings that were not fitted are explained worse than with viscous "
    "and Coulomb friction and an offset alone",
    Because.TOO_SHORT: "{begun} is not asked of logs of up to {names[0]}: what changes with nothing but the time takes "
    "a longer one to be distinguished from other errors",
    Because.NOT_NEEDED: "{begun} is not needed: without it, the other effects explain the data as well",
}
