"""Laws that no catalogue has: found exactly, beside known effects, and not where there is none."""

import json
from dataclasses import replace
from importlib import import_module
from pathlib import Path
from types import SimpleNamespace

import pytest
from click.testing import CliRunner

from bench.api.compare import compare
from bench.cli.diagnose import diagnose as diagnose_command
from bench.dataset.dataset import Dataset
from bench.diagnosis.as_json import diagnosis_json
from bench.diagnosis.discovery import reported
from bench.diagnosis.discovery.find import find_missing_effects
from bench.diagnosis.discovery.law_files import write_laws
from bench.diagnosis.discovery.with_laws import something_remains
from bench.diagnosis.law_words import law_sentences, symbols
from bench.diagnosis.result import Diagnosis, Remainder, Unexplained
from bench.diagnosis.summary import summary_sentences
from bench.diagnosis.with_catalogue import diagnose_with_catalogue
from bench.effects import catalogue_for
from bench.identification.identify import identify
from bench.identification.prepare import prepare
from bench.identification.problem import Problem, problem_of
from bench.page.folder import read_run
from bench.truth.dataset import as_dataset, write_simulation
from bench.truth.simulate import Simulation
from tests.discover_kit import BRAKED, FRICTIONS, among, measured, simulated

FLOOR = 1.15  # times the noise: what may be left


@pytest.fixture(scope="module")
def machine() -> Simulation:
    """Friction at one motor that grows with the acceleration's size."""
    return simulated({**BRAKED, "joint": "left"})


@pytest.fixture(scope="module")
def braked(machine: Simulation) -> Dataset:
    return as_dataset(machine)


@pytest.fixture(scope="module")
def found(braked: Dataset) -> Diagnosis:
    return find_missing_effects(problem_of(braked))


def left_over_floor(diagnosis: Diagnosis) -> float:
    assert diagnosis.ladder[-1].validate is not None
    return diagnosis.ladder[-1].validate / diagnosis.unexplained.noise_floor


def test_a_law_is_found_with_its_formula_its_value_and_its_place(found: Diagnosis) -> None:
    (law,) = found.discovered
    (term,) = law.terms
    assert (law.place, term.term, term.unit) == ("left", "sign(v)*abs(a)", "N*m*s^2/rad")
    assert term.value == pytest.approx(BRAKED["c"], rel=0.02)
    assert 0.0 < term.std < 0.02 * term.value
    assert law.formula == f"{term.value:.4g}*sign(v)*abs(a)"
    assert law.named is None
    assert found.missing == ()
    assert [one.effects for one in found.ladder] == [(), ("law_left",)]
    assert left_over_floor(found) < FLOOR
    assert not found.unexplained.significant


def test_a_law_is_told_where_it_stays(found: Diagnosis, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(reported, "discovered_at", lambda _finding, law, i: (law.name, law.places[i].name))
    places = (SimpleNamespace(name="left"), SimpleNamespace(name="right"))
    finding = SimpleNamespace(after=SimpleNamespace(effect_parameters={"law": {"right": {}}}))
    laws = [SimpleNamespace(name="law", places=places)]
    told = reported.with_discovered(finding, laws, laws, found)
    assert told.discovered == (("law", "right"),)


def test_a_law_is_told_in_words(found: Diagnosis) -> None:
    (sentence,) = law_sentences(found.discovered)
    assert sentence.startswith(
        "At left there is a torque that opposes the motion and grows with the size of the acceleration"
    )
    assert "N·m·s²/rad · sign(q̇)·|q̈|" in sentence
    assert sentence in summary_sentences(found)
    assert symbols("sign(v_right)*abs(a)**1.5*cos(2*q)") == "sign(q̇_right)·|q̈|^1.5·cos(2·q)"


def test_a_law_stands_in_the_json_as_documented(found: Diagnosis) -> None:
    (law,) = json.loads(json.dumps(diagnosis_json(found)))["discovered"]
    assert {"place", "formula", "terms", "error", "named", "file"} <= set(law)
    assert set(law["terms"][0]) == {"term", "value", "std", "unit"}
    assert {"identify", "validate"} <= set(law["error"])
    assert law["file"] is None


def test_a_law_is_written_as_an_effect_that_everything_takes(
    found: Diagnosis, braked: Dataset, tmp_path: Path
) -> None:
    written = write_laws(found, tmp_path)
    assert [one.file for one in written.discovered] == ["law_left.py"]
    catalogue = catalogue_for([tmp_path / "law_left.py"])
    result = identify(prepare(Problem(braked, catalogue, ("law_left:left",))))
    value = result.effect_parameters["law_left"]["left"]["c1"].value
    assert value == pytest.approx(found.discovered[0].terms[0].value, rel=0.01)
    assert result.error.validate == pytest.approx(found.discovered[0].validate, rel=0.01)


def test_where_the_catalogue_explains_all_nothing_is_discovered() -> None:
    dataset = measured({"effect": "viscous_friction", "Fv": 0.1})
    found = find_missing_effects(among(FRICTIONS, dataset), discover=True)
    assert found.missing == ("viscous_friction",)
    assert found.discovered == ()


def test_without_anything_hidden_no_law_is_claimed() -> None:
    found = find_missing_effects(problem_of(measured()), discover=True)
    assert (found.missing, found.discovered) == ((), ())


def test_noise_of_the_encoders_is_not_searched_for_laws() -> None:
    left = Unexplained(Remainder.NO_PATTERN, error=0.02, noise_floor=0.01, depends_on=())
    assert something_remains(left)
    assert not something_remains(replace(left, encoders=0.015))
    assert something_remains(replace(left, encoders=0.015, what=Remainder.PATTERN))


def test_a_law_beside_a_known_effect_is_one_law_of_both_motors() -> None:
    dataset = measured({**BRAKED, "c": 0.01}, {"effect": "viscous_friction", "Fv": 0.1})
    found = find_missing_effects(among(FRICTIONS, dataset))
    assert found.missing == ("viscous_friction",)
    assert [(one.place, one.law) for one in found.discovered] == [("left", "law"), ("right", "law")]
    assert {one.terms[0].term for one in found.discovered} == {"sign(v)*abs(a)"}
    assert left_over_floor(found) < FLOOR


def test_a_viscous_friction_that_varies_with_the_position_has_no_false_name() -> None:
    """Once it was called viscous friction and friction that varies with the position, for sure."""
    hidden = {"effect": "position_dependent_viscous_friction", "joint": "left", "a": -0.1, "b": -0.15}
    found = find_missing_effects(problem_of(measured(hidden)))
    assert found.missing == ()
    (law,) = found.discovered
    assert [one.term for one in law.terms] == ["v*cos(q)", "v*sin(q)"]
    assert left_over_floor(found) < FLOOR


def test_what_no_formula_fits_is_added_as_measured(braked: Dataset, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("bench.diagnosis.discovery.with_laws.search_laws", lambda *_: None)
    found = find_missing_effects(among(FRICTIONS, braked))
    (law,) = found.discovered
    assert (law.place, law.law) == ("left", "measured_left")
    assert all(one.term.startswith("sign(v)*hat(a, ") for one in law.terms)
    assert law.formula == "sign(v)*table(a)"
    assert law.without is not None
    assert law.validate is not None
    assert law.validate < 0.3 * law.without
    (sentence,) = law_sentences(found.discovered)
    assert (
        "As measured, it is a smooth function of the acceleration that reverses with the direction"
        in sentence
    )
    assert {one.effect for one in found.ranking} == set(FRICTIONS)


def test_where_it_is_not_wanted_nothing_is_discovered(braked: Dataset) -> None:
    problem = among(FRICTIONS, braked)
    plain = find_missing_effects(problem, discover=False)
    assert plain.discovered == ()
    assert plain.ladder == diagnose_with_catalogue(problem).ladder


def test_a_page_of_a_discovered_law_is_drawn_and_drawn_again(
    found: Diagnosis, machine: Simulation, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """That the command finds it by itself is shown by the tutorial."""
    steps = import_module("bench.api.diagnose")
    monkeypatch.setattr(steps, "find_missing_effects", lambda *_, **__: found)
    runner = CliRunner()
    folder, out = tmp_path / "data", tmp_path / "out"
    out.mkdir()
    write_simulation(machine, folder)
    named = ["--apply", str(out / "model.json"), "--json", str(out / "found.json"), "-o", str(out / "page")]
    made = runner.invoke(diagnose_command, [str(folder), "-q", *named])
    assert made.exit_code == 0, made.output
    (law,) = json.loads((out / "found.json").read_text(encoding="utf-8"))["discovered"]
    assert law["file"] == "law_left.py"
    assert (out / "law_left.py").is_file()
    assert json.loads((out / "model.json").read_text(encoding="utf-8"))["effect_files"] == ["law_left.py"]
    again = compare(folder, out / "model.json")  # which names the file of its law
    assert again.comparison.error.validate == pytest.approx(law["error"]["validate"], rel=0.01)
    kept = read_run(out / "page")
    assert kept.diagnosis is not None
    assert [one.formula for one in kept.diagnosis.discovered] == [law["formula"]]
    assert "law_left" in kept.problem.catalogue
    page = (out / "page" / "report.html").read_text(encoding="utf-8")
    assert "which is not in the catalogue" in page
    assert "Laws that were found" in page
    assert "law, forwards" in page
