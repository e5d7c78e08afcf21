"""Charts of one motor in one recording or in all: the currents, and the error against what it may depend on."""

from collections.abc import Sequence
from typing import Any

import numpy as np

from bench.basics.chi_squared import WITHIN_95
from bench.page.parts import Chart
from bench.page.thinned import rounded, significant, thinned
from bench.residuals.error_breakdown import AROUND, Branch, ErrorBreakdown
from bench.residuals.motor import MotorSeries
from bench.residuals.profile import Variable

HEIGHT, TALL = 210, 330  # px
BINS = 16
VARIABLES: tuple[Variable, ...] = ("velocity", "position", "acceleration", "current", "time")
LONGEST_NAME = 24

Spec = dict[str, Any]
Curve = tuple[str, str, MotorSeries]
"""role, name and series of one error curve."""


def currents_spec(curves: Sequence[Curve], units: tuple[str, str], label: str, most: int) -> tuple[Spec, int]:
    """Measured and modelled current over time, the errors below, and how many rows stand behind two points.

    curves: the errors to show, that of the model whose current is drawn last; most: points of each curve. With
    several models the last one's error stands once more in a panel of its own, at its own scale.
    """
    *_, (role, name, last) = curves
    current = units[0]
    x, values, width = thinned(
        last.row, _period(last), {"measured": last.measured, "modelled": last.modelled}, most
    )
    top = [
        {"kind": "line", "role": "measured", "name": "measured", "x": x, "y": values["measured"]},
        {"kind": "line", "role": "modelled", "name": "modelled", "x": x, "y": values["modelled"]},
    ]
    errors = [_error_line(curve, most) for curve in curves]
    panels = [
        {"weight": 1.5, "y": {"label": f"current [{current}]"}, "series": top},
        {"weight": 1.0, "y": {"label": f"error [{current}]"}, "series": [_noise_band(last.noise), *errors]},
    ]
    if len(curves) > 1:
        own = [_noise_band(last.noise), _error_line((role, name, last), most)]
        panels.append({"weight": 1.0, "y": {"label": f"error {name} [{current}], enlarged"}, "series": own})
    spec = {
        "label": label,
        "height": 150 + 115 * len(panels),
        "x": {"label": "time from the start of the recording [s]"},
        "panels": panels,
    }
    return spec, width


def error_charts(errors: ErrorBreakdown) -> tuple[Chart, ...]:
    """Everything that one motor's error may depend on, all recordings together."""
    return (
        *(_against(errors, variable) for variable in VARIABLES),
        _reversals(errors),
        _recordings(errors),
        _opposing(errors),
        _shares(errors),
        _spectrum(errors),
        _positions(errors),
        _autocorrelation(errors),
        _histogram(errors),
    )


def _period(series: MotorSeries) -> float:
    return 1.0 / series.rate if series.rate else 1.0


def _error_line(curve: Curve, most: int) -> Spec:
    role, name, series = curve
    x, values, _ = thinned(series.row, _period(series), {"error": series.error}, most)
    return {"kind": "line", "role": role, "name": f"error {name}".strip(), "x": x, "y": values["error"]}


def _noise_band(noise: float) -> Spec:
    noise = float(f"{noise:.4g}")
    return {"kind": "band", "role": "noise", "name": "± noise of the current", "low": -noise, "high": noise}


def _spec(x: Spec, y: Spec, series: list[Spec], title: str, **more: Any) -> Spec:
    return {"label": title, "height": HEIGHT, "x": x, "panels": [{"y": y, "series": series}], **more}


def _bins(branch: Branch) -> Spec:
    found = branch.bins
    lowest, highest = _extremes(branch)
    extent = float(np.nanmax(highest) - np.nanmin(lowest)) or 1.0
    return {
        "kind": "bins",
        "role": branch.direction,
        "name": branch.direction,
        "x": rounded(found.center),
        "mean": rounded(found.mean, extent),
        "spread": rounded(found.spread, extent),
        "low": rounded(lowest, extent),
        "high": rounded(highest, extent),
    }


def _extremes(branch: Branch) -> tuple[np.ndarray, np.ndarray]:
    """Smallest and largest error in every bin, as `binned` bins."""
    values, errors, edges = branch.x, branch.error, branch.bins.edges
    size = len(edges) - 1
    inside = (values >= edges[0]) & (values <= edges[-1])
    index = np.clip(np.searchsorted(edges, values[inside], side="right") - 1, 0, size - 1)
    low, high = np.full(size, np.inf), np.full(size, -np.inf)
    np.minimum.at(low, index, errors[inside])
    np.maximum.at(high, index, errors[inside])
    return np.where(np.isfinite(low), low, np.nan), np.where(np.isfinite(high), high, np.nan)


def _against(errors: ErrorBreakdown, variable: Variable) -> Chart:
    found = [_noise_band(errors.noise), *map(_bins, errors.against(variable, BINS))]
    title = f"Against {'modelled current' if variable == 'current' else variable}"
    aid = "Level with the band: nothing depends on it."
    x, y = {"label": errors.labels[variable]}, {"label": f"error [{errors.current}]"}
    return Chart(title, aid, _spec(x, y, found, title, shared=True, legend=False))


def _reversals(errors: ErrorBreakdown) -> Chart:
    branches = errors.around_reversals
    zero = {"kind": "rule", "role": "noise", "axis": "x", "at": 0.0, "dashed": True}
    found = [_noise_band(errors.noise), zero, *map(_bins, branches)]
    aid = "A step or spike at zero is friction or play. Colour: the direction afterwards."
    if not branches:
        aid = "The motor never reverses while it moves: nothing to show."
    title, reach = "Around reversals", AROUND / (errors.series[0].rate or 1.0)
    x = {"label": "time from the nearest reversal [s]", "include": [-reach, reach]}
    y = {"label": f"error [{errors.current}]"}
    return Chart(title, aid, _spec(x, y, found, title, shared=True, legend=False))


def _recordings(errors: ErrorBreakdown) -> Chart:
    found = errors.by_recording
    stems = [recording.recording.removesuffix(".csv").removesuffix(".parquet") for recording in found]
    names = [
        f"{stem}, {recording.payload}" if recording.payload else stem
        for stem, recording in zip(stems, found, strict=True)
    ]
    pairs = (
        ("error", "error", significant(np.array([recording.error for recording in found]))),
        ("noise", "noise of the current", significant(np.array([recording.noise for recording in found]))),
    )
    title = "By recording and payload"
    spec = _bars(title, "error of the current [%]", names, pairs, height=70 + 24 * len(found))
    return Chart(title, "A recording or payload that stands out is unlike the others.", spec)


def _bars(
    title: str, label: str, names: list[str], pairs: Sequence[tuple[str, str, Any]], *, height: int
) -> Spec:
    """Two bars for each name, the second one thin; pairs: role, name and lengths of either."""
    thick, thin = ({"kind": "hbars", "role": role, "name": name, "x": x} for role, name, x in pairs)
    return {
        "label": title,
        "height": max(TALL, height),
        "x": {"label": label, "percent": True, "include": [0.0]},
        "panels": [{"y": {"scale": "band", "categories": names}, "series": [thick, {**thin, "thin": True}]}],
    }


def _opposing(errors: ErrorBreakdown) -> Chart:
    known = [(_cut(name), opposing) for name, opposing in errors.opposing]
    mean = np.array([opposing.mean for _, opposing in known])
    half = WITHIN_95 * np.array([opposing.std for _, opposing in known])
    points = {
        "kind": "intervals",
        "role": "error",
        "name": "mean with 95 % interval",
        "y": list(range(len(known))),
        "x": significant(mean),
        "low": significant(mean - half),
        "high": significant(mean + half),
    }
    zero = {"kind": "rule", "role": "noise", "axis": "x", "at": 0.0}
    title = "Error that opposes the motion"
    aid = "Right of zero: more friction than modelled. Thirds that differ: warming up."
    y = {"scale": "band", "categories": [name for name, _ in known]}
    x = {"label": f"mean of error · direction [{errors.current}]", "room": True}
    return Chart(title, aid, {**_spec(x, y, [zero, points], title), "height": TALL})


def _shares(errors: ErrorBreakdown) -> Chart:
    found = errors.shares
    pairs = (
        ("error", "of the squared error", significant(np.array([region.error for region in found]), 4)),
        ("noise", "of the time", significant(np.array([region.time for region in found]), 4)),
    )
    title, names = "Where the squared error lies", [region.region for region in found]
    spec = _bars(title, "share [%]", names, pairs, height=70 + 17 * len(found))
    return Chart(title, "A bar far longer than the grey one: the error is concentrated there.", spec)


def _spectrum(errors: ErrorBreakdown) -> Chart:
    found = errors.spectrum
    curve: Spec = {
        "kind": "line",
        "role": "error",
        "name": "error",
        "x": rounded(found.frequency[1:]),
        "y": significant(found.density[1:], 3),
    }
    noise: Spec = {
        "kind": "rule",
        "role": "noise",
        "name": "noise of the current",
        "axis": "y",
        "at": float(f"{found.noise:.4g}"),
    }
    series_of = [noise, curve] if found.noise > 0 else [curve]
    title = "Spectrum over time"
    y: Spec = {"label": f"density [{errors.current}²/Hz]", "scale": "log"}
    if found.noise > 0:
        y["domain"] = [found.noise / 30.0, float(max(found.density[1:].max(), found.noise)) * 2.0]
    aid = "Above the grey line: more than noise. A peak is a vibration or a ripple."
    return Chart(title, aid, _spec({"label": "frequency [Hz]"}, y, series_of, title))


def _positions(errors: ErrorBreakdown) -> Chart:
    found = errors.over_position
    curve = {
        "kind": "line",
        "role": "error",
        "name": "error",
        "x": rounded(found.cycles),
        "y": rounded(found.amplitude),
    }
    title = "Spectrum over position"
    x = {"label": f"cycles per {errors.unit}"}
    y = {"label": f"amplitude [{errors.current}]", "include": [0.0]}
    return Chart(
        title, "A peak repeats with position: cogging, gears, geometry.", _spec(x, y, [curve], title)
    )


def _autocorrelation(errors: ErrorBreakdown) -> Chart:
    found = errors.autocorrelation
    band = {
        "kind": "band",
        "role": "noise",
        "name": "95 % of what chance gives",
        "low": -found.band,
        "high": found.band,
    }
    stems = {
        "kind": "stems",
        "role": "error",
        "name": "autocorrelation",
        "x": rounded(found.lag),
        "y": rounded(found.value, 2.0),
    }
    title = "Autocorrelation"
    y = {"label": "correlation", "include": [-0.2, 1.0]}
    aid = "Outside the band: errors follow each other. The first few come from the fit's low-pass."
    return Chart(title, aid, _spec({"label": "lag [s]"}, y, [band, stems], title))


def _histogram(errors: ErrorBreakdown) -> Chart:
    count, edges = np.histogram(errors.errors, bins=41)
    y = count.tolist()
    found: list[Spec] = [
        {"kind": "histogram", "role": "error", "name": "error", "edges": rounded(edges), "y": y}
    ]
    if errors.noise > 0:
        x = np.linspace(edges[0], edges[-1], 241)
        rows = errors.noise_alone(x) * len(errors.errors) * float(edges[1] - edges[0])
        line = {"kind": "line", "role": "noise", "name": "noise alone", "x": rounded(x), "y": rounded(rows)}
        found.append(line)
    title = "Histogram"
    scale = {"label": "rows, logarithmic", "scale": "log", "domain": [0.7, 1.5 * float(count.max())]}
    aid = "All errors, the largest included. Wider than the grey curve: more than noise."
    return Chart(title, aid, _spec({"label": f"error [{errors.current}]"}, scale, found, title))


def _cut(name: str) -> str:
    return name if len(name) <= LONGEST_NAME else f"{name[: LONGEST_NAME - 1]}…"
