"""Which effects a model lacks, judged on recordings that were not fitted."""

from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import replace
from functools import cache
from typing import Any

import numpy as np

from bench.dataset import Dataset
from bench.diagnose.candidates import Context, Proposal, context_of, propose, shaped
from bench.diagnose.encoder_noise import encoder_error
from bench.diagnose.partner import beside, partners
from bench.diagnose.possible import SHOWS, impossible_effects, refused, superfluous_effect
from bench.diagnose.restart import restarted
from bench.diagnose.result import Diagnosis, EffectVerdict, LadderStep
from bench.diagnose.search import NEEDED, Found, search
from bench.diagnose.split import with_judged_parts
from bench.diagnose.system import System, build_system, solve_set
from bench.diagnose.unexplained import unexplained
from bench.diagnose.verdicts import checked_error, verdicts
from bench.effects import CATALOGUE, Effect, EffectInstance
from bench.estimate.identify import fit, gains_can_be_fitted
from bench.estimate.prepare import Prepared, prepare, with_effects
from bench.estimate.quick import solved_quickly
from bench.estimate.result import Identification, relative_error
from bench.estimate.settle import present_model, settled
from bench.estimate.summary import ROBOT
from bench.progress import SILENT, Progress
from bench.signals.settings import FilterSettings

ROUNDS = 6  # of searching, each about the model that the last one found

Fits = Callable[[frozenset[str]], Identification]


def diagnose(
    dataset: Dataset,
    effects: Sequence[str] = (),
    *,
    filters: FilterSettings | Mapping[str, Any] | None = None,
    catalogue: Mapping[str, Effect] = CATALOGUE,
    progress: Progress = SILENT,
) -> Diagnosis:
    """Compare the model that has these effects with the data, and find the effects that it lacks.

    Evidence is a likelihood ratio on recordings that were not fitted (or, where there are none, on the last
    part of each), with as many samples as are independent of each other. All sets of up to three effects
    compete; each must earn its place.
    """
    progress.phase("preparing the recordings")
    dataset, split = with_judged_parts(dataset)
    start = prepare(dataset, effects, filters, catalogue=catalogue)
    fit_gains = gains_can_be_fitted(start, None)
    progress.phase("fitting the model as it is")
    start = settled(start, fit_gains)
    before = fit(start, fit_gains=fit_gains)
    barred: dict[str, str] = {}
    while True:
        model, proposals, system, found = _searched(start, catalogue, fit_gains, barred, progress)
        progress.phase("fitting what was found")
        model, after = _where_it_shows(start, model, fit_gains)
        added = model.effects[len(start.effects) :]
        out = impossible_effects(after, added)
        if not out:
            names = list(dict.fromkeys(one.effect.name for one in added))
            fits = _fits(start, added, before, after, fit_gains)
            ladder = _ladder(names, fits)
            out = superfluous_effect(ladder)
        if not out:
            break
        barred |= out
    progress.phase("judging every effect")
    places: dict[str, tuple[str, ...]] = {}
    for one in added:
        at = (one.joint,) if one.joint else dataset.robot.joints
        places[one.effect.name] = (*places.get(one.effect.name, ()), *at)
    scale = _relative(after, system, found)
    without = _errors_without(names, fits)
    left = unexplained(after, dataset.recordings, lambda: encoder_error(model, fit_gains))
    ranking = verdicts(
        system, proposals, found, _shown_places(proposals, found, places), scale, left, without
    )
    ranking = tuple(refused(one, barred.get(one.effect)) for one in ranking)
    ranking = tuple(replace(one, size=_sizes(model, after, one.effect)) for one in ranking)
    missing = tuple(one.effect for one in _by_strength(ranking) if one.effect in places)
    return Diagnosis(
        robot=dataset.robot.name,
        split=split,
        missing=missing,
        ladder=ladder,
        ranking=ranking,
        unexplained=left,
        before=before,
        after=after,
    )


def _searched(
    start: Prepared,
    catalogue: Mapping[str, Effect],
    fit_gains: bool,
    barred: Collection[str],
    progress: Progress,
) -> tuple[Prepared, list[Proposal], System, Found]:
    """Search, linearise about what was found, and search again until the same is found.

    barred: effects that may not be found: of an impossible sign, or superfluous.
    """
    progress.phase("searching, round 1", len(catalogue))
    proposals = propose(context_of(start, fit_gains), catalogue, progress)
    system, found = _judged(start, start, proposals, fit_gains, barred)
    tried: list[frozenset[int]] = []
    for _ in range(ROUNDS):
        model, proposals, system, found = _again(start, proposals, system, found, fit_gains, barred, progress)
        tried.append(frozenset(found.best.fit.chosen))
        progress.phase("searching for partners")
        better = _with_partner(start, model, proposals, found, fit_gains, barred)
        if better is None or frozenset(better[2].best.fit.chosen) in tried:
            break
        proposals, system, found = better
    return model, proposals, system, found


def _again(
    start: Prepared,
    proposals: list[Proposal],
    system: System,
    found: Found,
    fit_gains: bool,
    barred: Collection[str],
    progress: Progress,
) -> tuple[Prepared, list[Proposal], System, Found]:
    """Linearise about what was found, and search again, until the same is found: the settled model with it."""
    seen: list[set[str]] = []
    for _ in range(ROUNDS - 1):
        chosen = [proposals[i] for i in found.best.fit.chosen]
        if not chosen or {one.name for one in chosen} in seen[:-1]:
            break
        seen.append({one.name for one in chosen})
        progress.phase(f"searching, round {len(seen) + 1}", len(proposals))
        model = _with(start, proposals, found.best.fit.chosen, fit_gains)
        proposals = _reshaped(start, model, proposals, system, found, fit_gains, progress)
        system, found = _judged(start, model, proposals, fit_gains, barred)
        if {proposals[i].name for i in found.best.fit.chosen} == {one.name for one in chosen}:
            break
    return _with(start, proposals, found.best.fit.chosen, fit_gains), proposals, system, found


def _with(start: Prepared, proposals: Sequence[Proposal], chosen: Sequence[int], fit_gains: bool) -> Prepared:
    """The starting model with some of the proposals, settled."""
    instances = [one for i in chosen for one in proposals[i].instances]
    return settled(with_effects(start, (*start.effects, *instances)), fit_gains)


def _with_partner(
    start: Prepared,
    model: Prepared,
    proposals: Sequence[Proposal],
    found: Found,
    fit_gains: bool,
    barred: Collection[str],
) -> tuple[list[Proposal], System, Found] | None:
    """What is found when an effect joins the model and all shapes are settled anew; None if nothing better is."""
    chosen = found.best.fit.chosen
    for i in partners(model, proposals, chosen, fit_gains):
        if proposals[i].name in barred:
            continue
        joined = _with(start, proposals, (*chosen, i), fit_gains)
        reshaped = beside(proposals, joined, len(start.effects))
        system, wider = _judged(start, joined, reshaped, fit_gains, barred)
        if wider.best.total > found.best.total + NEEDED:
            return reshaped, system, wider
    return None


def _judged(
    start: Prepared,
    model: Prepared,
    proposals: Sequence[Proposal],
    fit_gains: bool,
    barred: Collection[str],
) -> tuple[System, Found]:
    """The starting model's equations with every proposal's columns, linearised about `model`, and the best set."""
    _, solution = solved_quickly(model, fit_gains)
    about = with_effects(start, start.effects, present_model(model, solution))
    stack, own = solved_quickly(about, fit_gains)
    own = restarted(stack, replace(own, weights=solution.weights), start.dataset.robot.nominal_gains)
    system = build_system(about, [one.instances for one in proposals], own)
    usable = [i for i, one in enumerate(proposals) if not one.absorbed and one.name not in barred]
    return system, search(system, usable)


def _reshaped(
    start: Prepared,
    model: Prepared,
    proposals: Sequence[Proposal],
    system: System,
    found: Found,
    fit_gains: bool,
    progress: Progress,
) -> list[Proposal]:
    """Proposals in the shape that suits the found set: as found, or in the place of the effect that they rival.

    An effect that could stand for a found one is given the shape that it would have without that one; the
    others the shape that explains most of what the found set leaves.
    """
    own = len(start.effects)
    added = model.effects[own:]
    contexts: dict[int | None, Context] = {None: context_of(model, fit_gains)}
    result = []
    for i, proposal in enumerate(proposals):
        progress.advance()
        if i in found.best.fit.chosen:
            instances = tuple(one for one in added if one.effect.name == proposal.name)
            result.append(replace(proposal, instances=instances))
            continue
        effect = proposal.instances[0].effect
        if proposal.absorbed or not (effect.shape or effect.depends_on_model):
            result.append(proposal)
            continue
        rival = _rival(system, found, i)
        if rival not in contexts:
            name = proposals[rival].name if rival is not None else ""
            others = [one for one in added if one.effect.name != name]
            contexts[rival] = context_of(with_effects(model, (*start.effects, *others)), fit_gains)
        result.append(replace(proposal, instances=shaped(contexts[rival], proposal.instances)))
    return result


def _rival(system: System, found: Found, i: int) -> int | None:
    """The found effect in whose place effect i does best, where that is better than most of what it explains."""
    best = found.best.fit
    swaps = {k: solve_set(system, (*(c for c in best.chosen if c != k), i)).fitted for k in best.chosen}
    rival = min(swaps, key=lambda k: swaps[k])
    without = solve_set(system, tuple(c for c in best.chosen if c != rival)).fitted
    return rival if swaps[rival] < 0.5 * (without + best.fitted) else None


def _where_it_shows(start: Prepared, model: Prepared, fit_gains: bool) -> tuple[Prepared, Identification]:
    """The found effects without the joints at which they are nothing or have an impossible sign."""
    result = fit(model, fit_gains=fit_gains)
    own, added = model.effects[: len(start.effects)], model.effects[len(start.effects) :]
    kept = [one for one in added if _shows(result, one)]
    for one in added:
        if not any(other.effect.name == one.effect.name for other in kept):
            kept.append(one)
    if len(kept) == len(added):
        return model, result
    ordered = [one for one in added if one in kept]
    model = settled(with_effects(start, (*own, *ordered)), fit_gains)
    return model, fit(model, fit_gains=fit_gains)


def _shows(result: Identification, instance: EffectInstance) -> bool:
    values = result.effect_parameters[instance.effect.name][instance.joint or ROBOT]
    linear = [(values[parameter.name], parameter.positive) for parameter in instance.effect.parameters]
    if any(positive and value.value < -SHOWS * value.std for value, positive in linear):
        return False
    return any(abs(value.value) > SHOWS * value.std for value, _ in linear)


def _relative(after: Identification, system: System, found: Found) -> float:
    """Error of the settled model over that of its set in the system, so that the errors of sets end where it does."""
    judged = relative_error([one for one in after.recordings if one.use == "validate"]) or 0.0
    here = checked_error(system, found.best.fit)
    return judged / here if here > 0 else 0.0


def _shown_places(
    proposals: Sequence[Proposal], found: Found, places: Mapping[str, tuple[str, ...]]
) -> dict[str, tuple[str, ...]]:
    return {proposals[i].name: places.get(proposals[i].name, ()) for i in found.best.fit.chosen}


def _by_strength(ranking: Sequence[EffectVerdict]) -> list[EffectVerdict]:
    return sorted(ranking, key=lambda one: -one.evidence)


def _sizes(model: Prepared, result: Identification, effect: str) -> dict[str, float]:
    """RMS torque of an effect at each motor over the fitted recordings, N*m or N; nothing where it is not there."""
    at = 0
    joints = list(model.dataset.robot.joints)
    total = None
    for one in model.effects:
        size = len(one.effect.parameters)
        if one.effect.name == effect:
            found = result.effect_parameters[effect][one.joint or ROBOT]
            values = np.array([found[parameter.name].value for parameter in one.effect.parameters])
            torque = np.concatenate([seen.effects[:, :, at : at + size] @ values for seen in model.fitted])
            total = torque if total is None else total + torque
        at += size
    if total is None:
        return {}
    rms = np.sqrt((total**2).mean(axis=0))
    return {joint: float(value) for joint, value in zip(joints, rms, strict=True) if value > 0}


def _fits(
    start: Prepared,
    added: Sequence[EffectInstance],
    before: Identification,
    after: Identification,
    fit_gains: bool,
) -> Fits:
    """The starting model with some of the found effects, by name, each such set fitted once."""

    @cache
    def fitted(names: frozenset[str]) -> Identification:
        if not names:
            return before
        chosen = [one for one in added if one.effect.name in names]
        if len(chosen) == len(added):
            return after
        return fit(with_effects(start, (*start.effects, *chosen)), fit_gains=fit_gains)

    return fitted


def _errors_without(names: Sequence[str], fits: Fits) -> dict[str, float]:
    """Relative error on recordings that were not fitted, by effect, of the found model without it, fitted anew."""
    return {name: fits(frozenset(names) - {name}).error.validate or 0.0 for name in names}


def _ladder(names: Sequence[str], fits: Fits) -> tuple[LadderStep, ...]:
    """Errors after each added effect, the one that helps most first."""
    before = fits(frozenset())
    steps = [LadderStep((), before.error.identify, before.error.validate, before.recordings)]
    left = list(names)
    taken: list[str] = []
    while left:
        tried = [(fits(frozenset((*taken, name))), name) for name in left]
        result, name = min(tried, key=lambda pair: pair[0].error.validate or pair[0].error.identify or 0.0)
        taken.append(name)
        left.remove(name)
        error = result.error
        steps.append(LadderStep(tuple(taken), error.identify, error.validate, result.recordings))
    return tuple(steps)
