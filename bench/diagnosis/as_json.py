"""A diagnosis as plain data."""

from dataclasses import asdict
from typing import Any

from bench.basics.plain_data import finite
from bench.dataset.robot_locked import locked_as_data
from bench.diagnosis.reason_words import unexplained_words, validated_on
from bench.diagnosis.result import Diagnosis, Discovered, EffectVerdict, Unfinished
from bench.diagnosis.summary import error_share, reason, summary_sentences
from bench.identification.model_json import to_json
from bench.identification.result import Identification

MODEL_KEYS = (
    "effects",
    "gains_fitted",
    "drive_gains",
    "std_from",
    "parameters",
    "effect_parameters",
    "error",
    "notes",
    "findings",
)


def diagnosis_json(diagnosis: Diagnosis, *, words: bool = True) -> dict[str, Any]:
    """The answer as plain data, ready for JSON; a number that is not finite becomes null.

    words: whether to write sentences; without them texts are empty, and all values and codes are there.

    finished: whether the search was complete before the deadline; not_looked_at: codes of its missing or incomplete
    parts. missing, ladder, ranking and unexplained as documented for other programs; size: RMS torque in N*m or force
    in N by actuator; error_share: removed share of the squared error; reason: its codes. differs_by_recording: effects
    that need more than one value for all recordings; request: as `--with` takes it. superfluous: effects of the
    starting model that the identified one lacks. before, after: gains, parameters and errors of the models without and
    with the missing effects.
    """
    answer = {
        "robot": diagnosis.robot,
        "locked": locked_as_data(diagnosis.after.locked),
        "judged_on": validated_on(diagnosis) if words else "",
        "summary": summary_sentences(diagnosis) if words else [],
        "finished": diagnosis.finished,
        "not_looked_at": list(diagnosis.unfinished),
        "missing": list(diagnosis.missing),
        "ladder": [
            {"effects": list(step.effects), "error": {"identify": step.identify, "validate": step.validate}}
            for step in diagnosis.ladder
        ],
        "ranking": [_verdict(diagnosis, verdict, words) for verdict in diagnosis.ranking],
        "something_else": diagnosis.something_else,
        "sets": [asdict(probable) for probable in diagnosis.sets],
        "decision_rule": asdict(diagnosis.after.rule),
        "tolerances": asdict(diagnosis.after.tolerances),
        "without_logs": [asdict(without) for without in diagnosis.without_logs],
        "unexplained": _unexplained(diagnosis, words),
        "differs_by_recording": [
            {**asdict(differing), "request": differing.request} for differing in diagnosis.differs
        ],
        "superfluous": [asdict(effect) for effect in diagnosis.superfluous],
        "discovered": [_discovered(law) for law in diagnosis.discovered],
        "before": _model(diagnosis.before, words),
        "after": _model(diagnosis.after, words),
    }
    return dict(finite(answer))


def verdict_json(diagnosis: Diagnosis) -> dict[str, Any]:
    """The core of an answer: what is missing and where, how far the error falls, laws and gains."""
    answer = diagnosis_json(diagnosis, words=False)
    missing = [entry for entry in answer["ranking"] if entry["effect"] in diagnosis.missing]
    short = {
        key: answer[key] for key in ("robot", "finished", "missing", "ladder", "unexplained", "discovered")
    }
    return {**short, "ranking": missing, "drive_gains": answer["after"]["drive_gains"]}


def _verdict(diagnosis: Diagnosis, verdict: EffectVerdict, words: bool) -> dict[str, Any]:
    return {
        "effect": verdict.effect,
        "error_before": verdict.error_before,
        "error_after": verdict.error_after,
        "evidence": verdict.evidence,
        "probability": verdict.probability,
        "places": dict(verdict.places),
        "verdict": verdict.verdict,
        "actuators": list(verdict.actuators),
        "alternatives": list(verdict.alternatives),
        "alike_places": {place: list(others) for place, others in verdict.alike.items()},
        "size": dict(verdict.size),
        "error_share": error_share(verdict),
        "reason": asdict(verdict.why),
        "why": reason(diagnosis, verdict) if words else "",
    }


def _unexplained(diagnosis: Diagnosis, words: bool) -> dict[str, Any]:
    unexplained, searched = diagnosis.unexplained, Unfinished.SETS not in diagnosis.unfinished
    return {
        "significant": unexplained.significant,
        "error": unexplained.error,
        "noise_floor": unexplained.noise_floor,
        "depends_on": list(unexplained.depends_on),
        "what": unexplained.what,
        "why": unexplained_words(unexplained, searched=searched) if words else "",
        "encoders": unexplained.encoders,
        "repeats": unexplained.repeats,
    }


def _discovered(law: Discovered) -> dict[str, Any]:
    return {
        "place": law.place,
        "law": law.law,
        "formula": law.formula,
        "terms": [
            {"term": term.term, "value": term.value, "std": term.std, "unit": term.unit} for term in law.terms
        ],
        "numbers": {name: asdict(value) for name, value in law.numbers.items()},
        "error": {"identify": law.identify, "validate": law.validate, "without": law.without},
        "named": law.named,
        "nearest": None if law.nearest is None else {"effect": law.nearest[0], "error": law.nearest[1]},
        "file": law.file,
    }


def _model(result: Identification, words: bool) -> dict[str, Any]:
    whole = to_json(result, words=words)
    return {key: whole[key] for key in MODEL_KEYS}
