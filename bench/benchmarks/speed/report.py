"""Cost of a report of 60 s at 1 kHz with six motors, and with a workbench of the whole catalogue."""

from collections.abc import Mapping
from pathlib import Path
from tempfile import TemporaryDirectory
from time import perf_counter
from typing import Any

import numpy as np

from bench.dataset.dataset import Dataset, load_dataset
from bench.diagnosis.reason import Because, Reason
from bench.diagnosis.result import Diagnosis, EffectVerdict, LadderStep, Remainder, Unexplained
from bench.diagnosis.unexplained import relative_noise_floor
from bench.effects import CATALOGUE
from bench.excitation.scenario import designer
from bench.identification.identify import identify
from bench.identification.prepare import prepare
from bench.identification.problem import problem_of
from bench.page.folder import read_run
from bench.page.section_run import CommandRun
from bench.page.write import write_diagnosis_report, write_saved_run
from bench.scenario.scenario import resolve_trajectories, scenario_from_dict
from bench.truth.dataset import write_simulation
from bench.truth.simulate import simulate

LEGS = 6
BASE, PLATFORM = 0.40, 0.22  # m, radii of the joints
HALF_ANGLE = 0.2  # rad, between a joint of a pair and the middle of the pair
HEIGHT = 0.65  # m, of the platform above the base in the home pose
RETRACTED = 0.35  # m, from a rod's origin to its end, the ball joint

_LEG = """
    <body name="leg_{i}" pos="{foot}" quat="{turn}">
      <inertial pos="0 0 0.15" mass="2.0" diaginertia="0.02 0.02 0.003"/>
      <joint name="tilt_{i}" type="hinge" axis="1 0 0"/>
      <joint name="swing_{i}" type="hinge" axis="0 1 0"/>
      <body name="rod_{i}" pos="0 0 {inside}">
        <inertial pos="0 0 0.20" mass="1.2" diaginertia="0.015 0.015 0.001"/>
        <joint name="leg_{i}" type="slide" axis="0 0 1" range="-0.2 0.2" armature="4"/>
      </body>
    </body>"""

_MODEL = """<mujoco model="hexapod">
  <compiler angle="radian" autolimits="true" inertiafromgeom="false"/>
  <option timestep="0.00025" integrator="Euler" solver="Newton" jacobian="dense">
    <flag contact="disable"/>
  </option>
  <default>
    <equality solref="0.002 1" solimp="0.9999 0.99999 0.001"/>
  </default>
  <worldbody>{legs}
    <body name="platform" pos="0 0 {height}">
      <freejoint name="pose"/>
      <inertial pos="0.01 -0.005 0.02" mass="6.0" diaginertia="0.08 0.09 0.15"/>
      <site name="tool" pos="0 0 0.03"/>
    </body>
  </worldbody>
  <equality>{loops}
  </equality>
</mujoco>
"""

_ACTUATOR = """
[[actuators]]
joint = "leg_{i}"
gain = 40.0
gain_unit = "N/A"
"""
LIMIT = 15.0  # s
AGAIN_LIMIT = 2.0  # s
DURATION = 20.0  # s, of each of three recordings
MISSING = ("coulomb_friction", "viscous_friction:leg_2")
ABSORBED = ("payload_mass_error", "rotor_inertia")


def write_hexapod(folder: Path) -> Path:
    """Write the robot's folder, MJCF and robot.toml; return its path."""
    legs, loops = [], []
    for i in range(LEGS):
        foot, ball = _joint(i, BASE, 0.0, outer=False), _joint(i, PLATFORM, HEIGHT, outer=True)
        length = float(np.linalg.norm(ball - foot))
        numbers = {
            "foot": _text(foot),
            "turn": _text(_turn(ball - foot)),
            "inside": f"{length - RETRACTED:.9g}",
        }
        legs.append(_LEG.format(i=i + 1, **numbers))
        loops.append(f'\n    <connect body1="rod_{i + 1}" body2="platform" anchor="0 0 {RETRACTED}"/>')
    folder.mkdir(parents=True, exist_ok=True)
    model = _MODEL.format(legs="".join(legs), loops="".join(loops), height=HEIGHT)
    (folder / "hexapod.xml").write_text(model, encoding="utf-8")
    head = 'name = "hexapod"\nmodel = "hexapod.xml"\n'
    motors = "".join(_ACTUATOR.format(i=i + 1) for i in range(LEGS))
    (folder / "robot.toml").write_text(f'{head}{motors}\n[tool]\nsite = "tool"\n', encoding="utf-8")
    return folder


def _joint(i: int, radius: float, height: float, *, outer: bool) -> np.ndarray:
    """Position (3,) of a leg's joint: three pairs on the base, and on the platform three pairs 60 degrees away."""
    pair, side = divmod(i + 1, 2) if outer else divmod(i, 2)
    middle = 2.0 * np.pi * (pair + (-0.5 if outer else 0.0)) / 3.0
    angle = middle + (2 * side - 1) * HALF_ANGLE
    return np.array([radius * np.cos(angle), radius * np.sin(angle), height])


def _turn(direction: np.ndarray) -> np.ndarray:
    """Quaternion (w, x, y, z) that rotates the z axis to a direction."""
    unit = direction / np.linalg.norm(direction)
    turn = np.array([1.0 + unit[2], -unit[1], unit[0], 0.0])
    return np.asarray(turn / np.linalg.norm(turn))


def _text(values: np.ndarray) -> str:
    return " ".join(f"{value:.9g}" for value in values)


SCENARIO: Mapping[str, Any] = {
    "seed": 3,
    "gains": {
        "error": {f"leg_{i + 1}": value for i, value in enumerate((0.08, -0.06, 0.05, -0.04, 0.1, -0.09))}
    },
    "payloads": {
        "block": {"mass": 3.0, "center_of_mass": [0.0, 0.0, 0.05], "inertia": [6e-3, 6e-3, 6e-3, 0, 0, 0]}
    },
    "sensors": {"encoder_resolution": 1e-6, "current_noise_ratio": 0.01},
    "design": {
        "harmonics": 8,
        "base_frequency": 0.2,
        "duration": DURATION,
        "span": 0.06,
        "velocity_limit": 0.5,
        "acceleration_limit": 8.0,
    },
    "recordings": [
        {"name": "unloaded", "use": "identify", "design": {"seed": 1}},
        {"name": "loaded", "use": "identify", "payload": "block", "design": {"seed": 2}},
        {"name": "check", "use": "validate", "design": {"seed": 3}},
    ],
    "hidden": [
        {"effect": "coulomb_friction", "Fc": 8.0},
        {"effect": "viscous_friction", "joint": "leg_2", "Fv": 40.0},
    ],
}


def six_motors(folder: Path, duration: float = DURATION) -> Dataset:
    """A simulated platform on six legs; robot and recordings of `duration` s are written into the folder."""
    content = {**SCENARIO, "robot": str(write_hexapod(folder / "hexapod"))}
    content["design"] = {**content["design"], "duration": duration}
    scenario = scenario_from_dict(content, "hexapod")
    write_simulation(simulate(scenario, resolve_trajectories(scenario, designer)), folder / "data")
    return load_dataset(folder / "data")


def stand_in_diagnosis(dataset: Dataset) -> Diagnosis:
    """A diagnosis that names the hidden effects, made without a search, with all effects in its ranking."""
    before, after = identify(prepare(problem_of(dataset))), identify(prepare(problem_of(dataset, MISSING)))
    errors = [(result.error.identify or 0.0, result.error.validate or 0.0) for result in (before, after)]
    missing = tuple(name.partition(":")[0] for name in MISSING)
    ranking = tuple(
        EffectVerdict(
            effect=name,
            verdict="missing" if name in missing else "absorbed" if name in ABSORBED else "not supported",
            error_before=errors[0][1],
            error_after=errors[1][1],
            evidence=1.0,
            actuators=(),
            alternatives=(),
            size={},
            why=Reason(Because.EXPLAINS),
        )
        for name in (*missing, *(name for name in CATALOGUE if name not in missing))
    )
    floor = relative_noise_floor(dataset.recordings, after.recordings, after.settings)
    return Diagnosis(
        robot=dataset.robot.name,
        held_out=0.0,
        missing=missing,
        ladder=(LadderStep((), *errors[0]), LadderStep(missing, *errors[1])),
        ranking=ranking,
        unexplained=Unexplained(Remainder.NOISE, errors[1][1], floor, ()),
        before=before,
        after=after,
    )


def measure() -> tuple[float, float]:
    """Seconds to write the page of a finished diagnosis, and to write it again from its folder."""
    with TemporaryDirectory() as name:
        folder = Path(name)
        dataset = six_motors(folder)
        diagnosis = stand_in_diagnosis(dataset)
        start = perf_counter()
        write_diagnosis_report(folder / "out", diagnosis, dataset, CommandRun("diagnose", "data"))
        written = perf_counter()
        write_saved_run(folder / "again.html", read_run(folder / "out"), folder / "out")
        return written - start, perf_counter() - written
