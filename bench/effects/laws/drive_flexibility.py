"""A spring between motor and link."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy.linalg import solve_banded

from bench.basics.errors import BenchError
from bench.basics.interpolation import cubic_spline
from bench.effects.effect import Bracket, Effect, EffectParameter, JointSamples, ShapeParameter
from bench.effects.motor_link_difference import (
    apparent_inertia,
    motion_cutoff,
    rates_behind,
    slopes,
    torque_behind,
    torque_of_motor,
)
from bench.effects.signals import RobotSignals

LARGEST = 0.05  # rad or m: deflection up to which the torque is computed exactly, not linearly
MOST_DAMPED = 0.9  # more does not oscillate
SWINGS = (1.4, 1.0, 0.7)  # of the fit's band: frequencies of the swing from which a search begins
LEAST = 1e-6  # of the largest squared period: keeps it above zero


@dataclass(frozen=True)
class DriveFlexibility(Effect):
    """The link lies behind the motor, whose position was logged, by the deflection d of a spring.

    The columns are changes of the model's torque when the link has the position, velocity and acceleration behind the
    spring; frequencies above the band of the joint's motion are removed, since encoder noise grows with their fourth
    power. Valid if friction acts at motor and gear and does not load the spring; coupled oscillations of drives are
    neglected. Source: Spong, "Modeling and control of elastic joint robots", Journal of Dynamic Systems, Measurement,
    and Control 109, 1987.
    """

    name = "drive_flexibility"
    law = "The link lies behind the motor, whose position was logged, by the deflection d of a spring."
    symbols = (
        "τ = τ_r(q − d) − τ_r(q) with d + 2 zeta T d' + T2 d'' = C τ_s, τ_s = τ_r − Ia q̈, T T = T2 = C (M "
        "− Ia): the link swings on the spring. C: compliance, one over the stiffness, positive, rad/(N·m) "
        "or m/N; τ_r: torque of the present rigid model at the joint, rotor included, and M its inertia "
        "there; τ_s: what a stiff drive would carry of it; Ia: inertia of the rotor, which does not follow "
        "the spring. CIa = C Ia: positive, s², one over the square of the rotor's angular frequency on the "
        "spring. zeta: damping ratio of the link on the spring, estimated from the data; without a C the link "
        "does not swing."
    )
    shown_by = "reverse fast, with a heavy payload"
    seen = ("acceleration",)
    in_key = ("grows with the change of the torque, and rings",)
    parameters = (
        EffectParameter("C", "{angle}/({effort})", positive=True),
        EffectParameter("CIa", "s^2", positive=True),
    )
    shape = (ShapeParameter("zeta", "1", (0.02, 0.06, 0.2, 0.6)),)
    depends_on_model = True
    every_sample = True
    bends = True

    C: float = 0.0
    CIa: float = 0.0
    zeta: float = 0.06

    def columns(self, robot: RobotSignals, joint: str) -> np.ndarray:
        torque, acceleration = torque_of_motor(robot, joint)
        at = list(robot.joints).index(joint)
        by_motion = slopes(robot, joint)
        parts = np.stack((torque, -acceleration), axis=1)
        compliance, rotor = max(self.C, 0.0), 0.0
        if compliance > 0.0:
            rotor = min(max(self.CIa, 0.0) / compliance, apparent_inertia(torque, acceleration))
            squared = compliance * (by_motion[2, :, at] - rotor)
            squared = np.maximum(squared, LEAST * np.abs(squared).max())
            damping = min(max(self.zeta, 0.0), MOST_DAMPED)
            parts = deflection(parts, robot.coarse.interval, squared, damping)
        cutoff = motion_cutoff(robot, joint)
        small = []
        for part in parts.T:
            rates = rates_behind(robot, part, cutoff)
            change = -np.einsum("okn,ok->kn", by_motion, rates)
            change[:, at] += rotor * rates[2]
            small.append(robot.refined(change))
        columns = np.stack(small, axis=2)
        if compliance > 0.0:
            key = ("bent", joint)
            if key not in robot.noted:  # small, and the same for all candidates about the present model
                robot.noted[key] = self._bent(robot, joint, parts, rotor, cutoff, columns)
            columns[:, :, 0] += robot.noted[key] / compliance
        return columns

    def _bent(
        self,
        robot: RobotSignals,
        joint: str,
        parts: np.ndarray,
        rotor: float,
        cutoff: float,
        columns: np.ndarray,
    ) -> np.ndarray:
        """Nonlinear part of the torque change by the deflection (N, n)."""
        values = np.array([max(self.C, 0.0), max(self.CIa, 0.0)])
        behind = parts @ values
        if np.abs(behind).max() > LARGEST:  # a deflection that no fit will keep
            return np.zeros(columns.shape[:2])
        try:
            change = torque_behind(robot, joint, behind, rotor, cutoff)
        except BenchError:  # out of reach, or singular
            return np.zeros(columns.shape[:2])
        return np.asarray(change - columns @ values)

    def starts(self, robots: Sequence[RobotSignals], joint: str) -> tuple["DriveFlexibility", ...]:
        """A stiff drive, and compliances at which the link oscillates near the fit's band, the stiffest first.

        Above the oscillation's frequency the response has the other sign, so no step leads from a stiff drive to the
        right compliance.
        """
        inertia = apparent_inertia(*torque_of_motor(robots[0], joint))
        if self.C > 0.0 or not inertia > 0.0:
            return (self,)
        rates = 2.0 * np.pi * robots[0].joints[joint].band * np.array(SWINGS)
        return (self, *(replace(self, C=float(1.0 / (inertia * rate**2))) for rate in rates))

    def brackets(self, parameter: ShapeParameter, samples: Sequence[JointSamples]) -> tuple[Bracket, ...]:  # noqa: ARG002
        """A few damping ratios as starts of the fit; no others if nothing oscillates."""
        values = {self.zeta, *parameter.candidates} if self.C > 0.0 else {self.zeta}
        return tuple((value, value, value) for value in sorted(values))


FINER = 4  # samples for each given one: a torque is then nearly straight between two


def deflection(
    settled: np.ndarray, interval: float, squared_period: np.ndarray, damping: float
) -> np.ndarray:
    """Deflection of a spring (K, m): y + 2 damping T y' + T2 y'' = settled, with T2 = T T.

    settled: (K, m) static deflection, `interval` s apart; squared_period: T2 (K,) s2, one over the square of the
    undamped angular frequency, above zero; damping: ratio, 0 to below 1. The spring starts at rest. Exact if `settled`
    is linear and T2 constant between fine samples.
    """
    time = interval * np.arange(len(settled))
    fine = interval / FINER * np.arange((len(settled) - 1) * FINER + 1)
    step = interval / FINER
    aim = cubic_spline(time, settled)(fine)
    slope = np.diff(aim, axis=0) / step
    period = np.sqrt(np.interp(fine[:-1] + 0.5 * step, time, squared_period))
    lag = 2.0 * damping * period[:, None] * slope
    transition = np.moveaxis(_swing(period, damping, step), 2, 0)  # propagates deviations from a line
    line = np.stack((aim[:-1] - lag, slope), axis=1)
    after = np.stack((aim[1:] - lag, slope), axis=1)
    given = after - transition @ line
    size = 2 * len(fine)
    band = np.zeros((4, size))
    band[0] = 1.0
    band[1, 1:-2:2] = -transition[:, 0, 1]
    band[2, :-2:2], band[2, 1:-2:2] = -transition[:, 0, 0], -transition[:, 1, 1]
    band[3, :-2:2] = -transition[:, 1, 0]
    right = np.concatenate((np.stack((aim[0], slope[0]))[None], given)).reshape(size, -1)
    return np.asarray(solve_banded((3, 0), band, right)[:: 2 * FINER])


def _swing(period: np.ndarray, damping: float, step: float) -> np.ndarray:
    """Position and velocity (2, 2, K) after a step of free swinging, by those before."""
    omega = 1.0 / period
    decay, swung = damping * omega, omega * np.sqrt(1.0 - damping**2)
    cos, sin = np.cos(swung * step), np.sin(swung * step) / swung
    decayed = np.exp(-decay * step)
    return np.asarray(decayed * np.array([[cos + decay * sin, sin], [-(omega**2) * sin, cos - decay * sin]]))
