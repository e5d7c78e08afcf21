"""Figures for papers: as wide as one column or two, fonts embedded, their numbers in a file next to them."""

import csv
import io
import math
import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import matplotlib as mpl
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from bench.basics.figure_style import STYLE
from bench.basics.files.atomic import atomic_path, write_text_atomically
from bench.document.layout import PAPER

WIDTHS = {"one_column": 88.0, "two_columns": 180.0}  # mm
# Any: matplotlib types every key of these by name.
PRINT: Any = {
    **STYLE,
    "font.size": 7.0,
    "axes.titlesize": 7.0,
    "axes.labelsize": 7.0,
    "xtick.labelsize": 6.5,
    "ytick.labelsize": 6.5,
    "legend.fontsize": 6.5,
    "legend.handlelength": 1.6,
    "legend.columnspacing": 1.2,
    "axes.linewidth": 0.5,
    "grid.linewidth": 0.35,
    "xtick.major.width": 0.5,
    "ytick.major.width": 0.5,
    "xtick.major.size": 2.0,
    "ytick.major.size": 2.0,
    "xtick.minor.size": 1.2,
    "ytick.minor.size": 1.2,
    "axes.labelpad": 2.0,
    "pdf.fonttype": 42,  # whole TrueType fonts: publishers refuse Type 3
    "ps.fonttype": 42,
    "savefig.dpi": PAPER.dpi,
}

Numbers = Mapping[str, Sequence[float | str | None]]
"""Columns of a table, all of the same length; a header carries its unit."""


@dataclass(frozen=True)
class PaperPanel:
    """One pair of axes. height: mm."""

    draw: Callable[[Axes], None]
    height: float


@dataclass(frozen=True)
class PaperFigure:
    """A figure, whatever its width.

    numbers: by the ending of the file name, "" for the main table. stacked: panels stand under each other on two
    columns as well, on one time axis.
    """

    name: str
    panels: tuple[PaperPanel, ...]
    numbers: Mapping[str, Numbers]
    stacked: bool = False


def paper_figure(what: PaperFigure, width: float) -> Figure:
    """Draw a figure `width` mm wide, its height following from its panels."""
    side_by_side = not what.stacked and width > WIDTHS["one_column"]
    columns = min(PAPER.panels, len(what.panels)) if side_by_side else 1
    rows = [what.panels[i : i + columns] for i in range(0, len(what.panels), columns)]
    heights = [max(drawn.height for drawn in row) for row in rows]
    with mpl.rc_context(PRINT):
        size = (width / PAPER.inch, (sum(heights) + PAPER.legend) / PAPER.inch)
        figure = Figure(figsize=size, layout="constrained")
        axes = figure.subplots(
            len(rows), columns, squeeze=False, height_ratios=heights, sharex="col" if what.stacked else False
        )
        for place, panel in zip(axes.flat, what.panels, strict=False):
            panel.draw(place)
        for spare in axes.flat[len(what.panels) :]:
            spare.set_visible(False)
        labels: dict[str, Any] = {}
        for place in axes.flat:
            for handle, label in zip(*place.get_legend_handles_labels(), strict=True):
                labels.setdefault(label, handle)
        if len(labels) > 1:
            in_one_row = width > WIDTHS["one_column"] or sum(map(len, labels)) <= PAPER.legend_letters
            across = len(labels) if in_one_row else 2
            figure.legend(
                labels.values(), labels.keys(), loc="outside upper center", ncols=across, frameon=False
            )
        figure.align_ylabels()
    return figure


def write_paper_figures(folder: Path, figures: Sequence[PaperFigure]) -> list[Path]:
    """Write every figure as PDF and PNG in both widths, and its numbers as CSV; tells the paths.

    Each file is whole or not there.
    """
    paths = []
    for what in figures:
        for width_name, width in WIDTHS.items():
            figure = paper_figure(what, width)
            for suffix in (".pdf", ".png"):
                path = folder / f"{what.name}_{width_name}{suffix}"
                with atomic_path(path) as partial, mpl.rc_context(PRINT):
                    figure.savefig(partial, metadata={"CreationDate": None} if suffix == ".pdf" else None)
                figure.set_layout_engine("none")  # it stays as it was worked out
                paths.append(path)
        for ending, numbers in what.numbers.items():
            path = folder / f"{what.name}{ending}.csv"
            write_text_atomically(path, csv_of(numbers))
            paths.append(path)
    return paths


def file_part(recording: str) -> str:
    """A recording's name as part of a file name: "run 2.csv (end)" -> "run_2_end"."""
    return re.sub(r"[^\w-]+", "_", re.sub(r"\.(csv|parquet)\b", "", recording)).strip("_")


def csv_of(numbers: Numbers) -> str:
    """A table as CSV, every number to the last digit; what is not known is empty."""
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(numbers.keys())
    for row in zip(*numbers.values(), strict=True):
        writer.writerow([_exact(entry) for entry in row])
    return text.getvalue()


def _exact(value: float | str | None) -> str:
    if isinstance(value, str):
        return value
    return "" if value is None or math.isnan(value) else repr(float(value))
