"""What is recorded of a run: numbers by name."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from bench.basics.chi_squared import WITHIN_95
from bench.identification.prepare import Prepared
from bench.identification.result import Identification
from bench.studies.sweep.accuracy import Metrics, accuracy
from bench.studies.sweep.metrics import METRICS
from bench.studies.sweep.true_parameters import true_base_parameters
from bench.truth.report import truth
from bench.truth.simulate import Simulation

WELL_KNOWN = 0.03  # relative deviation below which a parameter counts as essential, about


def measure(
    simulation: Simulation, prepared: Prepared, result: Identification, record: Sequence[str]
) -> Metrics:
    """Metrics of one identification; `record`: groups of them, see `RECORDS`."""
    joints = tuple(result.drive_gains)
    metrics = accuracy(simulation, result)
    metrics["gain_within"] = float(np.mean([metrics[f"gain_within.{joint}"] for joint in joints]))
    metrics["gain_rms"] = float(np.sqrt(np.mean([metrics[f"gain_error.{joint}"] ** 2 for joint in joints])))
    metrics |= {name: metric.value(result) for name, metric in METRICS.items() if metric.value is not None}
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
