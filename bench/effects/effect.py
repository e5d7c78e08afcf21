"""What an effect is: columns that the model lacks, beside those of the rigid bodies."""

from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping
from dataclasses import dataclass, fields
from typing import ClassVar, Literal

import numpy as np

from bench.model.geometry import Geometry
from bench.model.motion import Motion

Place = Literal["actuator", "passive", "robot"]


def unit_at(unit: str, rotates: bool) -> str:
    """A unit with `{effort}` and `{angle}` filled in for a hinge (True) or a slide (False)."""
    return unit.format(effort="N*m" if rotates else "N", angle="rad" if rotates else "m")


@dataclass(frozen=True)
class EffectParameter:
    """A parameter of an effect; in its unit `{effort}` is N*m or N and `{angle}` is rad or m.

    positive: a negative value would be physically impossible, such as a friction that drives.
    """

    name: str
    unit: str
    positive: bool = False

    def unit_at(self, rotates: bool) -> str:
        """The unit at a hinge (True) or at a slide (False)."""
        return unit_at(self.unit, rotates)


@dataclass(frozen=True)
class ShapeParameter:
    """A parameter that enters non-linearly, a field of the effect's class of the same name.

    `candidates` span its range; the best of them starts the search, which stays between the first and the last.
    """

    name: str
    unit: str
    candidates: tuple[float, ...]

    def unit_at(self, rotates: bool) -> str:
        """The unit at a hinge (True) or at a slide (False)."""
        return unit_at(self.unit, rotates)


@dataclass(frozen=True)
class JointSignals:
    """What is known of one actuated joint at every sample, each (N,), before decimation.

    time s, from the start of the recording; position, velocity, acceleration in rad or m and their rates,
    filtered; current in drive units, as logged; gain: the drive gain, N*m or N per drive unit, as the present
    model has it (nominal at first). `speed` is the joint's RMS speed over all fitted recordings.
    """

    time: np.ndarray
    position: np.ndarray
    velocity: np.ndarray
    acceleration: np.ndarray
    current: np.ndarray
    gain: float
    speed: float
    rate: float


@dataclass(frozen=True)
class RobotSignals:
    """One recording of a whole robot before decimation: N samples, n motors.

    joints: the actuated ones by name, in actuator order. tree: the motion of all joints of the opened tree.
    payload: the name of what it carries, None without; payload_torque (N, n): of its declared parameters.
    torque: the rigid-body torque (N, n) of the present model at other active positions, velocities and
    accelerations (N, n each) and, where given, another gravity (3,) m/s2 or geometry, payload included. An
    effect that depends on it is linearised about the present model, and the fit repeats until it is settled.
    """

    joints: Mapping[str, JointSignals]
    geometry: Geometry
    tree: Motion
    payload: str | None
    payload_torque: np.ndarray
    torque: "TorqueModel"


TorqueModel = Callable[..., np.ndarray]
"""torque(position, velocity, acceleration, *, gravity=None, geometry=None) -> (N, n)."""


@dataclass(frozen=True)
class Effect(ABC):
    """A physical effect, linear in `parameters`, with non-linear `shape` parameters as its own fields.

    The motors have to overcome `columns(...) @ parameters`, N*m or N, beside the rigid-body torque.

    place: "actuator" (one set of parameters for each actuated joint), "passive" (for each joint without a
    motor) or "robot" (one set). contains: effects that are special cases of this one; it must earn its
    extra parameters against them. depends_on_model: its columns use the present model's torque or gain.
    """

    name: ClassVar[str]
    parameters: ClassVar[tuple[EffectParameter, ...]]
    shape: ClassVar[tuple[ShapeParameter, ...]] = ()
    place: ClassVar[Place] = "actuator"
    contains: ClassVar[tuple[str, ...]] = ()
    depends_on_model: ClassVar[bool] = False

    @abstractmethod
    def columns(self, robot: RobotSignals, joint: str) -> np.ndarray:
        """Torque at every motor for a value of one of each parameter, (N, n, p).

        joint: where the effect sits; empty for an effect of the whole robot.
        """

    def shape_values(self) -> dict[str, float]:
        """The values of the shape parameters of this instance."""
        names = {parameter.name for parameter in self.shape}
        return {field.name: getattr(self, field.name) for field in fields(self) if field.name in names}


@dataclass(frozen=True)
class ActuatorEffect(Effect):
    """An effect at one actuated joint that shows in its own motor's torque alone."""

    @abstractmethod
    def torque(self, joint: JointSignals) -> np.ndarray:
        """One column (N, p) for each parameter: its torque or force at a parameter value of one."""

    def columns(self, robot: RobotSignals, joint: str) -> np.ndarray:
        """Columns (N, n, p) with `torque` in the joint's own row and zero elsewhere."""
        torque = self.torque(robot.joints[joint])
        names = list(robot.joints)
        columns = np.zeros((len(torque), len(names), torque.shape[1]))
        columns[:, names.index(joint)] = torque
        return columns
