"""The signals of a recording and of the present model that effects may use."""

from collections.abc import Callable, Hashable, Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import ClassVar, Protocol

import numpy as np

from bench.basics.interpolation import spline_at_every
from bench.effects.row_cache import KeptRows
from bench.model.geometry import Geometry
from bench.model.motion import Motion
from bench.signals.filtering import low_pass

OVERSAMPLING = 8.0  # coarse samples in one period of the highest frequency in the fit
WIDER = 2.0  # cut-off of the motor torque in units of that frequency: the filter attenuates by 0.4 % there


@dataclass(frozen=True)
class JointSignals:
    """Signals of one actuated joint at every sample, each (N,), before decimation.

    time s, from the start of the recording; position, velocity, acceleration in rad or m and their rates, filtered;
    current in drive units, as logged; gain: the present model's drive gain, N*m or N per drive unit (nominal at first).
    `speed` is the joint's RMS speed over all fitted recordings, `rate` the sampling rate in Hz, `band` the highest
    frequency in Hz in the fit; rotates: a hinge, not a slide. `needs` computes `needed_torque`.
    """

    time: np.ndarray
    position: np.ndarray
    velocity: np.ndarray
    acceleration: np.ndarray
    current: np.ndarray
    gain: float
    speed: float
    rate: float
    band: float
    rotates: bool
    needs: Callable[[], np.ndarray]

    @cached_property
    def needed_torque(self) -> np.ndarray:
        """Torque (N,), N*m or N, that the present model and its effects require of the motor, free of current noise.

        Without effects between current and torque, effects that use it themselves, and frequencies above the fit's
        band.
        """
        return self._smooth(self.needs())

    @cached_property
    def motor_torque(self) -> np.ndarray:
        """Gain times current (N,), N*m or N, without the noise above the fit's band."""
        return self._smooth(self.gain * self.current)

    def follows(self, phase: np.ndarray) -> np.ndarray:
        """Whether samples (N,) are dense enough for a signal of this phase (N,), rad: all of a log are."""
        return np.ones(len(phase), dtype=bool)

    def _smooth(self, values: np.ndarray) -> np.ndarray:
        cutoff = WIDER * self.band
        return values if cutoff >= 0.45 * self.rate else low_pass(values, self.rate, cutoff)


class AskedWithinError(Exception):
    """An effect asked for the model's needed torque while this was being summed from its effects."""


@dataclass(frozen=True, eq=False)
class Changed:
    """Changes from the measured state: active positions, velocities and accelerations (K, n) each, gravity (3,) m/s2,
    or the geometry; None if unchanged.
    """

    motion: tuple[np.ndarray, np.ndarray, np.ndarray] | None = None
    gravity: np.ndarray | None = None
    geometry: Geometry | None = None


UNCHANGED = Changed()


class TorqueModel(Protocol):
    """The rigid-body torque of the present model, payload included, for every `every`-th sample.

    At the measured or a changed motion, K = ceil(N / every). Returns (K, n), N*m or N. Raises BenchError if the loops
    cannot be closed.
    """

    def __call__(self, changed: Changed = UNCHANGED, every: int = 1) -> np.ndarray: ...


@dataclass(frozen=True)
class JointReaction:
    """Bearing force of a joint by the present model, in two directions perpendicular to its axis.

    force (K, 2) N, at one of `every` samples; of_mass (K, 2) N/kg: by a mass on the joint's axis, beyond it. mass: kg,
    the additional mass on the axis with equal bars as heavy as the model. by_torque: by a unit torque or force in
    another joint without a motor, by name, or in the joint itself (K, 2, d), d: 1 of a hinge or slide, 3 of a ball
    joint.
    """

    force: np.ndarray
    of_mass: np.ndarray
    mass: float
    by_torque: Callable[[str], np.ndarray]


class ReactionModel(Protocol):
    """Bearing force of a passive joint, for every `every`-th sample. Raises BenchError for any other joint."""

    def __call__(self, joint: str, every: int) -> JointReaction: ...


@dataclass(frozen=True)
class Coarse:
    """Thinned samples of a recording, enough for smooth signals: time (K,) s, interval s; of the active joints
    position, velocity and acceleration, and the present model's rigid-body torque, (K, n) each.
    """

    time: np.ndarray
    interval: float
    position: np.ndarray
    velocity: np.ndarray
    acceleration: np.ndarray
    torque: np.ndarray


@dataclass(frozen=True)
class Sparse:
    """Signals at one of `every` samples of a recording's `length`, from the first.

    shares: for every joint, the part of each sample's interval that lies in a gap, (K,) each.
    """

    every: int
    length: int
    shares: tuple[np.ndarray, ...]


@dataclass(frozen=True)
class RobotSignals:
    """One recording of a whole robot before decimation: N samples, n motors.

    joints: the actuated ones that move independently by name, in actuator order; redundant: the others with a motor.
    `moved` computes `tree`. payload: the name of what it carries, None without; payload_mass kg, as declared, zero if
    unknown; `carried` computes `payload_torque`. torque: the rigid-body torque of the present model, less that of
    redundant motors. joint_reaction: its forces in joints; in_joints: torques (N, d) of its effects in joints without a
    motor, by name, N*m or N; at_links: motor torques (N, n) for its effects on links, N*m or N. An effect that depends
    on the model is linearised about the present one, and the fit repeats until it converges. gaps: stretches of samples
    in which each joint is at rest. offsets: of the present model's encoders by joint, rad or m. log: the recording, for
    effects with a value for each. lasting: rows of effects that do not depend on the present model, kept as long as the
    recording; passing: those that do. noted: other results of effects for the present model. sparse: set if these are
    not all samples of the recording.
    """

    expands: ClassVar[bool] = False
    """Whether candidates of a search need only be exact to second order in an effect's value."""

    joints: Mapping[str, JointSignals]
    geometry: Geometry
    moved: Callable[[], Motion]
    payload: str | None
    payload_mass: float
    carried: Callable[[], np.ndarray]
    torque: TorqueModel
    gaps: tuple[np.ndarray, ...]
    joint_reaction: ReactionModel
    in_joints: Callable[[], Mapping[str, np.ndarray]]
    at_links: Callable[[], np.ndarray]
    offsets: Mapping[str, float] = field(default_factory=dict)
    log: str = ""
    redundant: Mapping[str, JointSignals] = field(default_factory=dict)
    lasting: KeptRows = field(default_factory=KeptRows, compare=False, repr=False)
    passing: KeptRows = field(default_factory=KeptRows, compare=False, repr=False)
    noted: dict[Hashable, np.ndarray] = field(default_factory=dict, compare=False, repr=False)
    sparse: Sparse | None = None

    def forget(self) -> None:
        """Free what effects have noted, once their rows are known: it is computed again on demand."""
        self.noted.clear()

    @property
    def sparsely(self) -> "RobotSignals":
        """For effects whose columns are often tried: in a search, at few samples."""
        return self

    @property
    def length(self) -> int:
        """Number of samples of the recording."""
        return len(self.time) if self.sparse is None else self.sparse.length

    @cached_property
    def tree(self) -> Motion:
        """The motion of all joints of the opened tree, with the encoder zeros of the present model."""
        return self.moved()

    @property
    def as_measured(self) -> bool:
        """Whether that is the measured motion: rows from it then last as long as the recording."""
        return not any(self.offsets.values())

    @cached_property
    def payload_torque(self) -> np.ndarray:
        """Torque or force (N, n) of the payload's declared parameters; zero without a payload."""
        return self.carried()

    @cached_property
    def redundant_torque(self) -> np.ndarray:
        """Torque or force (N, r) of the redundant motors, without the noise above the fit's band."""
        return np.column_stack([joint.motor_torque for joint in self.redundant.values()])

    @cached_property
    def time(self) -> np.ndarray:
        """From the start of the recording (N,), s."""
        return next(iter(self.joints.values())).time

    @cached_property
    def position(self) -> np.ndarray:
        """Positions of the active joints (N, n), rad or m, as logged."""
        return np.column_stack([joint.position for joint in self.joints.values()])

    @cached_property
    def velocity(self) -> np.ndarray:
        """Velocities of the active joints (N, n), rad/s or m/s."""
        return np.column_stack([joint.velocity for joint in self.joints.values()])

    @cached_property
    def acceleration(self) -> np.ndarray:
        """Accelerations of the active joints (N, n), rad/s2 or m/s2."""
        return np.column_stack([joint.acceleration for joint in self.joints.values()])

    @cached_property
    def every(self) -> int:
        """Number of samples per coarse one."""
        joint = next(iter(self.joints.values()))
        return max(1, int(joint.rate / (OVERSAMPLING * joint.band)))

    @cached_property
    def coarse(self) -> Coarse:
        """The recording at few samples, with the torque of the present model."""
        step = slice(None, None, self.every)
        joint = next(iter(self.joints.values()))
        return Coarse(
            time=self.time[step],
            interval=self.every / joint.rate,
            position=np.column_stack([joint.position[step] for joint in self.joints.values()]),
            velocity=np.column_stack([joint.velocity[step] for joint in self.joints.values()]),
            acceleration=np.column_stack([joint.acceleration[step] for joint in self.joints.values()]),
            torque=self.torque(every=self.every),
        )

    def refined(self, values: np.ndarray) -> np.ndarray:
        """Smooth values (K, ...) at the coarse samples, at every sample (N, ...): a cubic spline."""
        if self.every == 1:
            return values
        return spline_at_every(values, self.every, len(self.time))

    def torque_change(
        self,
        shift: np.ndarray | None = None,
        *,
        gravity: np.ndarray | None = None,
        geometry: Geometry | None = None,
    ) -> np.ndarray:
        """Change of the present model's torque with motion, gravity or geometry, (N, n), N*m or N.

        shift (3, K, n): added to the coarse positions, velocities and accelerations. Evaluated at the coarse samples.
        Raises BenchError if the loops cannot be closed after the change.
        """
        return self.refined(self.coarse_change(shift, gravity=gravity, geometry=geometry))

    def coarse_change(
        self,
        shift: np.ndarray | None = None,
        *,
        gravity: np.ndarray | None = None,
        geometry: Geometry | None = None,
    ) -> np.ndarray:
        """As `torque_change`, at the coarse samples (K, n)."""
        reference = self.coarse
        moved = None
        if shift is not None:
            moved = (
                reference.position + shift[0],
                reference.velocity + shift[1],
                reference.acceleration + shift[2],
            )
        return self.torque(Changed(moved, gravity, geometry), self.every) - reference.torque
