"""What `bench open` runs: the commands themselves, which can be cancelled, killed and watched by several browsers."""

import json
import os
import shlex
import signal
import sys
import time

import pytest

from bench.cli import main
from bench.local.folder import Folder
from bench.local.steps import command_of
from tests.open_kit import opened, short_dataset, write_log

LEFT = "viscous_friction:left"


@pytest.fixture(scope="module")
def root(tmp_path_factory):
    """A folder with a dataset, and the same recordings as logs of other units and names."""
    folder = tmp_path_factory.mktemp("opened")
    data = short_dataset(folder / "data")
    for name in ("free", "held"):
        write_log(folder / f"{name}.csv", data, f"{name}.csv")
    return folder


@pytest.fixture(scope="module")
def site(root):
    with opened(root, cwd=root) as one:
        yield one


def same_again(line, written, folder, monkeypatch):
    """Give the command that the page shows in a shell, with another name for what it writes; both as JSON."""
    before = json.loads((folder / written).read_text())
    again = f"again-{written.rpartition('/')[2]}"
    words = [again if word == written else word for word in shlex.split(line)]
    words = words[: words.index("-o")] if "-o" in words else words
    monkeypatch.chdir(folder)
    assert words[0] == "bench"
    assert main(words[1:]) == 0
    return before, json.loads((folder / again).read_text())


def test_a_log_becomes_a_recording_by_the_command_that_is_shown(site, root, monkeypatch):
    look = site.post("api/look/columns", {"log": "free.csv", "robot": "five_bar"}).json
    assert {target: one["column"] for target, one in look["guesses"].items()} == {
        "time": "t_ms",
        "position.left": "q_left",
        "position.right": "q_right",
        "current.left": "i_left",
        "current.right": "i_right",
    }
    columns = {target: one["column"] for target, one in look["guesses"].items()}
    asked = {"log": "free.csv", "robot": "five_bar", "columns": columns, "scale": {"time": "ms"}}
    found = site.post("api/look/checks", asked).json
    problems = {target: one["problems"] for target, one in found.items() if not one["ok"]}
    assert {target: [one["remedy"] for one in rows] for target, rows in problems.items()} == {
        "position.left": [{"unit": "deg"}],
        "position.right": [{"unit": "deg"}],
    }
    asked["scale"] |= {"position.left": "deg", "position.right": "deg"}
    assert all(one["ok"] for one in site.post("api/look/checks", asked).json.values())
    job = site.run({"step": "import", **asked, "dataset": "mine", "payload": "", "use": "identify"})
    assert job["state"] == "done"
    again = [word if word != "mine" else "mine_again" for word in shlex.split(job["line"])]
    monkeypatch.chdir(root)
    assert main(again[1:]) == 0
    for name in ("free.csv", "dataset.toml"):
        assert (root / "mine" / name).read_bytes() == (root / "mine_again" / name).read_bytes()


def test_what_an_import_refuses_is_said(site):
    asked = {
        "step": "import",
        "log": "free.csv",
        "robot": "five_bar",
        "dataset": "no",
        "columns": {"time": "t_ms"},
    }
    job = site.run(asked)
    assert job["state"] == "refused"
    assert "nothing is mapped to position.left" in job["error"]


def test_a_tick_is_the_model_that_identify_gives(site, root, monkeypatch):
    job = site.run({"step": "identify", "dataset": "data", "effects": [LEFT]})
    assert job["state"] == "done"
    ours, shell = same_again(job["line"], job["files"]["model"], root, monkeypatch)
    assert ours == shell
    assert ours["effect_parameters"]["viscous_friction"]["left"]["Fv"]["value"] == pytest.approx(0.3, rel=0.1)


def test_a_model_is_exported_beside_the_results(site, root):
    model = site.run({"step": "identify", "dataset": "data", "effects": [LEFT]})["files"]["model"]
    job = site.run({"step": "export", "dataset": "data", "model": model, "form": "csv"})
    assert job["state"] == "done"
    assert job["files"]["exported"] == model.replace(".json", ".csv")
    assert b"drive gain,left," in site.get(f"files/{job['files']['exported']}").body
    mjcf = site.run({"step": "export", "dataset": "data", "model": model, "form": "mjcf"})
    assert "the identified base parameters" in mjcf["output"]
    assert json.loads((root / mjcf["files"]["twin"]).read_text())["robot"] == "five_bar"
    loops = site.run({"step": "export", "dataset": "data", "model": model, "form": "urdf"})
    assert loops["state"] == "refused"
    assert "no loops" in loops["error"]


def test_results_are_told_in_order_of_time(site, root):
    asked = {"step": "identify", "dataset": "data", "effects": []}
    models = [site.run(asked)["files"]["model"] for _ in range(2)]
    for path, time_written in zip(models, (2e9, 1e9), strict=True):
        os.utime(root / path, (time_written, time_written))
    told = [one["path"] for one in site.get("api/folder").json["runs"]]
    assert (told[0], told[-1]) == (models[1], models[0])


def test_what_is_known_of_a_payload_is_told_to_the_import(tmp_path):
    (tmp_path / "log.csv").write_text("t\n0\n")
    asked = {"step": "import", "log": "log.csv", "robot": "five_bar", "dataset": "mine", "columns": {}}
    known = {"payload": "disc", "payload_mass": 0.5, "payload_center": [0, 0, -0.02]}
    known |= {"payload_inertia": [1e-3, 1e-3, 2e-3, 0, 0, 0], "topic": "/arm/states"}
    line = command_of(Folder(tmp_path), {**asked, **known}).line
    assert "--payload-center=0.0,0.0,-0.02 --payload-inertia=0.001,0.001,0.002,0.0,0.0,0.0 " in line
    assert "--topic=/arm/states " in line


def test_a_comparison_is_the_command_s_and_its_model_s_too(site, root, monkeypatch):
    plain = site.run({"step": "compare", "dataset": "data"})
    ours, shell = same_again(plain["line"], plain["files"]["answer"], root, monkeypatch)
    assert ours == shell
    model = site.run({"step": "identify", "dataset": "data", "effects": [LEFT]})["files"]["model"]
    applied = site.run({"step": "compare", "dataset": "data", "models": [model]})
    assert model in applied["line"]
    ours, shell = same_again(applied["line"], applied["files"]["answer"], root, monkeypatch)
    assert ours == shell
    fitted = json.loads((root / plain["files"]["answer"]).read_text())
    assert ours["where"]["left"]["error"] < 0.3 * fitted["where"]["left"]["error"]
    runs = [one["path"] for one in site.get("api/folder").json["runs"]]
    told = site.post("api/look/runs", {"paths": runs}).json
    kept = {one["path"]: (one["applied"], one["effects"]) for one in told}
    assert kept.pop(model) == (False, [LEFT])
    assert {path: one for path, one in kept.items() if "/model-" not in path} == {
        plain["files"]["run"]: (False, []),
        applied["files"]["run"]: (True, [LEFT]),
    }
    both = [plain["files"]["model"], model]
    beside = site.run({"step": "compare", "dataset": "data", "models": both})
    ours, shell = same_again(beside["line"], beside["files"]["answer"], root, monkeypatch)
    assert ours == shell
    assert [one["effects"] for one in ours["models"]] == [[], [LEFT]]
    assert any("has viscous friction at left" in sentence for sentence in ours["changed"])
    moving = site.post("api/look/machine", {"dataset": "data", "model": model, "recording": "free.csv"}).json
    frames = len(moving["time"])
    assert 2 <= frames <= 400
    assert len(moving["path"]) == 3 * frames
    assert {len(bar["from"]) for bar in moving["bars"]} == {3, 3 * frames}
    assert all(0.0 <= share <= 1.0 for share in moving["error"])
    models = [{"path": model, "name": "after", "role": "after"}]
    figure = site.post("api/look/curves", {"dataset": "data", "models": models}).json
    assert figure["type"] == "figure"
    assert [choice["name"] for choice in figure["choices"]] == ["Motor", "Recording"]


def test_the_robot_is_checked(site):
    job = site.run({"step": "robot", "robot": "five_bar"})
    assert job["state"] == "done"
    assert "five_bar" in job["output"]


def test_two_browsers_see_the_same_jobs_and_a_late_one_all_of_them(site):
    first, second = site.jobs(), site.jobs()
    before = len(next(first))
    assert len(next(second)) == before
    number = site.started({"step": "robot", "robot": "five_bar"})["number"]
    for stream in (first, second):
        assert any(jobs[-1]["number"] == number and jobs[-1]["state"] == "done" for jobs in stream)
    assert len(next(site.jobs())) == before + 1


def partials(folder):
    return [path for path in folder.rglob("*") if "partial" in path.name]


def test_a_command_is_cancelled_and_the_next_one_runs(site, root):
    results = root / "data.results"
    number = site.started({"step": "diagnose", "dataset": "data"})["number"]
    waiting = site.started({"step": "diagnose", "dataset": "data"})["number"]
    running = site.until(lambda job: job["number"] == number and job["phase"])
    assert running["state"] == "running"
    assert site.post("api/cancel", {"number": waiting}).status == 200
    assert site.post("api/cancel", {"number": number}).status == 200
    for one in (number, waiting):
        assert site.until(lambda job, one=one: job["number"] == one and job["state"] == "cancelled")
    assert not [path for path in results.iterdir() if "diagnosis" in path.name]
    assert partials(root) == []
    assert site.run({"step": "identify", "dataset": "data"})["state"] == "done"
    assert site.post("api/cancel", {"number": number}).status == 400


def alive(number):
    try:
        os.kill(number, 0)
    except ProcessLookupError:
        return False
    return True


@pytest.mark.skipif(sys.platform == "win32", reason="signals of POSIX")
def test_a_killed_server_leaves_nothing_half_written_and_nobody_at_work(tmp_path):
    short_dataset(tmp_path / "data")
    with opened(tmp_path, cwd=tmp_path) as site:
        site.started({"step": "diagnose", "dataset": "data"})
        site.until(lambda job: job["phase"])
        workers = site.workers()
        assert workers
        site.process.send_signal(signal.SIGKILL)
        site.process.wait()
        for _ in range(600):
            if not any(map(alive, workers)):
                break
            time.sleep(0.05)
        assert not any(map(alive, workers))
    assert partials(tmp_path) == []
    assert os.listdir(tmp_path / "data.results") == []
