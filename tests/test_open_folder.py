"""What lies in an opened folder: datasets, logs, robots, results and models, wherever they stand."""

import re
import shutil

import pytest

from bench.basics.errors import BenchError
from bench.dataset.catalogue import built_in_robots
from bench.dataset.logs.log_file import read_log
from bench.local.folder import LOGS, Folder
from bench.local.steps import command_of


def test_everything_is_found_for_what_it_is(tmp_path):
    for path in (
        "log.csv",
        "notes.md",
        "more/log.mat",
        "data/dataset.toml",
        "data/free.csv",
        "data.results/1-compare/report.json",
        "data.results/1-compare/series.parquet",
        "data.results/1-compare.json",
        "data.results/model-3.json",
        "data.results/2-diagnosis-model.json",
        ".hidden/log.csv",
    ):
        (tmp_path / path).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / path).write_text("")
    shutil.copytree(built_in_robots()["five_bar"], tmp_path / "arm")
    for name, text in (("mine.xml", "<!-- CAD --><mujoco/>"), ("other.xml", "<robot/>")):
        (tmp_path / name).write_text(text)
    found = Folder(tmp_path).look()
    assert found.mjcfs == ["mine.xml"]
    assert found.datasets == ["data"]
    assert found.logs == ["log.csv", "more/log.mat"]
    assert found.sizes == {"log.csv": 0, "more/log.mat": 0}
    assert found.runs == ["data.results/1-compare"]
    assert found.models == ["data.results/2-diagnosis-model.json", "data.results/model-3.json"]
    assert set(found.robots) == {*built_in_robots(), "arm"}
    assert not found.cut


def test_a_dataset_that_is_opened_itself_has_its_results_inside(tmp_path):
    (tmp_path / "dataset.toml").write_text("")
    (tmp_path / "results").mkdir()
    (tmp_path / "results" / "model-1.json").write_text("")
    found = Folder(tmp_path).look()
    assert (found.datasets, found.models) == (["."], ["results/model-1.json"])


def test_a_folder_that_is_called_results_is_a_folder_like_any_other(tmp_path):
    folder = tmp_path / "results"
    folder.mkdir()
    (folder / "log.csv").write_text("")
    assert Folder(folder).look().logs == ["log.csv"]


def test_a_robot_elsewhere_is_offered_where_the_command_names_it(tmp_path, monkeypatch):
    shutil.copytree(built_in_robots()["five_bar"], tmp_path / "arm")
    (tmp_path / "opened").mkdir()
    monkeypatch.chdir(tmp_path)
    folder = Folder(tmp_path / "opened", (tmp_path / "arm",))
    assert str(tmp_path / "arm") in folder.look().robots
    assert folder.robot(str(tmp_path / "arm")) == "arm"


def test_a_folder_of_very_many_files_is_cut_and_says_so(tmp_path, monkeypatch):
    monkeypatch.setattr("bench.local.folder.MANY", 3)
    for name in "abcde":
        (tmp_path / name).mkdir()
    assert Folder(tmp_path).look().cut


def test_every_kind_of_log_that_an_import_reads_is_offered(tmp_path):
    with pytest.raises(BenchError) as refused:
        read_log(tmp_path / "log.xyz")
    kinds = re.search(r"a log is one of (.*), or the folder", str(refused.value))
    assert kinds is not None
    assert set(LOGS) == set(kinds.group(1).split(", "))


def test_a_new_dataset_gets_a_name_that_nothing_has(tmp_path):
    folder = Folder(tmp_path)
    assert folder.free("my_data") == "my_data"
    (tmp_path / "my_data").mkdir()
    (tmp_path / "my_data_2.results").mkdir()
    assert folder.free("my_data") == "my_data_3"
    (tmp_path / "log.csv").write_text("t\n0\n")
    asked = {"step": "import", "log": "log.csv", "robot": "five_bar", "columns": {}, "fresh": True}
    with pytest.raises(BenchError, match="my_data: is there already"):
        command_of(folder, {**asked, "dataset": "my_data"})
    assert command_of(folder, {**asked, "dataset": "my_data_3"}).line.endswith("my_data_3")
    assert command_of(folder, {**asked, "dataset": "my_data", "fresh": False}).line.endswith("my_data")


@pytest.mark.parametrize(
    ("stem", "name"),
    [
        ("run@1 kHz", "run_1 kHz"),
        ("Größe ß", "Größe ß"),
        ("-o", "log-o"),
        ("<b>$(touch x)\n", "_b__(touch x)_"),
        ("x" * 300, "x" * 120),
        (" .", "log"),
    ],
)
def test_a_recording_has_a_plain_name_whatever_its_log_is_called(stem, name, tmp_path):
    folder = Folder(tmp_path)
    assert folder.name(folder.cleaned(stem)) == name
