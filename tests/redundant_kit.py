"""A five-bar with a third motor at its left elbow, by hand: what it gives is known, and the others give less."""

import shutil
from dataclasses import replace
from functools import cache
from pathlib import Path

import mujoco
import numpy as np

from bench.dataset.dataset import Dataset
from bench.dataset.robot import load_robot
from bench.scenario.scenario import load_scenario
from bench.truth.assembly import following
from bench.truth.dataset import as_dataset
from bench.truth.simulate import Simulation, simulate
from tests.hidden_kit import STEP

ELBOW = '\n[[actuators]]\njoint = "left_elbow"\ngain = 1.0\ngain_unit = "N*m/A"\n'
GAIN = 1.08  # N m/A, true
TRUE = {"left": 3.3, "right": 2.76, "left_elbow": GAIN}


def with_third_motor(root: Path, folder: Path) -> Path:
    """The folder of a five-bar whose left elbow has a motor too."""
    own = shutil.copytree(root / "robots" / "five_bar", folder / "third_motor")
    description = own / "robot.toml"
    text = description.read_text()
    description.write_text(text.replace("\n[tool]", f"{ELBOW}\n[tool]"))
    return own


@cache
def _plain() -> Simulation:
    """The five-bar as it is, short movements, no noise."""
    design = {"optimise": False, "duration": 6.0, "base_frequency": 0.4}
    sensors = {"encoder_bits": 0, "current_noise_ratio": 0.0}
    return simulate(load_scenario("five_bar", {"design": design, "sensors": sensors, "step": STEP}))


@cache
def by_hand(folder: Path, noise: float = 0.0, seed: int = 0) -> Dataset:
    """A dataset of the robot in this folder. noise: of every current, as a share of its RMS."""
    simulation, robot = _plain(), load_robot(folder)
    random = np.random.default_rng(seed)
    recordings = []
    for one, true in zip(as_dataset(simulation).recordings, simulation.recordings, strict=True):
        model = simulation.machine.models[true.table.payload]
        follow = elbow_speeds(model, simulation.machine.dofs, true.motion.qpos)
        t = one.time
        elbow = 0.8 * np.sin(2.0 * np.pi * 0.7 * t) + 0.5 * np.sin(2.0 * np.pi * 1.9 * t + len(recordings))
        gains = np.array([TRUE["left"], TRUE["right"]])
        current = one.current - follow * (GAIN * elbow)[:, None] / gains
        every = np.column_stack((current, elbow))
        every = every + noise * np.sqrt((every**2).mean(axis=0)) * random.normal(size=every.shape)
        recordings.append(replace(one, current=every[:, :2], redundant=every[:, 2:]))
    return replace(as_dataset(simulation), robot=robot, recordings=tuple(recordings))


def elbow_speeds(model: mujoco.MjModel, dofs: np.ndarray, poses: np.ndarray, step: int = 4) -> np.ndarray:
    """Speed (N, n) of the left elbow for unit speeds of the motors at these poses (N, nq)."""
    data = mujoco.MjData(model)
    index = int(model.joint("left_elbow").dofadr[0])
    at = np.append(np.arange(0, len(poses) - 1, step), len(poses) - 1)
    rows = np.empty((len(at), len(dofs)))
    for k, pose in enumerate(poses[at]):
        data.qpos[:] = pose
        rows[k] = following(model, data, dofs)[index]
    every = np.arange(len(poses))
    return np.column_stack([np.interp(every, at, row) for row in rows.T])
