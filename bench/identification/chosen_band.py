"""Filters chosen from the spectra, then checked by how the parameters change in half of the band."""

from collections.abc import Mapping
from dataclasses import replace

from bench.effects import Effect, places_in, select_effects
from bench.identification.bandwidth import moved, narrower, sharper
from bench.identification.filtered import forget_motions
from bench.identification.identify import fit
from bench.identification.nonlinear import converged
from bench.identification.prepare import Prepared, prepare, with_effects
from bench.identification.problem import Problem
from bench.signals.settings import FilterSettings


def usual_friction(catalogue: Mapping[str, Effect]) -> list[str]:
    """Effects that nearly every drive has, with a value in each run and without shape parameters."""
    return [name for name, effect in catalogue.items() if effect.varies_by_run and not effect.shape]


def prepare_checked(problem: Problem) -> Prepared:
    """As `prepare`, with the band halved until halving it no longer moves the parameters of rigid bodies and friction
    by more than their standard errors, nor makes these clearly smaller.

    The model has friction, since nearly every drive has it. Filters given by the user, even in part, stay.
    """
    prepared = prepare(problem)
    if problem.filters:
        return prepared
    known = {instance.name for instance in prepared.effects}
    friction = [name for name in usual_friction(problem.catalogue) if name not in known]
    places = places_in(prepared.model.geometry, problem.dataset.weighed)
    instances = select_effects(friction, places, problem.catalogue, prepared.logs)
    model = converged(with_effects(prepared, (*prepared.effects, *instances)))
    result, rejected = fit(model, deviations="serial"), list[FilterSettings]()
    while (half := narrower(model)) is not None:
        of_half = fit(half, deviations="serial")
        if not (moved(result, of_half) or sharper(result, of_half)):
            break
        rejected.append(model.settings)
        model, result = half, of_half
    if rejected:
        prepared = replace(prepare(replace(problem, filters=model.settings)), rejected=tuple(rejected))
    if half is not None:
        forget_motions(half.measured)
        for seen in half.signals:
            seen.forget()
    return replace(prepared, halved=half)
