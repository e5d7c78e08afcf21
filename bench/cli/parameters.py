"""Kinds of command-line values that several commands take."""

import math
from collections.abc import Callable
from typing import Any

import click


class Assignment(click.ParamType[tuple[str, str | float]]):
    """`KEY=VALUE`, as a pair; the key ends at the first equals sign, and the value may be a number."""

    name = "assignment"

    def __init__(self, value: Callable[[str], str | float] = str) -> None:
        self.value = value

    def convert(
        self, value: Any, param: click.Parameter | None, ctx: click.Context | None
    ) -> tuple[str, str | float]:
        """Split the text; fails, naming it, where a side is missing or the value is no number."""
        if isinstance(value, tuple):  # a default that is split already
            return value
        key, equals, text = str(value).partition("=")
        if not (key.strip() and equals and text.strip()):
            self.fail(f"{value!r} is not of the form KEY=VALUE", param, ctx)
        try:
            return key.strip(), self.value(text.strip())
        except ValueError:
            self.fail(f"{value!r}: {text.strip()!r} is not a number", param, ctx)


class Positive(click.ParamType[float]):
    """A positive number; a comma in it is taken for what it is."""

    name = "number"

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> float:
        """Raise click.BadParameter for anything else."""
        try:
            number = float(value)
        except ValueError:
            point = str(value).replace(",", ".")
            hint = f": write the decimal point as in {point}" if "," in str(value) else ""
            self.fail(f"{value!r} is no number{hint}", param, ctx)
        if not 0.0 < number < math.inf:
            self.fail(f"{value!r} is not positive", param, ctx)
        return number


class Numbers(click.ParamType[tuple[float, ...]]):
    """So many numbers with commas between them."""

    name = "numbers"

    def __init__(self, count: int) -> None:
        self.count = count

    def convert(
        self, value: Any, param: click.Parameter | None, ctx: click.Context | None
    ) -> tuple[float, ...]:
        """Split the text; fails, naming it, where it is not so many numbers."""
        if isinstance(value, tuple):  # a default that is split already
            return value
        try:
            numbers = tuple(float(part) for part in str(value).split(","))
        except ValueError:
            numbers = ()
        if len(numbers) != self.count or not all(map(math.isfinite, numbers)):
            self.fail(f"{value!r} is not {self.count} numbers with commas between them", param, ctx)
        return numbers


def number_or_word(text: str) -> float | str:
    """A number where the text is one, otherwise the text."""
    try:
        return float(text)
    except ValueError:
        return text


def unique(pairs: tuple[tuple[str, Any], ...], option: str) -> dict[str, Any]:
    """Pairs as a mapping; a key that is given twice is a usage error."""
    keys = [key for key, _ in pairs]
    for key in keys:
        if keys.count(key) > 1:
            raise click.UsageError(f"{option}: {key!r} is given twice")
    return dict(pairs)


class Rate(click.ParamType[tuple[float, str]]):
    """A positive number with a unit, as 3rad/s or 0.5m/s, or with none: (number, unit). per: s, or s2."""

    name = "rate"

    def __init__(self, per: str) -> None:
        self.units = (f"rad/{per}", f"m/{per}")

    def convert(
        self, value: Any, param: click.Parameter | None, ctx: click.Context | None
    ) -> tuple[float, str]:
        """Raise click.BadParameter for anything else."""
        if isinstance(value, tuple):  # a default that is split already
            return value
        text = str(value).replace(" ", "")
        unit = next((unit for unit in self.units if text.endswith(unit)), "")
        try:
            number = float(text.removesuffix(unit))
        except ValueError:
            number = 0.0
        if not 0.0 < number < float("inf"):
            self.fail(f"{value!r} is no positive number, alone or in {' or '.join(self.units)}", param, ctx)
        return number, unit
