"""All that an answer estimates, by unknown: gains, parameters, and values of effects."""

from collections.abc import Callable
from dataclasses import replace
from math import inf
from typing import TypeVar

from bench.identification.finding import Unknown
from bench.identification.result import DriveGain, Identification, Parameter, Quantity

Estimate = DriveGain | Parameter | Quantity
E = TypeVar("E", DriveGain, Parameter, Quantity)


def estimates(result: Identification) -> dict[Unknown, Estimate]:
    """Every value with its standard error, those of std 0 that were given included."""
    by_unknown: dict[Unknown, Estimate] = {
        Unknown("parameter", parameter.name): parameter for parameter in result.parameters
    }
    by_unknown |= {Unknown("gain", "gain", joint): gain for joint, gain in result.drive_gains.items()}
    return by_unknown | {
        Unknown("effect", name, place, effect): quantity
        for effect, places in result.effect_parameters.items()
        for place, each in places.items()
        for name, quantity in each.items()
    }


def in_both(first: Identification, second: Identification) -> dict[Unknown, tuple[Estimate, Estimate]]:
    """Values with a finite standard error in both answers, by unknown."""
    first_values, second_values = estimates(first), estimates(second)
    return {
        unknown: (value, second_values[unknown])
        for unknown, value in first_values.items()
        if unknown in second_values and all(0.0 < each.std < inf for each in (value, second_values[unknown]))
    }


def changed(
    result: Identification, value_of: Callable[[Unknown, Estimate], tuple[float, float]]
) -> Identification:
    """The answer with other values and standard errors, and nothing else changed."""

    def moved(estimate: E, unknown: Unknown) -> E:
        value, std = value_of(unknown, estimate)
        return replace(estimate, value=value, std=std)

    return replace(
        result,
        parameters=tuple(
            moved(parameter, Unknown("parameter", parameter.name)) for parameter in result.parameters
        ),
        drive_gains={
            joint: moved(gain, Unknown("gain", "gain", joint)) for joint, gain in result.drive_gains.items()
        },
        effect_parameters={
            effect: {
                place: {
                    name: moved(quantity, Unknown("effect", name, place, effect))
                    for name, quantity in each.items()
                }
                for place, each in places.items()
            }
            for effect, places in result.effect_parameters.items()
        },
    )
