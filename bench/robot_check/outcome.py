"""The result of a check as a code with its values; `bench.robot_check.words` has the sentences."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from enum import StrEnum, auto
from typing import Any, Literal, TypedDict

Verdict = Literal["ok", "note", "failed", "skipped"]


class CheckCode(StrEnum):
    """The findings. The values of each are the arguments of its sentence in `bench.robot_check.words`."""

    # the MJCF
    MJCF_SUPPORTED = auto()
    MJCF_UNSUPPORTED = auto()
    GEOMETRY_UNREADABLE = auto()
    FILES_LEFT_OUT = auto()
    RANGES_IN_DEGREES = auto()
    RANGES_OF_A_TURN = auto()
    KEYFRAMES_UNUSED = auto()
    EQUALITY_INACTIVE = auto()
    JOINT_FORCE_NOT_MODELLED = auto()
    MEDIUM_NOT_MODELLED = auto()
    GRAVITY_ZERO = auto()
    PLUGINS_NOT_MODELLED = auto()
    ACTUATORS_UNUSED = auto()
    TENDON_UNUSED = auto()
    TOOL_MISSING = auto()
    LENGTHS_LARGE = auto()
    MASSES_LARGE = auto()
    JOINTS_LOCKED = auto()
    # Pinocchio compared with MuJoCo
    JOINT_TREES_AGREE = auto()
    JOINT_COUNTS_DIFFER = auto()
    JOINT_NAMES_DIFFER = auto()
    JOINT_KINDS_DIFFER = auto()
    JOINT_COORDINATES_DIFFER = auto()
    JOINT_PARENTS_DIFFER = auto()
    JOINT_AXES_AGREE = auto()
    JOINT_AXES_DIFFER = auto()
    BODY_POSES_AGREE = auto()
    BODY_POSES_DIFFER = auto()
    TOTAL_MASSES_AGREE = auto()
    TOTAL_MASSES_DIFFER = auto()
    MASS_MATRICES_AGREE = auto()
    MASS_MATRICES_DIFFER = auto()
    BIAS_FORCES_AGREE = auto()
    BIAS_FORCES_DIFFER = auto()
    MOTOR_FORCES_AGREE = auto()
    MOTOR_FORCES_DIFFER = auto()
    BASE_PARAMETERS_AGREE = auto()
    BASE_PARAMETERS_DIFFER = auto()
    # loops
    LOOP_COUNTS_DIFFER = auto()
    LOOP_CLOSURES_AGREE = auto()
    LOOP_CLOSURES_DIFFER = auto()
    LOOP_OPENING_IN_MOTION = auto()
    COUPLING = auto()
    # the home pose
    HOME_WITHOUT_LOOPS = auto()
    HOME_CLOSED = auto()
    DRAWING_ROUNDED = auto()
    WELD_TOO_MUCH = auto()
    NEARLY_PARALLEL = auto()
    HOME_OPEN = auto()
    HOME_OPEN_AND_NO_CLOSED_POSE = auto()
    HOME_OPEN_AS_LOOPS_DISAGREE = auto()
    HOME_WITHIN_RANGES = auto()
    HOME_OUTSIDE_RANGE = auto()
    HOME_AT_RANGE_END = auto()
    HOME_REGULAR = auto()
    HOME_NEAR_SINGULAR = auto()
    HOME_SINGULAR = auto()
    # freedom and ranges
    MOBILITY = auto()
    MOBILITY_FAULT = auto()
    ROD_SPINS = auto()
    MOTION_FAULT = auto()
    POSES_LOOSE = auto()
    ROTOR_INERTIA = auto()
    GEOMS_TOUCH = auto()
    SINGULARITY_WITHIN_RANGES = auto()
    PASSIVE_RANGE_LEFT = auto()


@dataclass(frozen=True)
class Check:
    """One check. values: by name, plain ones for JSON; lengths in m, angles in rad, masses in kg."""

    code: CheckCode
    verdict: Verdict
    values: Mapping[str, Any] = field(default_factory=dict)


class RangeLeft(TypedDict):
    """A joint that leaves its range, whether it has a redundant motor, its travel and its range, rad or m."""

    joint: str
    redundant: bool
    lowest: float
    highest: float
    lower: float
    upper: float


class Equation(TypedDict):
    """A coupling: by joint the factors of the first and of the second side, of which the polynomial is taken."""

    coupling: str
    first: Mapping[str, float]
    second: Mapping[str, float]
    polynomial: Sequence[float]


class JointRange(TypedDict):
    """The range of a joint, rad or m."""

    joint: str
    lower: float
    upper: float


class RangeConflict(Equation):
    """A coupling that the ranges of its joints do not admit."""

    ranges: Sequence[JointRange]
