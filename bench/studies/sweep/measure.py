"""What is recorded of a run: numbers by name."""

from __future__ import annotations

from collections.abc import Sequence

from bench.identification.prepare import Prepared
from bench.identification.result import Identification
from bench.studies.sweep.accuracy import Metrics
from bench.studies.sweep.identified_run import IdentifiedRun
from bench.studies.sweep.metrics import METRICS
from bench.truth.simulate import Simulation


def measure(
    simulation: Simulation, prepared: Prepared, result: Identification, record: Sequence[str]
) -> Metrics:
    """Metrics of one identification; `record`: groups of them, see `RECORDS`."""
    run = IdentifiedRun(simulation, prepared, result, record)
    metrics: Metrics = dict(run.accuracy)
    for name, metric in METRICS.items():
        if metric.group and metric.group not in record:
            continue
        if metric.value is not None:
            metrics[name] = metric.value(run)
        if metric.values is not None:
            metrics |= {f"{name}.{of}": value for of, value in metric.values(run).items()}
    return metrics
