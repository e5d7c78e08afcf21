"""Code in how-to pages does what the pages say of it."""

import re
import shutil

import pytest
from pyarrow import compute, csv

import bench
from bench.identification import estimators
from bench.truth.hidden.entries import hidden_in


def python_of(page):
    return re.findall(r"```python\n(.*?)```", page.read_text(encoding="utf-8"), re.DOTALL)


def test_the_test_of_a_machine_fails_where_a_motor_has_changed(project_root, arm, tmp_path, monkeypatch):
    (code,) = python_of(project_root / "docs/pages/howto/ci.md")
    bench.save_model(bench.identify(arm / "data"), tmp_path / "model.json")
    for name in ("accepted", "today"):
        shutil.copytree(arm / "data", tmp_path / name)
    monkeypatch.chdir(tmp_path)
    names = {}
    exec(code, names)
    names["test_the_model_still_holds"]()
    for file in (tmp_path / "today").glob("*.csv"):
        log = csv.read_csv(file)
        column = log.column_names.index("current.shoulder")
        log = log.set_column(column, "current.shoulder", compute.multiply(log.column(column), 2.0))
        csv.write_csv(log, file)
    with pytest.raises(AssertionError, match=r"times the error at identification: {'shoulder': \d+"):
        names["test_the_model_still_holds"]()


def test_an_estimator_of_one_s_own_runs_from_a_script(project_root, arm, tmp_path, monkeypatch, capsys):
    (code,) = python_of(project_root / "docs/pages/howto/estimator.md")
    shutil.copytree(arm / "data", tmp_path / "my_data")
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(estimators, "ESTIMATORS", dict(estimators.ESTIMATORS))
    exec(code, {})
    assert "shoulder" in capsys.readouterr().out
    effects = ["viscous_friction:shoulder"]
    own, default = (bench.identify("my_data", effects, method) for method in ("least_absolute", "current"))
    for joint, gain in own.drive_gains.items():
        assert gain.value == pytest.approx(default.drive_gains[joint].value, rel=0.01)
        assert 0.0 < gain.std < 0.01 * gain.value


def test_the_effect_of_one_s_own_and_its_hidden_twin_are_those_of_the_other_pages(project_root, tmp_path):
    effect, hidden = python_of(project_root / "docs/pages/howto/effect.md")
    assert effect in (project_root / "CONTRIBUTING.md").read_text(encoding="utf-8")
    file = tmp_path / "my_fan.py"
    file.write_text(hidden, encoding="utf-8")
    assert list(hidden_in(file)) == ["fan"]
