"""The error against its possible variables: means and spread in bins, and the explained share."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np

from bench.basics.chi_squared import tail
from bench.identification.tolerances import TOLERANCES
from bench.residuals.autocorrelation import independent_rows
from bench.residuals.bounds import NAMING
from bench.residuals.motor import MotorSeries

Variable = Literal["time", "position", "velocity", "acceleration", "current", "direction", "constant"]
VARIABLES: tuple[Variable, ...] = (
    "constant",
    "time",
    "position",
    "velocity",
    "acceleration",
    "current",
    "direction",
)


@dataclass(frozen=True, eq=False)
class Profile:
    """Error of one motor in bins of a variable: edges (B+1,); mean, spread (standard deviation), count (B,).

    Bins hold equal numbers of rows; mean and spread are in the drive's unit, NaN in an empty bin.
    """

    edges: np.ndarray
    mean: np.ndarray
    spread: np.ndarray
    count: np.ndarray

    @property
    def center(self) -> np.ndarray:
        """Middle of each bin (B,)."""
        return (self.edges[1:] + self.edges[:-1]) / 2.0


@dataclass(frozen=True)
class Dependence:
    """The share of a motor's squared error that a variable's bin means explain.

    low, high: the smallest and the largest bin mean, drive unit; low_at, high_at: where. of_rest: whether a share of
    the residual without the variables named before.
    """

    joint: str
    variable: Variable
    error_share: float
    low: float
    low_at: float
    high: float
    high_at: float
    of_rest: bool


def values_of(series: MotorSeries, variable: Variable) -> np.ndarray:
    """One value per row (M,): time s, position rad or m and rates, current, ±1 for the direction, or one.

    The current is the modelled one: the measured one contains the error.
    """
    if variable == "constant":
        return np.ones(len(series.time))
    if variable == "direction":
        return np.where(series.forwards, 1.0, -1.0)
    name = "modelled" if variable == "current" else variable
    return np.asarray(getattr(series, name))


def profile(values: np.ndarray, errors: np.ndarray, bins: int | None = None) -> Profile:
    """Bin errors by values, both (N,), into bins with equally many rows."""
    count = TOLERANCES.statistics.bins if bins is None else bins
    edges = np.unique(np.quantile(values, np.linspace(0.0, 1.0, count + 1)))
    if len(edges) < 2:
        edges = np.array([edges[0] - 0.5, edges[0] + 0.5])
    if len(np.unique(values)) == 2:  # two values are two bins
        edges = np.array([edges[0], edges.mean(), edges[-1]])
    return binned(values, errors, edges)


def binned(values: np.ndarray, errors: np.ndarray, edges: np.ndarray) -> Profile:
    """Bin errors by values, both (N,), between given edges; values outside are omitted."""
    size = len(edges) - 1
    inside = (values >= edges[0]) & (values <= edges[-1])
    values, errors = values[inside], errors[inside]
    index = np.clip(np.searchsorted(edges, values, side="right") - 1, 0, size - 1)
    count = np.bincount(index, minlength=size)
    empty = np.where(count > 0, 1.0, np.nan)
    rows = np.maximum(count, 1)
    mean = np.bincount(index, weights=errors, minlength=size) / rows
    square = np.bincount(index, weights=(errors - mean[index]) ** 2, minlength=size) / rows
    return Profile(edges, mean * empty, np.sqrt(square) * empty, count)


def dependences(series: Sequence[MotorSeries]) -> list[Dependence]:
    """The variables on which a motor's error depends far beyond chance, the strongest first.

    The next is searched in the residual without the bin means of the previous one.
    """
    errors = np.concatenate([trace.error for trace in series])
    whole = errors
    named: list[Dependence] = []
    while len(named) < NAMING.variables:
        tried = [_dependence(series, kind, errors, named) for kind in VARIABLES]
        best, residual, chance = max(tried, key=lambda pair: pair[0].error_share)
        for plain in (tried[VARIABLES.index("direction")], tried[VARIABLES.index("constant")]):
            if plain[0].error_share > NAMING.as_good * best.error_share:
                best, residual, chance = plain
        small = best.error_share * float(errors @ errors) < NAMING.dependence / 2 * float(whole @ whole)
        if chance > NAMING.chance / len(VARIABLES) or best.error_share < NAMING.dependence or small:
            break
        named.append(best)
        errors = residual
    return named


def _dependence(
    series: Sequence[MotorSeries], variable: Variable, errors: np.ndarray, named: Sequence[Dependence]
) -> tuple[Dependence, np.ndarray, float]:
    """Dependence on a variable, the residual without it (N,), and its probability by chance."""
    values = np.concatenate([values_of(trace, variable) for trace in series])
    bins = profile(values, errors)
    size = len(bins.mean)
    index = np.clip(np.searchsorted(bins.edges, values, side="right") - 1, 0, size - 1)
    means = np.nan_to_num(bins.mean)
    residual = errors - means[index]
    whole = float(errors @ errors)
    share = 1.0 - float(residual @ residual) / whole if whole else 0.0
    cuts = np.cumsum([len(trace.time) for trace in series])[:-1]
    independent = independent_rows(series, np.split(residual, cuts))
    ratio = -independent * float(np.log(max(1.0 - share, 1e-12)))
    # of the residual, bin means alone take a share of size / independent by chance
    unbiased = max(1.0 - (1.0 - share) / (1.0 - size / independent), 0.0) if size < independent else 0.0
    low, high = int(np.argmin(means)), int(np.argmax(means))
    ends = (float(means[low]), float(bins.center[low]), float(means[high]), float(bins.center[high]))
    return Dependence(series[0].joint, variable, unbiased, *ends, bool(named)), residual, tail(ratio, size)
