"""Figures for papers: one or two columns wide, with embedded fonts, and their numbers in a file next to them."""

import csv
import io
import math
import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, TypeVar

import matplotlib as mpl
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from bench.basics.figure_style import STYLE
from bench.basics.files.atomic import atomic_path, write_text_atomically
from bench.document.charts.chart import Band, Binned, Chart, Histogram, Line, Rule, Stems
from bench.document.charts.currents import currents_chart
from bench.document.charts.motor import motor_charts
from bench.document.figures.draw import draw, points_of
from bench.document.layout import PAPER
from bench.residuals.error_breakdown import error_breakdown
from bench.residuals.motor import Compared, MotorSeries

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
    "pdf.fonttype": 42,  # TrueType: publishers refuse Type 3
    "ps.fonttype": 42,
    "savefig.dpi": PAPER.dpi,
}

Numbers = Mapping[str, Sequence[float | str | None]]
"""Columns of a table by header, all of the same length; a header includes the unit."""

CURRENT, ERROR, CLOUD, LINE = 26.0, 14.0, 42.0, 36.0  # heights of panels, mm
TIME = "time [s]"
HEADS = {
    "time": TIME,
    "reversals": "time from a reversal [s]",
}  # header of the column of x, if it is not the axis's title


@dataclass(frozen=True)
class PaperPanel:
    """One panel. draw: draws it into Axes; height: mm."""

    draw: Callable[[Axes], None]
    height: float


@dataclass(frozen=True)
class PaperFigure:
    """A figure for any width.

    numbers: by the ending of the file name, "" for the main table. stacked: whether panels are one below another even
    at two columns, with a common time axis.
    """

    name: str
    panels: tuple[PaperPanel, ...]
    numbers: Mapping[str, Numbers]
    stacked: bool = False


def paper_figure(what: PaperFigure, width: float) -> Figure:
    """Draw a figure `width` mm wide; its height follows from its panels."""
    side_by_side = not what.stacked and width > WIDTHS["one_column"]
    columns = min(PAPER.panels, len(what.panels)) if side_by_side else 1
    rows = [what.panels[i : i + columns] for i in range(0, len(what.panels), columns)]
    heights = [max(part.height for part in row) for row in rows]
    with mpl.rc_context(PRINT):
        size = (width / PAPER.inch, (sum(heights) + PAPER.legend) / PAPER.inch)
        figure = Figure(figsize=size, layout="constrained")
        axes = figure.subplots(
            len(rows), columns, squeeze=False, height_ratios=heights, sharex="col" if what.stacked else False
        )
        for place, drawn in zip(axes.flat, what.panels, strict=False):
            drawn.draw(place)
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
    """Write every figure as PDF and PNG in both widths, and its numbers as CSV, each whole; return the paths."""
    paths = []
    for what in figures:
        for width_name, width in WIDTHS.items():
            figure = paper_figure(what, width)
            for suffix in (".pdf", ".png"):
                path = folder / f"{what.name}_{width_name}{suffix}"
                with atomic_path(path) as partial, mpl.rc_context(PRINT):
                    figure.savefig(partial, metadata={"CreationDate": None} if suffix == ".pdf" else None)
                figure.set_layout_engine("none")  # keep the computed layout
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
    """A table as CSV, with numbers in full precision; unknown values are empty."""
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


Kind = TypeVar("Kind")
Columns = dict[str, list[float | str | None]]
AGAINST = {
    "error_by_time": "time",
    "error_by_position": "position",
    "error_by_velocity": "velocity",
    "error_by_acceleration": "acceleration",
    "error_by_current": "current",
    "error_at_reversals": "reversals",
}


def error_figures(what: Compared) -> list[PaperFigure]:
    """Currents of every recording, and the errors of all motors against the variables on which they may depend."""
    motors = {joint: motor_charts(error_breakdown(what, joint)) for joint in what.joints if what.of(joint)}
    figures = [_currents(what, name) for name in dict.fromkeys(trace.recording for trace in what.series)]
    for name, code in AGAINST.items():
        charts = {joint: charts[code] for joint, charts in motors.items()}
        if any(_binned(chart) for chart in charts.values()):
            figures.append(_against(name, charts, HEADS.get(code)))
    rest: tuple[tuple[str, str, Callable[[Chart], Columns]], ...] = (
        ("error_spectrum", "spectrum", _spectrum),
        ("error_over_position_spectrum", "positions", _positions),
        ("error_autocorrelation", "autocorrelation", _autocorrelation),
        ("error_histogram", "histogram", _histogram),
    )
    for name, code, columns in rest:
        charts = {joint: charts[code] for joint, charts in motors.items()}
        numbers = [_of_motor(joint, columns(chart)) for joint, chart in charts.items()]
        figures.append(PaperFigure(name, _panels(charts, LINE), {"": _joined(numbers)}))
    return figures


def _currents(what: Compared, recording: str) -> PaperFigure:
    series = [trace for trace in what.series if trace.recording == recording]
    panels, numbers = [], []
    for trace in series:
        unit = what.units[trace.joint][0]
        chart = currents_chart([("error", "", trace)], unit, recording)
        panels.append(panel(chart, CURRENT, ylabel=f"{trace.joint} [{unit}]", xlabel=""))
        panels.append(panel(chart, ERROR, number=1, xlabel=TIME if trace is series[-1] else ""))
        numbers.append(_current_numbers(trace, unit))
    name = f"currents_{file_part(recording)}"
    return PaperFigure(name, tuple(panels), {"": _joined(numbers)}, stacked=True)


def _current_numbers(trace: MotorSeries, unit: str) -> Columns:
    return {
        "motor": [trace.joint] * len(trace.time),
        TIME: trace.time.tolist(),
        f"measured [{unit}]": trace.measured.tolist(),
        f"modelled [{unit}]": trace.modelled.tolist(),
        f"error [{unit}]": trace.error.tolist(),
        f"noise [{unit}]": [trace.noise] * len(trace.time),
    }


def panel(chart: Chart, height: float, *, number: int = 0, key: bool = True, **labels: str) -> PaperPanel:
    """A panel of a chart. number: its index; height: mm; key: see `draw`; labels: replace the chart's."""

    def drawn(axes: Axes) -> None:
        draw(axes, chart, PAPER.scale, panel=number, key=key)
        if number:  # an error below its current
            axes.yaxis.set_major_locator(MaxNLocator(3))
        axes.set(**labels)

    return PaperPanel(drawn, height)


def _panels(charts: Mapping[str, Chart], height: float) -> tuple[PaperPanel, ...]:
    return tuple(panel(chart, height, key=False, title=joint) for joint, chart in charts.items())


def _binned(chart: Chart) -> list[Binned]:
    return [series for series in chart.series if isinstance(series, Binned)]


def _against(name: str, charts: Mapping[str, Chart], head: str | None) -> PaperFigure:
    means, points = [], []
    for joint, chart in charts.items():
        x, error = head or chart.x.title, chart.y.title
        for series in _binned(chart):
            columns: Columns = {
                "direction": [series.name] * len(series.mean),
                x: series.center.tolist(),
                f"mean {error}": series.mean.tolist(),
                f"standard deviation [{chart.y.unit}]": series.spread.tolist(),
                "rows": series.count.astype(float).tolist(),
            }
            means.append(_of_motor(joint, columns))
            drawn = points_of(series)
            columns = {"direction": [series.name] * len(drawn), x: series.x[drawn].tolist()}
            points.append(_of_motor(joint, {**columns, error: series.y[drawn].tolist()}))
    return PaperFigure(name, _panels(charts, CLOUD), {"": _joined(means), "_points": _joined(points)})


def _spectrum(chart: Chart) -> Columns:
    line, noise = _only(chart, Line), [series.at for series in chart.series if isinstance(series, Rule)]
    unit = chart.y.unit.replace("²", "^2")
    return {
        chart.x.title: line.x.tolist(),
        f"{chart.y.label} [{unit}]": line.y.tolist(),
        f"density of the noise [{unit}]": (noise or [0.0]) * len(line.x),
    }


def _positions(chart: Chart) -> Columns:
    line = _only(chart, Line)
    return {chart.x.title: line.x.tolist(), chart.y.title: line.y.tolist()}


def _autocorrelation(chart: Chart) -> Columns:
    stems, band = _only(chart, Stems), _only(chart, Band)
    return {
        chart.x.title: stems.x.tolist(),
        "autocorrelation": stems.y.tolist(),
        "95 % band": [band.high] * len(stems.x),
    }


def _histogram(chart: Chart) -> Columns:
    bars, unit = _only(chart, Histogram), chart.x.unit
    return {
        f"from [{unit}]": bars.edges[:-1].tolist(),
        f"to [{unit}]": bars.edges[1:].tolist(),
        "share of the rows [%]": (100.0 * bars.y).tolist(),
    }


def _only(chart: Chart, kind: type[Kind]) -> Kind:
    return next(series for series in chart.series if isinstance(series, kind))


def _of_motor(joint: str, columns: Columns) -> Columns:
    return {"motor": [joint] * len(next(iter(columns.values()))), **columns}


def _joined(parts: Sequence[Columns | Numbers]) -> Numbers:
    """Tables one below another; columns that one of them lacks are empty in its rows."""
    names = list(dict.fromkeys(name for part in parts for name in part))
    whole: Columns = {name: [] for name in names}
    for part in parts:
        rows = len(next(iter(part.values())))
        for name in names:
            whole[name] += list(part.get(name, [None] * rows))
    return whole
