"""Figures for papers on currents and errors: against time, motion, frequency, and their distribution."""

from collections.abc import Callable, Mapping, Sequence
from functools import partial
from typing import TypeVar

from matplotlib.axes import Axes
from matplotlib.ticker import MaxNLocator

from bench.document.charts.chart import Band, Binned, Chart, Histogram, Line, Rule, Stems
from bench.document.charts.currents import currents_chart
from bench.document.charts.motor import motor_charts
from bench.document.figures.draw import draw, points_of
from bench.document.figures.paper import Numbers, PaperFigure, PaperPanel, file_part
from bench.document.layout import PAPER
from bench.residuals.error_breakdown import error_breakdown
from bench.residuals.motor import Compared, MotorSeries

CURRENT, ERROR, CLOUD, LINE = 26.0, 14.0, 42.0, 36.0  # heights of panels, mm

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
HEADS = {
    "time": "time [s]",
    "reversals": "time from a reversal [s]",
}  # of the column of x, where it is shorter


def error_figures(what: Compared) -> list[PaperFigure]:
    """Currents of every recording, and the errors of all motors against what they may depend on."""
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
        panels.append(PaperPanel(partial(_draw_current, chart, f"{trace.joint} [{unit}]"), CURRENT))
        panels.append(PaperPanel(partial(_draw_error, chart, trace is series[-1]), ERROR))
        numbers.append(_current_numbers(trace, unit))
    name = f"currents_{file_part(recording)}"
    return PaperFigure(name, tuple(panels), {"": _joined(numbers)}, stacked=True)


def _current_numbers(trace: MotorSeries, unit: str) -> Columns:
    return {
        "motor": [trace.joint] * len(trace.time),
        "time [s]": trace.time.tolist(),
        f"measured [{unit}]": trace.measured.tolist(),
        f"modelled [{unit}]": trace.modelled.tolist(),
        f"error [{unit}]": trace.error.tolist(),
        f"noise [{unit}]": [trace.noise] * len(trace.time),
    }


def _draw_current(chart: Chart, label: str, axes: Axes) -> None:
    draw(axes, chart, PAPER.scale)
    axes.set(ylabel=label, xlabel="")


def _draw_error(chart: Chart, last: bool, axes: Axes) -> None:
    draw(axes, chart, PAPER.scale, panel=1)
    axes.yaxis.set_major_locator(MaxNLocator(3))
    axes.set_xlabel("time [s]" if last else "")


def _panels(charts: Mapping[str, Chart], height: float) -> tuple[PaperPanel, ...]:
    return tuple(PaperPanel(partial(_draw_motor, chart, joint), height) for joint, chart in charts.items())


def _draw_motor(chart: Chart, joint: str, axes: Axes) -> None:
    draw(axes, chart, PAPER.scale, key=False)
    axes.set_title(joint)


def _binned(chart: Chart) -> list[Binned]:
    return [series for series in chart.series if isinstance(series, Binned)]


def _against(name: str, charts: Mapping[str, Chart], head: str | None) -> PaperFigure:
    means, points = [], []
    for joint, chart in charts.items():
        x, error = head or chart.x.title, chart.y.title
        for series in _binned(chart):
            drawn = points_of(series)
            columns: Columns = {
                "direction": [series.name] * len(series.mean),
                x: series.center.tolist(),
                f"mean {error}": series.mean.tolist(),
                f"standard deviation [{chart.y.unit}]": series.spread.tolist(),
                "rows": [float(count) for count in series.count],
            }
            means.append(_of_motor(joint, columns))
            columns = {
                "direction": [series.name] * len(drawn),
                x: series.x[drawn].tolist(),
                error: series.y[drawn].tolist(),
            }
            points.append(_of_motor(joint, columns))
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
    """Tables under each other; a column that one of them lacks is empty there."""
    names = list(dict.fromkeys(name for part in parts for name in part))
    whole: Columns = {name: [] for name in names}
    for part in parts:
        rows = len(next(iter(part.values())))
        for name in names:
            whole[name] += list(part.get(name, [None] * rows))
    return whole
