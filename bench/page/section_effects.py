"""Sections on effects and gains: the ranking with its reasons, and the drive gains before and after."""

from collections.abc import Mapping, Sequence
from dataclasses import replace

from bench.basics.plural import plural
from bench.diagnosis.reason_words import reason_sentence, validated_on
from bench.diagnosis.result import Diagnosis, EffectVerdict
from bench.diagnosis.summary import reason
from bench.document import table as document
from bench.document.charts.chart import Role
from bench.document.charts.models import gains_chart
from bench.document.diagnosis import (
    gains_before_after,
    ranking_table,
    sets_table,
    something_else_words,
    without_logs_table,
)
from bench.document.identification import effects_table, gains_table
from bench.document.typeset import effect_name, typeset
from bench.effects import Effect
from bench.identification.result import DriveGain, Identification
from bench.identification.scale_words import scale_sentence, why_nominal
from bench.page.chart_spec import chart_figure
from bench.page.parts import Items, PageColumn, PageTable, Part, Section, row
from bench.page.tables import on_page

UNSUPPORTED = ("not supported", "absorbed")
VERDICTS_AID = (
    "missing: supported beyond what the model has. indistinguishable: these data cannot tell it from the named "
    "alternatives. resembles: it fits, and leaves much that no effect explains, or does as well as a discovered law. "
    "Evidence: log-likelihood ratio on recordings that were not fitted, in nats; 10 is strong. Probability: "
    "that it is there, given that the catalogue holds what is there. Saves: share of the squared error that it removes."
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


def ranking_section(diagnosis: Diagnosis, catalogue: Mapping[str, Effect]) -> Section:
    """Every effect with its verdict, those that count in full, the others folded; and the laws of what was found."""
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
        parts.append(
            Items("Why", "", tuple(typeset(reason(diagnosis, verdict)) for verdict in shown)),
        )
    else:
        parts.append(Items("Effects that count", "", ("None: no effect of the catalogue is supported.",)))
    if rest:
        title = f"{plural(len(rest), 'effect')} that the data do not support"
        parts.append(
            on_page(
                _with_reasons(diagnosis, rest),
                title,
                "Adding one of them gains nothing that is sure.",
                folded=True,
            )
        )
    if absorbed:
        title = f"{plural(len(absorbed), 'effect')} that no data of this robot could show"
        rows = tuple(
            row(effect_name(verdict.effect), typeset(reason_sentence(verdict))) for verdict in absorbed
        )
        aid = "The model's own parameters take them up completely, so they do no harm to its currents."
        parts.append(
            PageTable(
                title, aid, (PageColumn("effect", "keep"), PageColumn("reason", "words")), rows, folded=True
            )
        )
    lead = f"Every effect of the catalogue, and every set of a few, was fitted and judged on {validated_on(diagnosis)}."
    return Section("ranking", "Which effects are missing", typeset(lead), tuple(parts), "Missing effects")


def _laws(diagnosis: Diagnosis, catalogue: Mapping[str, Effect]) -> list[Part]:
    """What the identified effects do, as far as their classes tell it."""
    known = [catalogue[name] for name in diagnosis.missing if name in catalogue]
    rows = tuple(row(effect_name(entry.name), entry.law, entry.symbols) for entry in known if entry.law)
    columns = (PageColumn("effect", "keep"), PageColumn("law", "words"), PageColumn("symbols", "words"))
    return [PageTable("Laws of what was found", LAWS_AID, columns, rows)] if rows else []


def _with_reasons(diagnosis: Diagnosis, chosen: Sequence[EffectVerdict]) -> document.Table:
    """The ranking of some effects with the sentence on each."""
    table = ranking_table(diagnosis, chosen)
    kept = [column for column in table.columns if column.header != "verdict"]
    reasons = document.Column("reason", [reason_sentence(verdict) for verdict in chosen], "sentence")
    return replace(table, columns=(*kept, reasons))


def not_ranked_section() -> Section:
    """Says that nothing was looked for."""
    said_so = (
        "This run fitted or applied a model; which effects it lacks was not looked for. bench diagnose does."
    )
    return Section(
        "ranking", "Which effects are missing", "", (Items("", "", (said_so,)),), "Missing effects"
    )


def gains_section(after: Identification, before: Identification | None) -> Section:
    """Drive gains with their 95 % intervals and the nominal values; before: without what is missing."""
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
