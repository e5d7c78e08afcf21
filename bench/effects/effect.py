"""Base class of effects: columns in addition to those of the rigid bodies."""

from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, fields, replace
from typing import ClassVar, Literal, Self

import numpy as np

from bench.basics.errors import BenchError
from bench.basics.joint_units import joint_units
from bench.effects.signals import JointSignals, RobotSignals
from bench.model.geometry import Geometry


@dataclass(frozen=True)
class JointSamples:
    """Signals for a search of shape parameters, each (M,), decimated.

    position, velocity: rad or m and rate; motor_torque: gain times current, N*m or N; error: torque that the model
    lacks, zero where the joint is at rest. duration s, of the recording; speed: the joint's RMS over all fitted
    recordings; travel: between its extreme positions in all of them; band Hz; rotates: a hinge.
    """

    position: np.ndarray
    velocity: np.ndarray
    motor_torque: np.ndarray
    error: np.ndarray
    duration: float
    speed: float
    travel: float
    band: float
    rotates: bool


Place = Literal["actuator", "passive", "bearing", "body", "payload", "robot"]
Seen = Literal["opposes", "fades", "load", "velocity", "repeats", "position", "current", "acceleration"]
"""How an error looks, by the key of the atlas: it opposes the motion, fades or grows during a recording, or grows with
the load; passes through zero with the velocity; repeats over the position; is a smooth curve over it; follows the
current or its change; follows the acceleration, or rings.
"""
MjcfTerm = Literal["stiffness", "damping", "frictionloss", "armature"]
Bracket = tuple[float, float, float]
"""Range of a shape parameter: lower bound, first value, upper bound; all equal: no further search."""


def unit_at(unit: str, rotates: bool, drive: str = "A") -> str:
    """A unit with `{effort}`, `{angle}` and `{turn}` filled in for a hinge (True) or a slide (False).

    drive: the unit of the current, for `{drive}`.
    """
    at = joint_units(rotates)
    plain = unit.format(effort=at.effort, angle=at.position, turn=at.turn, drive=drive)
    return plain.replace("(N)", "N")


@dataclass(frozen=True)
class EffectParameter:
    """A parameter of an effect.

    In its unit `{effort}` is N*m or N, `{angle}` rad or m, `{turn}` turn or m, `{drive}` that of the current. positive:
    a negative value would be physically impossible, such as a friction that drives. below: an upper bound, in that
    unit, beyond which the effect cannot be distinguished from its source and its size means nothing.
    """

    name: str
    unit: str
    positive: bool = False
    below: float = float("inf")

    def unit_at(self, rotates: bool, drive: str = "A") -> str:
        """The unit at a hinge (True) or at a slide (False)."""
        return unit_at(self.unit, rotates, drive)


@dataclass(frozen=True)
class ShapeParameter:
    """A parameter that enters non-linearly, a field of the effect's class of the same name.

    `candidates`, in rising order, span its range; the best of them starts the search, which stays between its
    neighbours. `scale`: whether they are in units of the joint's RMS speed or of the longest recording's duration.
    discrete: only the candidates make sense. unlike: number of essentially different shapes in a search.
    """

    name: str
    unit: str
    candidates: tuple[float, ...]
    scale: Literal["", "speed", "duration"] = ""
    discrete: bool = False
    unlike: int = 1

    def unit_at(self, rotates: bool, drive: str = "A") -> str:
        """The unit at a hinge (True) or at a slide (False)."""
        return unit_at(self.unit, rotates, drive)


@dataclass(frozen=True)
class Effect(ABC):
    """A physical effect, linear in `parameters`, with non-linear `shape` parameters as its fields.

    The motors have to overcome `columns(...) @ parameters`, N*m or N, in addition to the rigid-body torque.

    place: where it acts, with a set of parameters for each: "actuator" (joint with a motor), "passive" (joint without),
    "bearing" (a passive joint whose force the motion determines), "body" (with a length), "payload", or once for the
    "robot". contains: effects that are special cases of this one; it must earn its extra parameters against them.
    depends_on_model: its columns use the present model's torque or gain. before_torque: it acts between the current
    reference and the torque, and is not part of the needed torque for effects. at_link: it acts on the link of its
    motor, as all effects elsewhere do, so that a spring in the drive, or play, carries its torque.

    law: a sentence with the law as a formula in written symbols; symbols: their meaning and units. Both may be "".
    shown_by: the motion in which it differs most from other effects. seen: how the error of a model without it looks,
    the most frequent first; in_key: for each of them the words of the atlas's key that continue its question, "" if
    another of them says it.

    A field named like a linear parameter is the value about which the columns are linearised (see `about`): columns
    times parameter is then exact at that value. bends: the columns change much with it, so that the fit uses
    derivatives. changes_machine: it is a change of motion, lengths or gravity, see `position_offset` and `machine`.
    every_sample: its columns need all samples, as differences do, or change fast between samples, as
    friction does in a slow joint: a search must not thin them. of_velocity: its torque is an odd function of its
    joint's velocity alone. by_motor: the motor must supply its torque, since it neither stores energy nor carries a
    weight; it cannot be many times the motor's torque. varies_by_run: its value may differ between recordings, like an
    amplifier's offset, and a diagnosis checks this. of_instant: it depends on acceleration or torque of the same
    instant only. in_balls: for passive joints, whether a ball joint can have it. in_mjcf: the term of an MJCF's joint
    that has its law. in_single_joints: parts of an effect of the whole robot in single joints, see `in_joints_of`.
    """

    name: ClassVar[str]
    law: ClassVar[str] = ""
    symbols: ClassVar[str] = ""
    shown_by: ClassVar[str] = "move over the whole range, fast and slowly"
    seen: ClassVar[tuple[Seen, ...]] = ()
    in_key: ClassVar[tuple[str, ...]] = ()
    parameters: ClassVar[tuple[EffectParameter, ...]]
    shape: ClassVar[tuple[ShapeParameter, ...]] = ()
    place: ClassVar[Place] = "actuator"
    contains: ClassVar[tuple[str, ...]] = ()
    depends_on_model: ClassVar[bool] = False
    before_torque: ClassVar[bool] = False
    at_link: ClassVar[bool] = False
    bends: ClassVar[bool] = False
    changes_machine: ClassVar[bool] = False
    every_sample: ClassVar[bool] = False
    of_velocity: ClassVar[bool] = False
    by_motor: ClassVar[bool] = False
    varies_by_run: ClassVar[bool] = False
    of_instant: ClassVar[bool] = False
    in_balls: ClassVar[bool] = False
    in_mjcf: ClassVar[MjcfTerm | None] = None
    in_single_joints: "ClassVar[tuple[Effect, ...]]" = ()

    @abstractmethod
    def columns(self, robot: RobotSignals, joint: str) -> np.ndarray:
        """Torque at every motor for a unit value of each parameter, (N, n, p).

        joint: where the effect acts (a joint, a body or a payload); empty for an effect of the whole robot.
        """

    def in_joint(self, robot: RobotSignals, joint: str) -> np.ndarray | None:  # noqa: ARG002 - by default none
        """Torque or force (N, d, p) in its joint without a motor for a unit value of each parameter; None elsewhere.

        d: 1 in a hinge or slide, 3 in a ball joint.
        """
        return None

    def in_joints_of(self, geometry: Geometry) -> "Mapping[str, Effect]":  # noqa: ARG002 - by default in none
        """Which of `in_single_joints` an effect also has in a robot, by joint name."""
        return {}

    def shape_values(self) -> dict[str, float]:
        """The values of the shape parameters of this instance."""
        return {parameter.name: getattr(self, parameter.name) for parameter in self.shape}

    def about(self, values: Mapping[str, float]) -> Self:
        """The effect linearised about these values of its linear parameters; itself if it is linear."""
        field_names = {field.name for field in fields(self)} - {parameter.name for parameter in self.shape}
        known = {name: value for name, value in values.items() if name in field_names}
        return replace(self, **known) if known else self

    def starts(self, robots: Sequence[RobotSignals], joint: str) -> tuple[Self, ...]:  # noqa: ARG002 - by default as it is
        """The effect, and the same about further starting values of a search; robots: the fitted recordings."""
        return (self,)

    def about_values(self) -> dict[str, float]:
        """The values of its linear parameters about which the effect is linearised; none if it is linear."""
        names = {parameter.name for parameter in self.parameters}
        return {field.name: getattr(self, field.name) for field in fields(self) if field.name in names}

    def position_offset(self, values: np.ndarray) -> float:  # noqa: ARG002 - by default none
        """Offset of its joint from the logged position, rad or m, at these values (p,) of the parameters."""
        return 0.0

    @property
    def moves_by_steps(self) -> bool:
        """Whether steps move the values about which it is linearised, in place of each solution's."""
        return self.bends or self.changes_machine

    def machine(self, geometry: Geometry, joint: str, values: np.ndarray) -> Geometry:  # noqa: ARG002 - by default the same
        """Lengths and gravity of a robot with the effect at these values (p,) of the parameters."""
        return geometry

    def furthest(self, geometry: Geometry, joint: str) -> float:  # noqa: ARG002 - by default any
        """Size of its parameters up to which an effect that changes the machine is valid."""
        return float("inf")

    def nodes(self, robot: RobotSignals, joint: str) -> tuple[float, float] | None:  # noqa: ARG002 - by default none
        """Two values of its one parameter: a search interpolates and extrapolates the columns, linearised about the
        value, linearly from these; None if columns must be computed for each value.
        """
        return None

    def brackets(self, parameter: ShapeParameter, samples: Sequence[JointSamples]) -> tuple[Bracket, ...]:
        """Search ranges of a shape parameter at a joint; samples: of all fitted recordings, none elsewhere."""
        unit = 1.0
        if parameter.scale == "speed" and samples:
            unit = samples[0].speed
        elif parameter.scale == "duration" and samples:
            unit = max(joint_samples.duration for joint_samples in samples)
        values = [unit * value for value in parameter.candidates]
        if parameter.discrete:
            return tuple((value, value, value) for value in values)
        return tuple(
            (values[max(i - 1, 0)], value, values[min(i + 1, len(values) - 1)])
            for i, value in enumerate(values)
        )

    def brackets_near(
        self, parameter: ShapeParameter, samples: Sequence[JointSamples]
    ) -> tuple[Bracket, ...]:
        """Range for small steps of a shape parameter from its value; by default the search ranges."""
        return self.brackets(parameter, samples)


@dataclass(frozen=True)
class ActuatorEffect(Effect):
    """An effect at one actuated joint that changes only its motor's torque."""

    @abstractmethod
    def torque(self, joint: JointSignals) -> np.ndarray:
        """One column (N, p) for each parameter: torque or force at unit value."""

    def motor_column(self, robot: RobotSignals, joint: str) -> np.ndarray:
        """`torque` (N, p) at a joint. Raises BenchError if it has another shape."""
        torque = self.torque(robot.redundant[joint] if joint in robot.redundant else robot.joints[joint])
        shape = len(robot.time), len(self.parameters)
        if torque.shape != shape:
            raise BenchError(
                f"effect {self.name!r}: torque has the shape {torque.shape} instead of {shape}, a column for each "
                "parameter"
            )
        return torque

    def columns(self, robot: RobotSignals, joint: str) -> np.ndarray:
        """Columns (N, n, p), `torque` in the joint's row, zero elsewhere.

        At a redundant motor, what the others supply for it through the loops.
        """
        torque = self.motor_column(robot, joint)
        if joint in robot.redundant:
            index = robot.geometry.joints[robot.geometry.joint_index(joint)].v.start
            return robot.tree.jacobian[:, index, :, None] * torque[:, None, :]
        columns = np.zeros((len(torque), len(robot.joints), torque.shape[1]))
        columns[:, list(robot.joints).index(joint)] = torque
        return columns


def changes_torque(effect: Effect) -> bool:
    """Whether an effect is a change of the present model's torque: much less work with nearby columns."""
    return effect.depends_on_model and not isinstance(effect, ActuatorEffect)
