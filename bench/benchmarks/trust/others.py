"""Robots of other people for the evaluation: copies without friction, with planned motions."""

import shutil
from collections.abc import Sequence
from pathlib import Path

import mujoco
import numpy as np

from bench.basics.files.atomic import whole_folder
from bench.benchmarks.measured_data import measured_data
from bench.benchmarks.trust.run import DURATION
from bench.dataset.robot import Robot, load_robot
from bench.excitation.experiment.files import SCENARIO, write_plan
from bench.excitation.experiment.forecast import forecast
from bench.excitation.experiment.plan import plan_experiment
from bench.excitation.experiment.request import ExperimentTable
from bench.scenario.tables import DeclaredPayload
from bench.studies.rehearsal import rehearse

OTHERS = ("g1_ankle", "jurmy_delta")
"""Folders of `foreign` in the measured data: a spatial ankle with two motors, and a Delta."""

PREPARED = "others"
"""The folder of the prepared robots, beside the cases."""

LIMITS = ExperimentTable(
    velocity=2.0, acceleration=20.0, duration=DURATION, payload=DeclaredPayload(mass=0.2)
)
"""What small robots can do: rad/s, rad/s^2, s, kg."""


def scenarios_of_others(folder: Path, names: Sequence[str] = OTHERS) -> list[str]:
    """The scenario files of those robots that are present, with the motions of `bench excite`.

    folder: receives robots and plans; those of an earlier call stay, since they are the same.
    """
    present = [name for name in names if (measured_data() / "foreign" / name).is_dir()]
    return [str(_prepared(measured_data() / "foreign" / name, folder / name)) for name in present]


def _prepared(source: Path, folder: Path) -> Path:
    scenario = folder / "plan" / SCENARIO
    if not (folder / "robot").is_dir():
        with whole_folder(folder / "robot") as partial:
            shutil.copytree(source, partial, dirs_exist_ok=True, copy_function=shutil.copyfile)
            _without_friction(load_robot(partial))
    if not scenario.is_file():
        plan = plan_experiment(load_robot(folder / "robot"), LIMITS)
        write_plan(scenario.parent, plan, forecast(plan), {}, rehearse(plan).drive)
    return scenario


def _without_friction(robot: Robot) -> None:
    """Remove what the drawing adds to rigid bodies and rotors, since only the hidden effects may act."""
    path = robot.model_path
    spec = mujoco.MjSpec.from_file(str(path))
    for joint in spec.joints:
        joint.frictionloss, joint.damping = 0.0, np.zeros(3)
        if joint.name not in robot.joints:
            joint.armature = 0.0
    spec.compile()
    path.write_text(spec.to_xml(), encoding="utf-8")
