"""The reference of scenario files stays in step with what the program accepts."""

import re
import runpy

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


def test_the_tables_of_effects_are_made_from_their_classes(project_root):
    made = runpy.run_path(str(project_root / "docs" / "made" / "readme_tables.py"))["made"]()
    for path, text in made.items():
        assert path.read_text(encoding="utf-8") == text, "python docs/made/readme_tables.py"
    assert list(HIDDEN_EFFECTS) == sorted(HIDDEN_EFFECTS)
    assert all(kind.law and kind.name == name for name, kind in HIDDEN_EFFECTS.items())


def test_the_example_loads(tmp_path):
    example = README.split("```toml")[1].split("```")[0]
    path = tmp_path / "example.toml"
    path.write_text(example)
    assert load_scenario(path).robot.name == "five_bar"
