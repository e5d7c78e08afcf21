"""Parameters of effects that are laws of one joint, from the movement of that joint alone."""

from __future__ import annotations

from collections.abc import Callable, Mapping

import numpy as np
from scipy.signal import lfilter

from bench.basics.errors import BenchError
from bench.truth.hidden.reference import JointMovement, rms

Sizes = dict[str, float]
Rule = Callable[[JointMovement, float], Sizes]
"""Parameters for which the RMS of the effect's torque is `share` of that of the joint's torque."""

LONGEST_DELAY = 0.05  # s


def _acceleration_dependent(j: JointMovement, share: float) -> Sizes:
    c = share * rms(j.torque) / rms(j.acceleration)
    if c > 0.5 * j.inertia:
        raise _too_large("acceleration_dependent_friction", j, share, "it would outweigh the inertia")
    return {"c": c}


def _asymmetric(j: JointMovement, share: float) -> Sizes:
    """Twice as much backwards as forwards."""
    unit = rms(np.where(j.velocity > 0, 1.0, 2.0) * j.velocity)
    return {"Fv_plus": share * rms(j.torque) / unit, "Fv_minus": 2 * share * rms(j.torque) / unit}


def _stribeck(j: JointMovement, share: float) -> Sizes:
    """Twice the friction at low speed, which ends at a fifth of the RMS speed."""
    vs = 0.2 * rms(j.velocity)
    unit = rms(1 + np.exp(-((j.velocity / vs) ** 2)))
    size = share * rms(j.torque) / unit
    return {"Fc": size, "Fs": size, "vs": vs}


def _shear_thinning(j: JointMovement, share: float) -> Sizes:
    """Bent from a fifth of the RMS speed on."""
    va = 0.2 * rms(j.velocity)
    return {"Fa": share * rms(j.torque) / rms(np.arcsinh(j.velocity / va)), "va": va}


def _wave(j: JointMovement, factor: np.ndarray, share: float) -> Sizes:
    """a, b and harmonic of a wave times a factor (N,); it falls towards the greatest position, positive all along.

    One harmonic in the position of a hinge, unless it turns so far that this would change its sign.
    """
    reach = 0.9 * np.pi
    harmonic = reach / j.span if j.slide or j.span > reach else 1.0
    phase = harmonic * j.position.max() - reach / 2
    size = share * rms(j.torque) / rms(np.cos(harmonic * j.position - phase) * factor)
    waves = {"a": size * np.cos(phase), "b": size * np.sin(phase)}
    return waves if harmonic == 1.0 else waves | {"harmonic": harmonic}


def _position_dependent_friction(j: JointMovement, share: float) -> Sizes:
    return _wave(j, np.ones_like(j.position), share)


def _position_dependent_viscous_friction(j: JointMovement, share: float) -> Sizes:
    return _wave(j, j.velocity, share)


def _presliding(j: JointMovement, share: float) -> Sizes:
    """Most of the friction is there after 3/50 of the span."""
    size = share * rms(j.torque)
    return {"Fc": size, "stiffness": size / (0.02 * j.span)}


def _hysteretic_cable(j: JointMovement, share: float) -> Sizes:
    """Most of it is there after a fifth of the span: loops of all strokes are round."""
    return {"F": share * rms(j.torque), "reach": 0.1 * j.span}


def _thermal(j: JointMovement, share: float) -> Sizes:
    """Viscous friction that has gone to a third after a third of the recording."""
    cooling = 0.3 * j.duration
    return {
        "T": cooling,
        "Fv": share * rms(j.torque) / rms(j.velocity * np.exp(-j.time / cooling)),
    }


def _gain_saturation(j: JointMovement, share: float) -> Sizes:
    k = share * rms(j.current) / rms(j.current**3)
    # the greatest torque is 2/3 of g / √(3 k); a fifth of it is kept for the controller
    if 3 * k * np.abs(j.current).max() ** 2 > (0.8 * 2 / 3) ** 2:
        raise _too_large("gain_saturation", j, share, "the motor could not give the greatest torque")
    return {"k": k}


def _current_delay(j: JointMovement, share: float) -> Sizes:
    """In the drive, or where the controller would not stand it, in the log."""
    late = share * rms(j.current) / rms(j.current_rate)
    if late > LONGEST_DELAY:
        raise _too_large("current_delay", j, share, f"it would take {1e3 * late:.0f} ms")
    return {"T": late if late * j.damping / j.inertia < 0.4 else -late}


def _current_loop_lag(j: JointMovement, share: float) -> Sizes:
    lag = share * rms(j.current) / rms(j.current_rate)
    if lag > 0.3 * j.damping / j.stiffness:
        raise _too_large("current_loop_lag", j, share, "the controller would not stand it")
    return {"T": lag}


def _joint_spring(j: JointMovement, share: float) -> Sizes:
    middle = float(np.mean(j.position))
    return {"k": share * rms(j.torque) / rms(j.position - middle), "q0": middle}


def _viscoelastic_cable(j: JointMovement, share: float) -> Sizes:
    relaxation = 0.5
    left = np.exp(-j.period / relaxation)
    z = lfilter([(1 - left) * relaxation], [1.0, -left], j.velocity)
    return {"k": share * rms(j.torque) / rms(z), "T": relaxation}


def _current_crosstalk(j: JointMovement, share: float) -> Sizes:
    if not rms(j.other_torques) > 0:
        raise BenchError("current_crosstalk: the robot has one motor only")
    return {"c": share * rms(j.torque) / rms(j.other_torques)}


def _too_large(effect: str, j: JointMovement, share: float, why: str) -> BenchError:
    return BenchError(f"{effect} of joint {j.joint}: a share of {share:g} of its torque is too large: {why}")


LAW_SIZES: Mapping[str, Rule] = {
    "acceleration_dependent_friction": _acceleration_dependent,
    "asymmetric_viscous_friction": _asymmetric,
    "cogging_torque": lambda j, share: {
        "a": 0.0,
        "b": np.sqrt(2) * share * rms(j.torque),
        "period": j.span / 6,
    },
    "constant_offset": lambda j, share: {"c": share * rms(j.torque)},
    "coulomb_friction": lambda j, share: {"Fc": share * rms(j.torque)},
    "current_crosstalk": _current_crosstalk,
    "current_delay": _current_delay,
    "current_loop_lag": _current_loop_lag,
    "gain_saturation": _gain_saturation,
    "hysteretic_cable": _hysteretic_cable,
    "joint_spring": _joint_spring,
    "load_dependent_friction": lambda _, share: {"mu": share},
    "periodic_disturbance": lambda j, share: {
        "size": np.sqrt(2) * share * rms(j.torque),
        "frequency": 2.7 * rms(j.acceleration) / rms(j.velocity) / (2 * np.pi),
    },
    "position_dependent_friction": _position_dependent_friction,
    "position_dependent_viscous_friction": _position_dependent_viscous_friction,
    "presliding_hysteresis": _presliding,
    "product_law": lambda j, share: {
        "c": share * rms(j.torque) / rms(np.abs(j.velocity) ** 1.5),
        "direction": 1.0,
        "v": 1.5,
    },
    "quadratic_drag": lambda j, share: {"c": share * rms(j.torque) / rms(j.velocity**2)},
    "rotor_inertia": lambda j, share: {"Ia": share * rms(j.torque) / rms(j.acceleration)},
    "shear_thinning_friction": _shear_thinning,
    "speed_dependent_gain": lambda j, share: {"v0": rms(j.torque * j.velocity) / (share * rms(j.torque))},
    "stribeck_friction": _stribeck,
    "thermal_friction_drift": _thermal,
    "torque_drift": lambda j, share: {"size": share * rms(j.torque), "T": j.duration / 20},
    "torque_ripple": lambda j, share: {"a": 0.0, "b": np.sqrt(2) * share, "period": j.span / 6},
    "viscoelastic_cable": _viscoelastic_cable,
    "viscous_friction": lambda j, share: {"Fv": share * rms(j.torque) / rms(j.velocity)},
}
"""Rules by name of the effect."""
