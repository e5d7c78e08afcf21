"""Rerun recordings, read back with Rerun's own reader: nothing is lost, and the robot moves as it was logged."""

from dataclasses import replace
from pathlib import Path

import mujoco
import numpy as np
import pytest
from rerun.chunk import RrdReader

from bench.basics.errors import BenchError
from bench.dataset.robot import load_robot
from bench.document.numbers import error_std, percent
from bench.viewer import body_motion
from bench.viewer import recording as writer
from bench.viewer.recording import entity_roots, write_rrd
from bench.viewer.scene import PAYLOAD_DENSITY
from tests.rrd_reader import batches, columns, numbers, static_value, verified
from tests.shown import DISC, dataset_of, identification_of

SECONDS = 1e-9


def poses(path, entity):
    """Times [s], positions (N, 3) m and rotations (N, 3, 3)."""
    times, values = columns(path, entity)
    quaternions = np.array(values["quaternion"].tolist(), dtype=float)[:, 0]
    rotations = np.empty((len(times), 9))
    for rotation, (x, y, z, w) in zip(rotations, quaternions, strict=True):
        mujoco.mju_quat2Mat(rotation, np.array([w, x, y, z]))
    return times, np.array(values["translation"].tolist(), dtype=float)[:, 0], rotations.reshape(-1, 3, 3)


@pytest.fixture(scope="module", params=["five_bar", "delta"])
def written(request, tmp_path_factory):
    dataset = dataset_of(load_robot(request.param))
    result = identification_of(dataset, effects=True)
    path = tmp_path_factory.mktemp(request.param) / "answer.rrd"
    write_rrd(path, result, dataset, truth={dataset.robot.joints[0]: 3.25})
    return path, result, dataset


def test_currents_are_all_there_to_the_last_bit(written):
    path, result, dataset = written
    deviation = error_std(result)
    for recording, series in zip(dataset.recordings, result.recordings, strict=True):
        root = "/" + Path(recording.name).stem
        for j, joint in enumerate(dataset.robot.joints):
            times, logged = numbers(path, f"{root}/current/{joint}/logged")
            np.testing.assert_array_equal(times, np.arange(len(recording.time)) * 1_000_000)
            np.testing.assert_array_equal(logged, recording.current[:, j])
            times, measured = numbers(path, f"{root}/current/{joint}/measured")
            np.testing.assert_array_equal(times, np.rint(series.time * 1e9))
            np.testing.assert_array_equal(measured, series.measured[:, j])
            np.testing.assert_array_equal(
                numbers(path, f"{root}/current/{joint}/modelled")[1], series.modelled[:, j]
            )
            error = numbers(path, f"{root}/error/{joint}/error")[1]
            np.testing.assert_array_equal(error, np.where(series.moving[:, j], series.error[:, j], np.nan))
            variance = numbers(path, f"{root}/error/{joint}/deviation", "variances")[1]
            np.testing.assert_allclose(np.sqrt(variance), deviation[j])
            np.testing.assert_array_equal(
                numbers(path, f"{root}/position/{joint}")[1], recording.position[:, j]
            )


def test_loops_are_closed_in_every_frame(written):
    path, _, dataset = written
    model = dataset.robot.mjcf_model()
    assert model.neq
    for recording in dataset.recordings:
        bodies = f"/{Path(recording.name).stem}/robot/bodies"
        for index in range(model.neq):
            ends = []
            for site in (model.eq_obj1id[index], model.eq_obj2id[index]):
                _, positions, rotations = poses(path, f"{bodies}/{model.body(model.site_bodyid[site]).name}")
                ends.append(positions + rotations @ model.site_pos[site])
            assert np.abs(ends[0] - ends[1]).max() < 2e-6  # single precision
            assert np.ptp(ends[0], axis=0).max() > 0.01  # it does move


def test_motors_turn_as_logged_fifty_times_a_second(written):
    path, result, dataset = written
    model = dataset.robot.mjcf_model()
    border = result.settings.border[0]
    for recording in dataset.recordings:
        for j, joint in enumerate(dataset.robot.joints):
            body = model.body(model.joint(joint).bodyid[0]).name
            times, _, rotations = poses(path, f"/{Path(recording.name).stem}/robot/bodies/{body}")
            np.testing.assert_array_equal(np.diff(times), 20_000_000)
            samples = np.rint(times * SECONDS * recording.rate).astype(int)
            assert samples[0] == border
            trace = np.trace(rotations[0].T @ rotations, axis1=1, axis2=2)
            turned = np.arccos(np.clip((trace - 1.0) / 2.0, -1.0, 1.0))
            logged = np.abs(recording.position[samples, j] - recording.position[border, j])
            assert np.abs(turned - logged).max() < 2e-3
            assert turned.max() > 0.1


def test_a_payload_is_drawn_where_it_is_carried_with_its_mass(written):
    path, _, dataset = written
    assert not batches(path, "/unloaded/robot/payload/**", static=True)
    assert not batches(path, "/check/robot/payload/**", static=False)
    ball = "/loaded/robot/payload/ball"
    (center,) = static_value(path, ball, "Ellipsoids3D:centers")
    np.testing.assert_allclose(center, DISC.center_of_mass, atol=1e-8)
    (size,) = static_value(path, ball, "Ellipsoids3D:half_sizes")
    np.testing.assert_allclose(4.0 / 3.0 * np.pi * np.prod(size) * PAYLOAD_DENSITY, DISC.mass, rtol=1e-5)
    model = dataset.robot.mjcf_model()
    site = model.site(dataset.robot.tool_site)
    body = model.body(site.bodyid[0]).name
    _, positions, rotations = poses(path, f"/loaded/robot/bodies/{body}")
    _, held, turned = poses(path, "/loaded/robot/payload")
    np.testing.assert_allclose(held, positions + rotations @ site.pos, atol=2e-6)
    tool = np.empty(9)
    mujoco.mju_quat2Mat(tool, site.quat)
    np.testing.assert_allclose(turned, rotations @ tool.reshape(3, 3), atol=2e-6)
    pieces = np.array(static_value(path, "/loaded/robot/tool_path", "LineStrips3D:strips"))
    np.testing.assert_allclose(pieces[:, 0], held[:-1], atol=1e-6)
    np.testing.assert_allclose(pieces[:, 1], held[1:], atol=1e-6)


def test_text_tells_gains_parameters_effects_errors_and_notes(written):
    path, result, dataset = written
    (summary,) = static_value(path, "/summary", "TextDocument:text")
    (parameters,) = static_value(path, "/parameters", "TextDocument:text")
    assert static_value(path, "/summary", "TextDocument:media_type") == ["text/markdown"]
    gain = result.drive_gains[dataset.robot.joints[0]]
    assert (
        f"| {dataset.robot.joints[0]} | {gain.value:.4f} ± 0.0015 | {percent(gain.relative_std)} | N·m/A |"
        in summary
    )
    assert "3.2500" in summary
    assert "0.1200 ± 0.0030 | 2.50 % | N·m·s/rad" in summary
    assert result.notes[0] in summary
    for one in result.parameters:
        assert one.grouping in parameters
    assert "**! 60.06 %**" in parameters
    for text in (summary, parameters):
        tables = [
            [line.count(" | ") for line in part.splitlines()] for part in text.split("\n\n") if "|" in part
        ]
        assert tables
        assert all(len(set(table)) == 1 for table in tables)  # rows as long as their headers


def test_the_saved_views_show_every_recording(written):
    path, _, dataset = written
    reader = RrdReader(path)
    (views,) = reader.blueprints()
    names, origins = set(), set()
    for chunk in reader.stream(store=views):
        batch = chunk.to_record_batch()
        for column in batch.schema.names:
            values = (
                [value for row in batch.column(column).to_pylist() for value in row or ()]
                if ":" in column
                else []
            )
            if column.endswith(":display_name"):
                names.update(values)
            if column.endswith(":space_origin"):
                origins.update(values)
    assert {"unloaded (fitted)", "loaded (fitted)", "check (not fitted)"} <= names
    for root in ("/unloaded", "/loaded", "/check"):
        wanted = {f"{root}/robot", f"{root}/phases", f"{root}/loop_gap"}
        wanted |= {
            f"{root}/{kind}/{joint}" for kind in ("current", "error") for joint in dataset.robot.joints
        }
        assert wanted <= origins
    assert {"/summary", "/parameters"} <= origins
    for origin in origins:  # no view is empty
        assert any(batches(path, f"{origin}/**", static=static) for static in (False, True)), origin


def test_rerun_verifies_the_file_and_not_a_part_of_it(written, tmp_path):
    path, _, _ = written
    part = tmp_path / "part.rrd"
    part.write_bytes(path.read_bytes()[:-2000])
    assert verified(path)
    assert not verified(part)


def test_twenty_seconds_of_a_delta_are_small(tmp_path):
    dataset = dataset_of(load_robot("delta"), duration=20.0, recordings=(("one.csv", "identify", "disc"),))
    path = tmp_path / "one.rrd"
    write_rrd(path, identification_of(dataset), dataset)
    assert path.stat().st_size < 15e6
    assert len(batches(path, "/one/current/motor_1/logged", static=False)) <= 4  # columns, not rows


def test_times_count_from_the_first_sample(tmp_path):
    dataset = dataset_of(load_robot("five_bar"), duration=1.0, start=4711.25)
    path = tmp_path / "late.rrd"
    write_rrd(path, identification_of(dataset), dataset)
    assert numbers(path, "/loaded/position/left")[0][0] == 0
    assert numbers(path, "/loaded/position/left")[0][-1] == 999_000_000


def test_recordings_of_one_name_and_names_with_signs_stay_apart(tmp_path):
    assert entity_roots(["run.csv", "run.parquet", "a b/c.csv"]) == {
        "run.csv": "/run.csv",
        "run.parquet": "/run.parquet",
        "a b/c.csv": "/c",
    }
    assert len(set(entity_roots(["a b.csv", "a/b.csv", "b.csv"]).values())) == 3
    names = (("first run.csv", "identify", None), ("Messung (2).csv", "validate", "disc"))
    dataset = dataset_of(load_robot("five_bar"), duration=1.0, recordings=names)
    path = tmp_path / "names.rrd"
    write_rrd(path, identification_of(dataset), dataset)
    for (name, _, _), recording in zip(names, dataset.recordings, strict=True):
        entity = f"{entity_roots([name])[name]}/current/right/logged"
        np.testing.assert_array_equal(numbers(path, entity)[1], recording.current[:, 1])


@pytest.fixture
def small():
    dataset = dataset_of(load_robot("five_bar"), duration=1.0)
    return identification_of(dataset), dataset


def test_another_suffix_is_refused(small, tmp_path):
    with pytest.raises(BenchError, match=r"answer.json: a Rerun recording is an .rrd file"):
        write_rrd(tmp_path / "answer.json", *small)
    assert not list(tmp_path.iterdir())


def test_a_result_of_another_dataset_is_refused(small, tmp_path):
    result, dataset = small
    other = replace(dataset, recordings=dataset.recordings[:2])
    with pytest.raises(BenchError, match=r"gentle: has no recording 'check.csv'"):
        write_rrd(tmp_path / "answer.rrd", result, other)
    assert not list(tmp_path.iterdir())


def test_a_recording_that_was_left_aside_is_not_shown(small, tmp_path):
    result, dataset = small
    extra = replace(dataset.recordings[0], name="aside.csv")
    write_rrd(tmp_path / "answer.rrd", result, replace(dataset, recordings=(extra, *dataset.recordings)))
    assert not batches(tmp_path / "answer.rrd", "/aside/**", static=False)


def test_an_interrupted_command_leaves_the_older_file(small, tmp_path, monkeypatch):
    path = tmp_path / "answer.rrd"
    path.write_bytes(b"older")

    def interrupted(*_):
        raise KeyboardInterrupt

    monkeypatch.setattr(writer, "send_robot", interrupted)
    with pytest.raises(KeyboardInterrupt):
        write_rrd(path, *small)
    assert path.read_bytes() == b"older"
    assert [one.name for one in tmp_path.iterdir()] == ["answer.rrd"]


def test_a_sample_out_of_reach_is_told_with_its_recording(small, tmp_path, monkeypatch):
    def unreachable(*_):
        raise BenchError("t = 0.5000 s: out of reach")

    monkeypatch.setattr(body_motion, "motion_of", unreachable)
    with pytest.raises(BenchError, match=r"^unloaded.csv: t = 0.5000 s: out of reach"):
        write_rrd(tmp_path / "answer.rrd", *small)
    assert not list(tmp_path.iterdir())
