"""Write a robot.toml for an MJCF file: the parts that motors may drive, and the text that lists the motors."""

import os
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Literal

import mujoco

from bench.basics.errors import BenchError, meant
from bench.basics.files.atomic import atomic_path
from bench.basics.files.toml_output import toml_line
from bench.dataset.names import ROBOT_FILE, Unit
from bench.dataset.robot import compiler_message, load_robot
from bench.dataset.robot_mjcf import read_model


@dataclass(frozen=True)
class MotorPart:
    """A part that a motor may drive. effort: a motor's unit; actuated: whether an actuator of the file acts on it."""

    name: str
    drives: Literal["joint", "tendon", "motor"]
    effort: Literal["N*m", "N"]
    actuated: bool


@dataclass(frozen=True)
class MjcfParts:
    """Parts of an MJCF file that motors may drive, joints first, and sites at which a payload may be fixed."""

    path: Path
    motors: tuple[MotorPart, ...]
    sites: tuple[str, ...]

    @property
    def named(self) -> Mapping[str, MotorPart]:
        """Parts by name; a joint takes precedence over a tendon or actuator of the same name."""
        by_name: dict[str, MotorPart] = {}
        for part in self.motors:
            by_name.setdefault(part.name, part)
        return by_name


def mjcf_parts(path: str | Path) -> MjcfParts:
    """The parts of an MJCF file. Raises BenchError, with file and line, if MuJoCo refuses it."""
    path = Path(path)
    if not path.is_file():
        raise BenchError(f"{path}: there is no such file")
    try:
        model = read_model(path)
        motors = tuple(part for part in _motors(model) if part.name)
        sites = (model.site(i).name for i in range(model.nsite))
        return MjcfParts(path, motors, tuple(name for name in sites if name))
    except (ValueError, mujoco.FatalError) as error:
        raise BenchError(compiler_message(path, str(error))) from error


def robot_toml(
    model: str,
    name: str,
    motors: Sequence[tuple[str, float]],
    parts: MjcfParts,
    unit: Unit,
    tool: str | None,
    locked: Mapping[str, float],
) -> str:
    """The text of a robot.toml. model: the MJCF as the file names it; motors: names with their nominal gains, in order;
    locked: joints that are held, with their positions.

    Raises BenchError for a motor or a site that the MJCF does not have.
    """
    lines = [toml_line("name", name), toml_line("model", model)]
    for motor, gain in motors:
        if motor not in parts.named:
            hint = meant(motor, parts.named, f"{parts.path.name} has")
            raise BenchError(f"motor {motor!r}: no joint, fixed tendon or actuator: {hint}")
        part = parts.named[motor]
        gain_unit = unit if unit == "1" else f"{part.effort}/{unit}"
        lines += ["", "[[actuators]]", toml_line(part.drives, motor)]
        lines += [toml_line("gain", gain), toml_line("gain_unit", gain_unit)]
    if tool is not None:
        if tool not in parts.sites:
            raise BenchError(f"tool {tool!r}: no site: {meant(tool, parts.sites, f'{parts.path.name} has')}")
        lines += ["", "[tool]", toml_line("site", tool)]
    if locked:
        lines += ["", "[locked]", *(toml_line(joint, value) for joint, value in locked.items())]
    return "\n".join(lines) + "\n"


def no_tool(sites: Sequence[str]) -> str:
    """What a robot without a tool site lacks, and the lines to add. sites: of its MJCF."""
    of_file = f"sites of the MJCF: {', '.join(sites)}"
    there = of_file if sites else "the MJCF needs a <site> of that name first"
    return (
        "the robot has no tool site to fix payloads at (bench excite --payload-mass needs one): add the lines "
        f'[tool] and site = "NAME" to robot.toml ({there})'
    )


def write_robot_toml(
    mjcf: str | Path,
    motors: Sequence[tuple[str, float]],
    *,
    unit: Unit = "A",
    tool: str | None = None,
    locked: Mapping[str, float] | None = None,
    name: str | None = None,
    folder: str | Path | None = None,
    overwrite: bool = False,
) -> Path:
    """Write the robot.toml of an MJCF file, and return its folder (by default that of the MJCF file).

    motors: joints, tendons or actuators of the file with their nominal drive gains, in the order of all later tables;
    unit: of the drives' command; tool: the site at which a payload is fixed; locked: joints that are held, with their
    positions in rad or m. The file is only written if `load_robot` accepts it.
    Raises BenchError, and nothing is written: for a motor or a site that the file does not have, a robot that
    `load_robot` refuses, or an existing robot.toml without `overwrite`.
    """
    mjcf = Path(mjcf)
    target = Path(folder if folder is not None else mjcf.parent) / ROBOT_FILE
    if target.exists() and not overwrite:
        raise BenchError(f"{target}: already exists; give another folder, or allow overwriting")
    try:
        reference = Path(os.path.relpath(mjcf.resolve(), target.parent.resolve())).as_posix()
    except ValueError:  # on another drive
        reference = mjcf.resolve().as_posix()
    parts = mjcf_parts(mjcf)
    text = robot_toml(reference, name or mjcf.stem, motors, parts, unit, tool, locked or {})
    with atomic_path(target) as partial:
        partial.write_text(text, encoding="utf-8")
        try:
            load_robot(partial)
        except BenchError as error:
            raise BenchError(str(error).replace(str(partial), str(target))) from None
    return target.parent


def _motors(model: mujoco.MjModel) -> Iterator[MotorPart]:
    efforts: dict[int, Literal["N*m", "N"]] = {
        int(mujoco.mjtJoint.mjJNT_HINGE): "N*m",
        int(mujoco.mjtJoint.mjJNT_SLIDE): "N",
    }
    on_joint, on_tendon = int(mujoco.mjtTrn.mjTRN_JOINT), int(mujoco.mjtTrn.mjTRN_TENDON)
    acts = set(zip(model.actuator_trntype.tolist(), model.actuator_trnid[:, 0].tolist(), strict=True))
    joints = {j: efforts[kind] for j, kind in enumerate(model.jnt_type.tolist()) if kind in efforts}
    tendons = {t: effort for t in range(model.ntendon) if (effort := _tendon_effort(model, t, joints))}
    for j, effort in joints.items():
        yield MotorPart(model.joint(j).name, "joint", effort, (on_joint, j) in acts)
    for t, effort in tendons.items():
        yield MotorPart(model.tendon(t).name, "tendon", effort, (on_tendon, t) in acts)
    for a in range(model.nu):
        kind, at = int(model.actuator_trntype[a]), int(model.actuator_trnid[a, 0])
        driven = {on_joint: joints, on_tendon: tendons}.get(kind, {})
        if at not in driven:
            continue
        name, itself = model.actuator(a).name, model.joint(at) if kind == on_joint else model.tendon(at)
        if name != itself.name or model.actuator_gear[a, 0] != 1.0:
            yield MotorPart(name, "motor", driven[at], True)


def _tendon_effort(
    model: mujoco.MjModel, tendon: int, joints: Mapping[int, Literal["N*m", "N"]]
) -> Literal["N*m", "N"] | None:
    """Effort of a motor on a fixed tendon: torque unless all its joints slide; None for a spatial tendon."""
    first = int(model.tendon_adr[tendon])
    wraps = range(first, first + int(model.tendon_num[tendon]))
    if any(int(model.wrap_type[w]) != int(mujoco.mjtWrap.mjWRAP_JOINT) for w in wraps):
        return None
    return "N" if all(joints.get(int(model.wrap_objid[w])) == "N" for w in wraps) else "N*m"
