"""Base classes of hidden effects: a change of the MuJoCo model, or laws that are evaluated at every step."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import ClassVar, Literal

import mujoco
import numpy as np
from numpy.typing import NDArray

from bench.basics.errors import BenchError
from bench.dataset.mjcf_neutral import neutral
from bench.dataset.payload import Payload
from bench.dataset.robot import Robot

Array = NDArray[np.float64]
Sizes = dict[str, float]
"""Parameters of an effect by name."""


@dataclass(frozen=True, eq=False)
class JointMovement:
    """One actuated joint of a reference; N samples of all recordings, SI units."""

    joint: str
    slide: bool
    time: Array
    """(N,) from 0 in each recording."""
    period: float
    position: Array
    velocity: Array
    acceleration: Array
    torque: Array
    """Of the motor; the next two are its first and second time derivatives."""
    torque_rate: Array
    torque_bend: Array
    current: Array
    current_rate: Array
    other_torques: Array
    """Sum of the torques of the other motors."""
    inertia: float
    """Effective inertia at the joint in the home pose, loops closed."""
    armature: float
    stiffness: float
    """kp of the controller."""
    damping: float
    """kv of the controller."""

    @property
    def duration(self) -> float:
        """Duration of the longest recording, s."""
        return float(self.time.max())

    @property
    def span(self) -> float:
        """Difference of the largest and the smallest position."""
        return float(np.ptp(self.position))

    def too_large(self, effect: str, share: float, why: str) -> BenchError:
        """The error for an effect that cannot have such a share of the torque."""
        return BenchError(
            f"{effect} of joint {self.joint}: a share of {share:g} of its torque is too large: {why}"
        )


def rms(values: Array) -> float:
    """Root mean square."""
    return float(np.sqrt(np.mean(np.square(values))))


def wave_sizes(j: JointMovement, factor: np.ndarray, share: float) -> Sizes:
    """a, b and harmonic of a wave times a factor (N,); the wave is positive and falls towards the largest position.

    One harmonic in the position of a hinge, unless it turns so far that this would change its sign.
    """
    reach = 0.9 * np.pi
    harmonic = reach / j.span if j.slide or j.span > reach else 1.0
    phase = harmonic * j.position.max() - reach / 2
    size = share * rms(j.torque) / rms(np.cos(harmonic * j.position - phase) * factor)
    waves = {"a": size * np.cos(phase), "b": size * np.sin(phase)}
    return waves if harmonic == 1.0 else waves | {"harmonic": harmonic}


Law = Callable[[], Array]
"""An effect's output at the present step, as a function of its signals; it may keep a state between steps."""

Parameters = Mapping[str, Array]
"""Parameters of an effect in m joints, by name, (m,) each."""


@dataclass(eq=False)
class Clock:
    """The time of the present step, s; 0 at the start of the log."""

    time: float = 0.0


@dataclass(frozen=True, eq=False)
class Signals:
    """State of m motors in R recordings at the present step, (R, m) each.

    A motor moves with its joint unless there is a spring or play between them. Its encoder measures the motor's
    position. The arrays are views that change at every step.
    """

    step: float
    """s."""
    recordings: tuple[str, ...]
    """(R,) names."""
    joints: tuple[str, ...]
    """(m,) names."""
    clock: Clock
    position: Array
    """rad or m."""
    velocity: Array
    acceleration: Array
    """One step ago, since the acceleration of the present step depends on its forces."""
    current: Array
    """The actual current, in the drive's unit."""
    torque: Array
    """Of the motor."""
    all_torques: Array
    """(R, n) of all motors."""

    def columns(self, columns: slice) -> Signals:
        """The same signals for some of the joints."""
        views = {
            name: getattr(self, name)[:, columns]
            for name in ("position", "velocity", "acceleration", "current", "torque")
        }
        return replace(self, joints=self.joints[columns], **views)


def harmonic(p: Parameters, position: Array, wave_number: Array) -> Array:
    """a cos(κ q) + b sin(κ q), (R, m), with κ = wave_number (m,) in 1/rad or 1/m."""
    phase = wave_number * position
    return p["a"] * np.cos(phase) + p["b"] * np.sin(phase)


PAYLOAD_BODY = "payload of the scenario"
MOTOR_SIDE = "hidden:motor side:"
"""Prefix of a joint's name for the rotor of its motor, if there is a spring or play between the two."""

NO_MOTOR = 1e-9  # N·m/A: MuJoCo requires a motor constant; braking grows with its square


@dataclass(frozen=True, eq=False)
class Draft:
    """A machine under construction: its uncompiled model, and the robot without hidden effects."""

    spec: mujoco.MjSpec
    robot: Robot
    plain: mujoco.MjModel
    home: Array
    """qpos (nq,) of `plain` in the keyframe `home`."""
    inertia: Mapping[str, float]
    """Effective inertia at each actuated joint in the home pose, loops closed, kg·m² or kg."""
    payloads: tuple[str, ...]
    """Names of the payloads of the scenario."""

    @property
    def step(self) -> float:
        """Step of the simulation, s."""
        return float(self.spec.option.timestep)

    def motor_side(self, joint: str) -> mujoco.MjsJoint:
        """The joint that the motor of an actuated joint turns: that of its rotor, or the joint itself."""
        rotor = self.spec.joint(MOTOR_SIDE + joint)
        return self.spec.joint(joint) if rotor is None else rotor

    def motor_inertia(self, joint: str) -> float:
        """Inertia, kg·m² or kg, that the motor of an actuated joint turns at home: that at the joint, or of its rotor
        alone.
        """
        rotor = self.spec.joint(MOTOR_SIDE + joint)
        return self.inertia[joint] if rotor is None else float(rotor.armature)


@dataclass(frozen=True)
class HiddenEffect:
    """An effect of the whole machine; the fields of a subclass are its parameters, in SI units.

    An effect overrides the methods below that it needs. Those that return a law receive the parameters of m joints at
    once, (m,) each, so that the same law serves one joint or several.
    """

    name: ClassVar[str]
    positive: ClassVar[tuple[str, ...]] = ()
    """Parameters that must be greater than 0."""
    not_negative: ClassVar[tuple[str, ...]] = ()
    """Parameters that physically cannot be negative."""
    changes_drives: ClassVar[bool] = False
    """Whether it changes what the motors turn; it is then applied before the motors are added."""
    in_catalogue: ClassVar[bool] = True
    """False for a law that no identified model is expected to contain."""
    law: ClassVar[str] = ""
    """One line for the table of scenarios/README.md."""
    needs: ClassVar[Literal["tool", "payload", "motors"] | None] = None
    """What a machine needs for it in addition to the joint: a tool site, a payload, or several motors."""
    shares: ClassVar[tuple[float, float]] = (0.004, 0.1)
    """Range of its torque over that of its motor, RMS over RMS, in a trial. It is higher for effects that the other
    parameters mostly absorb, and lower if more would mean a broken machine (play of degrees, links wrong by
    centimetres, a drive that resonates within the motion's frequencies).
    """
    scaled: ClassVar[tuple[str, float] | None] = None
    """A parameter to which its torques are proportional, and the initial value of the search for its size."""

    def change(self, draft: Draft) -> None:
        """Add the effect to the uncompiled model."""

    def adjust(self, model: mujoco.MjModel, draft: Draft) -> None:
        """Change the compiled model."""

    def weigh(self, payload: Payload) -> Payload:
        """The true payload if `payload` is declared."""
        return payload


@dataclass(frozen=True)
class JointEffect(HiddenEffect):
    """An effect in one joint of the machine.

    If there is a spring or play between a motor and its joint, friction acts on the motor's side, as that of motor
    and gear (Albu-Schäffer, Ott and Hirzinger, "A unified passivity-based control framework for position, torque and
    impedance control of flexible joint robots", IJRR 26, 2007); all laws of this class do.

    A torque is positive if the motor has to supply it in addition to that of the rigid body, g i = τ_rigid + law.
    Torques represent forces where the joint is a slide.
    """

    where: ClassVar[Literal["actuated", "passive", "any"]] = "actuated"
    """The joints that may have it. If no joint is named, all actuated (or all passive) joints have it."""
    in_balls: ClassVar[bool] = False
    """Whether passive ball joints may have it as well, in each coordinate of the angular velocity."""
    joint: str

    @staticmethod
    def sized(j: JointMovement, share: float) -> Sizes | None:  # noqa: ARG004
        """Parameters for which the RMS of its torque is `share` times that of the joint's torque; None without such a
        rule.
        """
        return None

    @staticmethod
    def encoder(p: Parameters, s: Signals) -> Law | None:  # noqa: ARG004
        """Error of the encoder, to be added to s.position, (R, m)."""
        return None

    @staticmethod
    def log(p: Parameters, s: Signals) -> Law | None:  # noqa: ARG004
        """The logged value that replaces the current reference s.current, (R, m)."""
        return None

    @staticmethod
    def current(p: Parameters, s: Signals) -> Law | None:  # noqa: ARG004
        """The actual current that replaces s.current, (R, m), in the drive's unit."""
        return None

    @staticmethod
    def gain(p: Parameters, s: Signals) -> Law | None:  # noqa: ARG004
        """Factor of the true drive gain, (R, m), at the actual current s.current."""
        return None

    @staticmethod
    def torque(p: Parameters, s: Signals) -> Law | None:  # noqa: ARG004
        """Opposing torque (R, m)."""
        return None

    @staticmethod
    def dry_friction(p: Parameters, s: Signals) -> Law | None:  # noqa: ARG004
        """Size (R, m) of a dry friction that opposes the motion and holds the joint at standstill."""
        return None

    @staticmethod
    def bearing_friction(p: Parameters, force: Array) -> Array | None:  # noqa: ARG004
        """Size (R, m) of a dry friction in passive joints with bearing forces `force` (R, m), N, perpendicular to
        their axes.
        """
        return None


@dataclass(frozen=True)
class DryFriction(JointEffect):
    """A dry friction whose size a law computes; the joint's friction constraint applies it and holds the joint at
    standstill.
    """

    def change(self, draft: Draft) -> None:
        hard_friction(draft, self.joint)


LAWS = ("encoder", "log", "current", "gain", "torque", "dry_friction", "bearing_friction")
"""Methods of a joint's effect that return a law, in the order of evaluation."""


def has_law(effect: HiddenEffect, law: str) -> bool:
    """Whether an effect overrides one of LAWS."""
    kind = type(effect)
    return isinstance(effect, JointEffect) and getattr(kind, law) is not getattr(JointEffect, law)


def hard_friction(draft: Draft, joint: str) -> None:
    """As `harden_friction`, on the motor's side of a joint."""
    harden_friction(draft.motor_side(joint), draft.step)


def harden_friction(joint: mujoco.MjsJoint, step: float) -> None:
    """Make the constraint of a joint's dry friction as hard as the step allows, s.

    MuJoCo's friction constraint brings a slow joint to rest within the time constant of its `solref`. With two steps,
    the shortest stable value, the full friction acts to rounding once the joint is faster than a few times
    (acceleration by the friction) · step, about 1e-3 rad/s. With the default of 0.02 s it would take 0.1 rad/s.
    """
    joint.solref_friction = [2 * step, 1.0]
    joint.solimp_friction = [0.9999, 0.99999, 0.001, 0.5, 2.0]


def add_damping(draft: Draft, joint: str, linear: float, quadratic: float = 0.0) -> None:
    """Add linear · q̇ + quadratic · q̇ |q̇| to the damping of a joint."""
    changed = draft.motor_side(joint)
    damping = changed.damping.copy()
    damping[:2] += linear, quadratic
    changed.damping = damping


def add_affine_actuator(draft: Draft, name: str, joint: mujoco.MjsJoint, bias: tuple[float, float]) -> None:
    """Add an actuator without command; its force on the joint is bias[0] + bias[1] · position."""
    actuator = draft.spec.add_actuator(neutral(), name=free_name(draft, name), target=joint.name)
    actuator.trntype = mujoco.mjtTrn.mjTRN_JOINT
    actuator.gaintype = mujoco.mjtGain.mjGAIN_FIXED
    actuator.gainprm[0] = 0.0
    actuator.biastype = mujoco.mjtBias.mjBIAS_AFFINE
    actuator.biasprm[0], actuator.biasprm[1] = bias


def add_dc_motor(
    draft: Draft,
    name: str,
    joint: mujoco.MjsJoint,
    lugre: Sequence[float] = (0.0, 0.0, 0.0, 0.0, 0.0),
    cogging: Sequence[float] = (0.0, 0.0, 0.0),
) -> None:
    """Add a DC motor without current, only for its friction and cogging.

    lugre: stiffness and damping of the bristles, Coulomb and static friction, Stribeck velocity.
    cogging: amplitude, periods in 2π rad, phase: amplitude · sin(periods · position + phase) on the joint.
    """
    actuator = draft.spec.add_actuator(neutral(), name=free_name(draft, name), target=joint.name)
    actuator.trntype = mujoco.mjtTrn.mjTRN_JOINT
    actuator.set_to_dcmotor(
        motorconst=[NO_MOTOR, 0.0],
        resistance=1.0,
        lugre=list(lugre),
        cogging=list(cogging),
        ctrlspec=int(mujoco.mjtCtrlInput.mjINPUT_NONE),
    )


def free_name(draft: Draft, name: str) -> str:
    """`name` with a prefix and a number that no other actuator has."""
    taken = {actuator.name for actuator in draft.spec.actuators}
    return next(n for n in (f"hidden:{name}:{i}" for i in range(len(taken) + 1)) if n not in taken)


def refuse_fast_swing(draft: Draft, effect: JointEffect, stiffness: float, inertia: float) -> None:
    """Raise BenchError if an inertia on a spring would oscillate too fast for the simulation's step."""
    if np.sqrt(stiffness / inertia) * draft.step > 0.5:
        raise BenchError(
            f"{effect.name} of joint {effect.joint}: {inertia:.2g} on {stiffness:g} swings too fast for a step of"
            f" {draft.step:g} s: at most {0.25 * inertia / draft.step**2:.3g}"
        )
