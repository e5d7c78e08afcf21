"""Sections on effects and gains: the ranking with its reasons, and the drive gains before and after."""

from collections.abc import Mapping

import numpy as np

from bench.chi_squared import WITHIN_95
from bench.diagnose.result import Diagnosis, EffectVerdict
from bench.diagnose.summary import effort_unit, error_share, reason
from bench.effects import Effect
from bench.estimate.result import DriveGain, Identification
from bench.report.parts import Cell, Column, Items, Part, Row, Section, Table, one_figure, row
from bench.report.thin import significant
from bench.report.words import (
    effect_name,
    said_list,
    share,
    short,
    typeset,
    with_std,
)
from bench.show.numbers import flat_effects, gain_change, pretty_unit

ROUNDING = 1e-6  # of an evidence in nats, of a share
FEW = 4  # alternatives named in a cell
UNSUPPORTED = ("not supported", "absorbed")
VERDICTS_AID = (
    "missing: supported beyond what the model has. indistinguishable: these data cannot tell it from the named "
    "alternatives. resembles: it fits, and leaves much that no effect explains. "
    "Evidence: log-likelihood ratio on recordings that were not fitted, in nats; 10 is strong."
)
LAWS_AID = (
    "τ: torque or force that the motors have to overcome beside the rigid bodies'; q, q̇, q̈: a joint's position, "
    "velocity and acceleration; sign: of a number, as +1 or −1."
)


def ranking_section(diagnosis: Diagnosis, catalogue: Mapping[str, Effect]) -> Section:
    """Every effect with its verdict, those that count in full, the others folded; and the laws of what was found."""
    shown = [one for one in diagnosis.ranking if one.verdict not in UNSUPPORTED]
    rest = [one for one in diagnosis.ranking if one.verdict == "not supported"]
    absorbed = [one for one in diagnosis.ranking if one.verdict == "absorbed"]
    parts: list[Part] = []
    if shown:
        parts.append(
            Table("Effects that count", VERDICTS_AID, _COLUMNS, tuple(_row(diagnosis, one) for one in shown))
        )
        parts += _laws(diagnosis, catalogue)
        parts.append(
            Items("Why", "", tuple(typeset(reason(diagnosis, one)) for one in shown)),
        )
    else:
        parts.append(Items("Effects that count", "", ("None: no effect of the catalogue is supported.",)))
    if rest:
        rows = tuple(
            row(
                effect_name(one.effect),
                share(one.error_before),
                share(one.error_after),
                short(_not_rounding(one.evidence)),
                typeset(one.why),
            )
            for one in rest
        )
        columns = (
            Column("effect", "keep"),
            Column("error without", "right"),
            Column("error with", "right"),
            Column("evidence", "right"),
            Column("reason", "words"),
        )
        title = f"{len(rest)} effects that the data do not support"
        parts.append(
            Table(title, "Adding one of them gains nothing that is sure.", columns, rows, folded=True)
        )
    if absorbed:
        title = f"{len(absorbed)} effects that no data of this robot could show"
        rows = tuple(row(effect_name(one.effect), typeset(one.why)) for one in absorbed)
        aid = "The model's own parameters take them up completely, so they do no harm to its currents."
        parts.append(
            Table(title, aid, (Column("effect", "keep"), Column("reason", "words")), rows, folded=True)
        )
    lead = (
        f"Every effect of the catalogue, and every set of a few, was fitted and judged on {diagnosis.split}."
    )
    return Section("ranking", "Which effects are missing", typeset(lead), tuple(parts), "Missing effects")


def _laws(diagnosis: Diagnosis, catalogue: Mapping[str, Effect]) -> list[Part]:
    """What the found effects do, as far as their classes tell it."""
    known = [catalogue[name] for name in diagnosis.missing if name in catalogue]
    rows = tuple(row(effect_name(one.name), one.law, one.symbols) for one in known if one.law)
    columns = (Column("effect", "keep"), Column("law", "words"), Column("symbols", "words"))
    return [Table("Laws of what was found", LAWS_AID, columns, rows)] if rows else []


def not_ranked_section() -> Section:
    """Says that nothing was looked for."""
    said_so = (
        "This run fitted or applied a model; which effects it lacks was not looked for. bench diagnose does."
    )
    return Section(
        "ranking", "Which effects are missing", "", (Items("", "", (said_so,)),), "Missing effects"
    )


_COLUMNS = (
    Column("effect", "keep"),
    Column("verdict"),
    Column("at"),
    Column("error without", "right"),
    Column("error with", "right"),
    Column("evidence", "right"),
    Column("RMS size, largest"),
    Column("of squared error", "right"),
    Column("alternatives"),
)


def _row(diagnosis: Diagnosis, one: EffectVerdict) -> Row:
    size = ""
    if one.size:
        joint = max(one.size, key=lambda name: one.size[name])
        size = f"{short(one.size[joint], 3)} {effort_unit(diagnosis.after, joint)}"
        size += f" at {joint}" if len(one.size) > 1 else ""
    return row(
        effect_name(one.effect),
        Cell(one.verdict, f"badge {one.verdict}"),
        _places(diagnosis, one),
        share(one.error_before),
        share(one.error_after),
        short(_not_rounding(one.evidence)),
        size or "–",
        _most(error_share(one)),
        _few([effect_name(name) for name in one.alternatives]),
        kind="strong" if one.effect in diagnosis.missing else "",
    )


def _places(diagnosis: Diagnosis, one: EffectVerdict) -> str:
    """Where an effect shows, in few words: the sentence beside has them all."""
    motors = list(diagnosis.after.drive_gains)
    if list(one.actuators) == motors and len(motors) > 1:
        return "all motors"
    return f"{len(one.actuators)} joints" if len(one.actuators) > 3 else said_list(one.actuators)


def _few(names: list[str]) -> str:
    """The first of many names: the sentence beside has them all."""
    return (
        said_list(names)
        if len(names) <= FEW
        else f"{said_list(names[: FEW - 1])} and {len(names) - FEW + 1} more"
    )


def _most(part: float | None) -> str:
    """A share near one to the digits that tell it from one."""
    if part is None:
        return "–"
    return "> 99.9\u00a0%" if part > 0.999 else f"{typeset(f'{100.0 * _not_rounding(part):.3g}')}\u00a0%"


def _not_rounding(value: float) -> float:
    """Zero for what is left of a difference of equal numbers."""
    return value if abs(value) > ROUNDING else 0.0


def gains_section(after: Identification, before: Identification | None) -> Section:
    """Drive gains with their 95 % intervals beside the nominal values; before: without what is missing."""
    if not after.gains_fitted:
        lead = (
            "No fitted recording carries a payload of known mass, which alone gives the gains their scale: they stay "
            "at their nominal values, and every parameter is wrong by the same share as the gain that scales it."
        )
        rows = tuple(
            row(joint, short(gain.nominal, 6), pretty_unit(gain.unit))
            for joint, gain in after.drive_gains.items()
        )
        columns = (Column("motor"), Column("nominal", "right"), Column("unit", "keep"))
        table = Table("Nominal gains", "As the maker's sheet gives them; not identified.", columns, rows)
        return Section("gains", "Drive gains", lead, (table,))
    models: list[tuple[str, str, Identification]] = [("after", "completed model", after)]
    if before is None:
        models = [("after", "identified", after)]
    else:
        models.insert(0, ("before", "model as it is", before))
    lead = "What a motor really gives for its current, fitted together with the dynamic parameters."
    if before is not None:
        lead += " A model that lacks an effect bends the gains to make up for it."
    return Section("gains", "Drive gains", lead, (_gains_figure(models), _gains_table(after, before)))


def _gains_figure(models: list[tuple[str, str, Identification]]) -> Part:
    joints = list(models[-1][2].drive_gains)
    series = []
    for i, (role, name, model) in enumerate(models):
        gains = list(model.drive_gains.values())
        value = np.array([gain_change(gain) for gain in gains])
        half = WITHIN_95 * np.array([gain.std / abs(gain.nominal) for gain in gains])
        series.append(
            {
                "kind": "intervals",
                "role": role,
                "name": name,
                "y": list(range(len(joints))),
                "x": significant(value),
                "low": significant(value - half),
                "high": significant(value + half),
                "shift": 0.0 if len(models) == 1 else 0.3 * (i - 0.5),
            }
        )
    rule = {"kind": "rule", "role": "noise", "name": "nominal value", "axis": "x", "at": 0.0}
    spec = {
        "label": "Drive gains against their nominal values",
        "height": 76 + (38 if len(models) > 1 else 28) * len(joints),
        "x": {"label": "difference to the nominal gain [%]", "percent": True, "room": True},
        "panels": [{"y": {"scale": "band", "categories": joints}, "series": [rule, *series]}],
    }
    aid = "Whiskers: 95 % intervals, where they are wider than a dot. A maker's sheet is often wrong by a tenth."
    return one_figure("Drive gains against their nominal values", aid, spec)


def _gains_table(after: Identification, before: Identification | None) -> Table:
    columns = [Column("motor"), Column("unit", "keep"), Column("nominal", "right")]
    if before is not None:
        columns += [Column("model as it is", "right"), Column("completed model", "right")]
        columns += [Column("moves by", "right")]
    else:
        columns += [Column("identified", "right")]
    columns += [Column("std", "right"), Column("from nominal", "right")]
    rows = []
    for joint, gain in after.drive_gains.items():
        cells = [joint, pretty_unit(gain.unit), short(gain.nominal, 6)]
        if before is not None:
            old: DriveGain = before.drive_gains[joint]
            cells += [
                with_std(old),
                with_std(gain),
                share(gain.value / old.value - 1.0, signed=True),
            ]
        else:
            cells += [with_std(gain)]
        rows.append(row(*cells, share(gain.relative_std), share(gain_change(gain), signed=True)))
    aid = "After ± and under std, in percent of the value: the standard deviation. 95 % intervals are twice as wide."
    return Table("The same in numbers", aid, tuple(columns), tuple(rows))


def effects_table(result: Identification) -> Table:
    """Parameters of the effects that a model has."""
    rows = []
    last = ""
    for effect, joint, name, one in flat_effects(result):
        first = effect_name(effect) if effect != last else ""
        rows.append(
            row(first, joint, name, with_std(one), pretty_unit(one.unit), share_of(one.std, one.value))
        )
        last = effect
    columns = (
        Column("effect", "keep"),
        Column("at"),
        Column("parameter"),
        Column("value ± std", "right"),
        Column("unit", "keep"),
        Column("std of value", "right"),
    )
    return Table(
        "Parameters of the effects", "The laws stand in bench/effects/README.md.", columns, tuple(rows)
    )


def share_of(std: float, value: float) -> Cell:
    """The deviation in percent of the value, marked where the value says little; a dash where it was given."""
    if std == 0.0 or value == 0.0:
        return Cell("–")
    part = std / abs(value)
    return Cell(share(part) if np.isfinite(part) else "not determined", "poor" if part > 0.3 else "")
