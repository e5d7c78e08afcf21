"""Two columns taken for each other are named; a model that merely lacks an effect is not suspected."""

from dataclasses import replace

import numpy as np
import pytest

from bench.dataset.dataset import load_dataset
from bench.identification.finding_words import sentence
from bench.identification.findings import with_findings
from bench.identification.identify import identify
from bench.identification.prepare import prepare
from bench.identification.problem import problem_of
from bench.identification.swapped_columns import swapped_columns
from bench.identification.tolerances import TOLERANCES
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
    (note,) = swapped_columns(problem_of(wrong), identify(prepare(problem_of(wrong))))
    assert sentence(note).startswith(
        "The columns of left and right are probably swapped: with current.left and current.right"
    )


def test_one_swapped_recording_is_named_though_friction_is_missing(lacking):
    recordings = tuple(_exchanged(one, 0, 1) if one.name == "held.csv" else one for one in lacking.recordings)
    wrong = replace(lacking, recordings=recordings)
    (note,) = swapped_columns(problem_of(wrong), identify(prepare(problem_of(wrong))))
    assert sentence(note).startswith("The columns of left and right in held.csv are probably swapped")


def test_swapped_currents_of_a_symmetric_robot_are_named(tmp_path):
    delta = load_dataset(write_dataset(tmp_path / "d", robot="delta", hidden=(), duration=5.0))
    wrong = replace(delta, recordings=tuple(_exchanged(one, 0, 2) for one in delta.recordings))
    (note,) = swapped_columns(problem_of(wrong), identify(prepare(problem_of(wrong))))
    assert "current.motor_1 and current.motor_3" in sentence(note)


@pytest.fixture(scope="module")
def lacking(tmp_path_factory):
    strong = [one | {"Fc": 2.0} if "Fc" in one else one for one in FRICTION]
    return load_dataset(write_dataset(tmp_path_factory.mktemp("lacking") / "d", hidden=strong))


def test_nothing_is_suspected_of_good_data_or_of_a_missing_effect(five_bar, lacking):
    assert swapped_columns(problem_of(five_bar), identify(prepare(problem_of(five_bar)))) == []
    result = identify(prepare(problem_of(lacking)))
    assert result.error.identify > TOLERANCES.findings.large_error
    assert swapped_columns(problem_of(lacking), result) == []


def test_the_error_told_is_that_of_a_fit_with_the_columns_exchanged(five_bar):
    wrong = replace(five_bar, recordings=tuple(_exchanged(one, 0, 1) for one in five_bar.recordings))
    result = identify(prepare(problem_of(wrong)))
    (note,) = swapped_columns(problem_of(wrong), result)
    told = note.numbers["error"]
    right = identify(
        prepare(problem_of(five_bar, ("coulomb_friction", "viscous_friction"), filters=result.settings))
    )
    assert told == pytest.approx(right.error.identify, rel=0.02)
    assert swapped_columns(
        problem_of(wrong), result, prepare(problem_of(wrong, (), filters=result.settings))
    ) == [note]


def test_currents_that_no_exchange_explains_are_no_swap(five_bar):
    wrong = replace(
        five_bar,
        recordings=tuple(
            replace(one, current=np.roll(one.current, len(one.time) // 3, axis=0))
            for one in five_bar.recordings
        ),
    )
    result = identify(prepare(problem_of(wrong)))
    assert result.error.identify > 2.0 * TOLERANCES.findings.large_error
    assert swapped_columns(problem_of(wrong), result) == []


def test_a_swap_must_better_the_very_result_that_it_comments(five_bar):
    wrong = replace(five_bar, recordings=tuple(_exchanged(one, 0, 1) for one in five_bar.recordings))
    result, well = identify(prepare(problem_of(wrong))), identify(prepare(problem_of(five_bar)))
    assert result.error.identify > 2.0 * TOLERANCES.findings.large_error
    assert swapped_columns(problem_of(wrong), replace(result, error=well.error)) == []


def test_a_reversed_sign_is_told_only_where_the_other_sign_explains_the_current(five_bar):
    turned = tuple(replace(one, current=one.current * [-1.0, 1.0]) for one in five_bar.recordings)
    result = identify(prepare(problem_of(replace(five_bar, recordings=turned))))
    (told,) = [note for note in result.notes if "is negative, which is impossible" in note]
    assert "the sign of current.left, or of position.left, is probably reversed" in told
    gain = result.drive_gains["left"]
    weak = replace(result, drive_gains={**result.drive_gains, "left": replace(gain, value=0.3 * gain.value)})
    (told,) = [note for note in with_findings(weak, ()).notes if "is negative, which is impossible" in note]
    assert "probably reversed" not in told
    assert "mounted differently" in told
