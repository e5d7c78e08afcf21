"""A diagnosis in a few sentences."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from bench.basics.joint_units import units_of_gain
from bench.basics.sentence import and_list, capital, in_percent, or_list
from bench.diagnosis.dependence_words import (
    by_log_sentence,
    from_run_to_run,
    unfinished_sentence,
    usual_sentence,
)
from bench.diagnosis.law_words import law_sentences
from bench.diagnosis.reason_words import (
    less_probable,
    probability_text,
    reason_sentence,
    unexplained_words,
    validated_on,
)
from bench.diagnosis.result import Diagnosis, EffectVerdict, Remainder, Unfinished
from bench.effects.display_names import spoken, telling_motions
from bench.identification.decision import RULE, deciding_by
from bench.identification.finding import CAUSES, Code
from bench.identification.finding_words import sentence
from bench.identification.findings import runaway, unlike
from bench.identification.result import Identification, Quantity
from bench.identification.scale_words import cure, is_one_gain, nominal_gains, why_nominal
from bench.identification.scale_words import reason as why_in_words
from bench.identification.summary import ROBOT
from bench.identification.tolerances import TOLERANCES, bounded_by
from bench.identification.wording import with_error


@dataclass(frozen=True)
class DiagnosisSummary:
    """The sentences of a diagnosis, by kind.

    verdict: what is missing; strange: doubts about the answer or its names; nominal: that the gains are only nominal,
    "" if they are fitted or do not matter; undecided: what could equally be missing; moved: change of the gain that
    moves most, "" if none does; superfluous: effects that the model does not need; differs: values that differ by
    recording; residual: what no effect explains; laws: those outside the catalogue; unfinished: parts that the deadline
    cut, "" if none; usual: friction in the model that is not missing, "" if none; by_log: names that stay with each log
    omitted, "" for one log.
    """

    verdict: str
    strange: tuple[str, ...]
    nominal: str
    undecided: tuple[str, ...]
    moved: str
    superfluous: str
    differs: tuple[str, ...]
    residual: str
    laws: tuple[str, ...] = ()
    unfinished: str = ""
    usual: str = ""
    by_log: str = ""

    @property
    def sentences(self) -> list[str]:
        """All of them in the order in which they are reported."""
        parts = [
            self.verdict,
            self.unfinished,
            *self.laws,
            *self.strange,
            self.nominal,
            *self.undecided,
            self.by_log,
            self.moved,
            self.superfluous,
            self.usual,
            *self.differs,
            self.residual,
        ]
        return [sentence for sentence in parts if sentence]


def summary_sentences(diagnosis: Diagnosis) -> list[str]:
    """What is missing, its influence, how certain it is, and the residual."""
    return summary_of(diagnosis).sentences


def summary_of(diagnosis: Diagnosis) -> DiagnosisSummary:
    """What is missing, its influence, how certain it is, the residual, and what was not searched."""
    with deciding_by(diagnosis.after.rule), bounded_by(diagnosis.after.tolerances):
        return replace(
            _summary(diagnosis),
            unfinished=unfinished_sentence(diagnosis),
            usual=usual_sentence(diagnosis.usual),
            by_log=by_log_sentence(diagnosis),
        )


def _summary(diagnosis: Diagnosis) -> DiagnosisSummary:
    searched = Unfinished.SETS not in diagnosis.unfinished
    missing = named_effects(diagnosis)
    first, last = diagnosis.ladder[0], diagnosis.ladder[-1]
    before, after = (step.reported for step in (first, last))
    floor = f"the noise floor is {in_percent(diagnosis.unexplained.noise_floor)}"
    residual_sentence = f"{capital(unexplained_words(diagnosis.unexplained, searched=searched))}."
    validation = validated_on(diagnosis)
    needless = _superfluous(diagnosis)
    each = diagnosis.by_recording
    differs = from_run_to_run(diagnosis.differs, each, clear=not diagnosis.unexplained.significant)
    laws = law_sentences(diagnosis.discovered)
    if not missing:
        what = f"No effect of the catalogue{' with one value for all recordings' if differs else ''}"
        lacks = "explains what the model lacks" if diagnosis.unexplained.significant else "is missing"
        nothing = (
            f"{what} {lacks}: judged on {validation}, no effect reduces the "
            f"error clearly below {in_percent(after if each else before)} of the current."
        )
        if not searched:
            nothing = (
                f"No missing effect was identified within the time limit: judged on {validation}, the error is "
                f"{in_percent(before)} of the current; {floor}."
            )
        elif not differs and _explains_nothing(diagnosis, before):
            nothing = (
                f"No model of this program explains these currents: judged on {validation}, the error is "
                f"{in_percent(before)} of the current; {floor}. No effect of the "
                "catalogue reduces it clearly."
            )
        causes = [expected for expected in diagnosis.after.findings if expected.code in CAUSES]
        if causes and searched:
            nothing = (
                f"{sentence(causes[0])} With the present declaration, no effect reduces the error of {validation} "
                f"clearly below {in_percent(before)} of the current."
            )
        strange = [
            *gains_in_doubt(diagnosis.after),
            *(
                sentence(finding)
                for finding in (runaway(diagnosis.after), unlike(diagnosis.after))
                if finding
            ),
        ]
        moved = _largest_change(diagnosis) if each else None
        return DiagnosisSummary(
            nothing, tuple(strange), "", (), moved or "", needless, differs, residual_sentence, laws
        )
    sure = [
        _named(diagnosis, effect_verdict)
        for effect_verdict in missing
        if effect_verdict.verdict != "resembles"
    ]
    like = [
        _named(diagnosis, effect_verdict)
        for effect_verdict in missing
        if effect_verdict.verdict == "resembles"
    ]
    parts = [*sure, *([f"something that resembles {and_list(like)}"] if like else [])]
    names = ", and ".join([and_list(sure), parts[-1]]) if sure and like else and_list(parts)
    said_of = "is" if len(parts) == 1 else "are"
    doubt, nominal = _strange(diagnosis), _nominal(diagnosis.after)
    if doubt or nominal:
        said_of = "seems to be" if len(parts) == 1 else "seem to be"
    doubt = (*gains_in_doubt(diagnosis.after), *doubt)
    if laws:
        names = f"{names}, in addition to {'a law' if len(laws) == 1 else 'laws'} outside the catalogue,"
    elif each:
        names = f"{names}, in addition to the effects that differ from run to run,"
    verdict = (
        f"{capital(names)} {said_of} missing: judged on {validation}, the error falls from {in_percent(before)} "
        f"to {in_percent(after)} of the current; {floor}."
    )
    if not laws and not each and _explains_nothing(diagnosis, after):
        verdict = (
            f"No model of this program explains these currents: judged on {validation}, the best one has an error of "
            f"{in_percent(after)} of the current; {floor}. It adds {names}; "
            f"without, the error is {in_percent(before)}."
        )
    undecided = (
        *(_cannot_tell(effect_verdict, missing) for effect_verdict in missing if effect_verdict.alternatives),
        *(each for effect_verdict in missing for each in _alike(effect_verdict)),
    )
    moved = _largest_change(diagnosis) or ""
    return DiagnosisSummary(
        verdict, doubt, nominal, undecided, moved, needless, differs, residual_sentence, laws
    )


def _explains_nothing(diagnosis: Diagnosis, error: float | None) -> bool:
    """Whether even the last model leaves most of the current, and more than noise."""
    more = diagnosis.unexplained.what in (Remainder.PATTERN, Remainder.NO_PATTERN)
    return more and error is not None and error > TOLERANCES.findings.explained


def doubts(diagnosis: Diagnosis) -> list[str]:
    """Doubts about the names of the identified effects: nominal gains, recordings that do not fit."""
    gains = gains_in_doubt(diagnosis.after)
    return [doubt for doubt in (*gains, *_strange(diagnosis), _nominal(diagnosis.after)) if doubt]


def gains_in_doubt(result: Identification) -> list[str]:
    """Doubts about drive gains although the model explains the currents: all off alike, or one far off."""
    alike = [finding for finding in result.findings if finding.code is Code.GAINS_ALIKE]
    far = [finding for finding in result.findings if finding.code is Code.GAIN_FAR]
    return [sentence(finding) for finding in alike or (() if runaway(result) else far)]


def _strange(diagnosis: Diagnosis) -> tuple[str, ...]:
    """Recordings that do not fit, or leave far more than noise."""
    result = diagnosis.after
    causes = [finding for finding in result.findings if finding.code in CAUSES]
    strange = causes[0] if causes else runaway(result) or unlike(result)
    unexplained = diagnosis.unexplained
    false = "The named effects may be wrong"
    if strange:
        return (f"{false}. {sentence(strange)}",)
    if unexplained.significant and unexplained.error > TOLERANCES.findings.remaining_noise * max(
        unexplained.noise_floor, TOLERANCES.findings.best_error, unexplained.repeats or 0.0
    ):
        size = (
            f"{unexplained.error / unexplained.noise_floor:.0f} times the noise"
            if unexplained.noise_floor
            else in_percent(unexplained.error)
        )
        return (f"{false}: the remaining error is {size}. Check columns, signs and payloads.",)
    return ()


def _nominal(result: Identification) -> str:
    """Why nominal gains make names uncertain; "" if they do not."""
    why = why_nominal(result)
    if why is None or len(result.drive_gains) == 1:
        return ""
    gains = nominal_gains(why)
    are = "is" if is_one_gain(why) else "are"
    return (
        f"T{gains[1:]} {are} nominal, because {why_in_words(why)}: gains that are wrong by a tenth look like other "
        f"effects, so the named effects may be wrong. {cure(why)}"
    ).rstrip()


def _superfluous(diagnosis: Diagnosis) -> str:
    """Unneeded effects of the starting model; "" if there are none."""
    alone = [spoken(effect.effect) for effect in diagnosis.superfluous if effect.replaced_by is None]
    parts = [
        f"{spoken(effect.effect)} is replaced by {spoken(effect.replaced_by)}"
        for effect in diagnosis.superfluous
        if effect.replaced_by is not None
    ]
    if alone:
        parts.insert(0, f"{and_list(alone)} {'is' if len(alone) == 1 else 'are'} superfluous")
    return (
        f"Of the effects in the given model, {and_list(parts)}: the error is no larger without."
        if parts
        else ""
    )


def _named(diagnosis: Diagnosis, verdict: EffectVerdict) -> str:
    """An effect, where it acts, and its alternatives, or without any its probability if it is not certain."""
    instead = (
        f" (or {or_list([spoken(name) for name in verdict.alternatives])})" if verdict.alternatives else ""
    )
    known = 1.0 if verdict.probability is None or instead else verdict.probability
    doubt = f" (probability {probability_text(known)})" if known < RULE.sure else ""
    return f"{spoken(verdict.effect)}{where(diagnosis, verdict)}{instead}{doubt}"


def _cannot_tell(verdict: EffectVerdict, missing: Sequence[EffectVerdict]) -> str:
    """Alternatives of an effect, and how to decide."""
    motions = "; ".join(telling_motions([verdict.effect, *verdict.alternatives])[: TOLERANCES.report.motions])
    options = "".join(f" --with {other.effect}" for other in missing if other is not verdict)
    less = less_probable(verdict)
    doubt = f", which is {less}, but not excluded" if less else ": these recordings cannot distinguish them"
    return (
        f"Instead of {spoken(verdict.effect)} the cause could also be "
        f"{or_list([spoken(name) for name in verdict.alternatives])}{doubt}. "
        f"To distinguish them: {motions}. The motion is designed by "
        f"`bench discriminate DATASET {verdict.effect} {verdict.alternatives[0]}{options} -o DIR`."
    )


def named_effects(diagnosis: Diagnosis) -> list[EffectVerdict]:
    """The verdicts on the effects that are missing, strongest first."""
    by_name = {verdict.effect: verdict for verdict in diagnosis.ranking}
    return [by_name[name] for name in diagnosis.missing]


def reason(diagnosis: Diagnosis, verdict: EffectVerdict) -> str:
    """The sentence on one effect, with its size in N·m (or N) and in percent of the squared error."""
    if not verdict.size:
        return reason_sentence(verdict)
    torque = motor_torques(diagnosis.after)
    sizes = [
        f"{size:.3g} {effort_unit(diagnosis.after, joint)} at {joint}" + _share(size, torque.get(joint, 0.0))
        for joint, size in verdict.size.items()
    ]
    share = error_share(verdict)
    taken = "" if share is None else f" and removes {_most(share)} of the squared error"
    said = reason_sentence(verdict).rstrip(".")
    return f"{said}; {spoken(verdict.effect)} has an RMS of {and_list(sizes)}{taken}."


def error_share(verdict: EffectVerdict) -> float | None:
    """The share of the squared error without an effect that it removes; None without an error."""
    if not verdict.error_before > 0.0:
        return None
    ratio = verdict.error_after / verdict.error_before
    return 1.0 - ratio * ratio


def motor_torques(result: Identification) -> dict[str, float]:
    """RMS torque or force of every motor over the fitted recordings, by the model's gains, N*m or N.

    Empty if the answer lacks their currents.
    """
    fitted = [trace for trace in result.recordings if trace.use == "identify"]
    if not fitted:
        return {}
    squares = np.concatenate([trace.measured**2 for trace in fitted]).mean(axis=0)
    gains = result.drive_gains
    return {
        joint: abs(gains[joint].value) * float(np.sqrt(squares[j])) for j, joint in enumerate(result.joints)
    }


def effort_unit(result: Identification, joint: str) -> str:
    """N·m or N, of one motor."""
    return units_of_gain(result.drive_gains[joint].unit).spelled_effort


def where(diagnosis: Diagnosis, verdict: EffectVerdict) -> str:
    """Places of an effect, as in " at left and right"; "" if only one place is possible."""
    places, motors = list(verdict.actuators), list(diagnosis.after.drive_gains)
    whole = ROBOT in diagnosis.after.effect_parameters.get(verdict.effect, {})
    if whole or not places or places == motors[:1] == motors:
        return ""
    if places == motors:
        return " at all motors"
    return f" at {and_list([_place(place, verdict.alike.get(place, ())) for place in places])}"


def _place(place: str, others: Sequence[str]) -> str:
    if not others:
        return place
    return f"{place} (or {or_list(others) if len(others) <= TOLERANCES.report.places else f'{len(others)} others'})"


def _alike(verdict: EffectVerdict) -> list[str]:
    """A sentence for each place that others could replace."""
    return [
        f"{capital(spoken(verdict.effect))} at {place} could also be at {or_list(others)}: these recordings cannot "
        "distinguish these places."
        for place, others in verdict.alike.items()
    ]


def moved_gain(diagnosis: Diagnosis) -> str | None:
    """The joint whose drive gain the identified effects move most, if gains were fitted and one moves."""
    before, after = diagnosis.before.drive_gains, diagnosis.after.drive_gains
    if not diagnosis.after.gains_fitted:
        return None
    changes = {joint: gain_moved(before[joint], after[joint]) for joint in after}
    joint = max(changes, key=lambda name: abs(changes[name]))
    gain = after[joint]
    if abs(changes[joint]) < TOLERANCES.findings.gain_change or gain.std > RULE.loose * abs(gain.value):
        return None
    return joint


def gain_moved(before: Quantity, after: Quantity) -> float:
    """Relative change of a gain; infinite from zero."""
    return after.value / before.value - 1.0 if before.value else math.inf


def _largest_change(diagnosis: Diagnosis) -> str | None:
    joint = moved_gain(diagnosis)
    if joint is None:
        return None
    before, after = diagnosis.before.drive_gains, diagnosis.after.drive_gains
    them = "it" if len(diagnosis.added) == 1 else "them"
    added = "one value per recording" if diagnosis.by_recording and not diagnosis.missing else them
    gain, was = after[joint], before[joint]
    came = f"is {with_error(was.value, was.std)}" if was.determined else "is not determined"
    return (
        f"With {added} the drive gain of {joint} is {with_error(gain.value, gain.std)} {gain.unit.replace('*', '·')}, "
        f"{100.0 * (gain.value / gain.nominal - 1.0):+.3g} % from its nominal {gain.nominal:.4g}; without {them} it "
        f"{came}."
    )


def _share(size: float, torque: float) -> str:
    return f" ({100.0 * size / torque:.2g} % of its torque)" if torque > 0.0 else ""


def _most(share: float) -> str:
    return "more than 99.9 %" if share > 0.999 else in_percent(share)
