"""Models side by side: each with its own errors and gains, and what is different between them."""

import json
import math
from dataclasses import replace
from pathlib import Path

import pytest
from rich.console import Console

from bench.cli import main
from bench.dataset.robot import load_robot
from bench.document.side_by_side import changed_sentences, compared_errors_table, compared_gains_table
from bench.document.terminal.identification import side_by_side_report
from bench.identification.result import Quantity
from bench.residuals.side_by_side import (
    ComparedModel,
    SideBySide,
    distinct_names,
    effect_places,
    interval,
    moved_parameters,
    side_by_side_json,
)
from tests.shown import dataset_of, identification_of


@pytest.fixture(scope="module")
def found():
    data = dataset_of(load_robot("five_bar"))
    before, after = identification_of(data), identification_of(data, effects=True)
    left = replace(after.drive_gains["left"], value=3.63)
    far = replace(after.parameters[0], value=after.parameters[0].value + 5.0 * after.parameters[0].std)
    after = replace(
        after,
        drive_gains={**after.drive_gains, "left": left},
        parameters=(far, *after.parameters[1:]),
        error=replace(after.error, identify=0.001, validate=0.002),
    )
    return SideBySide("five_bar", (ComparedModel("a.json", before), ComparedModel("b.json", after)))


def test_names_are_as_short_as_tells_files_apart():
    assert distinct_names([Path("x/a.json"), Path("y/b.json")]) == ["x/a.json", "y/b.json"]
    assert distinct_names([Path("a.json"), Path("b.json")]) == ["a.json", "b.json"]
    assert distinct_names([Path("r/1/m.json"), Path("r/2/m.json")]) == ["1/m.json", "2/m.json"]
    assert distinct_names([Path("m.json"), Path("r/m.json")]) == ["m.json", "r/m.json"]


def test_an_interval_is_two_deviations_to_either_side_and_a_given_value_has_none():
    assert interval(Quantity(3.0, 0.1, "A")) == pytest.approx((2.804, 3.196), abs=1e-5)
    assert interval(Quantity(3.0, 0.0, "A")) is None
    assert interval(Quantity(3.0, math.inf, "A")) is None


def test_what_changed_is_said(found):
    sentences = changed_sentences(found)
    joined = "\n".join(sentences)
    for effect in effect_places(found.models[1].model):
        assert effect.partition(":")[0].replace("_", " ").replace("coulomb", "Coulomb") in sentences[0]
    assert "b.json: error on recordings fitted" in joined
    assert "→ 0.200 %" in joined
    assert "drive gain of left" in joined
    assert "3.63" in joined
    assert f"1 of {len(found.models[1].model.parameters)} base parameters" in joined
    assert "another rate" not in joined
    first, other = found.models
    lacking = "\n".join(changed_sentences(SideBySide("five_bar", (other, first))))
    assert "a.json lacks" in lacking


def test_the_same_model_has_nothing_to_tell(found):
    first = found.models[0]
    again = changed_sentences(SideBySide("five_bar", (first, ComparedModel("c.json", first.model))))
    assert again[0] == "c.json has the same effects, beside a.json"
    assert not [one for one in again if "gain" in one or "parameters" in one]
    assert moved_parameters(first.model, first.model) == []


def test_other_filters_are_told(found):
    first = found.models[0]
    other = replace(first.model, settings=replace(first.model.settings, decimation=7))
    said = changed_sentences(SideBySide("five_bar", (first, ComparedModel("c.json", other))))
    assert "another rate or with other filters" in said[-1]


def test_the_tables_have_a_column_a_model(found):
    errors, gains = compared_errors_table(found), compared_gains_table(found)
    assert [column.header for column in errors.columns] == ["error", "a.json", "b.json"]
    assert len({len(column.cells) for column in errors.columns}) == 1
    assert [column.header for column in gains.columns] == ["drive gain", "a.json", "b.json", "unit"]
    assert gains.columns[2].cells[0].startswith("3.63")
    console = Console(width=80, record=True, file=None, quiet=False)
    with console.capture() as printed:
        side_by_side_report(found, changed_sentences(found), console)
    assert "What changed" in printed.get()
    answer = json.loads(json.dumps(side_by_side_json(found, ["x"]), allow_nan=False))
    assert answer["models"][1]["drive_gains"]["left"]["interval"][0] < 3.63
    assert answer["changed"] == ["x"]


def test_what_does_not_go_together_is_refused(tmp_path, capsys):
    assert (
        main(["compare", str(tmp_path), "--model", "a.json", "--model", "b.json", "-o", str(tmp_path / "x")])
        == 2
    )
    assert "-o needs a single model" in capsys.readouterr().err
