"""Filters that are chosen from the spectra, and then by what the parameters do in half of their band."""

from dataclasses import replace

from bench.identification.bandwidth import moved, narrower, sharper
from bench.identification.identify import fit
from bench.identification.prepare import Prepared, prepare
from bench.identification.problem import Problem
from bench.signals.settings import FilterSettings

FRICTION = ("viscous_friction", "coulomb_friction", "constant_offset")
"""What nearly every drive has: with these in the model, a band is not rejected for what friction does in it."""


def prepare_checked(problem: Problem) -> Prepared:
    """As `prepare`, with filters that are chosen narrower until the parameters of rigid bodies and friction no longer
    move by more than their errors where the band is halved, nor have clearly smaller ones. Filters that are given, in
    part too, stay.
    """
    prepared = prepare(problem)
    if problem.filters:
        return prepared
    friction = (name for name in FRICTION if name in problem.catalogue)
    requests = tuple(dict.fromkeys((*problem.effects, *friction)))
    model = prepare(replace(problem, effects=requests, filters=prepared.settings))
    here, rejected = fit(model), list[FilterSettings]()
    while (half := narrower(model)) is not None:
        there = fit(half)
        if not (moved(here, there) or sharper(here, there)):
            break
        rejected.append(model.settings)
        model, here = half, there
    if not rejected:
        return prepared
    return replace(prepare(replace(problem, filters=model.settings)), rejected=tuple(rejected))
