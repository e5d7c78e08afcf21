"""What a result folder keeps: it is read instead of being worked out, and never in place of what has changed."""

import json
import shutil
from dataclasses import fields, replace

import numpy as np
import pytest

from bench.basics.errors import BenchError
from bench.cli import main
from bench.dataset.robot import load_robot
from bench.identification import prepare
from bench.identification.effect_torques import effect_torques
from bench.identification.result import CurrentSeries, relative_error
from bench.page.folder import SERIES_FILE, WORKBENCH_FILE, read_run
from bench.page.series_file import read_series, write_series
from bench.truth.dataset import write_simulation
from tests.hidden_kit import run
from tests.report_kit import dataset
from tests.rrd_reader import verified
from tests.shown import identification_of
from tests.test_cli_report import essence

HIDDEN = (
    {"effect": "viscous_friction", "joint": "shoulder", "Fv": 1.5},
    {"effect": "coulomb_friction", "joint": "elbow", "Fc": 0.8},
)


@pytest.fixture(scope="module")
def diagnosed(tmp_path_factory):
    """An arm with two effects that its model lacks, so that its ladder has a step between; never changed."""
    folder = tmp_path_factory.mktemp("kept")
    write_simulation(
        run("two_link", *HIDDEN, design={"optimise": False, "duration": 8.0, "ramp": 0.5}), folder / "data"
    )
    assert main(["diagnose", str(folder / "data"), "-o", str(folder / "found")]) == 0
    return folder


@pytest.fixture
def copied(diagnosed, tmp_path):
    shutil.copytree(diagnosed, tmp_path / "copy")
    return tmp_path / "copy"


@pytest.fixture
def no_equations(monkeypatch):
    """Nothing may be worked out: neither equations nor loops."""

    def refused(*_args, **_kwargs):
        raise AssertionError("equations are prepared")

    monkeypatch.setattr(prepare, "measure", refused)


def reported(folder, page):
    return main(["report", str(folder / "found"), "-o", str(page)])


def test_page_recording_and_figures_work_nothing_out(diagnosed, tmp_path, no_equations, capsys):
    assert reported(diagnosed, tmp_path / "page.html") == 0
    assert essence(tmp_path / "page.html") == essence(diagnosed / "found" / "report.html")
    assert main(["view", str(diagnosed / "found"), "--no-truth", "--save", str(tmp_path / "found.rrd")]) == 0
    assert verified(tmp_path / "found.rrd")
    only = ["--only", "ladder", "--only", "gains"]
    assert main(["figures", str(diagnosed / "found"), "-o", str(tmp_path / "figures"), *only]) == 0
    assert capsys.readouterr().err == ""


def test_the_ladder_s_currents_and_the_effects_torques_come_back(diagnosed):
    kept = read_run(diagnosed / "found")
    assert len(kept.diagnosis.ladder) == 3
    for step in kept.diagnosis.ladder:
        fitted = [one for one in step.recordings if one.use == "identify"]
        assert relative_error(fitted) == pytest.approx(step.identify, rel=1e-12)
    for series, torque in zip(kept.after.recordings, effect_torques(kept.after.recordings), strict=True):
        shoulder = torque.by_effect["viscous_friction"][:, 0]
        expected = 1.5 * series.velocity[:, 0]
        left = (shoulder - expected)[series.moving[:, 0]]
        assert np.sqrt(np.mean(left**2)) < 0.05 * np.sqrt(np.mean(expected**2))
        np.testing.assert_array_equal(np.isnan(shoulder), ~series.moving[:, 0])


def test_series_are_read_as_they_were_written(tmp_path):
    data = dataset()
    models = [identification_of(data).recordings, identification_of(data, effects=True).recordings]
    moved = [replace(one, by_effect={"drag": np.sin(one.modelled)}) for one in models[1]]
    write_series(tmp_path / "series.parquet", [models[0], moved], data.robot.joints)
    read = read_series(tmp_path / "series.parquet", data, [(), ("drag",)])
    for written, found in zip([*models[0], *moved], [*read[0], *read[1]], strict=True):
        for one in fields(CurrentSeries):
            np.testing.assert_equal(getattr(found, one.name), getattr(written, one.name))
    with pytest.raises(BenchError, match="other joints or models"):
        read_series(tmp_path / "series.parquet", data, [(), ()])
    with pytest.raises(BenchError, match="other recordings"):
        read_series(
            tmp_path / "series.parquet", replace(data, recordings=data.recordings[:1]), [(), ("drag",)]
        )


def test_what_has_changed_is_worked_out_anew_and_said(copied, tmp_path, capsys):
    name = copied / "data" / "dataset.toml"
    name.write_text(name.read_text() + "\n# looked at again\n")
    assert reported(copied, tmp_path / "page.html") == 0
    out, err = capsys.readouterr()
    assert err.count("\n") == 1
    assert "changed since" in err
    assert str(tmp_path / "page.html") in out


def test_a_robot_that_has_changed_counts_as_well(copied, tmp_path, capsys):
    shutil.copytree(load_robot("two_link").folder, copied / "arm")
    toml = copied / "data" / "dataset.toml"
    toml.write_text(toml.read_text().replace('"two_link"', '"../arm"'))
    known = ["--with", "viscous_friction:shoulder", "--with", "coulomb_friction:elbow"]
    shutil.rmtree(copied / "found")
    assert main(["identify", str(copied / "data"), *known, "-o", str(copied / "found")]) == 0
    capsys.readouterr()
    assert reported(copied, tmp_path / "page.html") == 0
    assert capsys.readouterr().err == ""
    model = next((copied / "arm").glob("*.xml"))
    model.write_text(model.read_text().replace("<mujoco", "<!-- looked at --><mujoco", 1))
    assert reported(copied, tmp_path / "page.html") == 0
    assert capsys.readouterr().err == ""  # words that say nothing to MuJoCo
    model.write_text(model.read_text().replace('mass="', 'mass="1', 1))
    assert reported(copied, tmp_path / "page.html") == 0
    assert "changed since" in capsys.readouterr().err


def test_a_folder_that_keeps_less_is_worked_out_anew_and_said(copied, tmp_path, capsys):
    path = copied / "found" / "report.json"
    content = json.loads(path.read_text())
    path.write_text(
        json.dumps({key: value for key, value in content.items() if key not in {"digest", "files"}})
    )
    assert reported(copied, tmp_path / "page.html") == 0
    assert "earlier version" in capsys.readouterr().err


@pytest.mark.parametrize("name", [SERIES_FILE, WORKBENCH_FILE, "model_after.json", "model_before.json"])
@pytest.mark.parametrize("damage", ["truncated", "foreign", "gone"])
def test_a_damaged_file_is_one_line(copied, name, damage, tmp_path, capsys):
    path = copied / "found" / name
    if damage == "truncated":
        path.write_bytes(path.read_bytes()[:-100])
    elif damage == "foreign":
        path.write_text("something else")
    else:
        path.unlink()
    assert reported(copied, tmp_path / "page.html") == 2
    out, err = capsys.readouterr()
    assert out == ""
    assert err.count("\n") == 1
    assert str(path) in err
    assert not (tmp_path / "page.html").exists()
