"""The site of the documentation: it builds without a warning, and asks no other machine for anything."""

import inspect
import json
import re
import subprocess
import sys
import tomllib
from dataclasses import fields

import pytest

LEFT = re.compile(r"<!-- (evaluation|trials|gains|speed|estimators|clean|peers|seen|outside|names) -->")
MOST_DECISIONS = 20
ASKED = re.compile(
    r'<(?:script|img|iframe)[^>]*src="(https?:)?//|<link[^>]*rel="?stylesheet[^>]*href="(https?:)?//'
)


@pytest.fixture(scope="module")
def site(project_root, tmp_path_factory):
    folder = tmp_path_factory.mktemp("site")
    arguments = [
        "build",
        "--strict",
        "--quiet",
        "-f",
        str(project_root / "docs" / "mkdocs.yml"),
        "-d",
        str(folder),
    ]
    done = subprocess.run(
        [sys.executable, "-W", "ignore", "-m", "properdocs", *arguments],
        capture_output=True,
        text=True,
        check=False,
        cwd=project_root,
    )
    assert done.returncode == 0, done.stderr
    return folder


def test_every_effect_has_its_page(site):
    from bench.effects import CATALOGUE

    assert {path.stem for path in (site / "atlas").glob("*.html")} == {*CATALOGUE, "index"}


def test_a_page_asks_nobody_for_anything(site):
    foreign = {path.name: ASKED.findall(path.read_text(encoding="utf-8")) for path in site.rglob("*.html")}
    assert {name: found for name, found in foreign.items() if found} == {}


def test_equations_are_drawn_by_the_browser_itself(site):
    start = (site / "index.html").read_text(encoding="utf-8")
    assert '<math xmlns="http://www.w3.org/1998/Math/MathML"' in start
    assert "arithmatex" not in start


def test_the_key_of_the_atlas_leads_to_every_effect_and_each_has_its_figure(site, project_root):
    from bench.effects import CATALOGUE
    from bench.residuals.look_alikes import QUESTION

    key = (site / "atlas" / "index.html").read_text(encoding="utf-8").partition("<h2")[2].partition("<h2")[0]
    questions = dict(enumerate(re.split(r"<strong>\d\. ", key)))
    for name, effect in CATALOGUE.items():
        assert effect.seen, f"{name} does not say how its error looks"
        for seen in effect.seen:
            assert f'href="{name}.html"' in questions[QUESTION[seen]], (
                f"{name} is not in question {QUESTION[seen]}"
            )
    assert {path.stem for path in (site / "atlas").glob("*.png")} == {*CATALOGUE}
    for name in CATALOGUE:
        text = (site / "atlas" / f"{name}.html").read_text(encoding="utf-8")
        assert "What it looks like" in text
        assert "Which robots can show it" in text


def test_no_table_of_a_page_is_left_to_be_made(site):
    pages = {path.name: path.read_text(encoding="utf-8") for path in site.rglob("*.html")}
    assert [name for name, text in pages.items() if LEFT.search(text)] == []
    assert "one effect: named first" in pages["trust.html"]


def test_schemas_say_what_is_checked(site, project_root):
    schemas = {
        path.stem: json.loads(path.read_text()) for path in (site / "reference/schemas").glob("*.json")
    }
    assert {*schemas} == {"robot", "dataset", "map", "scenario", "sweep"}
    content = tomllib.loads((project_root / "robots" / "five_bar" / "robot.toml").read_text())
    assert {*content} <= {*schemas["robot"]["properties"]}
    keys = (site / "reference" / "keys.html").read_text(encoding="utf-8")
    assert "<code>recordings[].use</code>" in keys
    assert "<code>payloads.NAME.mass</code>" in keys


def test_code_keeps_its_brackets_where_a_page_stands_elsewhere(site):
    text = (site / "reference" / "sweeps.html").read_text(encoding="utf-8")
    assert "[axes]" in re.sub(r"<[^>]+>", "", text)


def test_answers_have_the_keys_that_the_formats_name(project_root):
    from bench.diagnosis import as_json
    from bench.identification import model_json

    page = (project_root / "docs" / "pages" / "reference" / "formats.md").read_text(encoding="utf-8")
    for module, first in ((as_json, "answer = {"), (model_json, "answer = {")):
        code = inspect.getsource(module).split(first, 1)[1].split("\n    }\n", 1)[0]
        keys = re.findall(r'^        "(\w+)":', code, flags=re.MULTILINE)
        assert len(keys) > 8
        assert [key for key in keys if f"`{key}`" not in page] == []


def test_the_formats_name_every_field_of_the_decision_rule(project_root):
    from bench.identification.decision import DecisionRule

    page = (project_root / "docs" / "pages" / "reference" / "formats.md").read_text(encoding="utf-8")
    (row,) = (line for line in page.splitlines() if line.startswith("| `decision_rule` |"))
    names = [field.name for field in fields(DecisionRule)]
    assert len(names) <= MOST_DECISIONS
    assert re.findall(r"`(\w+)`", row.partition(";")[0])[1:] == names
    assert all(re.search(rf"\b{name}:\s", DecisionRule.__doc__) for name in names)


def test_the_formats_name_every_topic_of_the_tolerances(project_root):
    from bench.identification.tolerances import Tolerances

    page = (project_root / "docs" / "pages" / "reference" / "formats.md").read_text(encoding="utf-8")
    (row,) = (line for line in page.splitlines() if line.startswith("| `tolerances` |"))
    assert re.findall(r"`(\w+)`", row.partition(";")[0])[1:] == [field.name for field in fields(Tolerances)]


def test_a_notebook_holds_the_cells_of_its_script_and_what_they_print(site, project_root):
    for script in sorted((project_root / "docs" / "notebooks").glob("*.py")):
        book = json.loads((site / "notebooks" / f"{script.stem}.ipynb").read_text(encoding="utf-8"))
        assert book["nbformat"] == 4
        code = ["".join(cell["source"]) for cell in book["cells"] if cell["cell_type"] == "code"]
        text = script.read_text(encoding="utf-8")
        assert code
        assert all(cell in text for cell in code)
        kept = json.loads((script.parent / "outputs.json").read_text(encoding="utf-8"))[script.stem]
        shown = [
            "".join("".join(output["text"]) for output in cell["outputs"])
            for cell in book["cells"]
            if cell["cell_type"] == "code"
        ]
        assert shown == kept
