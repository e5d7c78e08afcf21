"""Rounds of a search, about the model of the last selection, until it repeats."""

from collections.abc import Collection, Mapping, Sequence
from dataclasses import replace

import numpy as np

from bench.basics.deadline import TimeUpError
from bench.basics.progress import SILENT, Progress
from bench.diagnosis.base_model import BaseModel, added_names, restarted
from bench.diagnosis.candidates import Proposal, partners, propose
from bench.diagnosis.error_floor import judged_by_its_error
from bench.diagnosis.fewer_places import at_its_places, best_places, most_gained
from bench.diagnosis.noise import leaves_only_noise
from bench.diagnosis.normal_equations import build_system
from bench.diagnosis.round import Round, in_their_shape, reshaped_proposals, usable
from bench.diagnosis.search import best_set, neighbours, score_set, search
from bench.diagnosis.system import System
from bench.effects import Effect, EffectInstance
from bench.identification.decision import RULE
from bench.identification.nonlinear import settles
from bench.identification.prepare import Prepared, with_effects
from bench.identification.solution import Solution
from bench.identification.solve_only import solved_quickly
from bench.identification.tolerances import TOLERANCES


def first_round(base_model: BaseModel, catalogue: Mapping[str, Effect], progress: Progress = SILENT) -> Round:
    """Every effect in its best shape for the starting model; after the deadline `straight_round`."""
    progress.phase("searching, round 1", len(catalogue))
    try:
        proposals = propose(base_model.context(base_model.start), catalogue, progress, base_model.deadline)
        return round_about(base_model, base_model.start, proposals, ())
    except TimeUpError:
        return straight_round(base_model.at_leisure, catalogue)


def straight_round(base_model: BaseModel, catalogue: Mapping[str, Effect]) -> Round:
    """The best set of effects without searched parameters in their columns: it converges at once."""
    straight = {
        name: effect for name, effect in catalogue.items() if not settles([EffectInstance(effect, "", name)])
    }
    this_round = round_about(
        base_model, base_model.start, propose(base_model.context(base_model.start), straight), ()
    )
    return replace(_converged(base_model, this_round), cut=True)


def searched(
    base_model: BaseModel, first: Round, barred: Collection[str], progress: Progress = SILENT
) -> Round:
    """Search, linearise about the best model, and search again until the selection repeats; then while an additional
    effect leads to a set that, converged, is clearly better.

    barred: effects that may not be selected: of an impossible sign, or superfluous. The first round's set without them
    is the one to surpass. After the deadline the best set so far is the answer.
    """
    if first.cut:
        return first
    before = None
    if barred:
        whole, first = first, replace(first, selection=search(first.system, usable(first.proposals, barred)))
        stayed = tuple(i for i in whole.chosen if whole.proposals[i].name not in barred)
        if stayed and stayed != first.chosen:
            before = _converged(base_model.at_leisure, with_set(whole, stayed))
        del whole
    given = [first]
    del first  # passed on without a name, to free its system before the next is built
    this_round = _again(base_model, given.pop(), barred, progress, before)
    if this_round is before:  # its system is about the model with the barred effects
        try:
            about = _about_itself(base_model, this_round, barred)
        except TimeUpError:
            return replace(this_round, cut=True)
        before = with_set(about, this_round.chosen)
        this_round = _again(base_model, about, barred, progress, before)
    tried = {frozenset(this_round.chosen)}
    for _ in range(TOLERANCES.search.rounds - 1):
        before = this_round
        for seek in (_with_partner, _with_rival):
            if this_round.cut:
                return this_round
            progress.phase("searching for partners and rivals")
            try:
                better = seek(base_model, this_round, barred)
            except TimeUpError:
                return replace(this_round, cut=True)
            if better is not None and frozenset(better.chosen) not in tried:
                this_round = _again(base_model, better, barred, progress, this_round)
                tried |= {frozenset(better.chosen), frozenset(this_round.chosen)}
        if this_round is before:
            break
    return this_round


def staying(base_model: BaseModel, this_round: Round, barred: Collection[str]) -> Round:
    """A round's set without barred effects, converged, without another search."""
    stayed = [i for i in this_round.chosen if this_round.proposals[i].name not in barred]
    return replace(
        with_set(this_round, stayed), model=base_model.with_proposals(this_round.proposals, stayed), cut=True
    )


def _again(
    base_model: BaseModel,
    this_round: Round,
    barred: Collection[str],
    progress: Progress,
    before: Round | None = None,
) -> Round:
    """Linearise about the best model and search again, until the selection repeats or no set is better: its converged
    model.

    Sets are compared in one system, which is exact only about its model. So a set replaces another only if, both
    converged, it is clearly better, or is smaller and hardly worse; if the best set does not, those like the present
    one are tried. before: a converged round for the first to surpass.
    """
    if before is not None and not this_round.chosen:
        return before
    try:
        for number in range(2, TOLERANCES.search.rounds + 1):
            if not this_round.chosen:
                break
            progress.phase(f"searching, round {number}", len(this_round.proposals))
            better = _first_better(base_model, this_round, before, barred)
            if better is None:
                assert before is not None  # with none to surpass, the best set is accepted
                return before
            model, chosen, names, shapes = better.model, better.chosen, better.names, better.proposals
            try:
                proposals = reshaped_proposals(base_model, better, progress)
                before = None
                del this_round, better  # frees this round's system before the next is built
                this_round = round_about(base_model, model, proposals, barred)
            except TimeUpError:
                again = round_about(base_model.at_leisure, model, shapes, barred)
                return replace(with_set(again, chosen), cut=True)
            if this_round.names == names:
                return this_round
            before = with_set(this_round, chosen)
        return replace(this_round, model=base_model.with_proposals(this_round.proposals, this_round.chosen))
    except TimeUpError:
        return _straight(base_model, this_round, barred) if before is None else replace(before, cut=True)


def _straight(base_model: BaseModel, this_round: Round, barred: Collection[str]) -> Round:
    """A round with the best set of its effects that converge at once; the search is cut there."""
    usable_now = [
        i for i in usable(this_round.proposals, barred) if not settles(this_round.proposals[i].instances)
    ]
    best = replace(this_round, selection=search(this_round.system, usable_now))
    return replace(_converged(base_model.at_leisure, best), cut=True)


def _first_better(
    base_model: BaseModel, this_round: Round, before: Round | None, barred: Collection[str]
) -> Round | None:
    """The best set of a round with its model, or the first set similar to `before` that is better than it."""
    if before is None:
        return _best_machine(base_model, _converged(base_model, this_round), barred)
    every = (
        _converged(base_model, tried) for tried in (this_round, *_alike(this_round, before.chosen, barred))
    )
    return next((tried for tried in every if _better(tried, before)), None)


def _best_machine(base_model: BaseModel, this_round: Round, barred: Collection[str]) -> Round:
    """A converged round, or a more probable one with another effect that changes the machine in place of one.

    Such effects are compared by their tangents, which say little of large changes: a wrong zero of 50 mrad explains
    more than its tangent, and may explain more than many lengths. So where a set explains more than its tangents do,
    each other effect is converged in its place.
    """
    chosen, proposals = this_round.chosen, this_round.proposals
    machines = {
        i
        for i in usable(proposals, barred)
        if any(instance.effect.changes_machine for instance in proposals[i].instances)
    }
    by_tangents = this_round.selection.selected.total + RULE.undecided
    if this_round.residual.weight(this_round.system.samples) <= by_tangents:
        return this_round
    if leaves_only_noise(this_round.system, this_round.model, base_model.noise):
        return this_round
    best = this_round
    for k in sorted(machines.intersection(chosen)):
        rest = [c for c in chosen if c != k]
        for i in sorted(machines.difference(chosen)):
            there = _converged(base_model, with_set(this_round, sorted((*rest, i))))
            if _better(there, best):
                best = there
    return best


def _converged(base_model: BaseModel, this_round: Round) -> Round:
    """The round with its set's model."""
    return replace(
        this_round, model=base_model.in_search(this_round.system, this_round.proposals, this_round.chosen)
    )


def _alike(this_round: Round, chosen: tuple[int, ...], barred: Collection[str]) -> list[Round]:
    """The best sets of a round's system that differ from this one by one effect, more, less or another, and are more
    probable.
    """
    present = score_set(this_round.system, chosen)
    scored = neighbours(this_round.system, present, usable(this_round.proposals, barred), present.total)
    return [
        replace(this_round, selection=replace(this_round.selection, selected=neighbour))
        for neighbour in scored
        if neighbour.fit.chosen != this_round.chosen
    ][: TOLERANCES.search.alike]


def _better(this_round: Round, before: Round, least: float = 0.0) -> bool:
    """Whether a converged model is more probable than the one before, by `least` nats, and no gain has run away only in
    it.
    """
    new, old = this_round.residual, before.residual
    if new.away and not old.away:
        return False
    return new.weight(before.system.samples) > old.weight(before.system.samples) + least


def with_set(this_round: Round, chosen: Sequence[int]) -> Round:
    """The round with this set as its best."""
    selection = this_round.selection
    return replace(this_round, selection=replace(selection, selected=score_set(this_round.system, chosen)))


def _with_partner(base_model: BaseModel, this_round: Round, barred: Collection[str]) -> Round | None:
    """The round after one effect joins the model and all shapes converge again; None if none is better.

    Sets are compared in one system, since their weights are comparable only about the same model.
    """
    context = base_model.context(this_round.model)
    for i in partners(this_round.model, context, this_round.proposals, this_round.chosen):
        if this_round.proposals[i].name in barred:
            continue
        for settle in (base_model.nearly, base_model.with_proposals):
            joined = settle(this_round.proposals, (*this_round.chosen, i))
            if not _better(replace(this_round, model=joined), this_round):
                break
            others = in_their_shape(base_model, this_round.proposals, joined)
            wider = round_about(base_model, joined, others, barred)
            without = score_set(wider.system, this_round.chosen)
            if wider.selection.selected.total <= without.total:
                break
        else:
            return wider
    return None


def _with_rival(base_model: BaseModel, this_round: Round, barred: Collection[str]) -> Round | None:
    """The round from a set one effect away that is hardly less probable about this model, and more probable when
    converged; or None. An effect that joins acts at its best places, and must surpass the present ones at theirs.
    """
    spared = sum(best_places(this_round.system, this_round.chosen, k).gained for k in this_round.chosen)
    for rival in _rivals(this_round, barred, spared):
        there = _converged(base_model, rival)
        if _better(there, this_round, spared):
            return _about_itself(base_model, there, barred)
    return None


def _rivals(this_round: Round, barred: Collection[str], spared: float) -> list[Round]:
    """As `_alike`, at most RULE.undecided nats less probable, with an effect that joins at its best places.

    spared: nats by which the present effects would be more probable at their best places.
    """
    system, proposals = this_round.system, this_round.proposals
    present = score_set(system, this_round.chosen)
    least = present.total - RULE.undecided + spared
    rivals = []
    for neighbour in neighbours(system, present, usable(proposals, barred), -np.inf):
        new = [i for i in neighbour.fit.chosen if i not in this_round.chosen]
        if neighbour.total + sum(most_gained(system, i) for i in new) <= least:
            continue  # whatever its places
        best = {i: best_places(system, neighbour.fit.chosen, i) for i in new}
        total = neighbour.total + sum(places.gained for places in best.values())
        if total > least:
            there = [at_its_places(each, best[i]) if i in best else each for i, each in enumerate(proposals)]
            selection = replace(this_round.selection, selected=neighbour)
            rivals.append((total, replace(this_round, proposals=there, selection=selection)))
    rivals.sort(key=lambda pair: -pair[0])
    return [rival for _, rival in rivals[: TOLERANCES.search.alike]]


def _about_itself(base_model: BaseModel, this_round: Round, barred: Collection[str]) -> Round:
    """The round from the system about a round's converged model, with every effect in its best shape for it."""
    proposals = reshaped_proposals(base_model, this_round, SILENT)
    return round_about(base_model, this_round.model, proposals, barred)


def round_about(
    base_model: BaseModel, model: Prepared, proposals: Sequence[Proposal], barred: Collection[str]
) -> Round:
    """The starting model's equations with every proposal's columns, linearised about `model`, and the best set."""
    known = usable(proposals, barred)
    system, selection = judged_by_its_error(
        system_about(base_model, model, proposals),
        base_model.floor,
        lambda system: search(system, known, base_model.deadline),
    )
    return Round(model, proposals, system, selection)


def round_from(
    base_model: BaseModel, model: Prepared, proposals: Sequence[Proposal], barred: Collection[str]
) -> Round:
    """As `round_about`; the search also starts from the model's set: laws at one motor each show only together."""
    this_round = round_about(base_model, model, proposals, barred)
    there = added_names(base_model, model)
    known = usable(proposals, barred)
    begun = [i for i in known if proposals[i].name in there]
    best = best_set(this_round.system, [begun, this_round.chosen], known, base_model.deadline)
    return (
        replace(this_round, selection=replace(this_round.selection, selected=best))
        if best.total > this_round.selection.selected.total
        else this_round
    )


def system_about(base_model: BaseModel, model: Prepared, proposals: Sequence[Proposal]) -> System:
    """The starting model's equations with every proposal's columns, linearised about `model`."""
    start = base_model.start
    about = with_effects(model, start.effects)
    given_solution = _solution_about(start, about, solved_quickly(model)[1].weights)
    exact = model.effects[len(start.effects) :]
    listed = [() if proposal.absorbed else proposal.instances for proposal in proposals]
    near = base_model.nearby.signals(model.present, model.signals)
    system = build_system(about, near, listed, exact, given_solution, base_model.deadline)
    return replace(system, priors=tuple(proposal.prior for proposal in proposals))


def _solution_about(start: Prepared, about: Prepared, weights: np.ndarray) -> Solution:
    """The solution of the starting model, linearised like `about`, with other weights (n,)."""
    stack, solution = solved_quickly(about)
    return restarted(stack, replace(solution, weights=weights), start.dataset.robot.nominal_gains)
