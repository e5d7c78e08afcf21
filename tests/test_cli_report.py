"""`bench report`, and the reports that other commands write: by themselves, and again from their folders."""

import json
import re

import pytest

from bench.cli import main
from bench.dataset.dataset import load_dataset
from bench.page.folder import read_run
from docs.pictures.browser import opened, scrolled
from tests.made_once import made_once

DATE_AND_COMMANDS = re.compile(r"<footer>.*?</footer>|<pre tabindex.*?</pre>", flags=re.DOTALL)


@pytest.fixture(scope="module")
def runs(diagnosed_arm, tmp_path_factory):
    """Measurements of an arm with friction at one joint, diagnosed, identified, and compared with a model."""

    def make(_):
        data, model = str(diagnosed_arm / "data"), diagnosed_arm / "identified" / "model.json"
        with_friction = ["--with", "viscous_friction:shoulder"]
        assert main(["identify", data, *with_friction, "-o", str(model.parent)]) == 0
        assert main(["compare", data, "--model", str(model), "-o", str(diagnosed_arm / "compared")]) == 0

    made_once(tmp_path_factory, "runs_of_the_arm", make)
    return diagnosed_arm


def essence(path):
    """A page without its date and the commands that gave it."""
    return DATE_AND_COMMANDS.sub("", path.read_text(encoding="utf-8"))


@pytest.mark.parametrize(
    ("name", "title"),
    [
        ("found", "What the model of two_link is missing"),
        ("identified", "Drive gains and parameters of two_link"),
        ("compared", "Where a model of two_link fails"),
    ],
)
def test_every_run_writes_its_page(runs, name, title):
    text = (runs / name / "report.html").read_text(encoding="utf-8")
    assert f"<h1>{title}</h1>" in text
    assert len(text.encode()) < 3e6
    assert "bench report" in text


def test_a_diagnosis_says_what_was_hidden(runs):
    assert "Viscous friction at shoulder is missing" in (runs / "found" / "report.html").read_text()


@pytest.mark.parametrize("name", ["found", "identified", "compared"])
def test_a_page_is_written_again_from_its_folder(runs, name, tmp_path):
    again = tmp_path / "again.html"
    assert main(["report", str(runs / name), "-o", str(again)]) == 0
    assert essence(again) == essence(runs / name / "report.html")


def test_a_folder_gives_back_the_numbers_that_it_kept(runs):
    kept = read_run(runs / "found")
    assert kept.diagnosis.missing == ("viscous_friction",)
    model = json.loads((runs / "found" / "model_after.json").read_text())
    gain = kept.after.drive_gains["shoulder"]
    assert (gain.value, gain.std) == tuple(model["drive_gains"]["shoulder"][key] for key in ("value", "std"))
    assert kept.after.error.validate == pytest.approx(model["error"]["validate"], rel=1e-6)


def test_a_model_file_is_shown_beside_the_recordings_that_it_is_from(runs, tmp_path, capsys):
    model = runs / "identified" / "model.json"
    assert main(["report", str(model), "-o", str(tmp_path)]) == 0  # a folder: report.html in it
    text = (tmp_path / "report.html").read_text()
    assert "Applied as it is" in text
    *_, wrote, step = capsys.readouterr().out.splitlines()
    assert wrote == f"wrote {tmp_path / 'report.html'} (report)"
    assert step.startswith(f"next: bench export {model} --to mjcf -o {model.with_suffix('.xml')}    ")


@pytest.mark.parametrize("name", ["found", "identified", "compared"])
def test_the_robot_stands_in_every_report(runs, name):
    text = (runs / name / "report.html").read_text(encoding="utf-8")
    assert "window.Machine =" in text
    figures = re.search(r'<script type="application/json" id="figures">(.*?)</script>', text, flags=re.DOTALL)
    (robot,) = [one for one in json.loads(figures.group(1)).values() if one["type"] == "mechanism"]
    frames = len(robot["data"]["time"])
    assert 60 <= frames <= 150
    assert {len(bar["from"]) for bar in robot["data"]["bars"]} == {3, 3 * frames}
    assert len(json.dumps(robot)) < 3e5


def test_the_robot_follows_the_cursor_of_its_recording_alone(runs, chromium):
    page = scrolled(opened(chromium, runs / "found" / "report.html"))
    section = page.locator("#currents")
    before = section.locator("output").inner_text()
    section.locator(".charts svg[role=img]").first.hover()
    there = section.locator("output").inner_text()
    assert there != before
    recording = section.locator("fieldset", has_text="Recording").locator("select")
    now = recording.evaluate("(one) => one.selectedIndex")
    recording.select_option(index=1 - now if now < 2 else 0)
    section.locator(".charts svg[role=img]").first.hover(position={"x": 120, "y": 60})
    assert section.locator("output").inner_text() == there
    page.close()


def test_a_dataset_is_diagnosed(runs, tmp_path, capsys):
    assert main(["report", str(runs / "data"), "-o", str(tmp_path / "page.html")]) == 0
    step = capsys.readouterr().out.splitlines()[-1]
    assert step.startswith(f"next: bench diagnose {runs / 'data'} --apply model.json    ")
    assert "Viscous friction at shoulder is missing" in (tmp_path / "page.html").read_text()


@pytest.mark.parametrize(
    ("arguments", "culprit"),
    [
        (["nowhere"], "nowhere"),
        (["{runs}"], "no dataset.toml"),
        (["{runs}/identified", "--with", "viscous_friction"], "--with"),
        (["{runs}/data", "--data", "{runs}/data"], "--data"),
        (["{runs}/data.truth.json"], "data.truth.json"),
        (["{runs}/identified/model.json", "--data", "elsewhere"], "elsewhere"),
        (["{runs}/data", "--border", "x"], "--border"),
    ],
)
def test_bad_input_is_one_line_and_exit_code_2(runs, arguments, culprit, capsys, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert main(["report", *(one.format(runs=runs) for one in arguments)]) == 2
    out, err = capsys.readouterr()
    assert out == ""
    assert err.count("\n") == 1
    assert culprit in err
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("damage", ["{", "[]", '{"format": 1}', '{"format": 1, "run": {"effects": 3}}'])
def test_a_damaged_folder_is_named(runs, damage, tmp_path, capsys):
    (tmp_path / "report.json").write_text(damage)
    assert main(["report", str(tmp_path), "-o", str(tmp_path / "page.html")]) == 2
    assert str(tmp_path / "report.json") in capsys.readouterr().err


def test_a_dataset_that_has_gone_is_named(runs, tmp_path, capsys):
    content = json.loads((runs / "identified" / "report.json").read_text())
    (tmp_path / "report.json").write_text(json.dumps(content | {"dataset": "gone"}))
    assert main(["report", str(tmp_path), "-o", str(tmp_path / "page.html")]) == 2
    assert "gone" in capsys.readouterr().err


def test_the_dataset_s_path_is_kept_relative_to_the_folder(runs):
    content = json.loads((runs / "identified" / "report.json").read_text())
    assert content["dataset"] == "../data"
    assert load_dataset(runs / "identified" / content["dataset"]).robot.name == "two_link"
