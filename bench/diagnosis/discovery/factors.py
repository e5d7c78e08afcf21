"""Factors of laws: powers, waves, decays, steps, and first-order lags (memories)."""

from abc import ABC, abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np

from bench.diagnosis.discovery.variables import Place, Seen, Unit, Variable, times, written
from bench.diagnosis.result import Role
from bench.effects.memory import first_order
from bench.effects.table import hat
from bench.identification.tolerances import TOLERANCES


@dataclass(frozen=True)
class Number:
    """An adaptable constant of a factor, from low to high; unit: as of an effect's parameter."""

    name: str
    value: float
    unit: str
    low: float
    high: float


@dataclass(frozen=True)
class Factor(ABC):
    """A function of one or two variables, without a unit but that of its powers.

    `formula` and `code` have the same parts: two for a wave, whose phase is free, one per knot for a table, else one.
    numbers: the adaptable ones; names: theirs in code of the factor.
    """

    @property
    def parts(self) -> int:
        """Number of its coefficients."""
        return 1

    @property
    @abstractmethod
    def variables(self) -> tuple[Variable, ...]:
        """Its variables."""

    @property
    def number(self) -> Number | None:
        """The constant that can adapt."""
        return None

    @property
    @abstractmethod
    def role(self) -> Role:
        """How a law uses its variables."""

    @abstractmethod
    def values(self, seen: Seen) -> np.ndarray:
        """Values (M, parts) of its parts."""

    @abstractmethod
    def formula(self, place: Place) -> tuple[str, ...]:
        """Formulas of its parts with numbers, such as "abs(a)"."""

    @abstractmethod
    def code(self, place: Place, number: str) -> tuple[str, ...]:
        """The parts of the factor as Python code with numpy; number: the name of its number."""

    def unit(self, place: Place) -> Unit:  # noqa: ARG002 - by default none
        """The unit of its values."""
        return {}

    def with_number(self, value: float) -> "Factor":  # noqa: ARG002 - by default it has none
        """The same with another number."""
        return self


@dataclass(frozen=True)
class OfOne(Factor):
    """A function of one variable."""

    variable: Variable

    @property
    def variables(self) -> tuple[Variable, ...]:
        return (self.variable,)


@dataclass(frozen=True)
class Power(OfOne):
    """|x|^exponent, or where odd sign(x) |x|^exponent. free: the exponent may be adapted."""

    exponent: float = 1.0
    odd: bool = True
    free: bool = False

    @property
    def number(self) -> Number | None:
        x = self.exponent
        reach = TOLERANCES.laws.exponent_range
        return Number("p", x, "1", max(x - reach, 0.1), x + reach) if self.free else None

    def with_number(self, value: float) -> "Power":
        return replace(self, exponent=value)

    @property
    def role(self) -> Role:
        return ("signed" if self.exponent else "direction") if self.odd else "size"

    def values(self, seen: Seen) -> np.ndarray:
        x = seen.values[self.variable]
        if self.exponent == 0.0:
            return np.asarray(np.sign(x))[:, None]
        size = np.abs(x) if self.exponent == 1.0 else np.abs(x) ** self.exponent
        return np.asarray(np.sign(x) * size if self.odd else size)[:, None]

    def formula(self, place: Place) -> tuple[str, ...]:
        return (_power(self.variable.symbol(place), f"{self.exponent:.4g}", self.exponent, self.odd, ""),)

    def code(self, place: Place, number: str) -> tuple[str, ...]:
        exponent = None if self.free else self.exponent
        return (
            _power(self.variable.symbol(place), number or f"{self.exponent:.6g}", exponent, self.odd, "np."),
        )

    def unit(self, place: Place) -> Unit:
        return times(self.variable.unit(place), power=self.exponent)


def _power(x: str, number: str, exponent: float | None, odd: bool, prefix: str) -> str:
    """|x|^number, odd or not, in the shortest form; exponent: None if it is free."""
    if exponent == 0.0:
        return f"{prefix}sign({x})"
    if exponent == 1.0:
        return x if odd else f"{prefix}abs({x})"
    whole = exponent is not None and exponent == round(exponent)
    if whole and (round(exponent or 0.0) % 2 == 1) == odd:
        return f"{x}**{number}"
    if exponent == 2.0 and odd:
        return f"{x}*{prefix}abs({x})"
    return f"{f'{prefix}sign({x})*' if odd else ''}{prefix}abs({x})**{number}"


@dataclass(frozen=True)
class Wave(OfOne):
    """cos(w x) and sin(w x): a wave whose phase is free. x: a position or the time; w: `rate`, rad a unit of x.

    reach: range of the rate, if free. about_mean: with its mean as the first part.
    """

    rate: float
    reach: float
    free: bool = False
    about_mean: bool = False

    @property
    def parts(self) -> int:
        return 3 if self.about_mean else 2

    @property
    def number(self) -> Number | None:
        if not self.free:
            return None
        unit = "rad/s" if self.variable.kind == "time" else "rad/{angle}"
        return Number(
            "w", self.rate, unit, max(self.rate - self.reach, 0.1 * self.rate), self.rate + self.reach
        )

    def with_number(self, value: float) -> "Wave":
        return replace(self, rate=value)

    @property
    def role(self) -> Role:
        return "wave"

    def values(self, seen: Seen) -> np.ndarray:
        angle = self.rate * seen.values[self.variable]
        mean = (np.ones_like(angle),) if self.about_mean else ()
        return np.column_stack((*mean, np.cos(angle), np.sin(angle)))

    def formula(self, place: Place) -> tuple[str, ...]:
        return self._written(place, f"{self.rate:.5g}", "")

    def code(self, place: Place, number: str) -> tuple[str, ...]:
        return self._written(place, number or f"{self.rate:.12g}", "np.")

    def _written(self, place: Place, number: str, prefix: str) -> tuple[str, ...]:
        x = self.variable.symbol(place)
        angle = x if number == "1" else f"{number}*{x}"
        return (*(("1",) if self.about_mean else ()), f"{prefix}cos({angle})", f"{prefix}sin({angle})")


@dataclass(frozen=True)
class Timed(Factor):
    """A factor with an adaptable time constant, s."""

    duration: float

    @property
    def number(self) -> Number:
        factor = TOLERANCES.laws.duration_factor
        return Number("T", self.duration, "s", self.duration / factor, self.duration * factor)

    def with_number(self, value: float) -> "Timed":
        return replace(self, duration=value)


@dataclass(frozen=True)
class Decay(Timed):
    """exp(-t/T) from the start of a recording."""

    @property
    def variables(self) -> tuple[Variable, ...]:
        return (Variable("time"),)

    @property
    def role(self) -> Role:
        return "decay"

    def values(self, seen: Seen) -> np.ndarray:
        return np.asarray(np.exp(-seen.values[Variable("time")] / self.duration))[:, None]

    def formula(self, place: Place) -> tuple[str, ...]:  # noqa: ARG002 - the clock is everywhere the same
        return (f"exp(-t/{self.duration:.4g})",)

    def code(self, place: Place, number: str) -> tuple[str, ...]:  # noqa: ARG002 - as above
        return (f"np.exp(-t/{number})",)


@dataclass(frozen=True)
class Step(OfOne):
    """1 where x exceeds a threshold, else 0. x: a position or the time; reach: range of the threshold."""

    threshold: float
    reach: float

    @property
    def number(self) -> Number:
        x, unit = self.threshold, "s" if self.variable.kind == "time" else "{angle}"
        return Number("x0", x, unit, x - self.reach, x + self.reach)

    def with_number(self, value: float) -> "Step":
        return replace(self, threshold=value)

    @property
    def role(self) -> Role:
        return "step"

    def values(self, seen: Seen) -> np.ndarray:
        return (seen.values[self.variable] > self.threshold).astype(float)[:, None]

    def formula(self, place: Place) -> tuple[str, ...]:
        return (f"step({self.variable.symbol(place)} - {self.threshold:.4g})".replace("- -", "+ "),)

    def code(self, place: Place, number: str) -> tuple[str, ...]:
        return (f"np.heaviside({self.variable.symbol(place)} - {number}, 0.0)",)


@dataclass(frozen=True)
class Memory(Timed):
    """z with dz/dt = (x - z)/T, zero at the start: a first-order lag of x. x: a product of powers."""

    powers: tuple[Power, ...]

    @property
    def variables(self) -> tuple[Variable, ...]:
        return tuple(power.variable for power in self.powers)

    @property
    def role(self) -> Role:
        return "memory"

    def values(self, seen: Seen) -> np.ndarray:
        driven = np.ones(1)
        for power in self.powers:
            driven = driven * power.values(seen)[:, 0]
        parts = [first_order(driven[part], 1.0 / seen.interval, self.duration) for part in seen.parts]
        return np.concatenate(parts)[:, None]

    def formula(self, place: Place) -> tuple[str, ...]:
        driven = "*".join(power.formula(place)[0] for power in self.powers)
        return (f"lag({driven}, {self.duration:.4g})",)

    def code(self, place: Place, number: str) -> tuple[str, ...]:
        driven = "*".join(power.code(place, "")[0] for power in self.powers)
        return (f"first_order({driven}, joint.rate, {number})",)

    def unit(self, place: Place) -> Unit:
        return times(*(power.unit(place) for power in self.powers))


def unit_of(factors: tuple[Factor, ...], place: Place) -> str:
    """Unit of a coefficient that makes a torque or force of a product of factors."""
    product = times(*(factor.unit(place) for factor in factors), power=-1.0)
    return written(times({"{effort}": 1.0}, product))


@dataclass(frozen=True)
class PiecewiseLinear(OfOne):
    """f(x) by its values at knots, linear between them, constant beyond the first and the last."""

    knots: tuple[float, ...]

    @property
    def parts(self) -> int:
        return len(self.knots)

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
    """Knots with equally many values of a variable (M,) between them; `among` are knots, too."""
    places = np.quantile(values, np.linspace(0.01, 0.99, knots))
    apart = 0.3 * float(np.ptp(places)) / knots
    nodes = sorted(among)
    for place in places.tolist():
        if all(abs(place - value) > apart for value in nodes):
            nodes.append(place)
    return PiecewiseLinear(variable, tuple(sorted(nodes)))
