"""The robot of a trial: its motions, and the effects that can be hidden in it."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, Literal

import numpy as np

from bench.basics.errors import BenchError
from bench.basics.joint_units import units_of_gain
from bench.dataset.catalogue import built_in_scenarios
from bench.dataset.robot import Robot, load_robot
from bench.effects import CATALOGUE, places_in
from bench.effects.body_length import lengths
from bench.effects.places import Places
from bench.model.geometry import read_geometry
from bench.scenario.file import find_scenario, read_with_bases
from bench.studies.trial.unknown import LAW
from bench.truth.hidden import HIDDEN_EFFECTS, JointEffect
from bench.truth.hidden.laws.geometric_error import reach_of

Where = Literal["actuated", "passive", "link", "machine"]
MOVEMENTS = (
    ("unloaded", "identify"),
    ("loaded", "identify"),
    ("unloaded_check", "validate"),
    ("loaded_check", "validate"),
)
PAYLOAD_SHARE = 0.25  # of the mass of all bodies


@dataclass(frozen=True)
class Setup:
    """The common part of all cases of a trial.

    name: of the robot. content: of a scenario file without hidden effects. motors: actuated joints. passive: joints
    without a motor. links: joint -> body that it moves, only for bodies that extend in one direction, so that a
    longer link is unambiguous. effects: names of all effects that can be hidden in this robot, including those
    outside the catalogue. slides: joints that slide. discover: whether to search for laws even if nothing remains
    unexplained.
    """

    name: str
    content: Mapping[str, Any]
    motors: tuple[str, ...]
    passive: tuple[str, ...]
    links: Mapping[str, str]
    payloads: tuple[str, ...]
    effects: tuple[str, ...]
    discover: bool = False
    slides: frozenset[str] = frozenset()

    @property
    def catalogued(self) -> tuple[str, ...]:
        """Effects that a diagnosis can name."""
        return tuple(name for name in self.effects if HIDDEN_EFFECTS[name].in_catalogue)

    @property
    def outside(self) -> tuple[str, ...]:
        """Effects that no model contains."""
        return tuple(name for name in self.effects if not HIDDEN_EFFECTS[name].in_catalogue)


def make_setup(robot: str, scenario: str | None = None, duration: float | None = None) -> Setup:
    """The setup of a trial for a robot (name or folder), with the motions of a scenario.

    scenario: name or file; by default the built-in one of the robot's name, else motions about the home pose.
    duration: of each motion, s; by default that of the scenario.
    Raises BenchError if the robot or the scenario cannot be used.
    """
    description = load_robot(robot)
    if scenario is None and robot in built_in_scenarios():
        scenario = robot
    content = _plain_content(description) if scenario is None else read_with_bases(find_scenario(scenario))
    content = {key: value for key, value in content.items() if key not in ("hidden", "tolerances")}
    content["robot"] = robot
    if duration is not None:
        content["design"] = {**content.get("design", {}), "duration": duration}
    weighed = [
        name
        for name, payload in content.get("payloads", {}).items()
        if "mass" in payload.get("declared", payload)
    ]
    geometry = read_geometry(description)
    places = places_in(geometry, weighed)
    model = description.mjcf_model()
    long = {name for name, body in lengths(geometry).items() if body.direction is not None}
    links = {
        joint.name: joint.body
        for joint in geometry.joints
        if joint.body in long
        and joint.kind in ("hinge", "slide")
        and not np.allclose(reach_of(model, joint.name, description.tool_site), 0.0)
    }
    setup = Setup(
        description.name,
        content,
        description.joints,
        places.passive,
        links,
        places.payload,
        (),
        slides=frozenset(joint.name for joint in geometry.joints if joint.kind == "slide"),
    )
    names = tuple(name for name in HIDDEN_EFFECTS if _possible(setup, name, description, places))
    return replace(setup, effects=names)


def where(effect: str) -> Where:
    """The kind of place of an effect."""
    kind = HIDDEN_EFFECTS[effect]
    if not issubclass(kind, JointEffect):
        return "machine"
    if kind.where == "any":
        return "link"
    return "passive" if kind.where == "passive" else "actuated"


def _possible(setup: Setup, effect: str, robot: Robot, places: Places) -> bool:
    kind = HIDDEN_EFFECTS[effect]
    if effect == LAW or (kind.in_catalogue and effect not in CATALOGUE):
        return False  # a law is drawn with its numbers, see bench.studies.trial.unknown
    if effect in CATALOGUE and CATALOGUE[effect].place == "bearing" and places.bearing != places.passive:
        return False  # a model cannot have it in all passive joints
    needed: Mapping[str, Any] = {
        "payload": setup.payloads,
        "tool": robot.tool_site is not None,
        "motors": setup.motors[1:],
        "passive": setup.passive,
        "link": setup.links,
        "actuated": setup.motors,
        "machine": True,
    }
    return bool(needed[kind.needs or where(effect)])


def _plain_content(robot: Robot) -> dict[str, Any]:
    """The content of a scenario with motions about the home pose."""
    if not all(units_of_gain(motor.gain_unit).rotates for motor in robot.actuators):
        raise BenchError(
            f"trial: robot {robot.name!r} has slide joints: give its motions with --scenario FILE"
        )
    design = {
        "optimise": True,
        "harmonics": 8,
        "base_frequency": 0.2,
        "duration": 20.0,
        "span": 0.5,
        "velocity_limit": 5.0,
        "acceleration_limit": 60.0,
    }
    loaded = robot.tool_site is not None
    recordings = [
        {"name": name, "use": use, "design": {"seed": i + 1}}
        | ({"payload": "block"} if loaded and name.startswith("loaded") else {})
        for i, (name, use) in enumerate(MOVEMENTS)
    ]
    mass = PAYLOAD_SHARE * float(robot.mjcf_model().body_mass.sum())
    content: dict[str, Any] = {
        "sensors": {"encoder_bits": 20, "current_noise_ratio": 0.01},
        "design": design,
        "recordings": recordings,
    }
    if loaded:
        content["payloads"] = {"block": {"mass": mass, "inertia": [1e-3 * mass] * 3 + [0.0] * 3}}
    return content | {"robot": str(Path(robot.folder))}
