"""A simulation made again from its truth file, and the torque of what is hidden in it."""

import json

import numpy as np
import pytest

from bench.basics.errors import BenchError
from bench.dataset.dataset import load_dataset
from bench.identification.effect_torques import effect_torques
from bench.identification.identify import identify
from bench.identification.prepare import prepare
from bench.identification.problem import problem_of
from bench.truth.dataset import truth_path, write_simulation
from bench.truth.inverse import hidden_torque, plain_machine
from bench.truth.resense import repeated
from bench.truth.simulate import simulate
from tests.hidden_kit import scenario

FRICTION = {"effect": "viscous_friction", "joint": "left", "Fv": 0.3}
DESIGN = {"optimise": False, "duration": 4.0, "ramp": 0.5}


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    made = scenario("five_bar", [FRICTION], design=DESIGN)
    path = tmp_path_factory.mktemp("repeat") / "data"
    write_simulation(simulate(made), path)
    return path


@pytest.fixture(scope="module")
def again(folder):
    path = truth_path(folder)
    return repeated(json.loads(path.read_text()), str(path))


def test_it_is_the_same_to_the_last_bit(folder, again):
    for logged, made in zip(load_dataset(folder).recordings, again.recordings, strict=True):
        np.testing.assert_array_equal(made.log.position, logged.position)
        np.testing.assert_array_equal(made.log.current, logged.current)


def test_hidden_friction_is_the_torque_that_it_takes(again):
    plain = plain_machine(again)
    for recording in again.recordings:
        found = hidden_torque(again, recording, plain)
        rows = np.searchsorted(recording.motion.time, found.time - 1e-9)
        velocity = recording.motion.qvel[rows][:, again.machine.dofs]
        expected = velocity * (FRICTION["Fv"], 0.0)
        assert np.abs(expected).max() > 0.1
        np.testing.assert_allclose(found.torque, expected, atol=2e-3)
        np.testing.assert_array_equal(found.reference, recording.motion.reference[rows])
        assert 0.0 < found.loop_gap.max() < 1e-5


def test_the_model_finds_the_torque_that_is_hidden(folder, again):
    dataset = load_dataset(folder)
    result = identify(prepare(problem_of(dataset, ["viscous_friction:left"])))
    plain = plain_machine(again)
    for torque, recording in zip(effect_torques(result.recordings), again.recordings, strict=True):
        truth = hidden_torque(again, recording, plain)
        assert list(torque.by_effect) == ["viscous_friction"]
        found = np.interp(truth.time, torque.time, torque.total[:, 0])
        inner = (truth.time > torque.time[0]) & (truth.time < torque.time[-1]) & np.isfinite(found)
        error = np.sqrt(np.mean((found - truth.torque[:, 0])[inner] ** 2))
        assert error < 0.05 * np.sqrt(np.mean(truth.torque[inner, 0] ** 2))
        assert not np.nan_to_num(torque.total[:, 1]).any()


def test_a_damaged_truth_file_is_told():
    with pytest.raises(BenchError, match=r"x.truth.json: damaged truth file: KeyError at 'settings'"):
        repeated({}, "x.truth.json")
