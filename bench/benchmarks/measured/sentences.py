"""The results on a machine in one sentence for engineers."""

from collections.abc import Iterator, Mapping, Sequence
from statistics import median

from bench.basics.sentence import and_list, in_percent
from bench.benchmarks.measured.known import DRIVE_GAIN, AgainstKnown, KnownValue, MachineTable
from bench.benchmarks.measured.run import MachineRun, NamedEffects, Record
from bench.document.numbers import pretty_unit, value_and_std
from bench.effects import CATALOGUE
from bench.effects.display_names import begun, spoken
from bench.identification.tolerances import TOLERANCES

COULOMB = "coulomb_friction"
MOST_OTHERS = 3  # clauses on what else acts
FRICTION: Mapping[str, str] = {
    "asymmetric_viscous_friction": "differs with the direction",
    "load_dependent_friction": "grows with the load",
    "position_dependent_friction": "varies with the position",
    "presliding_hysteresis": "acts like a spring before it slides",
    "quadratic_drag": "grows with the square of the speed",
    "shear_thinning_friction": "levels off at high speed",
    "stribeck_friction": "is larger at low speed",
    "thermal_friction_drift": "falls as the joints warm up",
    "viscous_friction": "grows with the speed",
}
"""Clauses on friction, by effect."""
OTHERS: Mapping[str, str] = {
    "backlash": "there is play in the drives",
    "base_tilt": "the base is tilted",
    "cogging_torque": "a torque varies with the position of the motors",
    "constant_offset": "a constant torque acts",
    "current_delay": "the current acts late",
    "current_loop_lag": "the torque follows the current with a lag",
    "drive_flexibility": "the drives are elastic",
    "gain_saturation": "the drives saturate",
    "hysteretic_cable": "cables pull with a memory",
    "joint_spring": "springs act in the joints",
    "passive_coulomb_friction": "joints without a motor have Coulomb friction",
    "passive_spring": "springs act in joints without a motor",
    "passive_viscous_friction": "joints without a motor have viscous friction",
    "torque_ripple": "the torque ripples with the position of the motors",
}
"""Clauses on other effects, by effect."""


def short_name(machine: MachineTable) -> str:
    """A machine's name without the description after the colon."""
    return machine.machine.split(":")[0]


def machine_sentence(record: Record, machine: MachineTable) -> str:
    """How close the estimates are to known values, what friction does, how well Coulomb friction is known, and the
    remaining error.
    """
    runs = [run for run in record.runs if not run.failed]
    if not runs:
        return "No command gives an answer."
    diagnosed = next((run for run in runs if run.diagnosis), None)
    parts = _near(runs, machine)
    if diagnosed is not None:
        parts += [*_friction(diagnosed), *_coulomb(diagnosed)]
    said = "; ".join([*parts, _remaining(runs[0] if diagnosed is None else diagnosed)])
    return f"{said[:1].upper()}{said[1:]}."


def absent_values(record: Record) -> list[str]:
    """Sentences with the numbers of effects that the first diagnosis has instead of known friction."""
    run = next((run for run in record.runs if run.diagnosis and not run.failed), None)
    if run is None:
        return []
    absent = [row for row in run.rows if row.value is None and row.known is not None]
    return [_in_place_of(row, found) for row in absent for found in run.found if _contains(found, row)]


def _contains(found: NamedEffects, row: AgainstKnown) -> bool:
    """Whether an effect has the known one as a special case, and values at the same place."""
    effect = CATALOGUE.get(found.effect)
    there = any(parameter.place == row.place for parameter in found.parameters)
    return effect is not None and row.quantity.partition(" ")[0] in effect.contains and there


def _in_place_of(row: AgainstKnown, found: NamedEffects) -> str:
    effect, _, parameter = row.quantity.partition(" ")
    values = [each for each in found.parameters if each.place == row.place and each.value is not None]
    numbers = [
        f"{each.name} = {' ± '.join(value_and_std(each.value or 0.0, each.std or 0.0))}" for each in values
    ]
    unit = pretty_unit(values[0].unit) if values else ""
    return (
        f"{begun(found.effect)} at {row.place}: {and_list(numbers)} {unit}; known as {spoken(effect)}: {parameter} = "
        f"{row.known:g}."
    )


def _near(runs: Sequence[MachineRun], machine: MachineTable) -> list[str]:
    """Clauses on the differences from known values: one for all quantities that are close enough, and one for each
    other quantity.
    """
    near, others = [], []
    for known in machine.known:
        rows, called = _estimates(runs, known), known.called or spoken(known.of)
        bad = [row for row in rows if row.reached is False or row.inside is False]
        good = [row for row in rows if row not in bad]
        if good and not bad:
            near.append((called, _largest(good)))
        elif bad:
            within = (
                f" within {_rounded(_largest(good))} of what is known at {_places(good)}," if good else ""
            )
            others.append(f"{called}{within} {_away(bad)} at {_places(bad)}")
    names = and_list([name for name, _ in near])
    return (
        [f"{names} within {_rounded(max(off for _, off in near))} of what is known"] if near else []
    ) + others


def _estimates(runs: Sequence[MachineRun], known: KnownValue) -> list[AgainstKnown]:
    """Estimates of a known quantity from the first command that gives all its values; empty if none does.

    For gains, diagnoses come first, since their models are complete; for other quantities the identification, whose
    friction model has the known form.
    """
    quantity = f"{known.of} {known.parameter}".strip()
    for run in sorted(runs, key=lambda run: run.diagnosis != (known.of == DRIVE_GAIN)):
        rows = [row for row in run.rows if row.quantity == quantity and row.place in known.values]
        able = [row for row in rows if row.off is not None and not row.fixed]
        if len(able) == len(known.values):
            return able
    return []


def _largest(rows: Sequence[AgainstKnown]) -> float:
    return max(abs(row.off or 0.0) for row in rows)


def _places(rows: Sequence[AgainstKnown]) -> str:
    return and_list([row.place for row in rows])


def _away(rows: Sequence[AgainstKnown]) -> str:
    """The differences as text, for example "19 to 30 % below"."""
    offs = [row.off or 0.0 for row in rows]
    least, most = (_rounded(edge(map(abs, offs))) for edge in (min, max))
    size = most if least == most else f"{least.removesuffix(' %')} to {most}"
    return f"{size} {'below' if max(offs) < 0.0 else 'above' if min(offs) > 0.0 else 'off'}"


def _rounded(share: float) -> str:
    """A share in percent, with two digits from 10 % on, otherwise one."""
    return in_percent(share, 2 if share >= 0.1 else 1)


def _friction(run: MachineRun) -> Iterator[str]:
    """Clauses on friction and on other effects, certain ones first; of many clauses only the first are given."""
    for sure in (True, False):
        names = [found.effect for found in run.found if (found.verdict == "missing") == sure]
        friction = [FRICTION[name] for name in names if name in FRICTION]
        clauses = [f"friction {and_list(friction)}"] if friction else []
        clauses += [
            OTHERS.get(name, f"there is {spoken(name)}") for name in names if name not in (*FRICTION, COULOMB)
        ]
        if len(clauses) > MOST_OTHERS:
            clauses = [
                *clauses[: MOST_OTHERS - 1],
                f"{len(clauses) - MOST_OTHERS + 1} more effects resemble what acts",
            ]
        if clauses:
            yield and_list(clauses) if sure else f"it seems that {and_list(clauses)}"


def _coulomb(run: MachineRun) -> Iterator[str]:
    """A clause on the median relative standard error of Coulomb friction over the motors."""
    for found in run.found:
        spread = [p.std / abs(p.value) for p in found.parameters if p.name == "Fc" and p.value and p.std]
        if found.effect == COULOMB and spread:
            known_to = median(spread)
            yield f"Coulomb friction is {f'known to {_rounded(known_to)}' if known_to < 1.0 else 'not determined'}"


def _remaining(run: MachineRun) -> str:
    """A clause on the remaining error of the current."""
    judged = run.error_validate is not None
    error = run.error_validate if judged else run.error_identify
    part = run.judged.removesuffix(", not fitted") if "last" in run.judged else "motions that were not fitted"
    none = (
        ", and no model of this program explains it" if (error or 0.0) > TOLERANCES.findings.explained else ""
    )
    return (
        f"{in_percent(error, 2)} of the current remains in {part if judged else 'the fitted motions'}{none}"
    )
