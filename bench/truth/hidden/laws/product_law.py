"""A product of powers, a wave, a decay and a memory; not in the catalogue of effects."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from bench.truth.hidden.base import (
    Draft,
    JointEffect,
    JointMovement,
    Law,
    Parameters,
    Signals,
    Sizes,
    hard_friction,
    rms,
)

Array = NDArray[np.float64]


@dataclass(frozen=True)
class ProductLaw(JointEffect):
    """c s |q̇|^v |q̈|^a |τ|^tau |τ_o|^others |q|^q (1 + depth cos(wave q + phase)) exp(-t/T).

    s: product of sign(q̇) if direction is 1, and sign(τ) if odd_tau is 1; τ: torque of the motor; τ_o: sum of those
    of the others; q̈: one step ago. T: 0 for no decay. omega, zeta: if omega is not 0, a second-order filter of that
    frequency (rad/s) and damping is applied to the product. Friction (direction 1, v 0, omega 0) also sticks.
    """

    name = "product_law"
    law = "c s |q̇|^v |q̈|^a |τ|^tau …: a product of powers, a wave, a fading and a memory"
    not_negative = ("v", "a", "tau", "others", "q", "wave", "T", "omega", "zeta")
    in_catalogue = False
    c: float
    direction: float = 0.0
    odd_tau: float = 0.0
    v: float = 0.0
    a: float = 0.0
    tau: float = 0.0
    others: float = 0.0
    q: float = 0.0
    depth: float = 0.0
    wave: float = 0.0
    phase: float = 0.0
    T: float = 0.0
    omega: float = 0.0
    zeta: float = 0.0

    def change(self, draft: Draft) -> None:
        if self.direction and not self.v and not self.omega:
            hard_friction(draft, self.joint)

    @staticmethod
    def torque(p: Parameters, s: Signals) -> Law | None:
        rubs = _rubs(p)
        if rubs.all():
            return None
        sizes, after = _size(p, s), _remembered(p, s.step, s.position.shape)

        def law() -> Array:
            sign = np.where(p["direction"] > 0.0, np.sign(s.velocity), 1.0)
            sign = sign * np.where(p["odd_tau"] > 0.0, np.sign(s.torque), 1.0)
            return np.where(rubs, 0.0, after(sign * sizes()))

        return law

    @staticmethod
    def dry_friction(p: Parameters, s: Signals) -> Law | None:
        sizes, rubs = _size(p, s), _rubs(p)
        if not rubs.any():
            return None
        return lambda: np.where(rubs, sizes(), 0.0)

    @staticmethod
    def sized(j: JointMovement, share: float) -> Sizes:
        return {"c": share * rms(j.torque) / rms(np.abs(j.velocity) ** 1.5), "direction": 1.0, "v": 1.5}


def unit_torque(
    numbers: Mapping[str, float],
    position: Array,
    velocity: Array,
    acceleration: Array,
    torque: Array,
    others: Array,
    time: Array,
) -> Array:
    """The law with c = 1 along a recording of one motor; all arguments are samples (N,)."""
    p = {
        name: np.array([numbers.get(name, 0.0)])
        for name in ProductLaw.__dataclass_fields__
        if name != "joint"
    }
    p["c"] = np.ones(1)
    sign = np.sign(velocity) if p["direction"][0] else np.ones(len(time))
    if p["odd_tau"][0]:
        sign = sign * np.sign(torque)
    driven = sign * _product(p, position, velocity, acceleration, torque, others, time)
    after = _remembered(p, float(time[1] - time[0]), (1, 1))
    return np.array([after(np.array([[entry]]))[0, 0] for entry in driven])


def _rubs(p: Parameters) -> Array:
    return np.asarray((p["direction"] > 0.0) & (p["v"] == 0.0) & (p["omega"] == 0.0))


def _size(p: Parameters, s: Signals) -> Callable[[], Array]:
    def size() -> Array:
        others = s.all_torques.sum(axis=1, keepdims=True) - s.torque
        return _product(p, s.position, s.velocity, s.acceleration, s.torque, others, s.clock.time)

    return size


def _product(
    p: Parameters,
    position: Array,
    velocity: Array,
    acceleration: Array,
    torque: Array,
    others: Array,
    time: Array | float,
) -> Array:
    """The product without sign and memory; a zeroth power is one."""
    product = p["c"] * np.abs(velocity) ** p["v"] * np.abs(acceleration) ** p["a"]
    product = (
        product * np.abs(torque) ** p["tau"] * np.abs(others) ** p["others"] * np.abs(position) ** p["q"]
    )
    product = product * (1.0 + p["depth"] * np.cos(p["wave"] * position + p["phase"]))
    fades = p["T"] > 0.0
    return np.asarray(product * np.where(fades, np.exp(-time / np.where(fades, p["T"], 1.0)), 1.0))


def _remembered(p: Parameters, step: float, shape: tuple[int, ...]) -> Callable[[Array], Array]:
    """A second-order filter (semi-implicit Euler) where omega is not 0."""
    if not np.any(p["omega"]):
        return lambda driven: driven
    value, rate = np.zeros(shape), np.zeros(shape)

    def after(driven: Array) -> Array:
        rate[:] = rate + step * (p["omega"] ** 2 * (driven - value) - 2.0 * p["zeta"] * p["omega"] * rate)
        value[:] = value + step * rate
        return np.where(p["omega"] > 0.0, value, driven)

    return after
