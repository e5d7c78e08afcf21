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
    result = identify(wrong)
    (note,) = swapped_notes(wrong, result)
    assert note.startswith("The columns current.left and current.right are probably swapped: ")
    assert f"falls from {100 * result.error.identify:.3g} % to" in note


def test_on_a_symmetric_robot_positions_may_be_those_swapped(tmp_path):
    delta = load_dataset(write_dataset(tmp_path / "d", robot="delta", hidden=(), duration=5.0))
    wrong = replace(delta, recordings=tuple(_exchanged(one, 0, 2) for one in delta.recordings))
    (note,) = swapped_notes(wrong, identify(wrong))
    for what in ("current", "position"):
        assert f"{what}.motor_1 and {what}.motor_3" in note


def test_nothing_is_suspected_of_good_data_or_of_a_missing_effect(five_bar, tmp_path):
    assert swapped_notes(five_bar, identify(five_bar)) == []
    strong = [one | {"Fc": 2.0} if "Fc" in one else one for one in FRICTION]
    lacking = load_dataset(write_dataset(tmp_path / "d", hidden=strong))
    result = identify(lacking)
    assert result.error.identify > LARGE
    assert swapped_notes(lacking, result) == []
