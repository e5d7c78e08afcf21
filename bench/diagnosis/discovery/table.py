"""A function without a formula, by its values at some places."""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from bench.diagnosis.discovery.factors import Factor
from bench.diagnosis.discovery.variables import Place, Seen, Variable
from bench.diagnosis.result import Role
from bench.effects.table import hat


@dataclass(frozen=True)
class PiecewiseLinear(Factor):
    """f(x) by its values at knots, with straight lines between; constant beyond the first and the last."""

    variable: Variable
    knots: tuple[float, ...]

    @property
    def parts(self) -> int:
        return len(self.knots)

    @property
    def variables(self) -> tuple[Variable, ...]:
        return (self.variable,)

    @property
    def role(self) -> Role:
        return "table"

    def values(self, seen: Seen) -> np.ndarray:
        x = seen.values[self.variable]
        return np.column_stack([hat(x, *pair) for pair in self._hats()])

    def formula(self, place: Place) -> tuple[str, ...]:
        return self._written(place, ".4g")

    def code(self, place: Place, number: str) -> tuple[str, ...]:  # noqa: ARG002 - it has none
        return self._written(place, ".9g")

    def _written(self, place: Place, digits: str) -> tuple[str, ...]:
        x = self.variable.symbol(place)
        return tuple(f"hat({x}, {', '.join(format(each, digits) for each in pair)})" for pair in self._hats())

    def _hats(self) -> list[tuple[float, float, float]]:
        padded = (self.knots[0], *self.knots, self.knots[-1])
        return [(a, b, c) for (a, b), (_, c) in pairwise(pairwise(padded))]


def table_over(
    variable: Variable, values: np.ndarray, knots: int, among: Sequence[float] = ()
) -> PiecewiseLinear:
    """With as many values of a variable (M,) between any two of its knots; `among` are knots, too."""
    places = np.quantile(values, np.linspace(0.01, 0.99, knots))
    apart = 0.3 * float(np.ptp(places)) / knots
    nodes = sorted(among)
    for place in places.tolist():
        if all(abs(place - value) > apart for value in nodes):
            nodes.append(place)
    return PiecewiseLinear(variable, tuple(sorted(nodes)))
