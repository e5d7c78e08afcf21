"""Positions along which the loops cannot be closed: what they would close with is named."""

from dataclasses import replace

import numpy as np
import pytest

from bench.basics.errors import BenchError
from bench.identification.prepare import prepare
from bench.identification.problem import problem_of
from bench.truth.dataset import as_dataset
from tests.hidden_kit import plain


def refusal(change, robot: str = "five_bar") -> str:
    dataset = as_dataset(plain(robot))
    recordings = tuple(replace(one, position=change(one.position)) for one in dataset.recordings)
    with pytest.raises(BenchError) as error:
        prepare(problem_of(replace(dataset, recordings=recordings)))
    return str(error.value)


def test_a_sign_is_named_with_the_option_that_changes_it():
    said = refusal(lambda position: position * np.array([1.0, -1.0, 1.0]), "orthoglide")
    assert "they close with" in said
    assert "the other sign of position.axis_2 (import with `--scale position.axis_2=-1`)" in said


def test_exchanged_positions_are_named():
    assert refusal(lambda position: position[:, ::-1]).endswith(
        "they close with position.left and position.right exchanged"
    )


def test_nothing_is_named_where_nothing_helps():
    assert "they close with" not in refusal(lambda position: 3.0 * position, "orthoglide")
