"""Sections on effects and gains: the ranking with its reasons, discovered laws, drive gains before and after."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from bench.basics.joint_units import JointUnits, units_of_gain
from bench.basics.plural import plural
from bench.diagnosis.law_words import WHAT, law_sentences, symbols
from bench.diagnosis.reason_words import reason_sentence, validated_on
from bench.diagnosis.result import Diagnosis, Discovered, EffectVerdict, LooksAt
from bench.diagnosis.summary import reason
from bench.document import table as document
from bench.document.charts.chart import Axis, Binned, Chart, Line, Panel, Role, Series
from bench.document.charts.currents import gains_chart
from bench.document.diagnosis import (
    INDISTINGUISHABLE,
    gains_before_after,
    ranking_table,
    sets_table,
    something_else_words,
    without_logs_table,
)
from bench.document.identification import effects_table, gains_table
from bench.document.typeset import effect_name, short, typeset
from bench.effects import Effect
from bench.identification.result import CurrentSeries, DriveGain, Identification
from bench.identification.scale_words import scale_sentence, why_nominal
from bench.page.chart_spec import chart_figure, spec_of
from bench.page.parts import (
    Choice,
    Figure,
    Items,
    Kind,
    PageChart,
    PageTable,
    Part,
    Section,
    Text,
    Variant,
    on_page,
    page_table,
    sentences_section,
)
from bench.residuals.error_breakdown import Direction
from bench.residuals.profile import Profile, binned, profile

UNSUPPORTED = ("not supported", "absorbed")
VERDICTS_AID = (
    f"missing: supported beyond what the model has. {INDISTINGUISHABLE}. resembles: it fits, and leaves much that no "
    "effect explains, or does as well as a discovered law. Evidence: log-likelihood ratio on recordings that were not "
    "fitted, in nats; 10 is strong. Probability: that it is there, given that the catalogue holds what is there. "
    "Saves: share of the squared error that it removes."
)
SIZES_AID = (
    "In the completed model, after ± the standard error. What the letters mean stands under the laws below."
)
SETS_AID = (
    "Probability: that these effects are there together, given that the catalogue holds what is there. These "
    "recordings cannot tell sets of like probability apart."
)
LOGS_AID = (
    "Which effects the other logs do not support, and what the drive gains are by them alone. An effect that hangs on "
    "one log may be an event of that log."
)
LAWS_AID = (
    "τ: torque or force that the motors have to overcome beside the rigid bodies'; q, q̇, q̈: a joint's position, "
    "velocity and acceleration; sign: of a number, as +1 or −1."
)
BINS = 24
HEIGHT = 260  # px
PANES = 3  # charts of a law, at most
UNIT_OF = {"position": "{}", "velocity": "{}/s", "acceleration": "{}/s²"}


def ranking_section(diagnosis: Diagnosis, catalogue: Mapping[str, Effect]) -> Section:
    """Every effect with its verdict, supported ones in full, the others folded; and the laws of identified effects."""
    shown = [verdict for verdict in diagnosis.ranking if verdict.verdict not in UNSUPPORTED]
    rest = [verdict for verdict in diagnosis.ranking if verdict.verdict == "not supported"]
    absorbed = [verdict for verdict in diagnosis.ranking if verdict.verdict == "absorbed"]
    parts: list[Part] = []
    if shown:
        parts.append(on_page(ranking_table(diagnosis, shown), "Effects that count", VERDICTS_AID))
        if len(diagnosis.sets) > 1:
            words = something_else_words(diagnosis)
            aid = f"{SETS_AID} {words[0].upper()}{words[1:]}."
            parts.append(on_page(sets_table(diagnosis), "Sets of effects", aid))
        if diagnosis.without_logs:
            parts.append(on_page(without_logs_table(diagnosis), "With each log omitted", LOGS_AID))
        if diagnosis.after.effect_parameters:
            parts.append(on_page(effects_table(diagnosis.after), "How large they are", SIZES_AID))
        parts += _laws(diagnosis, catalogue)
        parts.append(Items("Why", "", tuple(typeset(reason(diagnosis, verdict)) for verdict in shown)))
    else:
        parts.append(Items("Effects that count", "", ("None: no effect of the catalogue is supported.",)))
    if rest:
        title = f"{plural(len(rest), 'effect')} that the data do not support"
        aid = "Adding one of them gains nothing that is sure."
        parts.append(on_page(_with_reasons(diagnosis, rest), title, aid, folded=True))
    if absorbed:
        title = f"{plural(len(absorbed), 'effect')} that no data of this robot could show"
        rows = [(effect_name(verdict.effect), typeset(reason_sentence(verdict))) for verdict in absorbed]
        aid = "The model's own parameters take them up completely, so they do no harm to its currents."
        parts.append(page_table(title, aid, {"effect": "keep", "reason": "words"}, rows, folded=True))
    lead = f"Every effect of the catalogue, and every set of a few, was fitted and judged on {validated_on(diagnosis)}."
    return Section("ranking", "Which effects are missing", typeset(lead), tuple(parts), "Missing effects")


def _laws(diagnosis: Diagnosis, catalogue: Mapping[str, Effect]) -> list[Part]:
    """The laws of the identified effects, if their classes state them."""
    known = [catalogue[name] for name in diagnosis.missing if name in catalogue]
    rows = [(effect_name(entry.name), entry.law, entry.symbols) for entry in known if entry.law]
    heads: Mapping[str, Kind] = {"effect": "keep", "law": "words", "symbols": "words"}
    return [page_table("Laws of what was found", LAWS_AID, heads, rows)] if rows else []


def _with_reasons(diagnosis: Diagnosis, chosen: Sequence[EffectVerdict]) -> document.Table:
    """The ranking of these effects, with the reason for each verdict."""
    table = ranking_table(diagnosis, chosen)
    kept = [column for column in table.columns if column.header != "verdict"]
    reasons = document.Column("reason", [reason_sentence(verdict) for verdict in chosen], "sentence")
    return replace(table, columns=(*kept, reasons))


def not_ranked_section() -> Section:
    """The section of a run that did not search for missing effects."""
    words = (
        "This run fitted or applied a model; which effects it lacks was not looked for. bench diagnose does."
    )
    return sentences_section("ranking", "Which effects are missing", [words], short="Missing effects")


def gains_section(after: Identification, before: Identification | None) -> Section:
    """Drive gains with their 95 % intervals and nominal values. before: the model without the missing effects."""
    why = why_nominal(after)
    if why is not None and not after.gains_fitted:
        lead = scale_sentence(why)
        aid = "As the maker's sheet gives them; not identified."
        return Section("gains", "Drive gains", lead, (on_page(gains_table(after), "Nominal gains", aid),))
    gains = after.drive_gains
    models: list[tuple[Role, str, Mapping[str, DriveGain]]] = [("after", "identified", gains)]
    if before is not None:
        models = [("before", "model as it is", before.drive_gains), ("after", "completed model", gains)]
    lead = "What a motor really gives for its current, fitted together with the dynamic parameters."
    if before is not None:
        lead += " A model that lacks an effect bends the gains to make up for it."
    if why is not None:
        lead += f" {scale_sentence(why)}"
    aid = "After ±: the standard error, under rel. std in percent. 95 % intervals are twice as wide."
    values = gains_table(after) if before is None else gains_before_after(before, after)
    table = on_page(values, "The same in numbers", aid)
    figure = chart_figure(gains_chart(models), 76 + (38 if len(models) > 1 else 28) * len(gains))
    return Section("gains", "Drive gains", lead, (figure, table))


def laws_section(diagnosis: Diagnosis) -> Section:
    """Every discovered law at every motor: its terms, and charts against the variables on which it depends."""
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
    values: list[tuple[str, str, Any]] = []
    values += [(law.place, symbols(term.term), term) for law in laws for term in law.terms]
    values += [(law.place, name, value) for law in laws for name, value in law.numbers.items()]
    rows = [
        (place, name, short(value.value), short(value.std, 2), symbols(value.unit))
        for place, name, value in values
    ]
    heads: Mapping[str, Kind] = {"at": "", "term or number": "", "value": "right", "standard error": "right"}
    return page_table("Terms", "The law is the sum of its terms.", {**heads, "unit": ""}, rows)


def _charts(law: Discovered, after: Identification) -> tuple[PageChart, ...]:
    joints = list(after.joints)
    units = units_of_gain(after.drive_gains[law.place].unit)
    looks = dict.fromkeys(
        LooksAt(look.what, look.motor, "size")
        for term in law.terms
        for look in term.looks_at
        if look.role != "direction"
    )
    usable = [look for look in looks if look.what in (*UNIT_OF, "time", "load")]
    charts = [_chart(law, after, look, joints, units) for look in usable or [LooksAt("velocity", "", "size")]]
    return tuple(charts[:PANES])


def _chart(
    discovered_law: Discovered, after: Identification, look: LooksAt, joints: Sequence[str], units: JointUnits
) -> PageChart:
    """The law and the measured torque that it explains, against one variable."""
    j = joints.index(discovered_law.place)
    at = joints.index(look.motor) if look.motor else j
    gain = after.drive_gains[discovered_law.place].value
    of_each = [_rows(each, discovered_law.law, j, at, look.what, gain) for each in after.recordings]
    x, law, residual, forwards = map(np.concatenate, zip(*of_each, strict=True))
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
    """In rows in which motor j moves: the variable, the law's torque, the model's residual torque, forwards or not."""
    rows = series.moving[:, j]
    if what == "time":
        x = series.time - series.time[0]
    elif what == "load":
        x = series.modelled[:, at]
    else:
        x = getattr(series, what)[:, at]
    torque = series.by_effect[law][:, j]
    return x[rows], torque[rows], gain * series.error[rows, j], series.velocity[rows, j] > 0.0
