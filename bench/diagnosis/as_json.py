"""A diagnosis as plain data."""

from dataclasses import asdict
from typing import Any

from bench.diagnosis.result import Diagnosis, Discovered, EffectVerdict
from bench.diagnosis.summary import error_share, reason, summary_sentences
from bench.files.atomic import finite
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
)


def diagnosis_json(diagnosis: Diagnosis) -> dict[str, Any]:
    """The answer as plain data, ready for JSON; a number that is not finite becomes null.

    missing, ladder, ranking and unexplained as documented for other programs; size: RMS torque in N*m or force
    in N by actuator; error_share: of the squared error, taken away. differs_by_recording: effects of which one value
    for all recordings is not enough, with request as `--with` takes it. superfluous: effects of the starting model
    that the found one does without. before, after: gains, parameters and errors of
    the models without and with what is missing.
    """
    answer = {
        "robot": diagnosis.robot,
        "judged_on": diagnosis.split,
        "summary": summary_sentences(diagnosis),
        "missing": list(diagnosis.missing),
        "ladder": [
            {
                "effects": list(step.effects),
                "error": {"identify": step.identify, "validate": step.validate},
            }
            for step in diagnosis.ladder
        ],
        "ranking": [_verdict(diagnosis, one) for one in diagnosis.ranking],
        "unexplained": asdict(diagnosis.unexplained),
        "differs_by_recording": [{**asdict(one), "request": one.request} for one in diagnosis.differs],
        "superfluous": [asdict(one) for one in diagnosis.superfluous],
        "discovered": [_discovered(one) for one in diagnosis.discovered],
        "before": _model(diagnosis.before),
        "after": _model(diagnosis.after),
    }
    return dict(finite(answer))


def _verdict(diagnosis: Diagnosis, one: EffectVerdict) -> dict[str, Any]:
    return {
        "effect": one.effect,
        "error_before": one.error_before,
        "error_after": one.error_after,
        "evidence": one.evidence,
        "verdict": one.verdict,
        "actuators": list(one.actuators),
        "alternatives": list(one.alternatives),
        "size": dict(one.size),
        "error_share": error_share(one),
        "why": reason(diagnosis, one),
    }


def _discovered(one: Discovered) -> dict[str, Any]:
    return {
        "place": one.place,
        "law": one.law,
        "formula": one.formula,
        "terms": [
            {"term": term.term, "value": term.value, "std": term.std, "unit": term.unit} for term in one.terms
        ],
        "numbers": {name: asdict(value) for name, value in one.numbers.items()},
        "error": {"identify": one.identify, "validate": one.validate, "without": one.without},
        "named": one.named,
        "nearest": None if one.nearest is None else {"effect": one.nearest[0], "error": one.nearest[1]},
        "file": one.file,
    }


def _model(result: Identification) -> dict[str, Any]:
    whole = to_json(result)
    return {key: whole[key] for key in MODEL_KEYS}
