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


def test_periods_on_a_slide_are_per_metre():
    """A cycle of 20 mm is 50 periods in a metre; on a hinge it would be 2 pi times as many in a turn."""
    hidden = [{"effect": "cogging_torque", "joint": "axis_1", "a": 2.0, "b": 1.0, "period": 0.02}]
    result = identify(prepare(problem_of(as_dataset(run("orthoglide", *hidden)), ["cogging_torque:axis_1"])))
    rows = {row["parameter"]: row for row in intervals(make_setup("orthoglide"), hidden, result, {})}
    assert rows["periods"]["truth"] == pytest.approx(50.0)
    assert all(abs(row["value"] - row["truth"]) < 5 * row["std"] for row in rows.values())
