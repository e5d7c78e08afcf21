"""Charts of one motor in one recording or in all: the currents, and the error against what it may depend on."""

from collections.abc import Sequence
from typing import Any

import numpy as np

from bench.basics.chi_squared import WITHIN_95
from bench.page.parts import Chart
from bench.page.thinned import rounded, significant, thinned
from bench.residuals.autocorrelation import autocorrelation
from bench.residuals.concentration import shares
from bench.residuals.motor import MotorSeries, relative_error_of, relative_noise
from bench.residuals.opposing_motion import by_load, over_warm_up
from bench.residuals.periods import position_spectrum, time_spectrum
from bench.residuals.profile import Profile, Variable, binned, profile, values_of
from bench.residuals.regions import regions

HEIGHT, TALL = 210, 330  # px
BINS = 16
AROUND = 8  # rows before and after a reversal
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
    errors = [_error_line(one, most) for one in curves]
    panels = [
        {"weight": 1.5, "y": {"label": f"current [{current}]"}, "series": top},
        {"weight": 1.0, "y": {"label": f"error [{current}]"}, "series": [_noise_band([last]), *errors]},
    ]
    if len(curves) > 1:
        own = [_noise_band([last]), _error_line((role, name, last), most)]
        panels.append({"weight": 1.0, "y": {"label": f"error {name} [{current}], enlarged"}, "series": own})
    spec = {
        "label": label,
        "height": 150 + 115 * len(panels),
        "x": {"label": "time from the start of the recording [s]"},
        "panels": panels,
    }
    return spec, width


def error_charts(series: Sequence[MotorSeries], units: tuple[str, str]) -> tuple[Chart, ...]:
    """Everything that one motor's error may depend on, all recordings together."""
    current, unit = units
    against: list[tuple[Variable, str]] = [
        ("velocity", f"velocity [{unit}/s]"),
        ("position", f"position [{unit}]"),
        ("acceleration", f"acceleration [{unit}/s²]"),
        ("current", f"modelled current [{current}]"),
        ("time", "time from the start of the recording [s]"),
    ]
    return (
        *(_against(series, variable, label, current) for variable, label in against),
        _reversals(series, current),
        _recordings(series),
        _opposing(series, current),
        _shares(series, unit, current),
        _spectrum(series, current),
        _positions(series, units),
        _autocorrelation(series),
        _histogram(series, current),
    )


def _period(series: MotorSeries) -> float:
    return 1.0 / series.rate if series.rate else 1.0


def _error_line(curve: Curve, most: int) -> Spec:
    role, name, series = curve
    x, values, _ = thinned(series.row, _period(series), {"error": series.error}, most)
    return {"kind": "line", "role": role, "name": f"error {name}".strip(), "x": x, "y": values["error"]}


def _noise_band(series: Sequence[MotorSeries]) -> Spec:
    noise = float(f"{_noise(series):.4g}")
    return {"kind": "band", "role": "noise", "name": "± noise of the current", "low": -noise, "high": noise}


def _noise(series: Sequence[MotorSeries]) -> float:
    rows = [len(one.time) for one in series]
    return float(np.sqrt(np.average([one.noise**2 for one in series], weights=rows)))


def _spec(x: Spec, y: Spec, series: list[Spec], title: str, **more: Any) -> Spec:
    return {"label": title, "height": HEIGHT, "x": x, "panels": [{"y": y, "series": series}], **more}


def _ways(series: Sequence[MotorSeries]) -> list[tuple[str, np.ndarray]]:
    forwards = np.concatenate([one.forwards for one in series])
    return [(role, way) for role, way in (("forwards", forwards), ("backwards", ~forwards)) if way.any()]


def _bins(role: str, found: Profile, center: np.ndarray, lowest: np.ndarray, highest: np.ndarray) -> Spec:
    extent = float(np.nanmax(highest) - np.nanmin(lowest)) or 1.0
    return {
        "kind": "bins",
        "role": role,
        "name": role,
        "x": rounded(center),
        "mean": rounded(found.mean, extent),
        "spread": rounded(found.spread, extent),
        "low": rounded(lowest, extent),
        "high": rounded(highest, extent),
    }


def _extremes(values: np.ndarray, errors: np.ndarray, edges: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Smallest and largest error in every bin, as `binned` bins."""
    size = len(edges) - 1
    inside = (values >= edges[0]) & (values <= edges[-1])
    index = np.clip(np.searchsorted(edges, values[inside], side="right") - 1, 0, size - 1)
    low, high = np.full(size, np.inf), np.full(size, -np.inf)
    np.minimum.at(low, index, errors[inside])
    np.maximum.at(high, index, errors[inside])
    return np.where(np.isfinite(low), low, np.nan), np.where(np.isfinite(high), high, np.nan)


def _against(series: Sequence[MotorSeries], variable: Variable, label: str, current: str) -> Chart:
    x = np.concatenate([values_of(one, variable) for one in series])
    errors = np.concatenate([one.error for one in series])
    found = [_noise_band(series)]
    for role, way in _ways(series):
        bins = profile(x[way], errors[way], BINS)
        found.append(_bins(role, bins, bins.center, *_extremes(x[way], errors[way], bins.edges)))
    title = f"Against {'modelled current' if variable == 'current' else variable}"
    aid = "Level with the band: nothing depends on it."
    y = {"label": f"error [{current}]"}
    return Chart(title, aid, _spec({"label": label}, y, found, title, shared=True, legend=False))


def _reversals(series: Sequence[MotorSeries], current: str) -> Chart:
    rate = series[0].rate or 1.0
    rows = np.concatenate([one.to_reversal for one in series])
    errors = np.concatenate([one.error for one in series])
    # a row before a reversal to forwards moves backwards
    into = np.concatenate([one.forwards ^ (one.to_reversal < 0) for one in series])
    near = np.abs(rows) <= AROUND
    edges = np.arange(-AROUND, AROUND + 1.0)
    found = [_noise_band(series), {"kind": "rule", "role": "noise", "axis": "x", "at": 0.0, "dashed": True}]
    for role, way in (("forwards", near & into), ("backwards", near & ~into)):
        if way.any():
            bins = binned(rows[way], errors[way], edges)
            found.append(_bins(role, bins, bins.center / rate, *_extremes(rows[way], errors[way], edges)))
    aid = "A step or spike at zero is friction or play. Colour: the direction afterwards."
    if not near.any():
        aid = "The motor never reverses while it moves: nothing to show."
    title = "Around reversals"
    x = {"label": "time from the nearest reversal [s]", "include": [-AROUND / rate, AROUND / rate]}
    y = {"label": f"error [{current}]"}
    return Chart(title, aid, _spec(x, y, found, title, shared=True, legend=False))


def _recordings(series: Sequence[MotorSeries]) -> Chart:
    stems = [one.recording.removesuffix(".csv").removesuffix(".parquet") for one in series]
    names = [
        f"{stem}, {one.payload}" if one.payload else stem for stem, one in zip(stems, series, strict=True)
    ]
    errors = np.array([relative_error_of([one]) or 0.0 for one in series])
    noise = np.array([relative_noise([one]) for one in series])
    title = "By recording and payload"
    spec = {
        "label": title,
        "height": max(TALL, 70 + 24 * len(series)),
        "x": {"label": "error of the current [%]", "percent": True, "include": [0.0]},
        "panels": [
            {
                "y": {"scale": "band", "categories": names},
                "series": [
                    {"kind": "hbars", "role": "error", "name": "error", "x": significant(errors)},
                    {
                        "kind": "hbars",
                        "role": "noise",
                        "name": "noise of the current",
                        "x": significant(noise),
                        "thin": True,
                    },
                ],
            }
        ],
    }
    return Chart(title, "A recording or payload that stands out is unlike the others.", spec)


def _opposing(series: Sequence[MotorSeries], current: str) -> Chart:
    parts = [*over_warm_up(series), *by_load(series)]
    names = ["first third", "last third", *(_cut(one.part) for one in parts[2:])]
    known = [(name, one) for name, one in zip(names, parts, strict=True) if np.isfinite(one.std)]
    mean = np.array([one.mean for _, one in known])
    half = WITHIN_95 * np.array([one.std for _, one in known])
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
    x = {"label": f"mean of error · direction [{current}]", "room": True}
    return Chart(title, aid, {**_spec(x, y, [zero, points], title), "height": TALL})


def _shares(series: Sequence[MotorSeries], unit: str, current: str) -> Chart:
    found = [one for one in regions(series, unit, current) if one.of == "motion"]
    both = np.array([shares(series, one) for one in found]).reshape(-1, 2)
    title = "Where the squared error lies"
    spec = {
        "label": title,
        "height": max(TALL, 70 + 17 * len(found)),
        "x": {"label": "share [%]", "percent": True, "include": [0.0]},
        "panels": [
            {
                "y": {"scale": "band", "categories": [one.name for one in found]},
                "series": [
                    {
                        "kind": "hbars",
                        "role": "error",
                        "name": "of the squared error",
                        "x": significant(both[:, 0], 4),
                    },
                    {
                        "kind": "hbars",
                        "role": "noise",
                        "name": "of the time",
                        "x": significant(both[:, 1], 4),
                        "thin": True,
                    },
                ],
            }
        ],
    }
    return Chart(title, "A bar far longer than the grey one: the error is concentrated there.", spec)


def _spectrum(series: Sequence[MotorSeries], current: str) -> Chart:
    found = time_spectrum(series)
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
    y: Spec = {"label": f"density [{current}²/Hz]", "scale": "log"}
    if found.noise > 0:
        y["domain"] = [found.noise / 30.0, float(max(found.density[1:].max(), found.noise)) * 2.0]
    aid = "Above the grey line: more than noise. A peak is a vibration or a ripple."
    return Chart(title, aid, _spec({"label": "frequency [Hz]"}, y, series_of, title))


def _positions(series: Sequence[MotorSeries], units: tuple[str, str]) -> Chart:
    found = position_spectrum(series)
    curve = {
        "kind": "line",
        "role": "error",
        "name": "error",
        "x": rounded(found.cycles),
        "y": rounded(found.amplitude),
    }
    title = "Spectrum over position"
    x = {"label": f"cycles per {units[1]}"}
    y = {"label": f"amplitude [{units[0]}]", "include": [0.0]}
    return Chart(
        title, "A peak repeats with position: cogging, gears, geometry.", _spec(x, y, [curve], title)
    )


def _autocorrelation(series: Sequence[MotorSeries]) -> Chart:
    found = autocorrelation(series)
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


def _histogram(series: Sequence[MotorSeries], current: str) -> Chart:
    errors = np.concatenate([one.error for one in series])
    count, edges = np.histogram(errors, bins=41)
    noise = _noise(series)
    found: list[Spec] = [
        {
            "kind": "histogram",
            "role": "error",
            "name": "error",
            "edges": rounded(edges),
            "y": count.tolist(),
        }
    ]
    if noise > 0:
        x = np.linspace(edges[0], edges[-1], 241)
        normal = np.exp(-0.5 * (x / noise) ** 2) / (noise * np.sqrt(2.0 * np.pi))
        rows = normal * len(errors) * float(edges[1] - edges[0])
        found.append(
            {
                "kind": "line",
                "role": "noise",
                "name": "noise alone",
                "x": rounded(x),
                "y": rounded(rows),
            }
        )
    title = "Histogram"
    y = {"label": "rows, logarithmic", "scale": "log", "domain": [0.7, 1.5 * float(count.max())]}
    aid = "All errors, the largest included. Wider than the grey curve: more than noise."
    return Chart(title, aid, _spec({"label": f"error [{current}]"}, y, found, title))


def _cut(name: str) -> str:
    return name if len(name) <= LONGEST_NAME else f"{name[: LONGEST_NAME - 1]}…"
