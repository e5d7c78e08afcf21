"""What the README shows is run."""

import json
import re
import statistics

import pyarrow.parquet as pq
import pytest

from bench.basics.sentence import in_percent
from bench.benchmarks.trust.evaluation import read_evaluation
from bench.benchmarks.trust.overview import readme_block, with_block
from bench.benchmarks.trust.run import TABLE
from bench.cli import main
from bench.studies.trial.summary import summarised
from bench.studies.trial.target import TargetFigure
from docs.made.readme_commands import FILE, commands_of


@pytest.fixture(scope="module")
def blocks(project_root):
    text = (project_root / "README.md").read_text(encoding="utf-8")
    return re.findall(r"```(\w+)\n(.*?)```", text, flags=re.DOTALL)


def test_the_python_example_runs_on_what_the_demo_leaves(blocks, project_root, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    assert main(["demo"]) == 0
    shown = capsys.readouterr().out
    assert shown.rstrip().splitlines()[-1].startswith("next: bench open results/demo/dataset ")
    quoted = gains_in((project_root / "README.md").read_text(encoding="utf-8"))
    assert list(quoted) == ["left", "right"]
    for joint, (value, std) in gains_in(shown).items():
        assert quoted[joint] == (pytest.approx(value, abs=0.1 * std), pytest.approx(std, rel=0.1))
    (example,) = [code for language, code in blocks if language == "python"]
    (reference,) = python_of(project_root / "docs" / "pages" / "reference" / "python.md")
    (twin,) = python_of(project_root / "docs" / "pages" / "howto" / "export.md")
    assert reference == example
    assert len(example.strip().splitlines()) <= 10 + 1  # ten lines, one of them blank
    names: dict[str, object] = {}
    exec(compile(example, "README.md", "exec"), names)
    printed = capsys.readouterr().out
    assert "left: 3.30" in printed
    assert "right: 2.76" in printed
    assert names["where"].recordings[0].error.shape[1] == 2
    assert set(names["table"]["kind"]) == {"drive gain", "parameter"}
    assert names["diagnosis"].missing == ()
    model = "results/demo/model.json"
    assert main(["export", model, "--to", "mjcf", "-o", "five_bar_identified.xml"]) == 0
    exec(compile(twin, "README.md", "exec"), names)
    assert names["twin"].data.time >= 2.0


def gains_in(text):
    rows = re.findall(r"^(left|right) +([\d.]+) ± ([\d.]+) .* σ$", text, flags=re.MULTILINE)
    return {joint: (float(value), float(std)) for joint, value, std in rows}


def python_of(page):
    return re.findall(r"```python\n(.*?)```", page.read_text(encoding="utf-8"), flags=re.DOTALL)


def test_pictures_and_links_of_the_readme_are_there(project_root):
    text = (project_root / "README.md").read_text(encoding="utf-8")
    targets = [t for t in re.findall(r"\]\(([^)#]+)\)", text) if not t.startswith("http")]
    assert targets
    assert [t for t in targets if not (project_root / t).exists()] == []


def test_figures_of_the_readme_are_those_of_the_results(project_root):
    text = (project_root / "README.md").read_text(encoding="utf-8")
    table = project_root / "results" / "trust" / TABLE
    if table.is_file():
        assert with_block(text, readme_block(read_evaluation(table))) == text
        return
    (heads,) = re.findall(r"^\| \|( five-bar .*)\|$\n\|---", text, flags=re.MULTILINE)[:1]
    robots = [
        {"five-bar": "five_bar", "hexapod": "stewart", "3-RRR": "three_rrr"}.get(r, r.lower())
        for r in map(str.strip, heads.split("|"))
    ]
    for words, figure in (
        ("one hidden effect: named first", TargetFigure.ONE_FIRST),
        ("nothing hidden: any alarm", TargetFigure.ALARM),
    ):
        (row,) = re.findall(rf"^\| {words} \|(.*)\|$", text, flags=re.MULTILINE)
        for robot, cell in zip(robots, map(str.strip, row.split("|")), strict=True):
            if not cell:
                continue
            rows = pq.read_table(project_root / "results" / "trial" / f"{robot}.parquet").to_pylist()
            (target,) = (one for one in summarised(robot, rows).targets if one.figure == figure)
            assert cell == f"{target.share.count} of {target.share.of}"
    (row,) = re.findall(r"^\| largest gain error \|(.*)\|$", text, flags=re.MULTILINE)
    found = dict(zip(robots, map(str.strip, row.split("|")), strict=True))
    for robot, cell in found.items():
        seeds = robot if robot in ("five_bar", "delta", "dualv") else "robots"
        table = pq.read_table(project_root / "results" / "montecarlo" / f"{seeds}_seeds.parquet").to_pylist()
        errors = [one["gain_error"] for one in table if one["scenario"] == robot]
        assert cell == f"{100 * statistics.median(errors):.3f} %"


def test_speeds_of_the_readme_are_those_last_measured(project_root):
    text = (project_root / "README.md").read_text(encoding="utf-8")
    rows = re.findall(r"^\| (.+?) \| ([\d.]+) (\w+) \| ≤ [\d.]+ \w+ \|$", text, flags=re.MULTILINE)
    assert len(rows) > 10
    last = {}
    history = project_root / "results" / "speed" / "history.jsonl"
    for line in history.read_text(encoding="utf-8").splitlines():
        record = json.loads(line)
        last |= {name: (f"{value:.3g}", record["units"][name]) for name, value in record["figures"].items()}
    assert {name: (value, unit) for name, value, unit in rows} == {row[0]: last[row[0]] for row in rows}


def test_what_the_readme_says_of_five_commands_is_what_they_gave(project_root):
    text = (project_root / "README.md").read_text(encoding="utf-8")
    kept = json.loads((project_root / "results" / "excite" / FILE).read_text(encoding="utf-8"))
    assert tuple(kept["commands"]) == commands_of(text)
    assert [command.split()[1] for command in kept["commands"]] == [
        "excite",
        "simulate",
        "identify",
        "export",
        "replay",
    ]
    quoted = {name: in_percent(share) for name, share in kept["off"].items()}
    assert f"(here {quoted['twin']} of the current off, the model itself {quoted['model']})" in " ".join(
        text.split()
    )
    for gain in kept["gains"].values():
        assert gain["found"] == pytest.approx(gain["expected"], rel=0.2)
    assert kept["better"] > 3.0
