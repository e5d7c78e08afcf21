"""The contents of a robot's report; every value is a plain number, text or code."""

from dataclasses import dataclass, field

import mujoco

from bench.basics.joint_units import joint_units
from bench.dataset.home_qpos import home_qpos
from bench.dataset.locked_couplings import held_bodies
from bench.dataset.robot import Robot
from bench.model.base import BaseParameters
from bench.model.supported import label_of
from bench.robot_check.bounds import PLAUSIBLE
from bench.robot_check.loops import active_equalities, gaps
from bench.robot_check.machine import CheckedMachine, body_label
from bench.robot_check.outcome import Check, CheckCode


@dataclass(frozen=True)
class JointLine:
    """A joint of the opened tree. `lower`, `upper`: rad or m, None if the MJCF sets no range."""

    name: str
    kind: str
    parent: str
    """The body on which the joint is mounted; "world" for the base."""
    actuated: bool
    gain: str
    """Nominal drive gain with its unit; empty for a passive joint."""
    lower: float | None
    upper: float | None
    home: float | None
    """Position in the home pose, rad or m; None for a ball or free joint."""


@dataclass(frozen=True)
class LoopLine:
    """A loop closure: the two bodies that it connects, and its gap at home."""

    name: str
    kind: str
    bodies: tuple[str, str]
    equations: int
    gap: float
    """m"""
    twist: float
    """rad; 0 for a connect"""


@dataclass(frozen=True)
class Mobility:
    """Degrees of freedom: those of the opened tree minus the rank of the closure equations and the idle spins."""

    tree: int
    equations: int
    rank: int
    motors: int
    spins: int = 0
    """Rods that can spin about their axis, which moves nothing else and is omitted."""

    @property
    def remaining(self) -> int:
        """Degrees of freedom of the closed robot."""
        return self.tree - self.rank - self.spins


@dataclass(frozen=True)
class Amplification:
    """The fastest passive joint for a unit speed of one motor, the others held."""

    value: float
    unit: str
    passive: str
    motor: str


@dataclass(frozen=True)
class Singularity:
    """How well the motors hold the robot at home, and where within the joint ranges they hold it worst.

    Singular values are those of the loop Jacobian with respect to the passive joints, lengths divided by `length` [m].
    """

    length: float
    home: float
    """Smallest singular value at home."""
    amplification: Amplification
    """At home."""
    poses: int
    """Number of poses, on straight paths of the motors from home."""
    lowest: float
    """Smallest singular value over all poses."""
    lowest_at: dict[str, float]
    """Positions of the actuated joints there, rad or m."""
    reach: dict[str, tuple[float, float]]
    """Lowest and highest position that each motor reaches with the others at home, rad or m."""
    singular_at: dict[str, float] | None
    """The singular pose or end of reach nearest to home; None if there is none."""
    travel: dict[str, float] | None
    """Travel of each motor from home to that pose, rad or m."""
    loose: tuple[str, ...]
    """Passive joints that can move in that pose with the motors held."""
    units: dict[str, str] = field(default_factory=dict)
    """rad or m, of each motor's position."""


@dataclass(frozen=True)
class RobotReport:
    """Everything that `bench robot check` reports; what could not be determined is None or empty."""

    robot: Robot
    joints: tuple[JointLine, ...]
    loops: tuple[LoopLine, ...]
    mobility: Mobility | None
    singularity: Singularity | None
    base: BaseParameters | None
    checks: tuple[Check, ...]

    @property
    def failures(self) -> tuple[Check, ...]:
        """The checks that failed, in the order in which they were made."""
        return tuple(check for check in self.checks if check.verdict == "failed")


def home_source(compiled: mujoco.MjModel, robot: Robot) -> dict[str, int | None]:
    """Source of the home pose: `given` of its `positions` from the keyframe home, None without one, the others from
    qpos0, which MuJoCo does without a warning.
    """
    given = next((len(drawn.qpos) for drawn in robot.mjcf_as_drawn().keys if drawn.name == "home"), None)
    return {"given": given, "positions": int(compiled.nq)}


def joint_lines(compiled: mujoco.MjModel, robot: Robot) -> tuple[JointLine, ...]:
    """Every joint of the MJCF, in its order."""
    home = home_qpos(compiled)
    gains = {actuator.joint: f"{actuator.gain:g} {actuator.gain_unit}" for actuator in robot.motors}
    lines = []
    for index in range(compiled.njnt):
        name = label_of(compiled, mujoco.mjtObj.mjOBJ_JOINT, index)
        kind = mujoco.mjtJoint(int(compiled.jnt_type[index])).name.removeprefix("mjJNT_").lower()
        body = int(compiled.jnt_bodyid[index])
        scalar, limited = kind in ("hinge", "slide"), bool(compiled.jnt_limited[index])
        low, high = (float(end) for end in compiled.jnt_range[index])
        lines.append(
            JointLine(
                name=name,
                kind=kind,
                parent=body_label(compiled, int(compiled.body_parentid[body])),
                actuated=name in gains,
                gain=gains.get(name, ""),
                lower=low if scalar and limited else None,
                upper=high if scalar and limited else None,
                home=float(home[compiled.jnt_qposadr[index]]) if scalar else None,
            )
        )
    return tuple(lines)


def loop_lines(machine: CheckedMachine) -> tuple[LoopLine, ...]:
    """Every loop closure with its gap in the home pose."""
    geometry, compiled = machine.geometry, machine.compiled
    lines = []
    for loop, equality, gap in zip(
        geometry.loops, active_equalities(compiled)[0], gaps(machine, geometry.home), strict=True
    ):
        first, second = (body_label(compiled, body) for body in held_bodies(compiled, equality))
        lines.append(LoopLine(loop.name, loop.kind, (first, second), loop.size, *gap))
    return tuple(lines)


def check_home_ranges(joints: tuple[JointLine, ...]) -> Check:
    """Whether home is within every joint range."""
    for joint in joints:
        if joint.home is None or joint.lower is None or joint.upper is None:
            continue
        if not joint.lower - PLAUSIBLE.end <= joint.home <= joint.upper + PLAUSIBLE.end:
            unit = joint_units(joint.kind == "hinge").position
            limits = {"lower": joint.lower, "upper": joint.upper}
            offender = {"joint": joint.name, "home": joint.home, "unit": unit, **limits}
            return Check(CheckCode.HOME_OUTSIDE_RANGE, "failed", offender)
    ranged = sum(joint.lower is not None for joint in joints)
    return Check(CheckCode.HOME_WITHIN_RANGES, "ok", {"ranged": ranged, "joints": len(joints)})
