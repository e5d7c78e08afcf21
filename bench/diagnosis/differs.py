"""Offsets and frictions that differ from run to run: a value per recording, judged on parts of each."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import combinations

import numpy as np

from bench.diagnosis.block_cross_validation import block_cross_validation
from bench.diagnosis.result import Differing
from bench.effects import Effect, EffectInstance
from bench.effects.select import at_joint, with_value_each
from bench.identification.decision import RULE
from bench.identification.identify import fit
from bench.identification.nonlinear import converged
from bench.identification.prepare import Prepared, with_effects
from bench.identification.result import Identification, Quantity
from bench.identification.solve_only import candidate_columns, solved_quickly


@dataclass(frozen=True)
class _Candidate:
    """An effect at a motor: the columns of its common value and of its values in all recordings but one."""

    effect: Effect
    joint: str
    common: tuple[int, ...]
    by_log: tuple[int, ...]


def differing(
    model: Prepared, catalogue: Mapping[str, Effect]
) -> tuple[tuple[Differing, ...], Identification | None]:
    """Effects, in a converged model or not, whose value differs by fitted recording, strongest first; and the answer
    with these values, None if nothing differs.

    One value for all recordings competes with one for each. A recording that is not fitted has no such value, so every
    other part of each fitted one is held out.
    """
    logs = model.logs
    if len(logs) < 2:
        return (), None
    candidates, instances = _candidates(model, catalogue)
    if not candidates:
        return (), None
    validation = block_cross_validation(*solved_quickly(model), candidate_columns(model, instances))
    motors = list(model.dataset.robot.joints)
    chosen: list[tuple[_Candidate, float, float, float]] = []
    while len(chosen) < len(candidates):
        taken = [i for candidate, *_ in chosen for i in (*candidate.common, *candidate.by_log)]
        tried = []
        for candidate in candidates:
            if any(candidate is other for other, *_ in chosen):
                continue
            before = validation.held_out_squares([*taken, *candidate.common])
            after = validation.held_out_squares([*taken, *candidate.common, *candidate.by_log])
            evidence = validation.evidence(before, after)
            j = motors.index(candidate.joint)
            errors = np.sqrt(before[j] / validation.measured[j]), np.sqrt(after[j] / validation.measured[j])
            if evidence > RULE.prior and errors[1] < (1.0 - RULE.helps) * errors[0]:
                tried.append((candidate, evidence, float(errors[0]), float(errors[1])))
        if not tried:
            break
        chosen.append(max(tried, key=lambda pair: pair[1]))
    return _that_show(model, chosen) if chosen else ((), None)


def _candidates(
    model: Prepared, catalogue: Mapping[str, Effect]
) -> tuple[list[_Candidate], list[EffectInstance]]:
    """Candidates, and the instances of all their columns, one each."""
    present = {instance.seat: instance for instance in model.effects}
    logs = model.logs
    candidates: list[_Candidate] = []
    instances: list[EffectInstance] = []
    for name in (name for name, effect in catalogue.items() if effect.varies_by_run):
        for joint in model.dataset.robot.joints:
            there = present.get((name, joint))
            if there is not None and there.recording:
                continue
            added = [] if there is not None else [at_joint(catalogue[name], joint)]
            start = len(instances)
            instances += added + with_value_each(catalogue[name], joint, logs)[:-1]
            at = start + len(added)
            candidates.append(
                _Candidate(catalogue[name], joint, tuple(range(start, at)), tuple(range(at, len(instances))))
            )
    return candidates, instances


def _that_show(
    model: Prepared, chosen: Sequence[tuple[_Candidate, float, float, float]]
) -> tuple[tuple[Differing, ...], Identification | None]:
    """Those whose values, fitted together, differ clearly and are possible; and that fit."""
    places = {(candidate.effect.name, candidate.joint) for candidate, *_ in chosen}
    kept = [instance for instance in model.effects if instance.seat not in places]
    logs = model.logs
    added = [
        instance
        for candidate, *_ in chosen
        for instance in with_value_each(candidate.effect, candidate.joint, logs)
    ]
    wider = converged(with_effects(model, (*kept, *added)), nearly=True)
    result = fit(wider)
    first = wider.layout.size - len(added)
    differences = []
    for i, (candidate, evidence, before, after) in enumerate(chosen):
        rows = slice(first + i * len(logs), first + (i + 1) * len(logs))
        (parameter,) = candidate.effect.parameters
        estimates = result.effect_parameters[candidate.effect.name]
        values = {log: estimates[f"{candidate.joint}@{log}"][parameter.name] for log in logs}
        impossible = parameter.positive and any(x.value < -RULE.shows * x.std for x in values.values())
        if not impossible and _apart(list(values.values()), result.covariance[rows, rows]):
            differences.append(
                Differing(candidate.effect.name, candidate.joint, values, evidence, before, after)
            )
    return tuple(
        sorted(differences, key=lambda difference: -difference.evidence)
    ), result if differences else None


def _apart(values: Sequence[Quantity], covariance: np.ndarray) -> bool:
    """Whether two of the values (k,) differ by more than chance explains; covariance (k, k)."""
    return any(
        abs(values[a].value - values[b].value)
        > RULE.shows * np.sqrt(covariance[a, a] + covariance[b, b] - 2.0 * covariance[a, b])
        for a, b in combinations(range(len(values)), 2)
    )
