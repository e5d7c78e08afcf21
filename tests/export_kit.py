"""Identified models of short simulations, saved as a user would have them."""

import functools
import shutil
import tempfile
from pathlib import Path

from bench.dataset.catalogue import built_in_robots
from bench.dataset.robot import load_robot
from bench.export.identified import load_identified
from bench.identification.identify import identify
from bench.identification.model_file import save_model
from bench.identification.prepare import prepare
from bench.identification.problem import problem_of
from bench.truth.dataset import as_dataset
from tests.hidden_kit import run

FRICTION = (
    {"effect": "coulomb_friction", "joint": "left", "Fc": 0.2},
    {"effect": "viscous_friction", "joint": "left", "Fv": 0.1},
)
RICH = {"optimise": False, "duration": 5.0, "ramp": 0.5}


@functools.cache
def simulated(name, hidden=(), **overrides):
    """The dataset of a short simulation; hidden: names of the above."""
    return as_dataset(run(name, *(FRICTION if hidden else ()), design=RICH, **overrides))


@functools.cache
def identified_file(name, hidden=False, effects=(), **overrides):
    """A model file of it."""
    path = Path(tempfile.mkdtemp()) / f"{name}.json"
    save_model(identify(prepare(problem_of(simulated(name, hidden, **overrides), effects))), path)
    return path


def identified(name, hidden=False, effects=(), **overrides):
    """The same, read."""
    return load_identified(identified_file(name, hidden, effects, **overrides))


def robot_with(folder, source, name):
    """A robot folder whose MJCF is an exported file."""
    folder.mkdir()
    shutil.copy(built_in_robots()[name] / "robot.toml", folder)
    shutil.copy(source, folder / f"{name}.xml")
    return load_robot(folder)
