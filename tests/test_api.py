"""The verbs of `import bench`: from paths or values to values that show themselves."""

import pytest

import bench
from bench.basics.errors import BenchError

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
    for value in (dataset, dataset.recordings[0], result, errors):
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
    diagnosis = bench.diagnose(folder)
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
    with pytest.raises(BenchError, match="no report is made of a int"):
        str(bench.report(3))
