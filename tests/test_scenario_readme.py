"""The reference of scenario files stays in step with what the program accepts."""

import re
from dataclasses import MISSING, fields

import pytest

from bench.dataset.catalogue import catalogue_folder
from bench.scenario import tables as scenario_tables
from bench.scenario.scenario import TOLERANCES, load_scenario
from bench.truth.hidden import HIDDEN_EFFECTS

README = (catalogue_folder("scenarios") / "README.md").read_text()
TABLES = [
    scenario_tables.ScenarioTable,
    scenario_tables.Gains,
    scenario_tables.PayloadTable,
    scenario_tables.RecordingTable,
    scenario_tables.Design,
    scenario_tables.Controller,
    scenario_tables.Sensors,
    scenario_tables.Filter,
    scenario_tables.Hidden,
]


@pytest.mark.parametrize("table", TABLES, ids=lambda table: table.__name__)
def test_every_key_is_described(table):
    for key in table.model_fields:
        assert re.search(rf"`\[*{key}\W", README), key


def test_every_metric_and_its_meaning():
    for name, meaning in TOLERANCES.items():
        assert f"| `{name}` | {meaning} |" in README


def test_every_hidden_effect_its_parameters_and_their_defaults():
    tables = README.split("outside the catalogue")
    for name, kind in HIDDEN_EFFECTS.items():
        parameters = ", ".join(
            f"`{field.name}`" + ("" if field.default is MISSING else f" = {field.default:g}")
            for field in fields(kind)
            if field.name != "joint"
        )
        assert f"| `{name}` | {parameters} |" in tables[0 if kind.in_catalogue else 1], name
        assert kind.name == name
    assert list(HIDDEN_EFFECTS) == sorted(HIDDEN_EFFECTS)


def test_the_example_loads(tmp_path):
    example = README.split("```toml")[1].split("```")[0]
    path = tmp_path / "example.toml"
    path.write_text(example)
    assert load_scenario(path).robot.name == "five_bar"
