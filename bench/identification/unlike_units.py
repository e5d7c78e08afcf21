"""Recordings whose currents are in thousandths of the others' unit: a log in mA among logs in A."""

import numpy as np

from bench.basics.joint_units import drive_unit
from bench.identification.finding import Code, Finding
from bench.identification.result import CurrentSeries, Identification
from bench.identification.tolerances import TOLERANCES


def unlike_units(result: Identification) -> list[Finding]:
    """The recordings whose currents are about a thousand times those of the others at every motor; [] where none are.

    names: a recording with the small currents, then those with the large ones. What is compared is the RMS of every
    motor's measured current, fitted or not.
    """
    sizes = {series.name: _sizes(series) for series in result.recordings}
    known = {name: size for name, size in sizes.items() if np.isfinite(size).all()}
    order = sorted(known, key=lambda name: float(known[name].mean()))
    if len(order) < 2:
        return []
    steps = np.diff([known[name].mean() for name in order])
    at = int(np.argmax(steps)) + 1
    low, high = (np.mean([known[name] for name in part], axis=0) for part in (order[:at], order[at:]))
    if np.abs(high - low - TOLERANCES.findings.thousand).max() > TOLERANCES.findings.near_decades:
        return []
    times = float(10.0 ** (high - low).mean())
    unit = drive_unit(next(iter(result.drive_gains.values())).unit)
    return [
        Finding(Code.UNITS_UNLIKE, (order[at - 1], *sorted(order[at:])), numbers={"times": times}, unit=unit)
    ]


def _sizes(series: CurrentSeries) -> np.ndarray:
    """Decades (n,) of the RMS of every motor's current; infinite where one has none."""
    rms = np.sqrt((series.measured**2).mean(axis=0))
    return np.log10(rms, out=np.full(len(rms), -np.inf), where=rms > 0.0)
