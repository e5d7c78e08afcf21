"""The axes of a sweep: settings that vary, and their values."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from typing import Annotated, Any, Literal, TypeAlias

import numpy as np
from pydantic import Field, TypeAdapter, ValidationError, model_validator

from bench.basics.errors import BenchError
from bench.basics.files.toml_input import UserTable, first_mistake
from bench.truth.hidden import HIDDEN_EFFECTS
from bench.truth.streams import stream

Value: TypeAlias = Any
"""A value in TOML: a number, a string, a list or a table."""

MOST_VALUES = 100_000  # of one axis: more indicates a mistake in a unit
DRAWS = ("uniform", "log_uniform", "normal", "choice")
Finite = Annotated[float, Field(allow_inf_nan=False)]


class Range(UserTable):
    """{ from = 0, to = 1, count = 5 } or step = 0.25; spacing = "log" for equal ratios."""

    start: Annotated[Finite, Field(alias="from")]
    stop: Annotated[Finite, Field(alias="to")]
    count: Annotated[int, Field(ge=2, le=MOST_VALUES)] | None = None
    step: Annotated[Finite, Field(gt=0)] | None = None
    spacing: Literal["linear", "log"] = "linear"

    @model_validator(mode="after")
    def _countable(self) -> Range:
        if (self.count is None) == (self.step is None):
            raise ValueError("should have either count or step")
        if self.spacing == "log" and (self.step is not None or min(self.start, self.stop) <= 0):
            raise ValueError('with spacing = "log" should have a count, and both ends above 0')
        if self.step is not None and self.stop < self.start:
            raise ValueError("should not end before it begins")
        if self.step is not None and (self.stop - self.start) / self.step > MOST_VALUES:
            raise ValueError(f"should have at most {MOST_VALUES} values")
        return self

    def values(self) -> tuple[Value, ...]:
        """The values, both ends included; integers if start and step are integers."""
        if self.step is not None:
            count = int(np.floor((self.stop - self.start) / self.step * (1 + 1e-9))) + 1
            numbers = self.start + self.step * np.arange(count)
            whole = float(self.start).is_integer() and float(self.step).is_integer()
            return tuple(int(x) if whole else float(f"{x:.12g}") for x in numbers)
        assert self.count is not None
        space = np.geomspace if self.spacing == "log" else np.linspace
        return tuple(float(f"{x:.12g}") for x in space(self.start, self.stop, self.count))


class Cases(UserTable):
    """{ cases = { NAME = { "a.path" = value, … }, … } }: several settings that go together."""

    cases: Annotated[Mapping[str, Mapping[str, Any]], Field(min_length=1)]


class Hideable(UserTable):
    """{ effects = "catalogue" } or "all" effects that can be hidden; without = [ … ] omits some."""

    effects: Literal["catalogue", "all"]
    without: tuple[str, ...] = ()

    def values(self) -> tuple[Value, ...]:
        """Names of effects, in alphabetical order."""
        for name in self.without:
            if name not in HIDDEN_EFFECTS:
                raise ValueError(f"without: no effect {name!r}; there are {', '.join(HIDDEN_EFFECTS)}")
        return tuple(
            name
            for name, kind in sorted(HIDDEN_EFFECTS.items())
            if name not in self.without and (kind.in_catalogue or self.effects == "all")
        )


class Even(UserTable):
    """{ draw = "uniform", from = -0.1, to = 0.1 }: uniform between two ends."""

    draw: Literal["uniform", "log_uniform"]
    start: Annotated[Finite, Field(alias="from")]
    stop: Annotated[Finite, Field(alias="to")]

    @model_validator(mode="after")
    def _ordered(self) -> Even:
        if self.stop <= self.start:
            raise ValueError("should end above where it begins")
        if self.draw == "log_uniform" and self.start <= 0:
            raise ValueError("should begin above 0")
        return self

    def value(self, random: np.random.Generator) -> Value:
        """One number."""
        share = random.uniform()
        if self.draw == "log_uniform":
            return float(self.start * (self.stop / self.start) ** share)
        return float(self.start + (self.stop - self.start) * share)


class Normal(UserTable):
    """{ draw = "normal", mean = 0, std = 0.05 }."""

    draw: Literal["normal"]
    mean: Finite
    std: Annotated[Finite, Field(gt=0)]

    def value(self, random: np.random.Generator) -> Value:
        """One number."""
        return float(self.mean + self.std * random.standard_normal())


class ChoiceDraw(UserTable):
    """{ draw = "choice", values = [ … ] }: one of a list, with equal probability."""

    draw: Literal["choice"]
    values: Annotated[tuple[Any, ...], Field(min_length=1)]

    def value(self, random: np.random.Generator) -> Value:
        """One of the values."""
        return self.values[int(random.integers(len(self.values)))]


Draw: TypeAlias = Even | Normal | ChoiceDraw
DRAW: TypeAdapter[Draw] = TypeAdapter(Annotated[Draw, Field(discriminator="draw")])
# a table with one of these is an axis, any other contains axes
KEYS = frozenset({"from", "values", "draw", "cases", "effects"})


@dataclass(frozen=True)
class Point:
    """One value of an axis: its label in tables, and its settings."""

    label: Value
    settings: Mapping[str, Value]


@dataclass(frozen=True)
class GridAxis:
    """An axis of the grid."""

    name: str
    points: tuple[Point, ...]

    @property
    def paths(self) -> frozenset[str]:
        """All settings that the axis changes."""
        return frozenset(path for point in self.points for path in point.settings)


@dataclass(frozen=True)
class DrawnAxis:
    """A setting drawn at random, once for each seed: the same for all grid points of that seed."""

    name: str
    draw: Draw

    @property
    def paths(self) -> frozenset[str]:
        """The setting."""
        return frozenset((self.name,))

    def value(self, seed: int) -> Value:
        """The value for a seed; it depends only on the seed and the name of the axis."""
        return self.draw.value(stream(seed, "axis", self.name))


Axis: TypeAlias = GridAxis | DrawnAxis


def read_axes(table: Mapping[str, Any], where: str) -> tuple[Axis, ...]:
    """The axes of the table [axes], nested or with dotted names; BenchError names the faulty axis."""
    axes: list[Axis] = []
    for name, value in flat(table, whole=lambda entry: not KEYS.isdisjoint(entry) or not entry):
        key = f"{where}: axes.{name}"
        try:
            axes.append(_axis(name, value))
        except ValidationError as error:
            raise BenchError(f"{key}: {first_mistake(error)}") from error
        except ValueError as error:
            raise BenchError(f"{key}: {error}") from error
    return tuple(axes)


def flat(
    table: Mapping[str, Any],
    prefix: str = "",
    *,
    whole: Callable[[Mapping[str, Any]], bool] = lambda _: False,
) -> Iterator[tuple[str, Any]]:
    """Settings by dotted path; tables are entered, except for those that are `whole`."""
    for key, value in table.items():
        if isinstance(value, Mapping) and not whole(value):
            yield from flat(value, f"{prefix}{key}.", whole=whole)
        else:
            yield f"{prefix}{key}", value


def _axis(name: str, value: Any) -> Axis:
    if isinstance(value, list):
        return _grid(name, value)
    if not isinstance(value, Mapping) or not value:
        raise ValueError(f"should be a list, a range, cases or a draw, got {value!r}")
    if "draw" in value:
        if value["draw"] not in DRAWS:
            raise ValueError(f"draw: {value['draw']!r} is not one of {', '.join(DRAWS)}")
        return DrawnAxis(name, DRAW.validate_python(value))
    if "cases" in value:
        cases = Cases.model_validate(value).cases
        return GridAxis(name, tuple(Point(label, dict(flat(case))) for label, case in cases.items()))
    if "from" in value:
        return _grid(name, list(Range.model_validate(value).values()))
    if "effects" in value:
        return _grid(name, list(Hideable.model_validate(value).values()))
    return _grid(name, value["values"])


def _grid(name: str, values: Any) -> GridAxis:
    if not isinstance(values, list) or not values:
        raise ValueError(f"should have at least one value, got {values!r}")
    for i, value in enumerate(values):
        if value in values[:i]:
            raise ValueError(f"{value!r} is given twice")
    return GridAxis(name, tuple(Point(value, {name: value}) for value in values))
