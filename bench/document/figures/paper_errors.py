"""Figures for papers on currents and errors: against time, motion, frequency, and their distribution."""

from collections.abc import Callable, Sequence
from functools import partial

import numpy as np
from matplotlib.axes import Axes
from matplotlib.ticker import MaxNLocator

from bench.document.colours import ON_WHITE
from bench.document.figures.comparison import with_gaps
from bench.document.figures.comparison_panels import BINS as SPREAD_BINS
from bench.document.figures.comparison_panels import (
    draw_autocorrelation,
    draw_branches,
    draw_noise_band,
    draw_position_spectrum,
    draw_time_spectrum,
    points_of,
)
from bench.document.figures.paper import SCALE, Numbers, Panel, PaperFigure, file_part
from bench.residuals.autocorrelation import Autocorrelation
from bench.residuals.error_breakdown import Branch, ErrorBreakdown, error_breakdown
from bench.residuals.motor import Compared, MotorSeries
from bench.residuals.periods import PositionSpectrum, Spectrum
from bench.residuals.profile import Variable

CURRENT, ERROR, CLOUD, LINE = 26.0, 14.0, 42.0, 36.0  # heights of panels, mm
BINS = 41  # of the histogram
REACH = 5.0  # deviations of the noise that the histogram covers at least

Columns = dict[str, list[float | str | None]]


def error_figures(what: Compared) -> list[PaperFigure]:
    """Currents of every recording, and the errors of all motors against what they may depend on."""
    joints = [joint for joint in what.joints if what.of(joint)]
    units = {joint: what.units[joint][1] for joint in joints}
    variables: list[tuple[str, Variable, Callable[[str], str]]] = [
        ("error_by_time", "time", lambda _: "time [s]"),
        ("error_by_position", "position", lambda joint: f"position [{units[joint]}]"),
        ("error_by_velocity", "velocity", lambda joint: f"velocity [{units[joint]}/s]"),
        ("error_by_acceleration", "acceleration", lambda joint: f"acceleration [{units[joint]}/s²]"),
        ("error_by_current", "current", lambda joint: f"modelled current [{what.units[joint][0]}]"),
    ]
    found = [_currents(what, name) for name in dict.fromkeys(trace.recording for trace in what.series)]
    motors = [error_breakdown(what, joint) for joint in joints]
    found += [
        _against(motors, name, [breakdown.against(variable, SPREAD_BINS) for breakdown in motors], label)
        for name, variable, label in variables
    ]
    at_reversals = [breakdown.around_reversals for breakdown in motors]
    if any(at_reversals):
        found.append(
            _against(motors, "error_at_reversals", at_reversals, lambda _: "time from a reversal [s]")
        )
    return [*found, _spectrum(motors), _over_position(motors), _autocorrelation(motors), _histogram(motors)]


def _currents(what: Compared, recording: str) -> PaperFigure:
    series = [trace for trace in what.series if trace.recording == recording]
    panels, numbers = [], []
    for trace in series:
        unit = what.units[trace.joint][0]
        panels.append(Panel(partial(_draw_current, trace, unit), CURRENT))
        panels.append(Panel(partial(_draw_error, trace, unit, trace is series[-1]), ERROR))
        numbers.append(
            {
                "motor": [trace.joint] * len(trace.time),
                "time [s]": trace.time.tolist(),
                f"measured [{unit}]": trace.measured.tolist(),
                f"modelled [{unit}]": trace.modelled.tolist(),
                f"error [{unit}]": trace.error.tolist(),
                f"noise [{unit}]": [trace.noise] * len(trace.time),
            }
        )
    name = f"currents_{file_part(recording)}"
    return PaperFigure(name, tuple(panels), {"": _joined(numbers)}, stacked=True)


def _draw_current(trace: MotorSeries, unit: str, axes: Axes) -> None:
    time = with_gaps(trace, trace.time)
    axes.plot(
        time,
        with_gaps(trace, trace.measured),
        color=ON_WHITE.measured,
        linewidth=1.8,
        alpha=0.45,
        label="measured",
    )
    axes.plot(
        time, with_gaps(trace, trace.modelled), color=ON_WHITE.modelled, linewidth=0.6, label="modelled"
    )
    axes.set_ylabel(f"{trace.joint} [{unit}]")
    axes.margins(x=0.01)


def _draw_error(trace: MotorSeries, unit: str, last: bool, axes: Axes) -> None:
    draw_noise_band(axes, trace.noise, "± noise")
    axes.plot(
        with_gaps(trace, trace.time),
        with_gaps(trace, trace.error),
        color=ON_WHITE.error,
        linewidth=0.45,
        label="error",
    )
    axes.set_ylabel(f"error [{unit}]")
    axes.yaxis.set_major_locator(MaxNLocator(3))
    axes.margins(x=0.01)
    if last:
        axes.set_xlabel("time [s]")


def _against(
    motors: Sequence[ErrorBreakdown],
    name: str,
    found: Sequence[Sequence[Branch]],
    label: Callable[[str], str],
) -> PaperFigure:
    panels, means, points = [], [], []
    for motor, branches in zip(motors, found, strict=True):
        current, joint = motor.current, motor.joint
        x, error = label(joint), f"error [{current}]"
        panels.append(Panel(partial(_draw_against, motor, branches, x, error), CLOUD))
        for branch in branches:
            rows, drawn = len(branch.bins.mean), points_of(branch)
            means.append(
                {
                    "motor": [joint] * rows,
                    "direction": [branch.direction] * rows,
                    x: branch.bins.center.tolist(),
                    f"mean {error}": branch.bins.mean.tolist(),
                    f"standard deviation [{current}]": branch.bins.spread.tolist(),
                    "rows": [float(count) for count in branch.bins.count],
                }
            )
            points.append(
                {
                    "motor": [joint] * len(drawn),
                    "direction": [branch.direction] * len(drawn),
                    x: branch.x[drawn].tolist(),
                    error: branch.error[drawn].tolist(),
                }
            )
    return PaperFigure(name, tuple(panels), {"": _joined(means), "_points": _joined(points)})


def _draw_against(motor: ErrorBreakdown, found: Sequence[Branch], x: str, y: str, axes: Axes) -> None:
    draw_noise_band(axes, motor.noise)
    draw_branches(axes, found, SCALE)
    axes.set(title=motor.joint, xlabel=x, ylabel=y)


def _spectrum(motors: Sequence[ErrorBreakdown]) -> PaperFigure:
    panels, numbers = [], []
    for motor in motors:
        found, unit, joint = motor.spectrum, motor.current, motor.joint
        panels.append(Panel(partial(_draw_spectrum, found, joint, unit), LINE))
        numbers.append(
            {
                "motor": [joint] * (len(found.frequency) - 1),
                "frequency [Hz]": found.frequency[1:].tolist(),
                f"density of the error [{unit}^2/Hz]": found.density[1:].tolist(),
                f"density of the noise [{unit}^2/Hz]": [found.noise] * (len(found.frequency) - 1),
            }
        )
    return PaperFigure("error_spectrum", tuple(panels), {"": _joined(numbers)})


def _draw_spectrum(found: Spectrum, joint: str, unit: str, axes: Axes) -> None:
    draw_time_spectrum(axes, found, SCALE)
    axes.set(title=joint, xlabel="frequency [Hz]", ylabel=f"density [{unit}²/Hz]")


def _over_position(motors: Sequence[ErrorBreakdown]) -> PaperFigure:
    panels, numbers = [], []
    for motor in motors:
        found, current, unit, joint = motor.over_position, motor.current, motor.unit, motor.joint
        cycles, amplitude = np.asarray(found.cycles), np.asarray(found.amplitude)
        panels.append(Panel(partial(_draw_cycles, found, joint, (current, unit)), LINE))
        numbers.append(
            {
                "motor": [joint] * len(cycles),
                f"cycles per {unit}": cycles.tolist(),
                f"amplitude of the error [{current}]": amplitude.tolist(),
            }
        )
    return PaperFigure("error_over_position_spectrum", tuple(panels), {"": _joined(numbers)})


def _draw_cycles(found: PositionSpectrum, joint: str, units: tuple[str, str], axes: Axes) -> None:
    draw_position_spectrum(axes, found, SCALE)
    axes.set(title=joint, xlabel=f"cycles per {units[1]}", ylabel=f"amplitude [{units[0]}]")


def _autocorrelation(motors: Sequence[ErrorBreakdown]) -> PaperFigure:
    panels, numbers = [], []
    for motor in motors:
        found, joint = motor.autocorrelation, motor.joint
        lag, value = np.asarray(found.lag), np.asarray(found.value)
        panels.append(Panel(partial(_draw_autocorrelation, found, joint), LINE))
        numbers.append(
            {
                "motor": [joint] * len(lag),
                "lag [s]": lag.tolist(),
                "autocorrelation": value.tolist(),
                "95 % band": [found.band] * len(lag),
            }
        )
    return PaperFigure("error_autocorrelation", tuple(panels), {"": _joined(numbers)})


def _draw_autocorrelation(found: Autocorrelation, joint: str, axes: Axes) -> None:
    draw_autocorrelation(axes, found, SCALE)
    axes.set(title=joint, xlabel="lag [s]", ylabel="autocorrelation")


def _histogram(motors: Sequence[ErrorBreakdown]) -> PaperFigure:
    panels, numbers = [], []
    for motor in motors:
        errors, unit, joint = motor.errors, motor.current, motor.joint
        reach = max(float(np.abs(errors).max()), REACH * motor.noise)
        edges = np.linspace(-reach, reach, BINS + 1)
        share = np.histogram(errors, edges)[0] / len(errors)
        panels.append(Panel(partial(_draw_histogram, motor, edges, share), LINE))
        numbers.append(
            {
                "motor": [joint] * BINS,
                f"from [{unit}]": edges[:-1].tolist(),
                f"to [{unit}]": edges[1:].tolist(),
                "share of the rows [%]": (100.0 * share).tolist(),
            }
        )
    return PaperFigure("error_histogram", tuple(panels), {"": _joined(numbers)})


def _draw_histogram(motor: ErrorBreakdown, edges: np.ndarray, share: np.ndarray, axes: Axes) -> None:
    axes.stairs(100.0 * share, edges, fill=True, color=ON_WHITE.error, alpha=0.75, label="error")
    if motor.noise > 0:
        x = np.linspace(edges[0], edges[-1], 400)
        width = edges[1] - edges[0]
        normal = motor.noise_alone(x)
        top = 1.25 * 100.0 * float(share.max())
        axes.plot(
            x, 100.0 * width * normal, color="#5A6470", linewidth=0.7, label="noise of the current alone"
        )
        axes.set_ylim(0.0, top)
    axes.xaxis.set_major_locator(MaxNLocator(5))
    axes.set(title=motor.joint, xlabel=f"error [{motor.current}]", ylabel="share of the rows [%]")


def _joined(parts: Sequence[Columns | Numbers]) -> Numbers:
    """Tables under each other; a column that one of them lacks is empty there."""
    names = list(dict.fromkeys(name for part in parts for name in part))
    whole: Columns = {name: [] for name in names}
    for part in parts:
        rows = len(next(iter(part.values())))
        for name in names:
            whole[name] += list(part.get(name, [None] * rows))
    return whole
