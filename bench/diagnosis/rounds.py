"""Rounds of a search: about the model that the last one selected, until the same is selected."""

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from bench.basics.deadline import NEVER, TimeUpError
from bench.basics.progress import SILENT, Progress
from bench.diagnosis.base_model import BaseModel
from bench.diagnosis.batched_sets import solve_sets, swapped
from bench.diagnosis.candidates import Context, Proposal, propose, shaped
from bench.diagnosis.evidence import ResidualSumOfSquares, effects_prior, residual_squares
from bench.diagnosis.noise import leaves_only_noise
from bench.diagnosis.normal_equations import System, build_system, solve_set
from bench.diagnosis.restart import restarted
from bench.diagnosis.revealed import in_their_shape, partners
from bench.diagnosis.search import Selection, contains, neighbours, score, search
from bench.diagnosis.special_case import explaining_most, explains, with_shapes_of
from bench.effects import Effect, EffectInstance
from bench.identification.decision import RULE
from bench.identification.nonlinear import settles
from bench.identification.prepare import Prepared, with_effects
from bench.identification.solution import Solution
from bench.identification.solve_only import solved_quickly
from bench.identification.tolerances import TOLERANCES


@dataclass(frozen=True)
class Round:
    """A converged model, every effect in the shape that suits it, their system about it, and the best set there.

    cut: whether the time was up before the search had ended; the model is that of the best set so far, then.
    """

    model: Prepared
    proposals: Sequence[Proposal]
    system: System
    selection: Selection
    cut: bool = False

    @cached_property
    def residual(self) -> ResidualSumOfSquares:
        """The residual sums of squares of its model."""
        return residual_squares(self.model, self.prior_of(self.model.effects))

    def prior_of(self, effects: Sequence[EffectInstance]) -> float:
        """Nats that effects must bring, with what its proposals must bring beyond an effect of the catalogue."""
        names = {instance.effect.name for instance in effects}
        return effects_prior(effects) + sum(each.prior for each in self.proposals if each.name in names)

    @property
    def chosen(self) -> tuple[int, ...]:
        """The best set's proposals (indices)."""
        return self.selection.selected.fit.chosen

    @property
    def names(self) -> set[str]:
        """The best set's effects."""
        return {self.proposals[i].name for i in self.chosen}


def first_round(base_model: BaseModel, catalogue: Mapping[str, Effect], progress: Progress = SILENT) -> Round:
    """Every effect in the shape that suits the starting model; after the deadline `straight_round`."""
    progress.phase("searching, round 1", len(catalogue))
    try:
        proposals = propose(base_model.context(base_model.start), catalogue, progress, base_model.deadline)
        return round_about(base_model, base_model.start, proposals, ())
    except TimeUpError:
        return straight_round(base_model.at_leisure, catalogue)


def straight_round(base_model: BaseModel, catalogue: Mapping[str, Effect]) -> Round:
    """The best set of the effects alone whose columns depend on nothing that is sought: it is converged at once."""
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
    """Search, linearise about the best model, and search again until the same is selected; then as long as an effect
    that joins leads to a set which, converged, leaves clearly less.

    barred: effects that may not be selected: of an impossible sign, or superfluous. What a round selected without them
    is there to be surpassed. After the deadline the best set so far is the answer.
    """
    if first.cut:
        return first
    before = None
    if barred:
        whole, first = first, replace(first, selection=_search(first.system, first.proposals, barred))
        stayed = tuple(i for i in whole.chosen if whole.proposals[i].name not in barred)
        if stayed and stayed != first.chosen:
            before = _converged(base_model.at_leisure, _with_set(whole, stayed))
        del whole
    given = [first]
    del first  # handed on without a name, so that its system is gone before the next is built
    this_round = _again(base_model, given.pop(), barred, progress, before)
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
    """What stays of a round's set where some effects may not be selected, converged, without another search."""
    stayed = [i for i in this_round.chosen if this_round.proposals[i].name not in barred]
    return replace(
        _with_set(this_round, stayed), model=base_model.with_proposals(this_round.proposals, stayed), cut=True
    )


def _again(
    base_model: BaseModel,
    this_round: Round,
    barred: Collection[str],
    progress: Progress,
    before: Round | None = None,
) -> Round:
    """Linearise about the best model, and search again, until the same is selected, or no set does better:
    the converged model with it.

    Sets are compared in one system, which is right about its model only. So a set takes the place of another only
    if, both converged, it leaves clearly less, or is smaller and leaves hardly more; where the best set does not, those
    like the present one are tried. before: a converged round in whose place the first is to be.
    """
    if before is not None and not this_round.chosen:
        return before
    spare = before  # what is answered where the time is up
    try:
        for number in range(2, TOLERANCES.search.rounds + 1):
            if not this_round.chosen:
                break
            progress.phase(f"searching, round {number}", len(this_round.proposals))
            better = _first_better(base_model, this_round, before, barred)
            if better is None:
                assert before is not None  # without one to surpass, the best set is taken
                return before
            spare = None if base_model.deadline is NEVER else better
            proposals = reshaped(base_model, better, progress)
            model, chosen, names = better.model, better.chosen, better.names
            before = None
            del (
                this_round,
                better,
            )  # so that this round's system is gone before the next is built, unless it is spared
            this_round = round_about(base_model, model, proposals, barred)
            if this_round.names == names:
                return this_round
            before = spare = _with_set(this_round, chosen)
        return replace(this_round, model=base_model.with_proposals(this_round.proposals, this_round.chosen))
    except TimeUpError:
        return _straight(base_model, this_round, barred) if spare is None else replace(spare, cut=True)


def _straight(base_model: BaseModel, this_round: Round, barred: Collection[str]) -> Round:
    """A round with the best set of its effects that are converged at once, and the search cut there."""
    usable_now = [
        i for i in usable(this_round.proposals, barred) if not settles(this_round.proposals[i].instances)
    ]
    best = replace(this_round, selection=search(this_round.system, usable_now))
    return replace(_converged(base_model.at_leisure, best), cut=True)


def _first_better(
    base_model: BaseModel, this_round: Round, before: Round | None, barred: Collection[str]
) -> Round | None:
    """The best set of a round with its model, or the first like the one before that does better than that one."""
    if before is None:
        return _converged(base_model, this_round)
    every = (
        _converged(base_model, tried) for tried in (this_round, *_alike(this_round, before.chosen, barred))
    )
    return next((tried for tried in every if _better(tried, before)), None)


def _converged(base_model: BaseModel, this_round: Round) -> Round:
    """The round with its set's model."""
    return replace(
        this_round, model=base_model.in_search(this_round.system, this_round.proposals, this_round.chosen)
    )


def _alike(
    this_round: Round, chosen: tuple[int, ...], barred: Collection[str], less: float = 0.0
) -> list[Round]:
    """The best sets of a round's system that are this one except for one effect, more, less or another, and less
    probable by no more than so many nats.
    """
    present = score(this_round.system, solve_set(this_round.system, chosen))
    scored = neighbours(
        this_round.system, present, usable(this_round.proposals, barred), present.total - less
    )
    return [
        replace(this_round, selection=replace(this_round.selection, selected=neighbour))
        for neighbour in scored
        if neighbour.fit.chosen != this_round.chosen
    ][: TOLERANCES.search.alike]


def _better(this_round: Round, before: Round) -> bool:
    """Whether a converged model is more probable than the one before, and its gains have not run away if those of the
    other have not.
    """
    new, old = this_round.residual, before.residual
    if new.away and not old.away:
        return False
    return new.weight(before.system.samples) > old.weight(before.system.samples)


def _with_set(this_round: Round, chosen: Sequence[int]) -> Round:
    """The round with this set as its best."""
    selection = this_round.selection
    fit = solve_set(this_round.system, chosen)
    return replace(this_round, selection=replace(selection, selected=score(this_round.system, fit)))


def _with_partner(base_model: BaseModel, this_round: Round, barred: Collection[str]) -> Round | None:
    """The round when an effect joins the model and all shapes are converged anew; None if nothing better is.

    Sets are compared in one system: what each promises holds where it was linearised about the same model.
    """
    context = base_model.context(this_round.model)
    for i in partners(this_round.model, context, this_round.proposals, this_round.chosen):
        if this_round.proposals[i].name in barred:
            continue
        for settle in (base_model.nearly, base_model.with_proposals):
            joined = settle(this_round.proposals, (*this_round.chosen, i))
            if not _better(replace(this_round, model=joined), this_round):
                break
            others = in_their_shape(this_round.proposals, joined, len(base_model.start.effects))
            wider = round_about(base_model, joined, others, barred)
            without = score(wider.system, solve_set(wider.system, this_round.chosen))
            if wider.selection.selected.total <= without.total:
                break
        else:
            return wider
    return None


def _with_rival(base_model: BaseModel, this_round: Round, barred: Collection[str]) -> Round | None:
    """The round from a set one effect away that is hardly less probable about this model, and more where it is
    converged; None if none is.
    """
    for rival in _alike(this_round, this_round.chosen, barred, RULE.undecided):
        there = _converged(base_model, rival)
        if _better(there, this_round):
            return round_about(base_model, there.model, reshaped(base_model, there, SILENT), barred)
    return None


def round_about(
    base_model: BaseModel, model: Prepared, proposals: Sequence[Proposal], barred: Collection[str]
) -> Round:
    """The starting model's equations with every proposal's columns, linearised about `model`, and the best set."""
    system = system_about(base_model, model, proposals)
    return Round(model, proposals, system, search(system, usable(proposals, barred), base_model.deadline))


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
    """The solution of the starting model, linearised as `about` is, with other weights (n,)."""
    stack, solution = solved_quickly(about)
    return restarted(stack, replace(solution, weights=weights), start.dataset.robot.nominal_gains)


def _search(system: System, proposals: Sequence[Proposal], barred: Collection[str]) -> Selection:
    return search(system, usable(proposals, barred))


def usable(proposals: Sequence[Proposal], barred: Collection[str]) -> list[int]:
    """Proposals (indices) that may be selected."""
    return [
        i for i, proposal in enumerate(proposals) if not proposal.absorbed and proposal.name not in barred
    ]


def reshaped(base_model: BaseModel, this_round: Round, progress: Progress) -> list[Proposal]:
    """Proposals in the shape that suits the selected set: as found, or in the place of the effect that they rival.

    An effect that could replace an identified one is given the shape that it would have without that one; the others
    the shape that explains most of what the selected set leaves, if that is more than noise. A special case of an
    identified effect that explains little of this is given its shape in the place of that one.
    """
    model, given_count = this_round.model, len(base_model.start.effects)
    added = model.effects[given_count:]
    contexts: dict[int | None, Context] = {None: base_model.context(model)}
    result = []
    only_noise = leaves_only_noise(this_round.system, model, base_model.noise)
    asked = [
        i
        for i, candidate in enumerate(this_round.proposals)
        if i not in this_round.chosen and _has_shape(candidate)
    ]
    solve_sets(
        this_round.system, swapped(this_round.chosen, asked)
    )  # together, and kept: each is asked for below
    for i, proposal in enumerate(this_round.proposals):
        progress.advance()
        base_model.deadline.check()
        if i in this_round.chosen:
            instances = tuple(instance for instance in added if instance.effect.name == proposal.name)
            result.append(replace(proposal, instances=instances))
            continue
        if not _has_shape(proposal):
            result.append(proposal)
            continue
        rival = _part(this_round.system, this_round.selection, i)
        if rival is None:
            rival = _rival(this_round.system, this_round.selection, i)
        if rival is None:
            instances = (
                proposal.instances
                if only_noise
                else shaped(contexts[None], proposal.instances, base_model.deadline)
            )
            rival = _whole(this_round.system, this_round.selection, i)
            if rival is None or (not only_noise and explains(contexts[None], instances)):
                result.append(replace(proposal, instances=instances))
                continue
        name = this_round.proposals[rival].name
        if rival not in contexts:
            others = [instance for instance in added if instance.effect.name != name]
            contexts[rival] = base_model.context(with_effects(model, (*base_model.start.effects, *others)))
        instances = shaped(contexts[rival], proposal.instances, base_model.deadline)
        if contains(this_round.system.candidates[rival], this_round.system.candidates[i]):
            present = [instance for instance in added if instance.effect.name == name]
            instances = explaining_most(contexts[rival], instances, with_shapes_of(present, instances))
        result.append(replace(proposal, instances=instances))
    return result


def _whole(system: System, selection: Selection, i: int) -> int | None:
    """The identified effect of which effect i is a special case."""
    wholes = (
        k for k in selection.selected.fit.chosen if contains(system.candidates[k], system.candidates[i])
    )
    return next(wholes, None)


def _part(system: System, selection: Selection, i: int) -> int | None:
    """The identified effect that is a special case of effect i."""
    parts = (k for k in selection.selected.fit.chosen if contains(system.candidates[i], system.candidates[k]))
    return next(parts, None)


def _has_shape(proposal: Proposal) -> bool:
    """Whether the columns of an effect depend on the model to which it is added."""
    return not proposal.absorbed and settles(proposal.instances)


def _rival(system: System, selection: Selection, i: int) -> int | None:
    """The identified effect in whose place effect i does best, where that is better than most of what it explains."""
    best = selection.selected.fit
    if not best.chosen:
        return None
    sets = zip(best.chosen, swapped(best.chosen, [i]), strict=True)
    swaps = {k: solve_set(system, pair).fitted for k, pair in sets}
    rival = min(swaps, key=lambda k: swaps[k])
    without = solve_set(system, tuple(c for c in best.chosen if c != rival)).fitted
    return rival if swaps[rival] < 0.5 * (without + best.fitted) else None
