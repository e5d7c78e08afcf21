"""A robot: its folder, its actuators with their nominal drive gains, its tool."""

import re
import shlex
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import islice
from pathlib import Path
from typing import Annotated, Literal, Self

import mujoco
import numpy as np
from pydantic import Field, field_validator, model_validator

from bench.basics.errors import BenchError, meant
from bench.basics.files.toml_input import UserTable, one_line, read_toml
from bench.basics.joint_units import HINGE, SLIDE, units_of_gain
from bench.dataset.catalogue import built_in_robots
from bench.dataset.robot_locked import LockedJoint, locked_in_words, locked_joints
from bench.dataset.robot_mjcf import (
    AS_IT_IS,
    RobotSetup,
    Transmission,
    drawn_spec,
    joints_of,
    robot_model,
    robot_spec,
)
from bench.dataset.robot_redundancy import independent_motors

GainUnit = Literal["N*m/A", "N/A", "N*m/V", "N/V", "N*m/(N*m)", "N/N", "1"]
TORQUE_LOGS = {"N*m": "N*m/(N*m)", "N": "N/N"}  # effort -> gain unit if efforts are logged
Text = Annotated[str, Field(min_length=1)]


@dataclass(frozen=True)
class Actuator:
    """A motor: torque (hinge) or force (slide) = gain * current reference, at the part that it drives.

    drives: a joint of the MJCF, a fixed tendon, or an actuator of the file with its gear. For the last two,
    `robot_model` adds a joint for the motor.
    """

    joint: str
    """Name of the joint, tendon or actuator."""
    gain: float
    """Nominal drive gain, as in the manufacturer's data sheet, in `gain_unit`."""
    gain_unit: str
    drives: Literal["joint", "tendon", "motor"] = "joint"


@dataclass(frozen=True)
class Robot:
    """A robot folder that has been read and checked; the MJCF itself is not kept in memory."""

    name: str
    folder: Path
    model_path: Path
    """The MJCF file."""
    actuators: tuple[Actuator, ...]
    """One for each degree of freedom; their order is the order of every per-actuator array and column."""
    tool_site: str | None
    """The MJCF site at which a payload is fixed."""
    redundant: tuple[Actuator, ...] = ()
    """The motors beyond the degrees of freedom; the motion of their joints follows from that of `actuators`."""
    locked: tuple[LockedJoint, ...] = ()
    """Joints that are held: the simulated machine and the model do not have them."""

    def mjcf_model(self) -> mujoco.MjModel:
        """The compiled MJCF without the locked joints and with a joint for every motor."""
        return robot_model(self.model_path, self.setup)

    def mjcf_spec(self) -> mujoco.MjSpec:
        """The same before compilation, to be edited."""
        return robot_spec(self.model_path, self.setup)

    def mjcf_as_drawn(self) -> mujoco.MjSpec:
        """The same before rounding errors of the drawing are corrected."""
        return drawn_spec(self.model_path, self.setup)

    def file_qpos(self, qpos: Sequence[float]) -> list[float]:
        """Positions (nq,) of `mjcf_model` converted to a keyframe of the MJCF: with locked joints, without rotors."""
        file, rest = robot_model(self.model_path), iter(qpos)
        held = {joint.name: joint.value for joint in self.locked}
        ends = [*file.jnt_qposadr[1:].tolist(), file.nq]
        positions: list[float] = []
        for joint, end in enumerate(ends):
            name = file.joint(joint).name
            positions += [held[name]] if name in held else islice(rest, end - len(positions))
        return positions

    @property
    def setup(self) -> RobotSetup:
        """The settings of robot.toml for the MJCF."""
        return RobotSetup(_transmissions(self.motors), self.locked, self.driven)

    @property
    def motors(self) -> tuple[Actuator, ...]:
        """All motors, the redundant ones last."""
        return (*self.actuators, *self.redundant)

    @property
    def driven(self) -> tuple[str, ...]:
        """Names of all driven joints, those of redundant motors last."""
        return tuple(actuator.joint for actuator in self.motors)

    @property
    def joints(self) -> tuple[str, ...]:
        """Names of the driven joints that move independently, (n,)."""
        return tuple(actuator.joint for actuator in self.actuators)

    @property
    def nominal_gains(self) -> np.ndarray:
        """Nominal drive gains, (n,), each in its actuator's `gain_unit`."""
        return np.array([actuator.gain for actuator in self.actuators])


def load_robot(robot: str | Path, relative_to: Path | None = None) -> Robot:
    """Read and check a robot.

    `robot` is a built-in name, or the path of a robot folder or of its robot.toml; a relative
    path is taken from `relative_to` (the working folder if None). A `Path`, or a string with a separator such as
    "./delta", is never taken for a built-in name.

    Raises BenchError, one line, if the robot does not exist, robot.toml has a wrong or unknown key, the MJCF does not
    compile, or the two files do not match.
    """
    description = _find_description(robot, relative_to)
    table = read_toml(description, RobotTable)
    model_path = description.parent / table.model
    if not model_path.is_file():
        raise BenchError(f"{description}: model: there is no file {model_path}")
    actuators = tuple(Actuator(part.name, part.gain, part.gain_unit, part.drives) for part in table.actuators)
    locked = _locked(description, actuators, table.locked, model_path) if table.locked else ()
    actuators, independent = _checked(description, actuators, table.tool, model_path, locked)
    return Robot(
        name=table.name,
        folder=description.parent,
        model_path=model_path,
        actuators=tuple(actuator for actuator in actuators if actuator.joint in independent),
        tool_site=table.tool.site if table.tool else None,
        redundant=tuple(actuator for actuator in actuators if actuator.joint not in independent),
        locked=locked,
    )


def refuse_redundant(robot: Robot, what: str) -> None:
    """Raise BenchError if a robot has redundant motors. what: the function that needs the torque of each motor."""
    if robot.redundant:
        extra = ", ".join(actuator.joint for actuator in robot.redundant)
        raise BenchError(
            f"robot {robot.name}: {what} does not support redundant motors ({extra}): a motion does not determine the "
            "torque of each of them"
        )


def refuse_other_locks(robot: Robot, locked: Sequence[LockedJoint], where: str) -> None:
    """Raise BenchError if the model that `where` names has other locked joints, or other positions of them."""
    if set(locked) != set(robot.locked):
        raise BenchError(
            f"{where}: a model with {locked_in_words(locked)} locked, but robot {robot.name} locks "
            f"{locked_in_words(robot.locked)}: identify again"
        )


class _ActuatorTable(UserTable):
    joint: Text | None = None
    tendon: Text | None = None
    motor: Text | None = None
    gain: Annotated[float, Field(strict=True, gt=0, allow_inf_nan=False)]
    gain_unit: GainUnit

    @model_validator(mode="after")
    def _one_part(self) -> Self:
        if sum(part is not None for part in (self.joint, self.tendon, self.motor)) != 1:
            raise ValueError("should name what the motor drives by one of joint, tendon, motor")
        return self

    @property
    def drives(self) -> Literal["joint", "tendon", "motor"]:
        return "joint" if self.joint else "tendon" if self.tendon else "motor"

    @property
    def name(self) -> str:
        return str(self.joint or self.tendon or self.motor)


class _ToolTable(UserTable):
    site: Text


class RobotTable(UserTable):
    """The keys of robot.toml."""

    name: Text
    model: Text
    actuators: tuple[_ActuatorTable, ...]
    tool: _ToolTable | None = None
    locked: dict[str, Annotated[float, Field(strict=True, allow_inf_nan=False)]] = Field(default_factory=dict)

    @field_validator("actuators")
    @classmethod
    def _some_actuator(cls, actuators: tuple[_ActuatorTable, ...]) -> tuple[_ActuatorTable, ...]:
        if not actuators:
            raise ValueError("should name at least one actuator")
        return actuators


def _find_description(robot: str | Path, relative_to: Path | None) -> Path:
    built_in = built_in_robots()
    if isinstance(robot, str) and robot in built_in:
        return built_in[robot] / "robot.toml"
    path = (relative_to or Path.cwd()) / Path(robot).expanduser()
    description = path if path.suffix == ".toml" else path / "robot.toml"
    if description.is_file():
        return description.resolve()
    if path.is_dir():
        raise BenchError(f"robot {str(robot)!r}: there is no robot.toml in {path}")
    if path.is_file():
        raise BenchError(f"robot {str(robot)!r}: {_as_folder(robot, path)}")
    hint = meant(str(robot), built_in, f"there is no {path}, and built-in are")
    raise BenchError(f"robot {str(robot)!r}: neither a built-in robot nor a folder: {hint}")


def _as_folder(robot: str | Path, file: Path) -> str:
    """How a robot is named for which a file was given."""
    if (file.parent / "robot.toml").is_file():
        return f"this is a file; give its folder {file.parent}"
    if file.suffix.lower() == ".xml":
        return f"this is an MJCF file; bench robot new {shlex.quote(str(robot))} makes a robot folder of it"
    return "this is a file; give a built-in robot, or a folder with a robot.toml and an MJCF"


def compiler_message(path: Path, text: str) -> str:
    """MuJoCo's message on a file as one line that starts with file and line, without the parser's codes."""
    text = one_line(text).removeprefix("XML Error: ").removeprefix("Error: ")
    line = re.search(r",? ?[Ll]ine(?: number)? ?[=:]? ?(\d+)", text)
    where = f"{path}, line {line.group(1)}" if line else str(path)
    if parser := re.match(r"XML parse error \d+: ?Error=XML_(?:ERROR_)?(\w+)(?:.*name=(\w+))?", text):
        said, element = parser.group(1).lower().replace("_", " "), parser.group(2)
        return f"{where}: not valid XML: {said}{f' <{element}>' if element else ''}"
    if massless := re.search(r"mass and inertia of moving bodies.*?Element name '(.+?)'", text):
        return (
            f"{where}: body {massless.group(1)!r} moves and has no mass or no inertia: give it an <inertial> "
            "(identification does not read it, simulations do)"
        )
    if line:
        text = text[: line.start()] + text[line.end() :]
    return f"{where}: MuJoCo cannot compile it: {text.strip(' ,:')}"


def _transmissions(actuators: Sequence[Actuator]) -> tuple[Transmission, ...]:
    return tuple(
        Transmission(actuator.joint, actuator.drives, not units_of_gain(actuator.gain_unit).rotates)
        for actuator in actuators
        if actuator.drives != "joint"
    )


def _locked(
    description: Path, actuators: Sequence[Actuator], values: Mapping[str, float], model_path: Path
) -> tuple[LockedJoint, ...]:
    """The joints of [locked], checked against the MJCF and the motors."""
    plain, _ = _compiled(f"{description}: locked", model_path)
    try:
        locked = locked_joints(plain, values)
        _refuse_driven(plain, actuators, values)
    except BenchError as error:
        raise BenchError(f"{description}: locked: {error}") from None
    _compiled(f"{description}: locked", model_path, RobotSetup(locked=locked))
    return locked


def _refuse_driven(plain: mujoco.MjModel, actuators: Sequence[Actuator], locked: Mapping[str, float]) -> None:
    transmissions = {transmission.name: transmission for transmission in _transmissions(actuators)}
    for i, actuator in enumerate(actuators):
        other = transmissions.get(actuator.joint)
        driven = (actuator.joint,) if other is None else joints_of(plain, other)
        if set(driven) <= set(locked):
            raise BenchError(f"actuators[{i}] drives {driven[0]!r}; leave out one of the two")


def _compiled(where: str, model_path: Path, setup: RobotSetup = AS_IT_IS) -> tuple[mujoco.MjModel, list[str]]:
    """The compiled MJCF and the names of its joints. Raises BenchError that begins with the file, or with `where`."""
    try:
        model = robot_model(model_path, setup)
        return model, [model.joint(i).name for i in range(model.njnt)]  # ValueError: a name is not UTF-8
    except (ValueError, mujoco.FatalError) as error:
        raise BenchError(compiler_message(model_path, str(error))) from error
    except BenchError as error:
        raise BenchError(f"{where}: {error}") from None


def _checked(
    description: Path,
    actuators: Sequence[Actuator],
    tool: _ToolTable | None,
    model_path: Path,
    locked: tuple[LockedJoint, ...],
) -> tuple[tuple[Actuator, ...], frozenset[str]]:
    """The actuators, checked against the MJCF, and the driven joints that move independently.

    A gain of unit 1 gets the unit N*m/(N*m) at a hinge and N/N at a slide.
    """
    setup = RobotSetup(_transmissions(actuators), locked)
    model, joint_names = _compiled(f"{description}: actuators", model_path, setup)
    units = {int(mujoco.mjtJoint.mjJNT_HINGE): HINGE.effort, int(mujoco.mjtJoint.mjJNT_SLIDE): SLIDE.effort}
    checked: list[Actuator] = []
    seen: dict[str, int] = {}
    for i, actuator in enumerate(actuators):
        key, name = f"{description}: actuators[{i}]", actuator.joint
        if name in seen:
            raise BenchError(f"{key}.joint: {name!r} is already driven by actuators[{seen[name]}]")
        seen[name] = i
        if name not in joint_names:
            known = ", ".join(joint for joint in joint_names if joint) or "none with a name"
            raise BenchError(f"{key}.joint: {model_path.name} has no joint {name!r} (it has: {known})")
        effort = units.get(int(model.joint(name).type[0]))
        if effort is None:
            raise BenchError(
                f"{key}.joint: {name!r} is a ball or free joint; a motor drives a hinge or slide"
            )
        given = actuator.gain_unit
        unit = TORQUE_LOGS[effort] if given == "1" else given
        checked.append(replace(actuator, gain_unit=unit))
        if unit.split("/")[0] != effort:
            noun = "slide" if effort == SLIDE.effort else "hinge"
            allowed = f'"{effort}/A" or "{effort}/V", or "1" for a log of torques'
            raise BenchError(f"{key}.gain_unit: {name!r} is a {noun}: {allowed}, got {given!r}")
    try:
        independent = independent_motors(model, list(seen)) if model.neq else tuple(seen)
    except BenchError as error:
        raise BenchError(f"{description}: actuators: {error}") from None
    if tool and mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_SITE, tool.site) < 0:
        raise BenchError(f"{description}: tool.site: {model_path.name} has no site {tool.site!r}")
    return tuple(checked), frozenset(independent)
