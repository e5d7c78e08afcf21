"""Charts: series over axes. `document.figures.draw` draws them with matplotlib, `page.chart_spec` for the page."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Literal

import numpy as np

Role = Literal[
    "measured",
    "modelled",
    "error",
    "before",
    "after",
    "noise",
    "forwards",
    "backwards",
    "one",
    "two",
    "three",
    "four",
    "five",
    "six",
    "seven",
]
"""What a series represents; every renderer has a colour for it."""


@dataclass(frozen=True)
class Axis:
    """A quantity with its unit, as typeset; with unit "%" the values are shares. categories: names of 0, 1, ...

    domain: its ends; include: values that it always shows; room: whether to leave space at its ends.
    """

    label: str
    unit: str = ""
    scale: Literal["linear", "log", "band"] = "linear"
    domain: tuple[float, float] | None = None
    include: tuple[float, ...] = ()
    categories: tuple[str, ...] = ()
    room: bool = False

    @property
    def title(self) -> str:
        """The quantity with its unit, as in "velocity [rad/s]"."""
        return f"{self.label} [{self.unit}]" if self.unit else self.label

    @property
    def percent(self) -> bool:
        """Whether the values are shares, shown in percent."""
        return self.unit == "%"


@dataclass(frozen=True, eq=False)
class Series:
    """Base of all series: the name in the legend, and what the series represents."""

    name: str
    role: Role


@dataclass(frozen=True, eq=False)
class Line(Series):
    """y over x, both (N,); NaN is a gap. markers: whether each value has a dot."""

    x: np.ndarray
    y: np.ndarray
    markers: bool = False


@dataclass(frozen=True, eq=False)
class Levels(Series):
    """A value for each category, (N,), NaN for none; texts: their labels."""

    values: np.ndarray
    texts: tuple[str, ...] = ()


@dataclass(frozen=True, eq=False)
class Band(Series):
    """The area between two values of y."""

    low: float
    high: float


@dataclass(frozen=True, eq=False)
class Rule(Series):
    """A straight line across the panel at a value of one axis; without a name it is not in the legend."""

    axis: Literal["x", "y"]
    at: float
    dashed: bool = False


@dataclass(frozen=True, eq=False)
class Binned(Series):
    """Rows (x, y), (K,), with their bins: edges (B+1,), and centre, mean, spread, smallest, largest and count (B,)."""

    x: np.ndarray
    y: np.ndarray
    edges: np.ndarray
    center: np.ndarray
    mean: np.ndarray
    spread: np.ndarray
    low: np.ndarray
    high: np.ndarray
    count: np.ndarray


@dataclass(frozen=True, eq=False)
class Whiskers(Series):
    """Middle values over x with the ends of their intervals, (N,). joined: whether x is a quantity, not a category.

    pick: for each, the values of the axes by which it can be selected; empty if it cannot be.
    """

    x: np.ndarray
    middle: np.ndarray
    low: np.ndarray
    high: np.ndarray
    joined: bool = True
    pick: tuple[Mapping[str, str], ...] = ()


@dataclass(frozen=True, eq=False)
class Spans(Series):
    """Values along x with the ends of their intervals, (N,), at the categories of y; low, high may be NaN."""

    y: np.ndarray
    x: np.ndarray
    low: np.ndarray
    high: np.ndarray
    shift: float = 0.0


@dataclass(frozen=True, eq=False)
class Bars(Series):
    """A length along x for each category of y, (N,). thin: whether it is for comparison with a thick one."""

    x: np.ndarray
    thin: bool = False


@dataclass(frozen=True, eq=False)
class Points(Series):
    """Single points (N,)."""

    x: np.ndarray
    y: np.ndarray


@dataclass(frozen=True, eq=False)
class Stems(Series):
    """Values y over x (N,), each joined to zero."""

    x: np.ndarray
    y: np.ndarray


@dataclass(frozen=True, eq=False)
class Histogram(Series):
    """y (B,) between edges (B+1,)."""

    edges: np.ndarray
    y: np.ndarray


@dataclass(frozen=True, eq=False)
class Cells(Series):
    """Column x, row y, shade 0 to 1 and text of each cell of a matrix, (N,). pick: see `Whiskers`."""

    x: np.ndarray
    y: np.ndarray
    shade: np.ndarray
    texts: tuple[str, ...]
    pick: tuple[Mapping[str, str], ...] = ()


@dataclass(frozen=True)
class Panel:
    """Series over one axis y. weight: its share of the height."""

    y: Axis
    series: tuple[Series, ...]
    weight: float = 1.0


@dataclass(frozen=True)
class Chart:
    """Panels one below another over one axis x. aid: how to read it; key: meaning of colours, if no legend gives it.

    legend: of this chart, shared by charts side by side, or none.
    """

    title: str
    x: Axis
    panels: tuple[Panel, ...]
    aid: str = ""
    key: str = ""
    legend: Literal["own", "shared", "none"] = "own"

    @property
    def y(self) -> Axis:
        """The y axis of the first panel."""
        return self.panels[0].y

    @property
    def series(self) -> tuple[Series, ...]:
        """The series of all panels."""
        return tuple(entry for panel in self.panels for entry in panel.series)


def is_wide(values: np.ndarray, ratio: float = 20.0) -> bool:
    """Whether values (N,) are positive and span at least `ratio`, so that they need a logarithmic axis."""
    known = values[np.isfinite(values)]
    return bool(len(known) > 1 and known.min() > 0 and known.max() / known.min() >= ratio)
