"""The laws of effects as their classes give them, and the page that tells them."""

from dataclasses import dataclass, replace
from io import StringIO

import pytest
from rich.console import Console

from bench.document.terminal.diagnosis import diagnosis_report
from bench.effects import CATALOGUE, ActuatorEffect, EffectParameter
from bench.identification.problem import Problem, problem_of
from bench.page.pages import diagnosis_page
from bench.page.parts import PageTable
from tests.report_kit import AGAIN, MISSING, dataset, diagnosis


@dataclass(frozen=True)
class Silent(ActuatorEffect):
    name = "silent"
    parameters = (EffectParameter("c", "{effort}"),)

    def torque(self, joint):
        return joint.velocity[:, None]


def laws_of(diagnosed, catalogue=CATALOGUE):
    page = diagnosis_page(diagnosed, Problem(dataset(), catalogue), AGAIN)
    (ranking,) = [one for one in page.sections if one.id == "ranking"]
    return [one for one in ranking.parts if isinstance(one, PageTable) and one.title.startswith("Laws")]


@pytest.mark.parametrize("name", CATALOGUE)
def test_every_effect_has_a_law_and_its_symbols(name):
    law, symbols = CATALOGUE[name].law, CATALOGUE[name].symbols
    assert law.endswith(".")
    assert symbols.endswith(".")
    for parameter in CATALOGUE[name].parameters:
        assert parameter.name in law + symbols
    for plain in ("Source", "Valid", "qd", "tau", "*", "^2"):
        assert plain not in law + symbols


def test_a_law_is_written_with_its_signs():
    law, symbols = CATALOGUE["stribeck_friction"].law, CATALOGUE["stribeck_friction"].symbols
    assert law.startswith("τ = (Fc + Fs exp(−|q̇/vs|^delta)) sign(q̇):")
    assert symbols.startswith(
        "Fc: Coulomb friction, Fs: what is added at the slowest motion, positive, N·m or N"
    )


def test_the_page_tells_the_laws_of_what_was_found():
    (table,) = laws_of(diagnosis())
    assert [[cell.text for cell in row.cells[:2]] for row in table.rows] == [
        ["viscous friction", "τ = Fv q̇: friction proportional to the velocity q̇, as of an oil film."]
    ]


def test_what_rounding_leaves_is_nothing():
    (first, *others) = diagnosis().ranking
    page = diagnosis_page(
        replace(diagnosis(), ranking=(replace(first, evidence=-1e-13), *others)),
        problem_of(dataset()),
        AGAIN,
    )
    (ranking,) = [one for one in page.sections if one.id == "ranking"]
    assert ranking.parts[0].rows[0].cells[2].text == "0.0"


def test_an_effect_that_tells_no_law_has_none():
    assert (Silent.law, Silent.symbols) == ("", "")
    found = replace(diagnosis(), missing=("silent",), ranking=(replace(MISSING, effect="silent"),))
    assert laws_of(found, {**CATALOGUE, "silent": Silent()}) == []


def test_a_change_of_sign_is_told_as_a_difference():
    found = diagnosis()
    first, *others = found.after.parameters
    turned = replace(
        found, after=replace(found.after, parameters=(replace(first, value=-first.value), *others))
    )
    console = Console(width=120, file=StringIO())
    diagnosis_report(turned, console)
    lines = console.file.getvalue().splitlines()
    start = next(i for i, line in enumerate(lines) if "before and after" in line and "parameters" in line)
    line = next(one for one in lines[start:] if first.name in one)
    assert f"{-2 * first.value:+.3g}" in line
    assert "%" not in line
