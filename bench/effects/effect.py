"""What an effect is: columns that the model lacks, in addition to those of the rigid bodies."""

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
    """What a search for shape parameters may look at, each (M,), decimated.

    position, velocity: rad or m and rate; motor_torque: gain times current, N*m or N; error: torque that the
    model lacks, zero where the joint does not move. duration s, of the recording; speed: the joint's RMS over
    all fitted recordings; travel: between its extreme positions in all of them; band Hz; rotates: a hinge.
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
"""What an error looks like, as the key of the atlas asks: it opposes the motion, fades or grows in the course of a
recording, or with the load; passes through zero with the velocity; repeats over the position; is a smooth curve over
it; follows the current or its change; follows the acceleration, or rings."""
MjcfTerm = Literal["stiffness", "damping", "frictionloss", "armature"]
Bracket = tuple[float, float, float]
"""Where a shape parameter is searched: lower bound, first value, upper bound; all equal: no further search."""


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

    In its unit `{effort}` is N*m or N, `{angle}` rad or m, `{turn}` turn or m, `{drive}` that of the current.
    positive: a negative value would be physically impossible, such as a friction that drives. below: a value, in that
    unit, from which on the effect would be another name for what it is made of, and its size means nothing.
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
    neighbours. They are in units of the joint's RMS speed or of the longest recording's duration where `scale`
    says so. discrete: nothing between the candidates makes sense. unlike: how many shapes that are nothing like each
    other a search may look at.
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

    place: where it sits, with a set of parameters for each: "actuator" (joint with a motor), "passive" (joint
    without), "bearing" (of those, one whose force follows from the motion), "body" (with a length), "payload", or once
    for the "robot". contains: effects that are special cases of this one; it must earn its extra parameters against
    them. depends_on_model: its columns use the present model's torque or gain. before_torque: it is between the
    current reference and the torque, and no part of the torque that effects see as needed. at_link: it acts on the link
    of its motor, as all that sits elsewhere does, so that a spring in the drive, or play, carries its torque.

    law: a sentence with the law as a formula in written symbols; symbols: what they mean, with their units. Both are
    "" where the effect tells none. shown_by: the motion in which it differs most from the others. seen: how the error
    of a model without it looks, what is most often seen first; in_key: the words of the atlas's key for each of them,
    which continue its question, "" where another of them says it.

    A field named like a linear parameter is the value about which the columns are linearised (see `about`):
    columns times parameter is then exact where the parameter has that value. bends: the columns change much with it,
    so that the fit goes by derivatives. every_sample: its columns follow from all samples, as differences do, or change
    much between few, as friction does where a joint is slow: a search must not take few of them. of_velocity: its
    torque is an odd function of its joint's velocity alone. by_motor: the motor has to give its torque, since it
    neither stores energy nor carries a weight; it cannot be many times what the motor gives. varies_by_run: it may have
    another value from one recording to the next, as an amplifier's offset has, and a diagnosis looks for that.
    of_instant: it follows from acceleration or torque of the same instant, and from nothing before. in_balls: of those
    at passive joints, one that a ball joint can have, too. in_mjcf: the term of an MJCF's joint that has its law.
    in_single_joints: what an effect of the whole robot is in single joints, see `in_joints_of`.
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
        """Torque at every motor for a value of one of each parameter, (N, n, p).

        joint: where the effect sits (a joint, a body or a payload); empty for an effect of the whole robot.
        """

    def in_joint(self, robot: RobotSignals, joint: str) -> np.ndarray | None:  # noqa: ARG002 - by default none
        """Torque or force (N, d, p) in its joint without a motor for a value of one of each parameter; None elsewhere.

        d: 1 in a hinge or slide, 3 in a ball joint.
        """
        return None

    def in_joints_of(self, geometry: Geometry) -> "Mapping[str, Effect]":  # noqa: ARG002 - by default in none
        """Which of `in_single_joints` an effect has in a robot in addition, by the joints' names."""
        return {}

    def shape_values(self) -> dict[str, float]:
        """The values of the shape parameters of this instance."""
        return {parameter.name: getattr(self, parameter.name) for parameter in self.shape}

    def about(self, values: Mapping[str, float]) -> Self:
        """The effect linearised about these values of its linear parameters; itself where it is linear."""
        field_names = {field.name for field in fields(self)} - {parameter.name for parameter in self.shape}
        known = {name: value for name, value in values.items() if name in field_names}
        return replace(self, **known) if known else self

    def starts(self, robot: RobotSignals, joint: str) -> tuple[Self, ...]:  # noqa: ARG002 - by default as it is
        """The effect as it is, and linearised about other values from which a search is to begin as well."""
        return (self,)

    def about_values(self) -> dict[str, float]:
        """The values of its linear parameters about which the effect is linearised; none where it is linear."""
        names = {parameter.name for parameter in self.parameters}
        return {field.name: getattr(self, field.name) for field in fields(self) if field.name in names}

    def position_offset(self, values: np.ndarray) -> float:  # noqa: ARG002 - by default none
        """How far its joint is from where it was logged, rad or m, at these values (p,) of the parameters."""
        return 0.0

    def nodes(self, robot: RobotSignals, joint: str) -> tuple[float, float] | None:  # noqa: ARG002 - by default none
        """Two values of its one parameter inside and outside of which a search takes the columns, linearised about the
        parameter's value, to follow a straight line; None where they are to be computed for each value.
        """
        return None

    def brackets(self, parameter: ShapeParameter, samples: Sequence[JointSamples]) -> tuple[Bracket, ...]:
        """Where to search a shape parameter at a joint; samples: of every fitted recording, none elsewhere."""
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
        """As far as small steps may take a shape parameter from its value; by default to where it is searched."""
        return self.brackets(parameter, samples)


@dataclass(frozen=True)
class ActuatorEffect(Effect):
    """An effect at one actuated joint that shows in its motor's torque alone."""

    @abstractmethod
    def torque(self, joint: JointSignals) -> np.ndarray:
        """One column (N, p) for each parameter: its torque or force at a parameter value of one."""

    def motor_column(self, robot: RobotSignals, joint: str) -> np.ndarray:
        """`torque` (N, p) at a joint. Raises BenchError where it has another shape."""
        torque = self.torque(robot.redundant[joint] if joint in robot.redundant else robot.joints[joint])
        shape = len(robot.time), len(self.parameters)
        if torque.shape != shape:
            raise BenchError(
                f"effect {self.name!r}: torque has the shape {torque.shape} instead of {shape}, a column for each "
                "parameter"
            )
        return torque

    def columns(self, robot: RobotSignals, joint: str) -> np.ndarray:
        """Columns (N, n, p) with `torque` in the joint's row and zero elsewhere.

        At a redundant motor, what the others have to supply for it through the loops.
        """
        torque = self.motor_column(robot, joint)
        if joint in robot.redundant:
            index = robot.geometry.joints[robot.geometry.joint_index(joint)].v.start
            return robot.tree.jacobian[:, index, :, None] * torque[:, None, :]
        columns = np.zeros((len(torque), len(robot.joints), torque.shape[1]))
        columns[:, list(robot.joints).index(joint)] = torque
        return columns


def changes_torque(effect: Effect) -> bool:
    """Whether an effect is a change of the present model's torque: much less work where small changes are known."""
    return effect.depends_on_model and not isinstance(effect, ActuatorEffect)
