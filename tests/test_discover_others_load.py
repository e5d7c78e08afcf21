"""A law of what all other motors give together: of drives that share a supply, say."""

import pytest

from bench.diagnosis.discovery.find import find_missing_effects
from bench.diagnosis.discovery.grammar import OTHERS, Scope, grammar
from bench.diagnosis.discovery.seen import are_several
from bench.diagnosis.discovery.variables import Place
from bench.diagnosis.result import LooksAt
from bench.excitation.scenario import designer
from bench.identification.problem import problem_of
from bench.scenario.scenario import load_scenario, resolve_trajectories
from bench.truth.dataset import as_dataset
from bench.truth.simulate import simulate
from tests.hidden_kit import STEP

MOTORS = ("motor_1", "motor_2", "motor_3")
SHARES = dict(zip(MOTORS, (0.05, 0.06, 0.07), strict=True))


def test_a_share_of_all_other_motors_torques_is_one_law_and_no_length():
    hidden = [{"effect": "current_crosstalk", "joint": motor, "c": c} for motor, c in SHARES.items()]
    changes = {"design": {"optimise": False, "duration": 8.0}, "hidden": hidden, "step": STEP}
    scenario = load_scenario("delta", changes)
    simulation = simulate(scenario, resolve_trajectories(scenario, designer))
    found = find_missing_effects(problem_of(as_dataset(simulation)), discover=True)
    assert found.missing == ()
    assert {law.place for law in found.discovered} == set(MOTORS)
    for law in found.discovered:
        (term,) = law.terms
        assert term.looks_at == (LooksAt("others_load", "", "signed"),)
        assert term.value == pytest.approx(SHARES[law.place], rel=0.1)
    assert found.unexplained.error < 1.1 * found.unexplained.noise_floor


@pytest.mark.parametrize(
    ("rotates", "several"),
    [((True, True), False), ((True, True, True), True), ((True, True, False), False)],
    ids=["two motors", "three hinges", "a slide among hinges"],
)
def test_loads_are_added_up_where_there_are_several_of_one_kind(rotates: tuple[bool, ...], several: bool):
    place = Place(MOTORS[: len(rotates)], rotates, 0)
    assert are_several(place) == several
    scope = Scope(len(rotates) - 1, several, True, 10.0, -1.0, 2.0, ((1.0, 0.5),), (7.0,), 0.01, True)
    seen = {variable for term in grammar(scope) for variable in term.variables}
    assert (OTHERS in seen) == several
