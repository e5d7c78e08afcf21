"""The grammar of laws: units, formulas, files, and that a file computes what its terms say."""

import ast
import re
from itertools import pairwise

import numpy as np
import pytest

from bench.diagnosis.base_model import base_model_of
from bench.diagnosis.discovery.factors import Decay, Memory, PiecewiseLinear, Power, Step, Wave, table_over
from bench.diagnosis.discovery.grammar import LOAD, NAMED, TOOL, A, Q, Scope, T, V, grammar, name_of
from bench.diagnosis.discovery.refine import Refined, _slower, _with_a_mean, instances_of
from bench.diagnosis.discovery.screen import Known, Residual, Screened, few_rows, residual_without, screened
from bench.diagnosis.discovery.seen import places_of, scope_of, seen_at
from bench.diagnosis.discovery.source import law_effect, law_source
from bench.diagnosis.discovery.term import Term, about_its_mean, at_other_harmonics, freed
from bench.diagnosis.discovery.variables import OF_A_MOTOR, Place, Seen, Variable, times, written
from bench.effects import CATALOGUE, EffectInstance, effect_columns
from bench.effects.memory import first_order
from bench.identification.prepare import prepare, with_effects
from bench.identification.problem import problem_of
from tests.discover_kit import BRAKED, measured

MIXED = Place(("left", "right", "slide"), (True, True, False), 0)
SCOPE = Scope(
    2, True, True, 10.0, -1.0, 2.0, tuple((rate, 0.5) for rate in (1.0, 2.0, 3.0, 4.0)), (7.0,), 0.01, True
)


@pytest.fixture(scope="module")
def context():
    start = base_model_of(prepare(problem_of(measured({**BRAKED, "joint": "left"}))))
    return start.context(start.start)


@pytest.fixture
def seen() -> Seen:
    random = np.random.default_rng(1)
    variables = [Variable(kind, ahead) for kind in OF_A_MOTOR for ahead in range(3)]
    values = {one: random.normal(size=60) for one in (*variables, TOOL)}
    return Seen({**values, T: np.tile(np.linspace(0.0, 3.0, 30), 2)}, [slice(0, 30), slice(30, 60)], 0.1)


def test_units_are_multiplied_and_written():
    assert (
        written(times({"{effort}": 1.0}, times({"{angle}": 1.0, "s": -2.0}, power=-1.0)))
        == "{effort}*s^2/{angle}"
    )
    assert written({}) == "1"
    assert written({"s": 1.5, "m": -1.0, "{angle}": -2.0}) == "s^1.5/(m*{angle}^2)"


def test_the_unit_of_a_coefficient_follows_from_its_factors():
    drag = Term((Power(V, 0.0), Power(A, 1.0, odd=False)))
    assert drag.unit(MIXED) == "{effort}*s^2/{angle}"
    assert drag.formulas(MIXED) == ("sign(v)*abs(a)",)
    crossed = Term((Power(Variable("velocity", 2)),))
    assert crossed.unit(MIXED) == "{effort}*s/m"  # of a slide, seen at a hinge
    assert crossed.formulas(MIXED) == ("v_slide",)
    assert Term((Power(LOAD), Power(V, 1.0, odd=False))).unit(MIXED) == "s/{angle}"


@pytest.mark.parametrize(
    ("power", "formula"),
    [
        (Power(V), "v"),
        (Power(V, 0.0), "sign(v)"),
        (Power(V, 1.0, odd=False), "abs(v)"),
        (Power(V, 2.0), "v*abs(v)"),
        (Power(V, 2.0, odd=False), "v**2"),
        (Power(V, 3.0), "v**3"),
        (Power(V, 1.5), "sign(v)*abs(v)**1.5"),
    ],
)
def test_a_power_is_written_in_the_shortest_way_and_means_what_it_says(
    power: Power, formula: str, seen: Seen
):
    assert power.formula(MIXED) == (formula,)
    x = seen.values[V]
    wanted = (np.sign(x) if power.odd else 1.0) * np.abs(x) ** power.exponent
    np.testing.assert_allclose(power.values(seen)[:, 0], wanted)
    np.testing.assert_allclose(eval(formula, {"v": x, "abs": np.abs, "sign": np.sign}), wanted)


def test_every_term_is_tried_once_and_has_a_unit_and_a_file_that_can_be_read():
    terms = grammar(SCOPE)
    assert len(set(terms)) == len(terms) > 1000
    for one in terms[::20]:
        assert one.unit(MIXED)
        tree = ast.parse(law_source("law", [one], MIXED))
        assert [node.name for node in tree.body if isinstance(node, ast.ClassDef)] == ["Law"]


def test_what_two_recordings_remember_does_not_mix(seen: Seen):
    memory = Memory(0.5, (Power(V),))
    parts = [first_order(seen.values[V][part], 10.0, 0.5) for part in seen.parts]
    np.testing.assert_allclose(memory.values(seen)[:, 0], np.concatenate(parts))


def test_a_first_order_state_follows_a_ramp_exactly():
    time = np.arange(0.0, 4.0, 0.01)
    found = first_order(time, 100.0, 0.5)
    np.testing.assert_allclose(found, time - 0.5 * (1.0 - np.exp(-time / 0.5)), atol=1e-12)


@pytest.mark.parametrize(
    "terms",
    [
        [Term((Power(V, 0.0), Power(A, 1.5, odd=False, free=True)))],
        [Term((Power(V), Wave(Q, 2.0, 0.5, free=True))), Term((Power(V, 0.0), Decay(3.0)))],
        [Term((Power(V, 0.0), Memory(0.2, (Power(V, 1.0, odd=False),)))), Term(())],
        [Term((Power(V, 0.0), Wave(Q, 2.0, 0.5, about_mean=True)))],
        [Term((Power(Variable("load", 1)), Step(Q, 0.1, 0.2)))],
        [
            Term((Power(V, 0.0), PiecewiseLinear(A, (-2.0, 0.0, 1.0, 3.0)))),
            Term((PiecewiseLinear(Q, (-1.0, 0.5)),)),
        ],
        [Term((Power(V), Power(TOOL, 2.0, odd=False))), Term((Power(LOAD), Power(Variable("velocity", 1))))],
    ],
    ids=lambda terms: "+".join(terms[0].formulas(MIXED)),
)
def test_the_file_of_a_law_computes_what_its_terms_say(terms: list[Term], context):
    """Once as the search sees them, at the fit's rate, and once as the written effect computes them."""
    places = places_of(context.prepared)
    prepared = context.prepared
    index = [one.recording.use for one in prepared.measured].index("identify")
    robot = prepared.signals[index]
    every = seen_at(_alone(prepared, index), places[0])
    effect, source = law_effect("law_left", terms, places[0])
    columns = effect_columns(EffectInstance(effect, "left", "law_left:left"), robot)
    wanted = np.concatenate(
        [np.broadcast_to(one.values(every), (len(robot.time), one.parts)) for one in terms], axis=1
    )
    np.testing.assert_allclose(columns[:, 0], wanted, rtol=1e-9, atol=1e-9 * np.abs(wanted).max())
    assert not columns[:, 1:].any()
    assert all(len(line) <= 120 for line in source.splitlines())
    assert [one.unit for one in effect.parameters] == [
        one.unit(places[0]) for one in terms for _ in range(one.parts)
    ]


def _alone(prepared, index: int):
    """One recording at its own rate."""
    from dataclasses import replace

    settings = replace(prepared.settings, decimation=1)
    return replace(
        prepared,
        settings=settings,
        signals=(prepared.signals[index],),
        measured=(prepared.measured[index],),
    )


def test_what_has_a_name_is_called_by_it_whatever_its_numbers():
    assert set(NAMED) <= set(CATALOGUE)
    assert name_of(Term((Power(V, 0.0), Wave(Q, 3.0, 0.5)))) == "position_dependent_friction"
    assert name_of(Term((Power(V, 0.0),))) == "coulomb_friction"
    assert name_of(Term((Power(V, 0.0), Power(A, 1.0, odd=False)))) is None


def test_a_power_whose_exponent_was_adapted_has_no_name():
    """Neither has one that came out near a named one: what is adapted has an unknown more."""
    for exponent in (0.55, 1.0):
        assert name_of(Term((Power(V, exponent, free=True),))) is None


def test_a_fixed_exponent_or_frequency_can_be_freed():
    term = Term((Power(V, 0.0), Power(A, 1.0, odd=False), Wave(Q, 2.0, 0.5)))
    numbers = [[one.name for one in each.numbers] for each in freed(term)]
    assert numbers == [["p"], ["w"]]
    assert freed(freed(Term((Power(V),)))[0]) == ()


def test_the_hidden_law_explains_most_of_what_a_rigid_model_leaves(context):
    places = places_of(context.prepared)
    terms = grammar(scope_of(context.prepared, context.regression, places))
    rows = few_rows(len(context.regression.remainder))
    known = [Known(seen_at(context.prepared, place), rows, terms) for place in places]
    found = screened(residual_without(context.regression, known, rows), terms, 3)
    assert found[0].term.formulas(places[0]) == ("sign(v)*abs(a)",)
    assert all(one.share >= other.share for one, other in pairwise(found))
    assert re.match(r"\{effort\}", found[0].term.unit(places[0]))


def test_what_is_left_beside_terms_is_known_from_what_was_left_without_them(context):
    places = places_of(context.prepared)
    terms = grammar(scope_of(context.prepared, context.regression, places))
    rows = few_rows(len(context.regression.remainder))
    known = [Known(seen_at(context.prepared, place), rows, terms) for place in places]
    wide = residual_without(context.regression, known, rows)
    for _ in range(2):
        wide = wide.orthogonal_to(screened(wide, terms, 1)[0])
    anew = Residual(wide.basis, wide.error, wide.weights, known)
    np.testing.assert_allclose(wide.explained(), anew.explained(), rtol=1e-6, atol=1e-9 * wide.squares)


def test_a_term_that_is_there_already_takes_nothing_away(context):
    places = places_of(context.prepared)
    terms = grammar(scope_of(context.prepared, context.regression, places))
    rows = few_rows(len(context.regression.remainder))
    known = [Known(seen_at(context.prepared, place), rows, terms) for place in places]
    wide = residual_without(context.regression, known, rows)
    (first,) = screened(wide, terms, 1)
    once = wide.orthogonal_to(first)
    again = once.orthogonal_to(first)
    assert again.basis[0].shape == once.basis[0].shape
    np.testing.assert_allclose(again.explained(), once.explained(), rtol=1e-6, atol=1e-9 * wide.squares)


def test_a_table_is_its_values_with_straight_lines_between(seen: Seen):
    table = table_over(V, seen.values[V], 5, [0.0])
    assert 0.0 in table.knots
    values = np.sin(np.array(table.knots))
    wanted = np.interp(seen.values[V], table.knots, values)
    np.testing.assert_allclose(table.values(seen) @ values, wanted, atol=1e-12)


def test_a_wave_is_tried_at_other_harmonics_of_the_turn():
    term = Term((Power(V), Wave(Q, 6.0, 0.5)))
    assert [one.factors[-1].rate for one in at_other_harmonics(term)] == pytest.approx([2.0, 3.0, 12.0])
    assert [one.factors[-1].rate for one in at_other_harmonics(Term((Wave(Q, 1.0, 0.5),)))] == [2.0]
    assert at_other_harmonics(Term((Wave(T, 4.0, 0.5, free=True),))) == ()


def test_a_wave_and_its_mean_can_be_one_term(seen: Seen):
    friction = (Power(V, 0.0), Power(LOAD, 1.0, odd=False))
    wave = Term((*friction, Wave(Q, 2.0, 0.5)))
    joined, mean = about_its_mean(wave) or (wave, wave)
    assert name_of(mean) == "load_dependent_friction"
    assert joined.formulas(MIXED) == (*mean.formulas(MIXED), *wave.formulas(MIXED))
    assert np.array_equal(joined.values(seen), np.hstack((mean.values(seen), wave.values(seen))))
    assert [joined.part(k).variables for k in range(3)] == [mean.variables, wave.variables, wave.variables]
    assert about_its_mean(mean) is None


def test_only_a_wave_of_the_load_beside_its_named_mean_takes_it_in():
    friction = (Power(V, 0.0), Power(LOAD, 1.0, odd=False))
    wave = Term((*friction, Wave(Q, 2.0, 0.5)))
    found = list(_with_a_mean(wave, {"load_dependent_friction", "viscous_friction"}))
    assert [name for _, name in found] == ["load_dependent_friction"] * 3
    assert [one.factors[-1].rate for one, _ in found] == [2.0, 1.0, 4.0]
    assert not list(_with_a_mean(wave, {"viscous_friction"}))
    assert not list(_with_a_mean(Term((Power(V), Wave(Q, 2.0, 0.5))), {"viscous_friction"}))


@pytest.mark.parametrize(("rate", "slower"), [(0.05, True), (0.6, False)])
def test_a_wave_that_has_become_a_straight_line_is_known(rate: float, slower: bool, context):
    """Over a travel of a radian or two it would stand for what a steeper function does better."""
    term = Term((Power(V), Wave(Q, 1.0, 0.5, free=True)))
    start = context.prepared
    instances = instances_of("wave", Screened(term.with_numbers([rate]), {}, 0.0), places_of(start))
    model = with_effects(start, (*start.effects, *instances))
    assert _slower(Refined(model, {"wave": term}, 0.0)) is slower


def test_a_law_of_the_load_is_a_part_of_that_load(context):
    """As a gear's friction goes by all that its motor gives."""
    prepared = context.prepared
    places = places_of(prepared)
    robot = prepared.signals[0]
    term = Term((Power(V, 0.0), Power(LOAD, 1.5, odd=False)))
    effect, _ = law_effect("law_left", [term], places[0])
    about = effect.about({"c1": 0.02})
    column = effect_columns(EffectInstance(about, "left", "law_left:left"), robot)[:, 0, 0]
    joint = robot.joints["left"]
    load = joint.needed_torque + 0.02 * column
    wanted = np.sign(joint.velocity) * np.abs(load) ** 1.5
    plain = np.sign(joint.velocity) * np.abs(joint.needed_torque) ** 1.5
    assert np.abs(column - wanted).max() < 0.01 * np.abs(column - plain).max()
