"""Thresholds and numerical bounds in place of the defaults, by name."""

from collections.abc import Sequence
from dataclasses import asdict
from typing import Any

from pydantic import TypeAdapter, ValidationError

from bench.basics.errors import BenchError, meant
from bench.identification.decision import DecisionRule
from bench.identification.tolerances import Tolerances


def given_rule(given: Sequence[str]) -> tuple[DecisionRule, Tolerances]:
    """The rule and the tolerances with these changes, each NAME=VALUE or PART.NAME=VALUE.

    Raises BenchError for an unknown name, or a value that is not a number.
    """
    rule: dict[str, Any] = asdict(DecisionRule())
    parts: dict[str, dict[str, Any]] = asdict(Tolerances())
    for text in given:
        name, equals, value = text.partition("=")
        part, _, bound = name.rpartition(".")
        values = parts.get(part, {}) if part else rule
        if not equals or bound not in values:
            names = [*rule, *(f"{part}.{bound}" for part, bounds in parts.items() for bound in bounds)]
            why = "has no value, as in prior=12" if not equals else f"no such threshold; {meant(name, names)}"
            raise BenchError(f"rule {text!r}: {why}")
        values[bound] = value
    try:
        return TypeAdapter(DecisionRule).validate_python(rule), TypeAdapter(Tolerances).validate_python(parts)
    except ValidationError as error:
        (first, *_) = error.errors()
        name = ".".join(map(str, first["loc"]))
        raise BenchError(f"rule {name}={first['input']}: {first['msg'].lower()}") from error
