"""Exciting trajectories: a finite Fourier series for each active joint, with a smooth start and stop.

Swevers et al., "Optimal robot excitation and identification", IEEE Trans. Robotics and Automation 13 (1997).
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, fields, replace
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from bench.basics.errors import BenchError

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class FourierTrajectory:
    """q(t) = center + s(t) · Σ_k [a_k sin(k ω t) + b_k cos(k ω t)], ω = 2π · base_frequency, k = 1 … H.

    The blend s rises from 0 to 1 in the first `ramp` seconds and falls back to 0 in the last, as a polynomial
    of order 7: at both ends the position is `center`, and velocity, acceleration and jerk are zero.
    Before 0 and after `duration`, the joints rest at `center`.

    center: (n,), a, b: (n, H), rad or m.  base_frequency: Hz.  duration, ramp: s, 2 · ramp ≤ duration.
    """

    center: Array
    a: Array
    b: Array
    base_frequency: float
    duration: float
    ramp: float

    def __post_init__(self) -> None:
        center = np.array(self.center, dtype=float)
        a, b = np.array(self.a, dtype=float), np.array(self.b, dtype=float)
        if center.ndim != 1:
            raise BenchError(
                f"trajectory: center must be a list of one number a joint, not of shape {center.shape}"
            )
        if a.ndim != 2 or a.shape != b.shape or a.shape[0] != len(center) or a.shape[1] == 0:
            raise BenchError(
                f"trajectory: a and b must both be {len(center)} lists (one a joint) of equal length,"
                f" not of shapes {a.shape} and {b.shape}"
            )
        if not all(np.isfinite(x).all() for x in (center, a, b)):
            raise BenchError("trajectory: a coefficient is not a finite number")
        for name in ("base_frequency", "duration", "ramp"):
            value = float(getattr(self, name))
            if not (np.isfinite(value) and value > 0):
                raise BenchError(f"trajectory: {name} must be positive, not {value:g}")
            object.__setattr__(self, name, value)
        if 2 * self.ramp > self.duration:
            raise BenchError(
                f"trajectory: ramp = {self.ramp:g} s must be at most half of duration = {self.duration:g} s"
            )
        for name, array in (("center", center), ("a", a), ("b", b)):
            array.setflags(write=False)
            object.__setattr__(self, name, array)

    def __eq__(self, other: object) -> bool:
        """Whether it is the same trajectory to the last bit."""
        return isinstance(other, FourierTrajectory) and self._content == other._content

    def __hash__(self) -> int:
        return hash(self._content)

    @property
    def _content(self) -> tuple[object, ...]:
        arrays = (array.tobytes() for array in (self.center, self.a, self.b))
        return (self.a.shape, *arrays, self.base_frequency, self.duration, self.ramp)

    @property
    def harmonics(self) -> int:
        """H, the number of harmonics of each joint."""
        return int(self.a.shape[1])

    def scaled(self, factor: float | NDArray[Any]) -> FourierTrajectory:
        """The motion about `center` times a factor, one of each joint (n, 1) or of each coefficient (n, H)."""
        return replace(self, a=self.a * factor, b=self.b * factor)

    def evaluate(self, t: ArrayLike) -> tuple[Array, Array, Array]:
        """Position, velocity and acceleration, each (N, n), at the times t (N,) in s; all analytic."""
        time = np.atleast_1d(np.asarray(t, dtype=float))
        k_omega = 2 * np.pi * self.base_frequency * np.arange(1, self.harmonics + 1)
        phase = np.outer(time, k_omega)
        sin, cos = np.sin(phase), np.cos(phase)
        f = sin @ self.a.T + cos @ self.b.T
        df = cos @ (self.a * k_omega).T - sin @ (self.b * k_omega).T
        ddf = -(sin @ (self.a * k_omega**2).T + cos @ (self.b * k_omega**2).T)
        s, ds, dds = (x[:, None] for x in self._blend(time))
        return self.center + s * f, ds * f + s * df, dds * f + 2 * ds * df + s * ddf

    def to_dict(self) -> dict[str, Any]:
        """Plain numbers and lists, for TOML and JSON; `from_dict` reads them back to the last bit."""
        return {
            field.name: value.tolist()
            if isinstance(value := getattr(self, field.name), np.ndarray)
            else value
            for field in fields(self)
        }

    @classmethod
    def from_dict(cls, data: Mapping[str, Any]) -> FourierTrajectory:
        """The inverse of `to_dict`; BenchError for a missing or unknown key or a wrong shape."""
        names = [field.name for field in fields(cls)]
        for key in data:
            if key not in names:
                raise BenchError(f"trajectory: unknown key {key!r}; known are {', '.join(names)}")
        for name in names:
            if name not in data:
                raise BenchError(f"trajectory: key {name!r} is missing")
        try:
            return cls(**{name: np.asarray(data[name], dtype=float) for name in names})  # type: ignore[arg-type]
        except (ValueError, TypeError) as error:
            raise BenchError(f"trajectory: center, a and b must be lists of numbers: {error}") from error

    def _blend(self, t: Array) -> tuple[Array, Array, Array]:
        """s, ds/dt and d²s/dt² (N,): product of the rise at the start and the fall at the end."""
        up, dup, ddup = _rise(t / self.ramp)
        down, ddown, dddown = _rise((self.duration - t) / self.ramp)
        # 2 ramp ≤ duration: while one of the two changes, the other is 1
        return up * down, (dup - ddown) / self.ramp, (ddup + dddown) / self.ramp**2


def _rise(x: Array) -> tuple[Array, Array, Array]:
    """35x⁴ − 84x⁵ + 70x⁶ − 20x⁷ on [0, 1], constant outside, with its two derivatives: (N,) each."""
    value, slope, bend = (x >= 1.0).astype(float), np.zeros(len(x)), np.zeros(len(x))
    rising = np.flatnonzero((x > 0.0) & (x < 1.0))  # a small part of most motions, and powers are slow
    x = x[rising]
    y = 1.0 - x
    value[rising] = x**4 * (35 - 84 * x + 70 * x**2 - 20 * x**3)
    slope[rising], bend[rising] = 140 * (x * y) ** 3, 420 * (x * y) ** 2 * (y - x)
    return value, slope, bend


def random_trajectory(
    seed: int | np.random.SeedSequence,
    center: ArrayLike,
    span: ArrayLike,
    velocity_limit: ArrayLike,
    *,
    acceleration_limit: ArrayLike = np.inf,
    harmonics: int = 5,
    base_frequency: float = 0.1,
    duration: float = 20.0,
    ramp: float = 1.0,
) -> FourierTrajectory:
    """A trajectory with random coefficients, scaled for each joint until the first of its limits is reached.

    Coefficients are normal with standard deviation 1/k, so that every harmonic contributes equally to the velocity.
    center: (n,) rad or m.  span: largest |q − center|.  velocity_limit, acceleration_limit: largest |q̇|, |q̈|.
    Limits are numbers, or (n,) for each joint. The same seed gives the same trajectory.
    """
    center = np.atleast_1d(np.asarray(center, dtype=float))
    limits = [
        np.broadcast_to(np.asarray(x, dtype=float), center.shape)
        for x in (span, velocity_limit, acceleration_limit)
    ]
    if any((limit <= 0).any() for limit in limits):
        raise BenchError("trajectory: span, velocity limit and acceleration limit must be positive")
    if harmonics < 1:
        raise BenchError(f"trajectory: harmonics must be at least 1, not {harmonics}")
    rng = np.random.default_rng(seed)
    a, b = rng.standard_normal((2, len(center), harmonics)) / np.arange(1, harmonics + 1)
    trajectory = FourierTrajectory(center, a, b, base_frequency, duration, ramp)
    q, qd, qdd = trajectory.evaluate(_dense_times(trajectory))
    scale = np.min(
        [limit / np.abs(x).max(axis=0) for limit, x in zip(limits, (q - center, qd, qdd), strict=True)],
        axis=0,
    )
    return trajectory.scaled(0.999 * scale[:, None])  # the grid misses a peak by less than 0.1 %


def _dense_times(trajectory: FourierTrajectory) -> Array:
    """Times (N,) at which no peak of the trajectory is missed by more than 0.1 %."""
    per_second = max(150 * trajectory.harmonics * trajectory.base_frequency, 100 / trajectory.ramp)
    return np.linspace(0.0, trajectory.duration, int(np.ceil(per_second * trajectory.duration)) + 1)
