"""Reasons of verdicts, and what remains, in sentences."""

from collections.abc import Callable, Mapping

from bench.diagnosis.reason import Because, Doubt
from bench.diagnosis.result import Diagnosis, EffectVerdict, Remainder, Unexplained
from bench.effects.display_names import begun, spoken
from bench.identification.decision import RULE
from bench.identification.wording import and_list, in_percent, or_list

DOUBTS: Mapping[Doubt, str] = {
    Doubt.MUCH_LEFT: "a large error remains that no effect of the catalogue explains, and this effect may only "
    "imitate its cause",
    Doubt.BESIDE_A_LAW: "a law at the same motor explains far more, and this effect may only compensate for an "
    "inexact form of the law",
}


def reason_sentence(verdict: EffectVerdict) -> str:
    """Why an effect has its verdict, a sentence."""
    doubts = [DOUBTS[doubt] for doubt in verdict.why.doubts]
    return f"{'; '.join([WORDS[verdict.why.because](verdict), *doubts])}."


def validated_on(diagnosis: Diagnosis) -> str:
    """What the errors and the evidence are of."""
    if not diagnosis.held_out:
        return "recordings that were not fitted"
    return f"the last {100.0 * diagnosis.held_out:.0f} % of every recording, not fitted"


def unexplained_words(unexplained: Unexplained, *, searched: bool = True) -> str:
    """What remains with the identified effects, and how large the noise is; without a capital letter and full stop.

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
    if not unexplained.floor_known:
        noise = "the noise floor is not known, since the currents are noisier above the band of the fit than in it"
    if unexplained.encoders > 0.1 * unexplained.noise_floor:
        noise += f", that of the encoders {encoders}"
    if unexplained.repeats is not None:
        noise += f", and the logs are repeatable to {100.0 * unexplained.repeats:.3g} %"
    if unexplained.what == Remainder.NO_PATTERN:
        return f"the remaining error is {error} of the current ({noise}); it depends on no variable that was tested"
    variables = ", ".join(unexplained.depends_on)
    varies = f"the remaining error is {error} of the current ({noise}), and it depends on {variables}"
    return f"{varies}: no effect of the catalogue explains it" if searched else varies


def floor_words(unexplained: Unexplained) -> str:
    """The noise floor, where it is known, as a clause."""
    if unexplained.floor_known:
        return f"the noise floor is {in_percent(unexplained.noise_floor)}"
    return "the noise floor is not known"


def _explains(verdict: EffectVerdict) -> str:
    at = f" at {', '.join(verdict.actuators)}" if verdict.actuators else ""
    said = (
        f"With {spoken(verdict.effect)}{at} the error of recordings that were not fitted falls "
        f"from {in_percent(verdict.error_before)} to {in_percent(verdict.error_after)} of the current"
    )
    return (
        f"{said}; these data cannot distinguish it from {_alternatives(verdict)}"
        if verdict.alternatives
        else said
    )


def _as_good(verdict: EffectVerdict) -> str:
    others = _alternatives(verdict) if verdict.alternatives else "the chosen effects"
    said = f"{begun(verdict.effect)} would explain the data as well as {others}"
    return f"{said}: these recordings cannot distinguish them"


def _as_good_as_a_law(verdict: EffectVerdict) -> str:
    at = f" at {and_list(verdict.why.names)}" if verdict.why.names else ""
    return (
        f"{begun(verdict.effect)} would explain the data as well as the discovered law{at}: these recordings cannot "
        "distinguish them"
    )


def _adding(verdict: EffectVerdict, gained: str) -> str:
    return (
        f"Adding {spoken(verdict.effect)} {gained} on recordings that were not fitted "
        f"({in_percent(verdict.error_before)} to {in_percent(verdict.error_after)})"
    )


def _taken_up(verdict: EffectVerdict) -> str:
    by = "".join(f", mainly {name}," for name in verdict.why.names)
    return (
        f"The parameters of the model{by} absorb {spoken(verdict.effect)} completely: no data of this robot with these "
        "payloads can show it"
    )


def _impossible(verdict: EffectVerdict) -> str:
    parameter, *place = verdict.why.names
    at = "".join(f" at {name}" for name in place)
    return (
        f"{begun(verdict.effect)} would need a negative {parameter}{at} to explain the data, which is physically "
        "impossible: the cause is a similar effect"
    )


def _alternatives(verdict: EffectVerdict) -> str:
    return or_list([spoken(name) for name in verdict.alternatives])


WORDS: Mapping[Because, Callable[[EffectVerdict], str]] = {
    Because.EXPLAINS: _explains,
    Because.AS_GOOD: _as_good,
    Because.AS_GOOD_AS_A_LAW: _as_good_as_a_law,
    Because.GAINS_NOTHING: lambda verdict: _adding(verdict, "improves nothing"),
    Because.GAINS_LITTLE: lambda verdict: _adding(verdict, "improves the error too little to be certain"),
    Because.TAKEN_UP: _taken_up,
    Because.IMPOSSIBLE: _impossible,
    Because.CANCELS: lambda verdict: (
        f"{begun(verdict.effect)} would need a torque at {verdict.why.names[0]} many times all that the motor gives, "
        "which other terms of the model would have to cancel"
    ),
    Because.MOVES_GAIN: lambda verdict: (
        f"{begun(verdict.effect)} would change the drive gain of {verdict.why.names[0]}, and explains too little "
        "for that, compared with what the model leaves unexplained"
    ),
    Because.NOT_NEEDED: lambda verdict: (
        f"{begun(verdict.effect)} is not needed: without it, the other effects explain the data as well"
    ),
}
