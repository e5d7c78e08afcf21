"""What the README shows is run."""

import re

import pytest

from bench.cli import main


@pytest.fixture(scope="module")
def blocks(project_root):
    text = (project_root / "README.md").read_text(encoding="utf-8")
    return re.findall(r"```(\w+)\n(.*?)```", text, flags=re.DOTALL)


def test_the_python_example_runs_on_what_the_demo_leaves(blocks, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    assert main(["demo"]) == 0
    shown = capsys.readouterr().out
    assert shown.rstrip().splitlines()[-1].startswith("Open results/demo/")
    example, twin = [code for language, code in blocks if language == "python"]
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


def test_pictures_and_links_of_the_readme_are_there(project_root):
    text = (project_root / "README.md").read_text(encoding="utf-8")
    targets = [t for t in re.findall(r"\]\(([^)#]+)\)", text) if not t.startswith("http")]
    assert targets
    assert [t for t in targets if not (project_root / t).exists()] == []
