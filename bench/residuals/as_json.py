"""Where a model fails, as plain data."""

from collections.abc import Callable
from dataclasses import asdict
from typing import Any

from bench.basics.plain_data import finite
from bench.residuals.residuals import MotorErrors, WhereItFails
from bench.residuals.words import (
    alike_words,
    change_words,
    concentration_words,
    dependence_words,
    level_sentence,
    line_words,
    overlapping,
    where_sentences,
)


def where_json(where: WhereItFails, *, words: bool = True) -> dict[str, Any]:
    """Noise floor, findings and warm-up of every motor, and all of it in sentences; shares lie between 0 and 1.

    Opposing errors are in the drive's unit; every finding has a `text`. words: whether to write texts and sentences.
    """

    def text(sentence: Callable[..., str], *of: Any) -> str:
        return sentence(*of) if words else ""

    answer = {
        "noise_floor": {motor.joint: motor.noise for motor in where.motors},
        "where": {motor.joint: _motor(motor, text) for motor in where.motors},
        "sentences": where_sentences(where) if words else [],
        "shares": overlapping(where) if words else "",
    }
    return dict(finite(answer))


def _fields(value: Any, *names: str) -> dict[str, Any]:
    """These fields of a dataclass as plain data."""
    whole = asdict(value)
    return {name: whole[name] for name in names}


def _motor(motor: MotorErrors, text: Callable[..., str]) -> dict[str, Any]:
    units = motor.units
    return {
        "text": text(level_sentence, motor),
        "error": motor.error,
        "noise": motor.noise,
        "by_recording": {
            name: {"error": error, "noise": noise} for name, (error, noise) in motor.by_recording.items()
        },
        "alike_over": motor.autocorrelation_time,
        "concentrated": [
            {
                "region": part.where.name,
                **_fields(part, "error_share", "time_share", "evidence", "of_rest"),
                "text": text(concentration_words, part),
            }
            for part in motor.concentrations
        ],
        "follows": [
            {
                **_fields(dependence, "variable", "error_share"),
                "low": {"mean": dependence.low, "at": dependence.low_at},
                "high": {"mean": dependence.high, "at": dependence.high_at},
                **_fields(dependence, "of_rest"),
                "text": text(dependence_words, dependence, units),
            }
            for dependence in motor.dependences
        ],
        "repeats": [
            {
                **_fields(line, "over", "frequency", "resolution", "error_share", "amplitude"),
                "text": text(line_words, line, units),
            }
            for line in motor.lines
        ],
        "changes": [
            {**_fields(change, "first", "second"), "text": text(change_words, change, units[0])}
            for change in motor.changes
        ],
        "looks_like": [
            {**asdict(rival), "question": rival.question, "text": text(alike_words, motor.joint, rival)}
            for rival in motor.alike
        ],
        "warm_up": [asdict(opposing) for opposing in motor.warm_up],
        "by_load": [asdict(opposing) for opposing in motor.by_load],
    }
