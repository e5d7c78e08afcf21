"""A tilted base: what gravity then moves, and what no base parameter holds of it."""

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from bench.api.diagnose import diagnose
from bench.dataset.robot import load_robot
from bench.effects.laws.base_tilt import BaseTilt
from bench.export.identified import load_identified
from bench.export.physical import physical_set
from bench.export.replay.replay import replay
from bench.identification.identify import identify
from bench.identification.model_file import save_model
from bench.identification.prepare import prepare
from bench.identification.problem import problem_of
from bench.model.geometry import Geometry
from bench.model.model import build_model
from bench.model.motion import Motion
from bench.model.regressor import projected_regressor
from bench.model.states import random_motion
from bench.scenario.scenario import load_scenario
from bench.truth.dataset import as_dataset
from bench.truth.simulate import simulate
from tests.hidden_kit import run
from tests.mechanisms import NAMES, robot_named
from tests.test_robots_of_others import NAMES as FOREIGN

STATES, SEED = 60, 3
ROUNDED = 1e-6  # of the largest; drawings of other people are rounded

Drawn = Callable[[str], Path]


@pytest.fixture
def drawn(tmp_path: Path, measured_data: Path) -> Drawn:
    """The folder of a robot."""

    def folder(name: str) -> Path:
        if name in NAMES:
            return Path(robot_named(name, tmp_path).folder)
        found = measured_data / "foreign" / name
        if not found.is_dir():
            pytest.skip(
                "the robots that other people drew are not with the measured data (set PARABENCH_DATA)"
            )
        return found

    return folder


def weights(geometry: Geometry, motion: Motion) -> np.ndarray:
    """Columns (N n, k) of what `BaseTilt` is in single joints, written down once more."""
    columns = []
    for name, effect in BaseTilt().in_joints_of(geometry).items():
        joint = geometry.joints[geometry.joint_index(name)]
        angle = motion.q[:, joint.q.start]
        parts = (np.cos(angle), np.sin(angle)) if joint.kind == "hinge" else (np.ones(len(angle)),)
        assert len(parts) == len(effect.parameters)
        columns += [motion.jacobian[:, joint.v.start, :] * part[:, None] for part in parts]
    flat = [column.reshape(-1) for column in columns]
    return (
        np.stack(flat, axis=1) if flat else np.zeros((motion.jacobian.shape[0] * motion.jacobian.shape[2], 0))
    )


@pytest.mark.parametrize("name", [*NAMES, *FOREIGN])
def test_whatever_a_level_gravity_moves_follows_from_base_parameters_and_weights_in_single_joints(
    name: str, drawn: Drawn
) -> None:
    """For any masses: the columns of all standard parameters and rotors under a gravity along another axis."""
    model = build_model(load_robot(drawn(name)))
    geometry, base = model.geometry, model.base
    if not np.any(geometry.gravity):
        pytest.skip("without gravity a tilt changes nothing")
    motion = random_motion(geometry, STATES, SEED)
    count = base.grouping.shape[1]
    bodies = np.flatnonzero(np.any(base.grouping != 0.0, axis=0))
    carried = [10 * joint + k for joint, _ in geometry.bodies for k in range(10)]
    every = np.unique([*bodies, *carried])
    kept = base.columns[base.columns < count]
    own = weights(geometry, motion)
    vertical = int(np.argmax(np.abs(geometry.gravity)))

    def of_gravity(axis: int, columns: np.ndarray) -> np.ndarray:
        rows = [
            projected_regressor(replace(geometry, gravity=size * np.eye(3)[axis]), motion, columns)
            for size in (9.81, 0.0)
        ]
        return (rows[0] - rows[1]).reshape(-1, len(columns))

    for axis in {0, 1, 2} - {vertical}:
        whole, grouped = of_gravity(axis, every), of_gravity(axis, kept)
        missing = whole - grouped @ base.grouping[: len(kept)][:, every]
        rotors = -grouped @ base.rotors[: len(kept)]
        unseen = np.concatenate((missing, rotors), axis=1)
        left = unseen - own @ np.linalg.lstsq(own, unseen)[0] if own.shape[1] else unseen
        assert np.linalg.norm(left, axis=0).max() <= ROUNDED * np.linalg.norm(whole, axis=0).max(initial=1.0)


def test_a_tilt_of_a_robot_whose_cranks_turn_about_the_vertical_is_named_alone() -> None:
    """Cosines of the crank angles were called constant offsets and cogging before their weight was estimated."""
    hidden = [{"effect": "base_tilt", "about_x": 0.01, "about_y": -0.02}]
    changes = {"seed": 2, "step": 0.0005, "design": {"optimise": False, "duration": 10.0}, "hidden": hidden}
    answer = diagnose(as_dataset(simulate(load_scenario("three_rrr", changes))), discover=False)
    assert answer.missing == ("base_tilt",)
    tilt = answer.after.effect_parameters["base_tilt"]["robot"]
    for parameter, value in (("tilt_x", 0.01), ("tilt_y", -0.02)):
        assert abs(tilt[parameter].value - value) < 3.0 * tilt[parameter].std


def test_a_saved_model_has_the_weights_at_their_joints(tmp_path: Path) -> None:
    dataset = as_dataset(run("three_rrr", {"effect": "base_tilt", "about_x": 0.01, "about_y": -0.02}))
    result = identify(prepare(problem_of(dataset, ["base_tilt"])))
    assert result.effects == ("base_tilt",)
    save_model(result, tmp_path / "model.json")
    model = load_identified(tmp_path / "model.json")
    assert [effect.place for effect in model.effects_in()] == ["", "motor_1", "motor_2", "motor_3"]
    found = replay(problem_of(dataset), physical_set(model))
    assert found.left_out == ("base_tilt", *(f"base_tilt at motor_{k}" for k in (1, 2, 3)))
    assert found.model.error.identify == pytest.approx(result.error.identify, rel=1e-3)
