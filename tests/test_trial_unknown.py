"""Laws that no model is told of: how they are hidden, and how what is found is held against them."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from bench.diagnosis.discovery.factors import Power
from bench.diagnosis.discovery.grammar import A, V
from bench.diagnosis.discovery.seen import places_of
from bench.diagnosis.discovery.source import law_effect
from bench.diagnosis.discovery.term import Term
from bench.diagnosis.result import Discovered, EffectVerdict, LawTerm, LooksAt
from bench.document.markdown.tables import markdown
from bench.effects import EffectInstance
from bench.excitation.scenario import designer
from bench.identification.prepare import prepare, with_effects
from bench.identification.problem import problem_of
from bench.scenario.scenario import load_scenario, resolve_trajectories
from bench.studies.trial import judge
from bench.studies.trial.cases import Case, Hide
from bench.studies.trial.judge import Named, _alike, _torque_error, judgement_of, law_columns
from bench.studies.trial.unknown import FAMILIES, drawn_law, law_along, named_parts, sized
from bench.studies.trial.unknown_page import unknown_table, write_unknown
from bench.studies.trial.work import _answer
from bench.truth.dataset import as_dataset
from bench.truth.hidden.base import rms
from bench.truth.hidden.reference import Reference
from bench.truth.simulate import simulate
from tests.hidden_kit import STEP

SHORT = {"design": {"optimise": False, "duration": 4.0}, "step": STEP}
ROW = {
    "status": "ok",
    "kind": "unknown",
    "hidden": "product_law",
    "least_own_error_over_floor": 20.0,
    "error_over_floor.before": 20.0,
    "error_over_floor.after": 1.02,
    "law": '{"c": 0.1, "direction": 1.0, "v": 1.5}',
    "law.found": "left: 0.1*sign(v)*abs(v)**1.5",
    "law.error": 0.03,
    "law.structure": True,
    "law.elsewhere": 0,
    "missing": "",
    "wrong": "",
    "exact_undecided": True,
    "commit": "abc",
}


@pytest.fixture(scope="module")
def reference() -> Reference:
    scenario = load_scenario("five_bar", SHORT)
    return Reference(simulate(scenario, resolve_trajectories(scenario, designer)))


@pytest.mark.parametrize("index", range(len(FAMILIES)))
def test_every_family_has_the_size_asked_for(index: int, reference: Reference) -> None:
    numbers = drawn_law(index, 2, np.random.default_rng(index))
    law = sized(numbers, reference, "left", 0.002)
    found = law["c"] * rms(law_along(numbers, reference, "left"))
    assert found == pytest.approx(0.002 * rms(reference.movement("left").torque), rel=1e-3)


def test_the_simulated_machine_has_the_law_that_is_judged(reference: Reference) -> None:
    """What the motor must give beyond the rigid body is the law along the true motion."""
    law = {
        "effect": "product_law",
        "joint": "left",
        "c": 0.05,
        "direction": 1.0,
        "v": 1.5,
        "depth": 0.8,
        "wave": 2.0,
    }
    plain = reference.simulation
    with_law = load_scenario("five_bar", {**SHORT, "hidden": [law]})
    recordings = simulate(with_law, resolve_trajectories(plain.scenario, designer)).recordings
    without = plain.recordings
    m, i = recordings[0].motion, 0
    change = m.torque[:, i] - without[0].motion.torque[:, i]
    velocity, position = without[0].motion.qvel, without[0].motion.qpos
    wanted = 0.05 * np.sign(velocity[:, 0]) * np.abs(velocity[:, 0]) ** 1.5
    wanted = wanted * (1.0 + 0.8 * np.cos(2.0 * position[:, 0]))
    assert np.corrcoef(change, wanted)[0, 1] > 0.98


def test_a_structure_is_alike_where_variables_and_symmetry_are() -> None:
    looks = (LooksAt("velocity", "", "direction"), LooksAt("acceleration", "", "size"))
    found = Discovered(
        "left",
        "law_left",
        (LawTerm("sign(v)*abs(a)", 0.1, 0.01, "1", looks),),
        {},
        0.1,
        0.1,
        0.2,
        None,
        None,
        "",
    )
    assert _alike({"c": 0.1, "direction": 1.0, "a": 1.0}, [found])
    assert not _alike({"c": 0.1, "direction": 1.0, "a": 1.0, "q": 1.0}, [found])
    even = replace(found.terms[0], looks_at=(LooksAt("velocity", "", "size"), looks[1]))
    assert not _alike({"c": 0.1, "direction": 1.0, "a": 1.0}, [replace(found, terms=(even,))])


@pytest.mark.parametrize(
    ("wave", "aside"), [(0.0, {"constant_offset", "viscous_friction"}), (0.8, {"constant_offset"})]
)
def test_known_effects_by_their_names_are_no_error_of_a_law(
    wave: float, aside: set[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    """But for one of which the law is a part; Coulomb friction was not found, and is at another motor."""
    law = {"c": 0.1, "direction": 1.0, "v": 1.0, "depth": wave, "wave": 2.0 if wave else 0.0}
    entries = [
        SimpleNamespace(effect="product_law", joint="left", parameters=law),
        SimpleNamespace(effect="constant_offset", joint=None),
        SimpleNamespace(effect="viscous_friction", joint="left"),
        SimpleNamespace(effect="coulomb_friction", joint="left"),
        SimpleNamespace(effect="joint_spring", joint="right"),
    ]
    simulation = SimpleNamespace(scenario=SimpleNamespace(settings=SimpleNamespace(hidden=entries)))
    found = dict.fromkeys(("constant_offset", "viscous_friction", "joint_spring"), ("left", "right"))
    discovered = SimpleNamespace(place="left", formula="", terms=())
    diagnosis = SimpleNamespace(
        discovered=(discovered,),
        after=SimpleNamespace(effect_parameters={**found, "coulomb_friction": ("right",)}),
    )
    left_out = []
    monkeypatch.setattr(judge, "_torque_error", lambda *given: left_out.append(set(given[-1])) or 0.1)
    law_columns(simulation, diagnosis, None)  # type: ignore[arg-type]
    assert left_out == [set(), aside]


def test_a_law_that_is_found_exactly_has_no_error(monkeypatch: pytest.MonkeyPatch) -> None:
    """A friction jumps where its motor reverses, and the equations leave that out."""
    law = {"effect": "product_law", "joint": "left", "c": 0.02, "direction": 1.0, "a": 1.0}
    scenario = load_scenario("five_bar", {**SHORT, "hidden": [law], "step": 0.00025})
    simulation = simulate(scenario, resolve_trajectories(scenario, designer))
    prepared = prepare(problem_of(as_dataset(simulation)))
    friction = Term((Power(V, 0.0), Power(A, 1.0, odd=False)))
    effect, _ = law_effect("law_left", [friction], places_of(prepared)[0])
    model = with_effects(prepared, [EffectInstance(effect, "left", "law_left:left")])
    for c, error in ((0.02, 0.0), (0.018, 0.1)):
        monkeypatch.setattr(judge, "_identified_model", lambda *_, c=c: (model, np.array([c])))
        found = _torque_error(simulation, SimpleNamespace(), prepared, "left", ())  # type: ignore[arg-type]
        assert found == pytest.approx(error, abs=0.015)


def test_the_page_counts_what_is_large_enough(tmp_path) -> None:
    rows = [
        ROW,
        {**ROW, "law.error": 0.5, "law.structure": False},
        {**ROW, "least_own_error_over_floor": 2.0, "law.error": 0.9},
        {**ROW, "hidden": "product_law + viscous_friction", "wrong": "backlash"},
    ]
    nothing = [{"status": "ok", "laws": 0}, {"status": "ok", "laws": 1}, {"status": "failed"}]
    text = markdown(unknown_table(rows, nothing))
    assert "| 1 of 2 |" in text.splitlines()[-1]
    assert "| 2 of 2 |" in text
    assert "| 1 of 2 |" in text
    page, table = write_unknown("five_bar", rows, tmp_path)
    assert "direction 1, v 1.5" in page.read_text(encoding="utf-8")
    assert table.stat().st_size > 0
    assert write_unknown("five_bar", [], tmp_path) == []


def test_the_known_effects_beside_a_law_can_be_named_exactly() -> None:
    """The law itself has no name, and is not asked for."""
    named = [Named("viscous_friction", "missing", ())]
    assert judgement_of(["viscous_friction"], ["viscous_friction"], named).exact
    case = Case(
        "unknown",
        0,
        (Hide("product_law", ("left",), 0.1), Hide("viscous_friction", ("left",), 0.1)),
        0.01,
        20,
        1,
    )
    verdict = EffectVerdict("viscous_friction", "missing", 0.1, 0.01, 90.0, ("left",), (), {}, "")
    diagnosis = SimpleNamespace(
        ranking=(verdict,),
        missing=("viscous_friction",),
        unexplained=SimpleNamespace(significant=False, depends_on=()),
    )
    answer = _answer(case, diagnosis)
    assert answer["exact"]
    assert answer["wrong"] == ""


def test_a_summand_of_the_law_that_has_a_name_may_be_named() -> None:
    swinging = {"c": 0.1, "direction": 1.0, "v": 1.0, "depth": 0.8, "wave": 2.0}
    assert named_parts(swinging) == {"viscous_friction"}
    assert named_parts({"c": 0.1, "direction": 1.0, "v": 1.0, "a": 1.0}) == frozenset()
    named = [Named("viscous_friction", "missing", ()), Named("backlash", "missing", ())]
    assert judgement_of([], [], named, named_parts(swinging)).wrong == ("backlash",)
