"""Two columns taken for each other are named; a model that merely lacks an effect is not suspected."""

from dataclasses import replace

import pytest

from bench.dataset import load_dataset
from bench.estimate.identify import identify
from bench.estimate.swapped import LARGE, swapped_notes
from tests.workbench_kit import FRICTION, write_dataset


def _exchanged(recording, first, second):
    order = list(range(recording.current.shape[1]))
    order[first], order[second] = second, first
    return replace(recording, current=recording.current[:, order])


@pytest.fixture(scope="module")
def five_bar(tmp_path_factory):
    return load_dataset(write_dataset(tmp_path_factory.mktemp("plain") / "d", hidden=()))


def test_swapped_currents_are_named_with_the_error_they_cause(five_bar):
    wrong = replace(five_bar, recordings=tuple(_exchanged(one, 0, 1) for one in five_bar.recordings))
    (note,) = swapped_notes(wrong, identify(wrong))
    assert note.startswith(
        "The columns of left and right are probably swapped: with current.left and current.right"
    )


def test_one_swapped_recording_is_named_though_friction_is_missing(lacking):
    recordings = tuple(_exchanged(one, 0, 1) if one.name == "held.csv" else one for one in lacking.recordings)
    wrong = replace(lacking, recordings=recordings)
    (note,) = swapped_notes(wrong, identify(wrong))
    assert note.startswith("The columns of left and right in held.csv are probably swapped")


def test_swapped_currents_of_a_symmetric_robot_are_named(tmp_path):
    delta = load_dataset(write_dataset(tmp_path / "d", robot="delta", hidden=(), duration=5.0))
    wrong = replace(delta, recordings=tuple(_exchanged(one, 0, 2) for one in delta.recordings))
    (note,) = swapped_notes(wrong, identify(wrong))
    assert "current.motor_1 and current.motor_3" in note


@pytest.fixture(scope="module")
def lacking(tmp_path_factory):
    strong = [one | {"Fc": 2.0} if "Fc" in one else one for one in FRICTION]
    return load_dataset(write_dataset(tmp_path_factory.mktemp("lacking") / "d", hidden=strong))


def test_nothing_is_suspected_of_good_data_or_of_a_missing_effect(five_bar, lacking):
    assert swapped_notes(five_bar, identify(five_bar)) == []
    result = identify(lacking)
    assert result.error.identify > LARGE
    assert swapped_notes(lacking, result) == []
