"""The section on laws that no catalogue has: in words, and as a curve through what was measured."""

from collections.abc import Sequence

import numpy as np

from bench.basics.joint_units import JointUnits, units_of_gain
from bench.diagnosis.law_words import WHAT, law_sentences, symbols
from bench.diagnosis.result import Diagnosis, Discovered, LooksAt
from bench.document.charts.chart import Axis, Binned, Chart, Line, Panel, Series
from bench.document.typeset import short, typeset
from bench.identification.result import CurrentSeries, Identification
from bench.page.chart_spec import spec_of
from bench.page.parts import (
    Cell,
    Choice,
    Figure,
    PageChart,
    PageColumn,
    PageRow,
    PageTable,
    Section,
    Text,
    Variant,
)
from bench.residuals.error_breakdown import Direction
from bench.residuals.profile import Profile, binned, profile

BINS = 24
HEIGHT = 260  # px
PANES = 3  # charts of a law
SERIES = {"position": "position", "velocity": "velocity", "acceleration": "acceleration"}
UNIT_OF = {"position": "{}", "velocity": "{}/s", "acceleration": "{}/s²"}


def laws_section(diagnosis: Diagnosis) -> Section:
    """Every law at every motor: its terms, and what it goes by."""
    laws = diagnosis.discovered
    variants = {f"{i}": Variant(_charts(law, diagnosis.after)) for i, law in enumerate(laws)}
    names = tuple(f"{law.place}, {law.law}" for law in laws)
    figure = Figure(
        "The law and what was measured",
        "Dots and shade: what the rest of the model leaves, mean and standard deviation in bins with "
        "equally many rows, forwards and backwards. Line: the law in the same bins.",
        False,
        (Choice("Law", names, 0),),
        variants,
        tuple(variants),
    )
    said = Text("", tuple(typeset(law_sentence) for law_sentence in law_sentences(laws)))
    lead = "Laws that are in no catalogue, found from what its effects leave."
    return Section("laws", "Laws that were found", lead, (said, figure, _terms(laws)))


def _terms(laws: Sequence[Discovered]) -> PageTable:
    rows = [
        _row(law.place, symbols(term.term), short(term.value), short(term.std, 2), symbols(term.unit))
        for law in laws
        for term in law.terms
    ]
    rows += [
        _row(law.place, name, short(value.value), short(value.std, 2), symbols(value.unit))
        for law in laws
        for name, value in law.numbers.items()
    ]
    columns = (
        PageColumn("at"),
        PageColumn("term or number"),
        PageColumn("value", "right"),
        PageColumn("standard error", "right"),
        PageColumn("unit"),
    )
    return PageTable("Terms", "The law is the sum of its terms.", columns, tuple(rows))


def _row(*texts: str) -> PageRow:
    return PageRow(tuple(Cell(text) for text in texts))


def _charts(law: Discovered, after: Identification) -> tuple[PageChart, ...]:
    joints = list(after.joints)
    units = units_of_gain(after.drive_gains[law.place].unit)
    looks = dict.fromkeys(
        LooksAt(look.what, look.motor, "size")
        for term in law.terms
        for look in term.looks_at
        if look.role != "direction"
    )
    usable = [look for look in looks if look.what in (*SERIES, "time", "load")]
    charts = [_chart(law, after, look, joints, units) for look in usable or [LooksAt("velocity", "", "size")]]
    return tuple(charts[:PANES])


def _chart(
    discovered_law: Discovered,
    after: Identification,
    look: LooksAt,
    joints: Sequence[str],
    units: JointUnits,
) -> PageChart:
    """The law and the rest, both in torque, over one variable."""
    j = joints.index(discovered_law.place)
    at = joints.index(look.motor) if look.motor else j
    gain = after.drive_gains[discovered_law.place].value
    x, law, residual, forwards = (
        np.concatenate(parts)
        for parts in zip(
            *(_rows(each, discovered_law.law, j, at, look.what, gain) for each in after.recordings),
            strict=True,
        )
    )
    series: list[Series] = []
    directions: tuple[tuple[Direction, np.ndarray], ...] = (("forwards", forwards), ("backwards", ~forwards))
    for role, way in directions:
        if way.any():
            rest = (law + residual)[way]
            bins = profile(x[way], rest, BINS)
            same = binned(x[way], law[way], bins.edges)
            series.append(_measured(role, bins, x[way], rest))
            series.append(Line(f"law, {role}", "modelled", bins.center, same.mean))
    of = f" of {look.motor}" if look.motor else ""
    unit = {"time": "s", "load": "of the modelled current"}.get(look.what) or UNIT_OF[look.what].format(
        units.position
    )
    title = f"Against the {WHAT[look.what]}{of}"
    panel = Panel(Axis(f"at {discovered_law.place}", units.spelled_effort), tuple(series))
    chart = Chart(title, Axis(f"{WHAT[look.what]}{of}", unit), (panel,), legend="none")
    return PageChart(title, "", spec_of(chart, HEIGHT))


def _measured(role: Direction, bins: Profile, x: np.ndarray, y: np.ndarray) -> Binned:
    low, high = bins.mean - bins.spread, bins.mean + bins.spread
    return Binned(role, role, x, y, bins.edges, bins.center, bins.mean, bins.spread, low, high, bins.count)


def _rows(
    series: CurrentSeries, law: str, j: int, at: int, what: str, gain: float
) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Where the motor moves: the variable, the law's torque, the torque that the whole model leaves, the direction."""
    rows = series.moving[:, j]
    if what == "time":
        x = series.time - series.time[0]
    elif what == "load":
        x = series.modelled[:, at]
    else:
        x = getattr(series, SERIES[what])[:, at]
    torque = series.by_effect[law][:, j]
    return x[rows], torque[rows], gain * series.error[rows, j], series.velocity[rows, j] > 0.0
