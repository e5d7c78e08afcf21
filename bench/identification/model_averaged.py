"""Standard errors that cover other answers to the same data."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from math import hypot, inf
from typing import TypeVar

import numpy as np

from bench.identification.decision import RULE
from bench.identification.finding import Unknown
from bench.identification.result import DriveGain, Identification, Parameter, Quantity
from bench.identification.standard_errors import StdFrom


def model_averaged(result: Identification, apart: Mapping[Unknown, float], by: StdFrom) -> Identification:
    """The answer with standard errors at least as large as the distance to other answers, by unknown.

    by: the kind of other answers. The covariance grows at constant correlations; an unknown without a standard error
    remains without.
    """
    before = estimates(result)
    if not any(distance > before[unknown].std for unknown, distance in apart.items()):
        return result
    std = np.array([before[unknown].std if unknown in before else 0.0 for unknown in result.covariance_rows])
    far = np.array([apart.get(unknown, 0.0) for unknown in result.covariance_rows])
    known = (std > 0.0) & np.isfinite(std)
    times = np.maximum(np.divide(far, std, out=np.ones_like(std), where=known), 1.0)
    covariance = result.covariance * np.outer(times, times)
    covariance[np.diag_indices(len(std))] += np.where(std > 0.0, 0.0, far**2)
    wider = changed(
        result, lambda unknown, estimate: (estimate.value, max(estimate.std, apart.get(unknown, 0.0)))
    )
    return replace(wider, covariance=covariance, std_from=by)


def gains_model_averaged(
    result: Identification, others: Sequence[Identification], by: StdFrom = "models"
) -> Identification:
    """As `model_averaged`, for fitted gains, by the farthest other answer in which the gain has not run away, if it has
    not in `result`.
    """
    apart = {
        Unknown("gain", "gain", joint): max(
            (
                abs(other.drive_gains[joint].value - gain.value)
                for other in others
                if _away(gain) or not _away(other.drive_gains[joint])
            ),
            default=0.0,
        )
        for joint, gain in result.drive_gains.items()
        if gain.std > 0.0
    }
    return model_averaged(result, apart, by)


def gains_spread(result: Identification, spread: Mapping[str, float]) -> Identification:
    """As `model_averaged`, for fitted gains, by additional standard deviations of the joints in `spread`."""
    apart = {
        Unknown("gain", "gain", joint): hypot(gain.std, spread[joint])
        for joint, gain in result.drive_gains.items()
        if joint in spread and 0.0 < gain.std < inf
    }
    return model_averaged(result, apart, "models")


def gains_no_surer(result: Identification, other: Identification) -> Identification:
    """As `model_averaged`, for fitted gains, with standard errors at least those of another answer."""
    apart = {
        Unknown("gain", "gain", joint): other.drive_gains[joint].std
        for joint, gain in result.drive_gains.items()
        if gain.std > 0.0 and 0.0 < other.drive_gains[joint].std < inf
    }
    return model_averaged(result, apart, "models")


def _away(gain: DriveGain) -> bool:
    return not 1.0 / RULE.gain_lost < gain.value / gain.nominal < RULE.gain_lost


def all_model_averaged(result: Identification, other: Identification, by: StdFrom) -> Identification:
    """As `model_averaged`, for gains and parameters, by another answer to the same equations."""
    there = estimates(other)
    apart = {
        unknown: abs(there[unknown].value - estimate.value)
        for unknown, estimate in estimates(result).items()
        if unknown.kind != "effect" and unknown in there
    }
    return model_averaged(result, apart, by)


Estimate = DriveGain | Parameter | Quantity
E = TypeVar("E", DriveGain, Parameter, Quantity)


def estimates(result: Identification) -> dict[Unknown, Estimate]:
    """Every value with its standard error, including given values, of std 0."""
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
