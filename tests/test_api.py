"""The verbs of `import bench`: from paths or values to values that show themselves."""

from dataclasses import replace

import pytest

import bench
from bench.basics.errors import BenchError
from bench.identification.model_file import save_model as write_model

SHORT = 400  # characters


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    path = tmp_path_factory.mktemp("api") / "data"
    assert isinstance(bench.simulate("two_link", path, seed=3), bench.Dataset)
    return path


@pytest.fixture(scope="module")
def result(folder):
    return bench.identify(folder)


def test_a_scenario_becomes_the_same_dataset_in_memory_and_on_disk(folder):
    here, there = bench.simulate("two_link", seed=3), bench.load_dataset(folder)
    assert [one.name for one in here.recordings] == [one.name for one in there.recordings]
    assert abs(here.recordings[0].current - there.recordings[0].current).max() < 1e-8


def test_a_path_is_a_dataset(folder, result):
    again = bench.identify(bench.load_dataset(str(folder)))
    assert repr(again) == repr(result)
    assert again.findings == result.findings


def test_values_are_short_on_a_line(folder, result):
    dataset = bench.load_dataset(folder)
    errors = bench.compare(folder, result)
    parts = (errors.motors, errors.motors.series[0], errors.where.motors[0].by_recording, result.recordings)
    for value in (dataset, dataset.recordings[0], result, errors, *parts):
        assert len(repr(value)) < SHORT
        assert "\n" not in repr(value)
    for joint, gain in result.drive_gains.items():
        assert f"{joint} {gain.value:.4g}" in repr(result)


def test_a_saved_model_is_compared_as_the_result_is(folder, result, tmp_path):
    path = bench.save_model(result, tmp_path / "model.json", folder)
    assert bench.load_model(path).model.robot == "two_link"
    saved, given, anew = bench.compare(folder, path), bench.compare(folder, result), bench.compare(folder)
    for joint, error in given.error.by_actuator.items():
        assert saved.error.by_actuator[joint] == pytest.approx(error, rel=1e-6)
        assert anew.error.by_actuator[joint] == pytest.approx(error, rel=1e-6)
    assert saved.identified is None
    assert given.identified is result


def test_a_loaded_model_is_read_printed_and_saved_as_the_result_is(folder, result, tmp_path):
    path = bench.save_model(result, tmp_path / "model.json", folder)
    loaded = bench.load_model(path)
    assert loaded.drive_gains == result.drive_gains
    assert loaded.to_dataframe().equals(result.to_dataframe())
    assert "<td>parameter</td>" in loaded._repr_html_()
    assert len(repr(loaded)) < SHORT
    told = str(bench.report(loaded))
    assert f"rank {result.rank}" in told
    for recording in result.recordings:
        assert recording.name in told
    again = bench.save_model(loaded, tmp_path / "again.json")
    assert again.read_bytes() == path.read_bytes()
    with pytest.raises(BenchError, match="page of a saved model"):
        bench.report(loaded).save(tmp_path / "page.html", folder)
    with pytest.raises(BenchError, match="a Dataset is not a model"):
        bench.save_model(bench.load_dataset(folder), tmp_path / "none.json")
    assert not (tmp_path / "none.json").exists()


def test_a_loaded_model_keeps_the_files_of_its_effects_wherever_it_is_saved(result, tmp_path):
    own = tmp_path / "own.py"
    own.write_text("", encoding="utf-8")
    write_model(result, tmp_path / "model.json", effect_files=[own])
    (tmp_path / "deeper").mkdir()
    moved = bench.save_model(bench.load_model(tmp_path / "model.json"), tmp_path / "deeper" / "model.json")
    (file,) = bench.load_model(moved).effect_files
    assert file.samefile(own)


def test_a_folder_is_no_model_file(tmp_path):
    with pytest.raises(BenchError, match="a folder, not a model file"):
        bench.load_model(tmp_path)


def test_errors_are_a_table_and_figures(folder, result, tmp_path):
    errors = bench.compare(folder, result)
    table = errors.to_dataframe()
    assert list(table["error"]) == [
        value for motor in errors.where.motors for value, _ in motor.by_recording.values()
    ]
    assert set(table["use"]) == {trace.use for trace in result.recordings}
    assert "<td>identify</td>" in errors._repr_html_()
    of_errors = bench.figures(errors, folder, tmp_path / "errors", ["error_at_reversals"])
    of_result = bench.figures(result, folder, tmp_path / "result", ["error_at_reversals"])
    assert [path.name for path in of_errors] == [path.name for path in of_result]
    assert of_errors


def test_a_result_of_other_recordings_is_refused_by_name(folder, result, tmp_path):
    data = bench.load_dataset(folder)
    first = data.recordings[0]
    renamed = replace(data, recordings=(replace(first, name="elsewhere.csv"), *data.recordings[1:]))
    shorter = replace(data, recordings=(first.part(slice(0, 100)), *data.recordings[1:]))
    for function in (bench.compare, lambda data, result: bench.figures(result, data, tmp_path / "figures")):
        with pytest.raises(BenchError, match=f"no recording '{first.name}'.*elsewhere.csv"):
            function(renamed, result)
        with pytest.raises(BenchError, match=f"'{first.name}' is not the recording"):
            function(shorter, result)
        with pytest.raises(BenchError, match="but the result is of other"):
            function(data, replace(result, robot="other"))
        with pytest.raises(BenchError, match="no currents"):
            function(data, replace(result, recordings=()))
    assert not (tmp_path / "figures").exists()


def test_reports_are_text_html_and_a_page(folder, result, tmp_path):
    report = bench.report(result)
    assert str(report) == repr(report)
    assert "Drive gains" in str(report)
    assert "Drive gains" in report._repr_html_()
    assert "Error" in str(bench.report(bench.compare(folder, result)))
    assert (
        report.save(tmp_path / "page.html", folder).read_text(encoding="utf-8").startswith("<!doctype html>")
    )


def test_a_diagnosis_is_one_line_a_table_and_a_report(folder):
    data = bench.load_dataset(folder)
    data = replace(
        data, recordings=tuple(recording for recording in data.recordings if recording.use == "identify")
    )
    diagnosis = bench.diagnose(data)
    assert (
        bench.compare(data, diagnosis.after).identified is diagnosis.after
    )  # judged on the ends of recordings
    assert diagnosis.missing == ()
    assert repr(diagnosis).startswith("<two_link: nothing missing; error ")
    assert list(diagnosis.to_dataframe()["effect"]) == [one.effect for one in diagnosis.ranking]
    assert "viscous_friction" in diagnosis._repr_html_()
    assert str(bench.report(diagnosis))


def test_a_table_in_a_notebook_is_escaped(result):
    assert "<td>parameter</td>" in result._repr_html_()
    assert "<script" not in result._repr_html_()


def test_what_is_no_result_and_no_folder_is_named(tmp_path):
    with pytest.raises(BenchError, match="nothing"):
        bench.identify(tmp_path / "nothing")
    with pytest.raises(BenchError, match="cannot report a int"):
        str(bench.report(3))
    with pytest.raises(BenchError, match="cannot draw a int"):
        bench.figures(3, tmp_path, tmp_path / "figures")
