"""An answer that was worked out reaches its reader, whatever becomes of words, figures, pages and files."""

import errno
import json
from pathlib import Path

import pytest

from bench.basics.errors import BenchError, FaultsError
from bench.basics.files import atomic
from bench.cli import main
from bench.cli.last_lines import take_all
from bench.dataset.dataset import load_dataset
from bench.identification.model_file import load_model
from bench.truth.dataset import write_simulation
from tests.diagnosis_kit import found_diagnosis
from tests.shown import identification_of


class DefectError(Exception):
    """Something that nobody thought of."""


def defective(*_, **__):
    raise DefectError("a wording that fails")


@pytest.fixture(scope="module")
def folder(five_bar_simulation, tmp_path_factory):
    made = tmp_path_factory.mktemp("kept") / "data"
    write_simulation(five_bar_simulation, made)
    return made


@pytest.fixture
def asked(folder, tmp_path, monkeypatch):
    """Commands on an answer that is made by hand, in a folder of their own."""
    dataset = load_dataset(folder)
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr("bench.api.diagnose.diagnose", lambda *_, **__: found_diagnosis(dataset))
    monkeypatch.setattr("bench.api.identify.identify", lambda *_, **__: identification_of(dataset))
    return lambda command, *options: main([command, str(folder), *map(str, options)])


WORDS = [
    "bench.diagnosis.as_json.summary_sentences",
    "bench.diagnosis.as_json.reason",
    "bench.diagnosis.as_json.unexplained_words",
    "bench.identification.result.note",
    "bench.document.terminal.diagnosis.summary_sentences",
    "bench.document.figures.diagnosis.write_diagnosis_figures",
    "bench.page.write.diagnosis_page",
    "bench.page.write.page_data",
]


@pytest.mark.parametrize("word", WORDS)
def test_no_wording_and_no_drawing_costs_a_diagnosis(word, asked, monkeypatch, capsys):
    monkeypatch.setattr(word, defective)
    with pytest.raises((DefectError, ExceptionGroup)):
        asked("diagnose", "--json", "answer.json", "--apply", "model.json", "-o", "out")
    answer = json.loads(Path("answer.json").read_text())
    assert answer["missing"] == ["viscous_friction"]
    assert answer["ranking"][0]["reason"] == {"because": "explains", "names": [], "doubts": []}
    assert answer["after"]["drive_gains"]["left"]["value"] == 3.63
    assert load_model("model.json").model.drive_gains["left"].value == 3.63
    said = capsys.readouterr().out
    assert "viscous_friction" in said or "Viscous friction" in said
    assert "wrote answer.json (diagnosis)" in said
    assert load_model("out/model_after.json").model.drive_gains["left"].value == 3.63
    if word != "bench.identification.result.note":  # of a model's notes, before which it is written
        kept = json.loads(Path("out/report.json").read_text())["diagnosis"]
        assert kept["missing"] == ["viscous_friction"]


def test_where_the_report_fails_the_verdict_is_printed_as_it_is(asked, monkeypatch, capsys):
    monkeypatch.setattr("bench.document.terminal.diagnosis.ladder_table", defective)
    with pytest.raises(DefectError, match="a wording that fails"):
        asked("diagnose", "--quiet", "--json", "-")
    answer = json.loads(capsys.readouterr().out)
    assert answer["missing"] == ["viscous_friction"]
    with pytest.raises(DefectError):
        asked("diagnose")
    said = capsys.readouterr().out
    verdict = json.loads(said[said.index("\n{") : said.index("\n}") + 2])
    assert verdict["missing"] == ["viscous_friction"]
    assert verdict["drive_gains"]["left"]["value"] == 3.63


@pytest.mark.parametrize("word", ["bench.identification.result.note", "bench.page.write.identification_page"])
def test_nor_an_identification(word, asked, monkeypatch, capsys):
    monkeypatch.setattr(word, defective)
    with pytest.raises((DefectError, ExceptionGroup)):
        asked("identify", "--json", "model.json", "-o", "out")
    assert load_model("model.json").model.drive_gains["left"].value == pytest.approx(3.3)
    assert "wrote model.json (model)" in capsys.readouterr().out


def fails(number):
    def fail(path, *_, **__):
        raise OSError(number, "as the system says", str(path))

    return fail


@pytest.mark.parametrize("command", ["diagnose", "identify"])
@pytest.mark.parametrize("gone", [True, False])
def test_a_file_that_cannot_be_written_after_all_leaves_the_verdict_on_the_terminal(
    command, gone, asked, monkeypatch, capsys
):
    made = atomic.Path.replace if gone else atomic.Path.write_text
    name, number = ("replace", errno.ENOENT) if gone else ("write_text", errno.ENOSPC)
    assert callable(made)
    monkeypatch.setattr(atomic.Path, name, fails(number))
    assert asked(command, "--json", "answer.json") == 2
    out, err = capsys.readouterr()
    assert err == "bench: cannot write answer.json: as the system says\n"
    assert "left" in out
    assert list(Path().iterdir()) == []


def test_a_full_device_is_told_in_one_line(asked, capsys):
    assert asked("diagnose", "--json", "/dev/full") == 2
    out, err = capsys.readouterr()
    assert err == "bench: cannot write /dev/full: No space left on device\n"
    assert "Viscous friction" in out


@pytest.mark.parametrize(
    ("options", "said"),
    [
        (["--json", "out"], "--json out: cannot be written: it is a folder"),
        (["--apply", "out"], "--apply out: cannot be written: it is a folder"),
        (["--json", "/proc/answer.json"], "--json /proc/answer.json: cannot be written: "),
        (["-o", "/proc/out/more"], "-o /proc/out/more: "),
        (["--json", "a.json", "--apply", "./a.json"], "--json names the same file"),
    ],
)
def test_paths_are_tried_before_the_work_begins(options, said, folder, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "out").mkdir()
    monkeypatch.setattr("bench.dataset.dataset.load_dataset", defective)
    assert main(["diagnose", str(folder), *options]) == 2
    out, err = capsys.readouterr()
    assert (out, err.count("\n")) == ("", 1)
    assert said in err
    assert [path.name for path in tmp_path.rglob("*")] == ["out"]


def test_every_step_is_taken_and_no_error_is_lost():
    def user(text):
        def step():
            raise BenchError(text)

        return step

    taken = []
    with pytest.raises(BenchError, match=r"^a$"):
        take_all(user("a"), lambda: taken.append(1))
    assert taken == [1]
    with pytest.raises(FaultsError) as told:
        take_all(user("a"), lambda: None, user("b"))
    assert told.value.lines == ("a", "b")
    with pytest.raises(ExceptionGroup) as both:
        take_all(defective, user("b"))
    assert [type(error) for error in both.value.exceptions] == [DefectError, BenchError]
    with pytest.raises(KeyboardInterrupt):
        take_all(lambda: (_ for _ in ()).throw(KeyboardInterrupt), lambda: taken.append(2))
    assert taken == [1]
