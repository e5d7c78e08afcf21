"""An effect competes at the places where it makes the model more probable, not at all places together."""

from dataclasses import replace

import pytest

from bench.basics.progress import SILENT
from bench.dataset.dataset import Dataset
from bench.diagnosis import rounds
from bench.diagnosis.base_model import BaseModel, base_model_of
from bench.diagnosis.candidates import Proposal
from bench.diagnosis.fewer_places import at_its_places, best_places, most_gained
from bench.diagnosis.ladder import with_special_cases
from bench.diagnosis.round import Round
from bench.diagnosis.rounds import round_about, searched, with_set
from bench.diagnosis.search import held_out_error, score_set
from bench.effects import CATALOGUE, EffectInstance, places_in
from bench.effects.select import at_joint
from bench.identification.decision import RULE
from bench.identification.identify import fit
from bench.identification.nonlinear import converged
from bench.identification.prepare import prepare
from bench.identification.problem import problem_of
from bench.identification.solve_only import reshaped
from tests.discover_kit import measured

SHORTER = {"effect": "geometric_error", "joint": "left", "error": 0.002}
DISSIPATED = {"effect": "passive_viscous_friction", "joint": "left_elbow", "Fv": 0.3}
PRESLIDING = {"effect": "presliding_hysteresis", "Fc": 0.2, "stiffness": 8.0}


def everywhere(base_model: BaseModel, name: str) -> Proposal:
    """An effect at all places of a five-bar."""
    places = places_in(base_model.start.model.geometry, base_model.start.dataset.weighed)
    effect = CATALOGUE[name]
    instances = tuple(EffectInstance(effect, joint, f"{name}:{joint}") for joint in places.where(effect))
    return Proposal(name, instances, False, "")


def first_round(dataset: Dataset, *names: str) -> tuple[BaseModel, Round]:
    """The round about the rigid bodies, with these effects at all places."""
    base_model = base_model_of(converged(prepare(problem_of(dataset))))
    proposals = [everywhere(base_model, name) for name in names]
    return base_model, round_about(base_model, base_model.start, proposals, ())


def test_a_wrong_length_acts_at_one_body() -> None:
    _, this_round = first_round(measured(SHORTER), "geometric_error")
    (proposal,) = this_round.proposals
    assert len(proposal.instances) > 2
    best = best_places(this_round.system, (0,), 0)
    assert best.places == {"left_crank"}
    assert 0.0 < best.gained < most_gained(this_round.system, 0)
    there = at_its_places(proposal, best)
    assert [instance.place for instance in there.instances] == ["left_crank"]
    assert there.prior == pytest.approx(proposal.prior + best.prior)


def test_a_friction_that_acts_everywhere_keeps_all_places() -> None:
    everywhere_alike = {key: value for key, value in DISSIPATED.items() if key != "joint"}
    _, this_round = first_round(measured(everywhere_alike), "passive_viscous_friction")
    best = best_places(this_round.system, (0,), 0)
    assert best.places == {instance.place for instance in this_round.proposals[0].instances}
    assert best.gained == best.prior == 0.0


def test_places_at_motors_do_not_compete() -> None:
    hidden = {"effect": "viscous_friction", "joint": "left", "Fv": 0.5}
    _, this_round = first_round(measured(hidden), "viscous_friction")
    assert best_places(this_round.system, (0,), 0).places == {"left", "right"}
    assert most_gained(this_round.system, 0) == 0.0


def test_without_a_law_its_special_case_acts_at_its_places() -> None:
    """Presliding friction at both motors, of which one was taken for a cable that is nearly as sharp."""
    left = at_joint(CATALOGUE["presliding_hysteresis"], "left")
    right = reshaped(at_joint(CATALOGUE["hysteretic_cable"], "right"), {"x0": 0.024, "n": 1.01})
    alone = with_special_cases([left], [left, right])
    assert [(each.name, each.joint) for each in alone] == [
        ("presliding_hysteresis", "left"),
        ("presliding_hysteresis", "right"),
    ]
    assert alone[1].effect.shape_values() == {"x0": 0.024}
    assert with_special_cases([right], [left, right]) == [right]
    assert with_special_cases([left, right], [left, right]) == [left, right]


def test_a_search_without_a_barred_effect_ends_in_the_system_of_its_model(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Sets are solved about a model; about another one their errors and probabilities mean nothing.

    With the cable, presliding friction has a displacement at the right motor with which it is Coulomb friction; and
    in the system about that model another set seems to be the best without the cable.
    """
    names = ("presliding_hysteresis", "hysteretic_cable", "gain_saturation", "stribeck_friction")
    base_model, first = first_round(measured(PRESLIDING), *names)
    friction, *others = first.proposals
    left, right = friction.instances
    sharp = replace(friction, instances=(reshaped(left, {"x0": 0.025}), reshaped(right, {"x0": 0.001})))
    proposals = [sharp, *others]
    about_both = base_model.with_proposals(first.proposals, [0, 1])
    both = with_set(round_about(base_model, about_both, proposals, ()), (0, 1))
    promising = replace(both.selection, selected=score_set(both.system, (0, 2)))
    answers = [promising]
    whole_search = rounds.search
    monkeypatch.setattr(rounds, "search", lambda *a: answers.pop() if answers else whole_search(*a))
    last = searched(base_model, both, {"hysteretic_cable"}, SILENT)
    assert last.names == {"presliding_hysteresis"}
    error = fit(last.model).error.validate
    assert held_out_error(last.system, last.selection.selected.fit) == pytest.approx(error, rel=0.01)
    with_cable = score_set(last.system, (0, 1))
    assert with_cable.total < last.selection.selected.total + RULE.prior
