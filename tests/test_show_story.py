"""What a recording for the viewer tells beyond an identification, read back with Rerun's own reader."""

from dataclasses import replace

import numpy as np
import pytest

from bench.basics.errors import BenchError
from bench.dataset.robot import load_robot
from bench.document.colours import scale_colours
from bench.identification.effect_torques import EffectTorques
from bench.viewer.context import KnownTruth, LadderModel, ViewContext
from bench.viewer.recording import ViewedRun, write_rrd, write_side_by_side
from bench.viewer.scene import error_share
from bench.viewer.tracks import BACKWARDS, FORWARDS, REVERSAL, STILL, lanes, motion_states
from tests.rrd_reader import batches, columns, numbers, origins, static_value, verified
from tests.shown import dataset_of, identification_of


@pytest.fixture(scope="module", params=["five_bar", "delta"])
def told(request, tmp_path_factory):
    """A story about every recording: another model before, torques, and what a simulation knows."""
    dataset = dataset_of(load_robot(request.param), start=3.0)
    result = identification_of(dataset, effects=True)
    before = [replace(one, modelled=one.modelled - 0.2) for one in result.recordings]
    torques, known = {}, {}
    for one, recording in zip(result.recordings, dataset.recordings, strict=True):
        friction = {"coulomb_friction": 0.3 * np.sign(one.velocity), "viscous_friction": 0.1 * one.velocity}
        torques[one.name] = EffectTorques(one.name, one.time, friction)
        known[one.name] = KnownTruth(
            recording.time[::10],
            reference=recording.position[::10] + 0.001,
            torque=np.cos(recording.time[::10])[:, None] * np.arange(1.0, 1.0 + one.measured.shape[1]),
            loop_gap=np.full((len(recording.time[::10]), 2), (1e-7, 3e-7)),
        )
    steps = (LadderModel("the model as it is", before),)
    story = ViewContext(steps, torques, known, {dataset.robot.joints[0]: 3.25}, "### Told", "+ friction")
    path = tmp_path_factory.mktemp(request.param) / "story.rrd"
    write_rrd(path, result, dataset, context=story)
    return path, result, dataset, story


def test_the_errors_of_every_step_lie_on_one_time_line(told):
    path, result, _, story = told
    for series, before in zip(result.recordings, story.steps[0].recordings, strict=True):
        root = "/" + series.name.removesuffix(".csv")
        for j, joint in enumerate(result.drive_gains):
            moving = series.moving[:, j]
            for number, one in enumerate((before, series)):
                times, error = numbers(path, f"{root}/steps/{joint}/{number}")
                np.testing.assert_array_equal(times, np.rint((series.time - 3.0) * 1e9))
                np.testing.assert_array_equal(error[moving], one.error[moving, j])
            names = [static_value(path, f"{root}/steps/{joint}/{k}", "SeriesLines:names")[0] for k in (0, 1)]
            assert names == ["the model as it is", "+ friction"]


def test_hidden_torque_stands_beside_what_was_found(told):
    path, result, _, story = told
    for name, known in story.known.items():
        root = "/" + name.removesuffix(".csv")
        for j, joint in enumerate(result.drive_gains):
            times, hidden = numbers(path, f"{root}/torque/{joint}/0_hidden")
            np.testing.assert_array_equal(hidden, known.torque[:, j])
            np.testing.assert_array_equal(times, np.rint((known.time - 3.0) * 1e9))
            found = numbers(path, f"{root}/torque/{joint}/3_found")[1]
            np.testing.assert_array_equal(found, story.torques[name].total[:, j])
            parts = [
                numbers(path, f"{root}/torque/{joint}/2_{effect}")[1]
                for effect in story.torques[name].by_effect
            ]
            np.testing.assert_allclose(sum(parts), found, atol=1e-15)
            left = numbers(path, f"{root}/torque/{joint}/1_left_over")[1]
            series = next(one for one in result.recordings if one.name == name)
            expected = result.drive_gains[joint].value * series.error[:, j]
            np.testing.assert_allclose(left[series.moving[:, j]], expected[series.moving[:, j]])


def test_reference_and_actual_path_and_the_loops(told):
    path, result, dataset, _ = told
    for name in (one.name for one in result.recordings):
        root = "/" + name.removesuffix(".csv")
        actual = np.stack([numbers(path, f"{root}/tool/1_{axis}")[1] for axis in "xyz"], axis=1)
        wanted = np.stack([numbers(path, f"{root}/tool/2_{axis}")[1] for axis in "xyz"], axis=1)
        apart = numbers(path, f"{root}/following")[1]
        np.testing.assert_allclose(apart, 1e3 * np.linalg.norm(actual - wanted, axis=1), atol=1e-9)
        assert 0.02 < apart.max() < 5.0  # a milliradian at every motor
        np.testing.assert_allclose(numbers(path, f"{root}/loop_gap/machine")[1], 0.3)
        assert numbers(path, f"{root}/loop_gap/drawn")[1].max() < 0.01  # µm
        (strip,) = static_value(path, f"{root}/robot/reference_path", "LineStrips3D:strips")
        np.testing.assert_allclose(strip, wanted, atol=1e-6)
        for joint in dataset.robot.joints:
            assert batches(path, f"{root}/reference/{joint}", static=False)


def test_the_path_has_the_colour_of_the_error(told):
    path, result, _, _ = told
    largest = np.percentile(np.concatenate([error_share(one)[3:] for one in result.recordings]), 99.0)
    for series in result.recordings:
        root = "/" + series.name.removesuffix(".csv")
        times, values = columns(path, f"{root}/robot/tool_error")
        colours = np.array(values["colors"].tolist(), dtype=np.int64)[:, 0]
        rows = np.clip(np.searchsorted(series.time - 3.0, times * 1e-9 - 1e-9), 0, len(series.time) - 1)
        expected = scale_colours(error_share(series)[rows] / largest).astype(np.int64)
        packed = (expected[:, 0] << 24) + (expected[:, 1] << 16) + (expected[:, 2] << 8) + 255
        assert np.mean(colours == packed) > 0.99
        assert len(set(colours.tolist())) > 20
        pieces = static_value(path, f"{root}/robot/tool_path", "LineStrips3D:colors")
        np.testing.assert_array_equal(pieces, colours[:-1])


def test_phases_are_states(told):
    path, result, dataset, _ = told
    for series in result.recordings:
        root = "/" + series.name.removesuffix(".csv")
        _, values = columns(path, f"{root}/phases/2_payload")
        load = "disc, 0.5 kg" if series.payload else "no payload"
        assert values["state"].tolist() == [[load], [load]]
        _, values = columns(path, f"{root}/phases/1_phase")
        assert [text[0].partition(":")[0] for text in values["state"]] == ["start", "middle", "end", "end"]
        for j, joint in enumerate(dataset.robot.joints):
            times, values = columns(path, f"{root}/phases/{j + 3}_{joint}")
            states = motion_states(series.velocity[:, j], series.moving[:, j])
            at = np.searchsorted(times, np.rint((series.time - 3.0) * 1e9), side="right") - 1
            np.testing.assert_array_equal([values["state"][k][0] for k in at[:-1]], states[:-1])
            assert {FORWARDS, BACKWARDS, STILL} <= set(states)


def test_every_view_of_the_story_shows_something(told):
    path, _, dataset, _ = told
    wanted = {f"/loaded/{kind}/{joint}" for kind in ("steps", "torque") for joint in dataset.robot.joints}
    wanted |= {"/loaded/tool", "/loaded/following", "/loaded/loop_gap", "/loaded/phases"}
    found = origins(path)
    assert wanted <= found
    for origin in found:
        assert batches(path, f"{origin}/**", static=False) or batches(path, origin, static=True), origin
    (text,) = static_value(path, "/summary", "TextDocument:text")
    assert text.startswith("### Told\n\n**")
    assert "3.2500" in text
    assert verified(path)


def test_states_at_a_change_of_direction_and_at_standstill():
    velocity = np.array([1.0, 1.0, 0.5, -0.5, -1.0, 0.0, 0.0, -1.0, 1.0])
    moving = np.array([True, True, True, True, True, False, False, True, True])
    assert motion_states(velocity, moving).tolist() == [
        FORWARDS,
        FORWARDS,
        REVERSAL,
        REVERSAL,
        BACKWARDS,
        STILL,
        STILL,
        REVERSAL,
        REVERSAL,
    ]


def test_a_lane_s_states_all_have_a_colour():
    dataset = dataset_of(load_robot("five_bar"))
    series = identification_of(dataset).recordings[1]
    for lane in lanes(series, dataset.robot.joints, dataset.payloads["disc"]):
        assert set(lane.states) <= set(lane.colours)
        assert len(lane.time) == len(lane.states)
        assert (np.diff(lane.time) >= 0).all()


def test_a_logged_reference_is_the_path_that_was_asked_for(tmp_path):
    dataset = dataset_of(load_robot("five_bar"))
    joints = dataset.robot.joints
    recordings = tuple(
        replace(one, extra={f"reference.{joint}": one.position[:, j] for j, joint in enumerate(joints)})
        for one in dataset.recordings
    )
    dataset = replace(dataset, recordings=recordings)
    write_rrd(tmp_path / "logged.rrd", identification_of(dataset), dataset)
    assert numbers(tmp_path / "logged.rrd", "/loaded/following")[1].max() < 1e-3  # mm: the filter alone


def test_without_a_story_there_are_no_views_of_it(tmp_path):
    dataset = dataset_of(load_robot("five_bar"))
    path = tmp_path / "plain.rrd"
    write_rrd(path, identification_of(dataset), dataset)
    found = origins(path)
    assert not [one for one in found if "/steps/" in one or "/torque/" in one or one.endswith("/following")]


@pytest.fixture
def runs():
    dataset = dataset_of(load_robot("five_bar"), duration=1.0)
    result = identification_of(dataset)
    worse = replace(
        result, recordings=tuple(replace(one, modelled=one.modelled - 0.1) for one in result.recordings)
    )
    return [ViewedRun("run 1, seed 1", result, dataset), ViewedRun("run 2, seed 7", worse, dataset)]


def test_runs_stand_side_by_side(runs, tmp_path):
    path = tmp_path / "runs.rrd"
    write_side_by_side(path, runs)
    assert verified(path)
    found = origins(path)
    for k, run in enumerate(runs):
        root = f"/{k} {run.title}".replace(" ", "\\ ").replace(",", "\\,")
        series = run.result.recordings[0]
        error = numbers(path, f"{root}/unloaded/error/left/error")[1]
        moving = series.moving[:, 0]
        np.testing.assert_array_equal(error[moving], series.error[moving, 0])
        assert {f"{root}/unloaded/robot", f"{root}/check/error/right", f"{root}/summary"} <= found
    for origin in found:
        assert batches(path, f"{origin}/**", static=False) or batches(path, origin, static=True), origin


def test_other_robots_do_not_stand_side_by_side(runs, tmp_path):
    dataset = dataset_of(load_robot("delta"), duration=1.0)
    other = ViewedRun("delta", identification_of(dataset), dataset)
    with pytest.raises(BenchError, match=r"five_bar and delta have other motors"):
        write_side_by_side(tmp_path / "runs.rrd", [runs[0], other])
    with pytest.raises(BenchError, match=r"nothing to show"):
        write_side_by_side(tmp_path / "runs.rrd", [])
    assert not list(tmp_path.iterdir())
