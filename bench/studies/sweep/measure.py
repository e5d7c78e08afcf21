"""What is recorded of a run: numbers by name."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from bench.basics.chi_squared import WITHIN_95
from bench.identification.prepare import Prepared
from bench.identification.result import Identification
from bench.studies.sweep.accuracy import Metrics, accuracy
from bench.studies.sweep.true_parameters import true_base_parameters
from bench.truth.report import truth
from bench.truth.simulate import Simulation

METRICS = {
    "gain_error": "largest relative deviation of an estimated drive gain from the true one; .JOINT with its sign",
    "gain_std": "standard deviation of a drive gain as estimated, relative; .JOINT",
    "gain_within": "share of the drive gains whose 95 % interval holds the truth; .JOINT",
    "gain_rms": "root mean square of the relative deviations of all drive gains",
    "error": "relative error of the current; .identify, .validate",
    "noise_floor": "what a perfect model would leave of the current; .identify, .validate",
    "identify_error_over_noise_floor": "error of the current over the noise floor, fitted recordings",
    "validate_error_over_noise_floor": "the same, recordings that were not fitted",
    "scaled_condition": "condition number of the observation matrix, columns of unit length",
    "loop_gap": "largest opening of a loop, m",
    "position_cutoff": "cut-off of the low-pass on positions, Hz",
    "decimation": "one sample in this many is fitted",
    "drive_gain": "drive gain; .JOINT",
    "parameter": "base parameter; .NAME, .NAME.std, .NAME.true",
    "parameter_error": "largest relative deviation of an essential base parameter from the true one",
    "parameter_within": "share of the base parameters whose 95 % interval holds the truth",
    "diagnosis": "of `diagnose`: .missed and .invented, how many effects; .missing, their names; .gain_error after",
    "effect": "effect parameter; .EFFECT.JOINT.PARAMETER and .std",
}
"""Every metric, what it measures; after a dot, what it is of."""

WELL_KNOWN = 0.03  # relative deviation below which a parameter counts as essential, about


def measure(
    simulation: Simulation, prepared: Prepared, result: Identification, record: Sequence[str]
) -> Metrics:
    """Metrics of one identification; `record`: groups of them, see `RECORDS`."""
    joints = tuple(result.drive_gains)
    metrics = accuracy(simulation, result)
    metrics["gain_within"] = float(np.mean([metrics[f"gain_within.{joint}"] for joint in joints]))
    metrics["gain_rms"] = float(np.sqrt(np.mean([metrics[f"gain_error.{joint}"] ** 2 for joint in joints])))
    metrics["position_cutoff"] = result.settings.position_cutoff
    metrics["decimation"] = float(result.settings.decimation)
    if "gains" in record:
        metrics |= {f"drive_gain.{joint}": gain.value for joint, gain in result.drive_gains.items()}
    if "parameters" in record:
        metrics |= _parameters(simulation, prepared, result)
    if "effects" in record:
        for effect, by_joint in result.effect_parameters.items():
            for joint, values in by_joint.items():
                for name, quantity in values.items():
                    metrics[f"effect.{effect}.{joint}.{name}"] = quantity.value
                    metrics[f"effect.{effect}.{joint}.{name}.std"] = quantity.std
    return metrics


def _parameters(simulation: Simulation, prepared: Prepared, result: Identification) -> Metrics:
    true = dict(
        zip(prepared.model.base.names, true_base_parameters(prepared.model, truth(simulation)), strict=True)
    )
    metrics: Metrics = {}
    errors, within = [], []
    for parameter in result.parameters:
        metrics[f"parameter.{parameter.name}"] = parameter.value
        metrics[f"parameter.{parameter.name}.std"] = parameter.std
        if parameter.name not in true:
            continue
        metrics[f"parameter.{parameter.name}.true"] = true[parameter.name]
        within.append(float(abs(parameter.value - true[parameter.name]) <= WITHIN_95 * parameter.std))
        if parameter.relative_std < WELL_KNOWN:
            errors.append(abs(parameter.value / true[parameter.name] - 1.0))
    metrics["parameter_error"] = max(errors, default=float("nan"))
    metrics["parameter_within"] = float(np.mean(within)) if within else float("nan")
    return metrics
