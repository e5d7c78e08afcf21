"""Where a model fails, as plain data."""

from dataclasses import asdict
from typing import Any

from bench.files.atomic import finite
from bench.residuals.residuals import MotorErrors, WhereItFails
from bench.residuals.words import (
    alike_words,
    change_words,
    concentration_words,
    dependence_words,
    level_sentence,
    line_words,
    where_sentences,
)


def where_json(where: WhereItFails) -> dict[str, Any]:
    """Noise floor, findings and warm-up of every motor, and all of it in sentences; shares lie between 0 and 1.

    Opposing errors are in the drive's unit, every finding with a `text`.
    """
    answer = {
        "noise_floor": {one.joint: one.noise for one in where.motors},
        "where": {one.joint: _motor(one) for one in where.motors},
        "sentences": where_sentences(where),
    }
    return dict(finite(answer))


def _motor(motor: MotorErrors) -> dict[str, Any]:
    units = motor.units
    return {
        "text": level_sentence(motor),
        "error": motor.error,
        "noise": motor.noise,
        "by_recording": {
            name: {"error": error, "noise": noise} for name, (error, noise) in motor.by_recording.items()
        },
        "alike_over": motor.memory,
        "concentrated": [
            {
                "region": one.region,
                "error_share": one.error_share,
                "time_share": one.time_share,
                "evidence": one.evidence,
                "of_rest": one.of_rest,
                "text": concentration_words(one),
            }
            for one in motor.concentrations
        ],
        "follows": [
            {
                "variable": one.variable,
                "error_share": one.error_share,
                "low": {"mean": one.low, "at": one.low_at},
                "high": {"mean": one.high, "at": one.high_at},
                "of_rest": one.of_rest,
                "text": dependence_words(one, units),
            }
            for one in motor.dependences
        ],
        "repeats": [
            {
                "over": one.over,
                "frequency": one.frequency,
                "error_share": one.error_share,
                "amplitude": one.amplitude,
                "text": line_words(one, units),
            }
            for one in motor.lines
        ],
        "changes": [
            {"first": asdict(one.first), "second": asdict(one.second), "text": change_words(one, units[0])}
            for one in motor.changes
        ],
        "looks_like": [
            {**asdict(one), "question": one.question, "text": alike_words(motor.joint, one)}
            for one in motor.alike
        ],
        "warm_up": [asdict(one) for one in motor.warm_up],
        "by_load": [asdict(one) for one in motor.by_load],
    }
