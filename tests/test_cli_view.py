"""The command that shows a dataset, a model, results or a sweep in the viewer."""

import json
import shutil
import subprocess
import sys

import numpy as np
import pytest

from bench.cli import main
from bench.dataset.dataset import load_dataset
from bench.identification.identify import identify
from bench.identification.prepare import prepare
from bench.identification.problem import problem_of
from bench.studies.sweep.rerun_runs import run_again, telling_runs
from tests.rrd_reader import numbers, origins, static_value, verified


@pytest.fixture(scope="module")
def data(arm):
    """Measurements of a two-link arm with friction at its shoulder, and the truth beside them."""
    return arm / "data"


def viewed(*arguments):
    assert main(["view", *map(str, arguments)]) == 0


def test_a_dataset_with_an_effect_shows_it_beside_the_truth(data, tmp_path, capsys):
    path = tmp_path / "arm.rrd"
    viewed(data, "--with", "viscous_friction:shoulder", "--save", path)
    wrote, step = capsys.readouterr().out.splitlines()
    assert wrote == f"wrote {path} (recording: open it with rerun {path})"
    assert step.startswith(f"next: bench compare {data} --with viscous_friction:shoulder    ")
    assert verified(path)
    times, hidden = numbers(path, "/free/torque/shoulder/0_hidden")
    at, found = numbers(path, "/free/torque/shoulder/3_found")
    hidden = np.interp(at, times, hidden)
    moving = np.isfinite(found)
    assert moving.mean() > 0.8
    assert np.sqrt(np.mean((found - hidden)[moving] ** 2)) < 0.05 * np.sqrt(np.mean(hidden**2))
    before, after = (numbers(path, f"/free/steps/shoulder/{k}")[1] for k in (0, 1))
    assert np.nanstd(after) < 0.3 * np.nanstd(before)
    (text,) = static_value(path, "/summary", "TextDocument:text")
    assert "1.500" in text  # the truth, beside what was found
    assert numbers(path, "/held/following")[1].max() > 0.0


def test_without_truth_nothing_of_it_is_shown(data, tmp_path):
    path = tmp_path / "arm.rrd"
    viewed(data, "--no-truth", "--save", path)
    assert not [one for one in origins(path) if "torque" in one or "following" in one]


def test_changed_measurements_have_no_truth(data, tmp_path):
    shutil.copytree(data, tmp_path / "other")
    shutil.copy(data.with_name("data.truth.json"), tmp_path / "other.truth.json")
    for file in (tmp_path / "other").glob("*.csv"):
        lines = file.read_text().splitlines(keepends=True)
        file.write_text("".join([lines[0], *lines[11:]]))
    path = tmp_path / "arm.rrd"
    viewed(tmp_path / "other", "--save", path)
    assert not [one for one in origins(path) if "torque" in one]


def test_a_model_file_knows_its_dataset_and_takes_another(data, tmp_path, capsys):
    model = tmp_path / "model.json"
    assert main(["identify", str(data), "--with", "viscous_friction:shoulder", "--json", str(model)]) == 0
    viewed(model, "--save", tmp_path / "own.rrd")
    shutil.copytree(data, tmp_path / "other")
    capsys.readouterr()
    viewed(model, "--data", tmp_path / "other", "--save", tmp_path / "other.rrd")
    assert f"\nnext: bench compare {tmp_path / 'other'} --model {model}    " in capsys.readouterr().out
    one, other = (
        numbers(tmp_path / f"{name}.rrd", "/held/error/elbow/error")[1] for name in ("own", "other")
    )
    np.testing.assert_array_equal(one, other)


def test_a_diagnosis_shows_its_ladder(diagnosed_arm, tmp_path, capsys):
    found, path = diagnosed_arm / "found", tmp_path / "found.rrd"
    capsys.readouterr()
    viewed(found, "--save", path)
    assert f"\nnext: bench figures {found}    " in capsys.readouterr().out
    names = [static_value(path, f"/free.csv/steps/shoulder/{k}", "SeriesLines:names")[0] for k in (0, 1)]
    assert names == ["the model as it is", "+ viscous friction"]
    _, hidden = numbers(path, "/free.csv\\ \\(end\\)/torque/shoulder/0_hidden")  # the part that was judged
    assert 0.2 < len(hidden) / len(numbers(path, "/free.csv/torque/shoulder/0_hidden")[1]) < 0.6
    (text,) = static_value(path, "/summary", "TextDocument:text")
    assert "### What is missing" in text
    content = json.loads((found / "report.json").read_text())
    assert content["diagnosis"]["missing"] == ["viscous_friction"]


@pytest.fixture(scope="module")
def swept(tmp_path_factory):
    """A sweep of four runs, of which nothing but the table is kept."""
    folder = tmp_path_factory.mktemp("swept")
    (folder / "bits.toml").write_text(
        'base = "two_link"\nseeds = 2\n[scenario]\n"design.optimise" = false\n"design.duration" = 4.0\n'
        '[axes]\n"sensors.encoder_bits" = [14, 20]\n'
    )
    assert main(["sweep", str(folder / "bits.toml"), "-o", str(folder / "out"), "--workers", "1"]) == 0
    return folder / "out"


def test_runs_of_a_sweep_are_made_again_and_stand_side_by_side(swept, tmp_path, capsys):
    from bench.studies.sweep.rerun_runs import plan_of
    from bench.studies.sweep.results import table_in
    from bench.studies.sweep.table import read_table

    path = tmp_path / "swept.rrd"
    capsys.readouterr()
    viewed(swept, "--run", "0", "--run", "3", "--save", path)
    assert f"\nnext: bench table {swept}    " in capsys.readouterr().out
    assert verified(path)
    tabs = [one for one in origins(path) if one.endswith("/robot")]
    assert {one.split("/")[1].split("\\ ")[0] for one in tabs} == {"0", "1"}
    plan = plan_of(swept)
    table = read_table(table_in(swept), ["run", "seed", "sensors.encoder_bits"])
    again = run_again(swept, plan, 3)
    row = table["run"].index(3)
    assert again.run.seed == table["seed"][row]
    assert f"sensors.encoder_bits {table['sensors.encoder_bits'][row]}" in again.title
    chosen = telling_runs(swept, plan)
    assert len(chosen) == len(set(chosen)) == 3


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["{tmp}/nowhere"], "no such folder or model file"),
        (["{tmp}"], "neither a dataset (dataset.toml), nor a result (report.json), nor a sweep (sweep.toml)"),
        (["{data}", "--save", "{tmp}/a.txt"], "a Rerun recording is an .rrd file"),
        (["{data}", "--with", "nonsense"], "nonsense"),
        (["{swept}", "--run", "99"], "no run 99; there are 0 to 3"),
    ],
)
def test_a_mistake_is_one_line(data, swept, tmp_path, capsys, arguments, said):
    given = [one.format(tmp=tmp_path, data=data, swept=swept) for one in arguments]
    capsys.readouterr()
    assert main(["view", *given]) == 2
    out, err = capsys.readouterr()
    assert said in err
    assert out == ""
    assert err.count("\n") == 1
    assert not list(tmp_path.iterdir())


def test_it_opens_in_a_window_of_its_own_where_there_is_a_screen(data, tmp_path, monkeypatch, capsys):
    shutil.copytree(data, tmp_path / "arm")
    started = []
    monkeypatch.setattr(subprocess, "Popen", lambda command, **_: started.append(command))
    monkeypatch.setenv("DISPLAY", ":0")
    viewed(tmp_path / "arm")
    assert started[0][1] == str(tmp_path / "arm.rrd")
    assert "Opened in the Rerun viewer" in capsys.readouterr().out
    monkeypatch.delenv("DISPLAY")
    monkeypatch.delenv("WAYLAND_DISPLAY", raising=False)
    monkeypatch.setattr(sys, "platform", "linux")
    viewed(tmp_path / "arm")
    assert len(started) == 1
    assert f"rerun --web-viewer {tmp_path / 'arm.rrd'}" in capsys.readouterr().out


def by_topic(path):
    """Log times [s] and messages of every topic, by MCAP's own reader; the unit of a field by topic."""
    from mcap.reader import make_reader

    messages, schemas = {}, {}
    with path.open("rb") as file:
        for schema, channel, message in make_reader(file).iter_messages():
            messages.setdefault(channel.topic, []).append((1e-9 * message.log_time, json.loads(message.data)))
            schemas[channel.topic] = json.loads(schema.data)["properties"]
    return messages, schemas


def test_an_mcap_file_has_currents_errors_torques_and_joint_states(data, tmp_path, capsys):
    path = tmp_path / "arm.mcap"
    viewed(data, "--with", "viscous_friction:shoulder", "--save", path)
    assert f"wrote {path} (recording: open it in Foxglove or PlotJuggler)\n" in capsys.readouterr().out
    messages, schemas = by_topic(path)
    kinds = ["log", "currents", "joint_states", "torque/viscous_friction", "torque/hidden"]
    assert set(messages) == {f"/{name}/{kind}" for name in ("free", "held") for kind in kinds}
    problem = problem_of(load_dataset(data), ("viscous_friction:shoulder",))
    result = identify(prepare(problem))
    series = next(series for series in result.recordings if series.name == "free.csv")
    rows = messages["/free/currents"]
    logged = next(one for one in problem.dataset.recordings if one.name == "free.csv")
    assert messages["/free/log"][0][0] == 0.0
    np.testing.assert_allclose([time for time, _ in rows], series.time - logged.time[0], atol=1e-9)
    for j, joint in enumerate(result.joints):
        for name in ("measured", "modelled"):
            found = [row[joint][name] for _, row in rows]
            np.testing.assert_array_equal(found, getattr(series, name)[:, j])
        known = [(row[joint]["error"], k) for k, (_, row) in enumerate(rows) if "error" in row[joint]]
        assert [k for _, k in known] == np.flatnonzero(series.moving[:, j]).tolist()
        np.testing.assert_array_equal([error for error, _ in known], series.error[series.moving[:, j], j])
    torque = [row["shoulder"].get("torque") for _, row in messages["/free/torque/viscous_friction"]]
    velocity = [row["shoulder"]["velocity"] for _, row in messages["/free/joint_states"]]
    (value,) = result.effect_parameters["viscous_friction"]["shoulder"].values()
    there = np.array([entry is not None for entry in torque])
    np.testing.assert_allclose(
        np.array(torque)[there].astype(float), value.value * np.array(velocity)[there], rtol=0.05, atol=0.02
    )
    assert schemas["/free/joint_states"]["elbow"]["properties"]["velocity"]["description"] == "rad/s"
    as_readers_document_it(path)


def as_readers_document_it(path):
    """JSON objects with a JSON schema of type object and no references, as Foxglove asks for; PlotJuggler chooses its
    reader by the encoding of the messages.
    """
    from mcap.reader import make_reader

    with path.open("rb") as file:
        summary = make_reader(file).get_summary()
    assert {channel.message_encoding for channel in summary.channels.values()} == {"json"}
    for schema in summary.schemas.values():
        assert schema.encoding == "jsonschema"
        assert json.loads(schema.data)["type"] == "object"
        assert b"$ref" not in schema.data


def test_without_the_package_an_mcap_file_is_refused_at_once(data, tmp_path, monkeypatch, capsys):
    monkeypatch.setitem(sys.modules, "mcap.writer", None)
    capsys.readouterr()
    assert main(["view", str(data), "--save", str(tmp_path / "arm.mcap")]) == 2
    assert capsys.readouterr().err.endswith("an MCAP file needs mcap: pip install 'parabench[mcap]'\n")
    assert not list(tmp_path.iterdir())
