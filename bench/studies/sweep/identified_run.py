"""An identified run with its truth: the basis of all metrics."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from bench.basics.chi_squared import WITHIN_95

if TYPE_CHECKING:
    from bench.identification.prepare import Prepared
    from bench.identification.result import Identification, Parameter
    from bench.truth.simulate import Simulation

WELL_KNOWN = 0.03  # relative standard error below which a parameter counts as well determined


@dataclass(frozen=True, eq=False)
class IdentifiedRun:
    """One run of a sweep. record: the requested groups of metrics."""

    simulation: Simulation
    prepared: Prepared
    result: Identification
    record: Sequence[str]

    @cached_property
    def accuracy(self) -> dict[str, float]:
        """Errors of gains and currents, by column: see `bench.studies.sweep.accuracy`."""
        from bench.studies.sweep.accuracy import accuracy  # noqa: PLC0415 - descriptions need no MuJoCo

        return accuracy(self.simulation, self.result)

    def by_gain(self, metric: str) -> np.ndarray:
        """A metric of every gain (n,)."""
        return np.array([self.accuracy[f"{metric}.{joint}"] for joint in self.result.drive_gains])

    @cached_property
    def true_parameters(self) -> dict[str, float]:
        """The true base parameters by name, and the true gains by joint."""
        from bench.studies.sweep.accuracy import true_values  # noqa: PLC0415 - likewise
        from bench.truth.report import truth  # noqa: PLC0415 - likewise

        return true_values(self.prepared.model, truth(self.simulation))

    @property
    def _estimates(self) -> list[tuple[Parameter, float]]:
        """The base parameters whose true values are known, with these."""
        true = self.true_parameters
        return [(entry, true[entry.name]) for entry in self.result.parameters if entry.name in true]

    def worst_parameter(self) -> float:
        """Largest relative error of a parameter that the data determine well; NaN if there is none."""
        known = [(entry, true) for entry, true in self._estimates if entry.relative_std < WELL_KNOWN]
        return max((abs(entry.value / true - 1.0) for entry, true in known), default=float("nan"))

    def parameters_within(self) -> float:
        """Share of the parameters whose 95 % interval contains the truth; NaN if there are none."""
        within = [abs(entry.value - true) <= WITHIN_95 * entry.std for entry, true in self._estimates]
        return float(np.mean(within)) if within else float("nan")

    def parameter_columns(self) -> dict[str, float]:
        """Every base parameter with its standard error and its true value, by the part of the column's name after the
        dot.
        """
        columns = {}
        for parameter in self.result.parameters:
            columns[parameter.name] = parameter.value
            columns[f"{parameter.name}.std"] = parameter.std
            if parameter.name in self.true_parameters:
                columns[f"{parameter.name}.true"] = self.true_parameters[parameter.name]
        return columns

    def effect_columns(self) -> dict[str, float]:
        """Every parameter of an effect with its standard error, likewise."""
        columns = {}
        for effect, by_joint in self.result.effect_parameters.items():
            for joint, values in by_joint.items():
                for name, quantity in values.items():
                    columns[f"{effect}.{joint}.{name}"] = quantity.value
                    columns[f"{effect}.{joint}.{name}.std"] = quantity.std
        return columns
