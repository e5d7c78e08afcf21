"""True parameters beside estimated ones, where the motors see a sum of several joints' friction."""

import numpy as np
import pytest

from bench.identification.identify import identify
from bench.identification.prepare import prepare
from bench.identification.problem import problem_of
from bench.studies.trial.intervals import intervals, moving_alike
from bench.studies.trial.setup import make_setup
from bench.truth.dataset import as_dataset
from tests.hidden_kit import plain, run


def test_rods_of_a_parallelogram_move_alike():
    setup = make_setup("delta")
    alike = moving_alike(plain("delta"), setup.passive)
    assert alike["rod_2b_roll"] == alike["rod_2a_roll"] == "rod_2a_roll"
    assert alike["rod_2b_pitch"] == "rod_2a_pitch"
    assert len(set(alike.values())) == 6
    five_bar = moving_alike(plain("five_bar"), make_setup("five_bar").passive)
    assert all(joint == first for joint, first in five_bar.items())


@pytest.mark.parametrize(
    ("joints", "expected"),
    [(("rod_1a_pitch",), 0.5), (("rod_1b_pitch",), 0.5), (("rod_1a_pitch", "rod_1b_pitch"), 1.0)],
)
def test_the_motors_see_the_sum(joints, expected):
    setup = make_setup("delta")
    hidden = [{"effect": "passive_viscous_friction", "joint": joint, "Fv": 0.5} for joint in joints]
    simulation = run("delta", *hidden)
    result = identify(prepare(problem_of(as_dataset(simulation), ["passive_viscous_friction:rod_1a_pitch"])))
    (one,) = intervals(setup, hidden, result, moving_alike(simulation, setup.passive))
    assert (one["effect"], one["at"], one["parameter"]) == ("passive_viscous_friction", "rod_1a_pitch", "Fv")
    assert one["truth"] == expected
    assert abs(one["value"] - one["truth"]) < 5 * one["std"]
    assert np.isfinite(one["std"])
