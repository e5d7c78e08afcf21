"""A drive whose current follows its reference with a lag."""

from dataclasses import dataclass

import numpy as np

from bench.truth.hidden.base import Array, JointEffect, JointMovement, Law, Parameters, Signals, Sizes, rms


@dataclass(frozen=True)
class CurrentLoopLag(JointEffect):
    """T di/dt = i_ref - i, τ = g i: a current loop of first order. Exact for a reference that is linear between two
    steps of the simulation.

    T: time constant, s.
    """

    name = "current_loop_lag"
    shares = (0.002, 0.01)
    law = "T di/dt = i_ref − i"
    positive = ("T",)
    T: float

    @staticmethod
    def current(p: Parameters, s: Signals) -> Law:
        passed = s.step / p["T"]
        decayed = np.exp(-passed)
        mean = -np.expm1(-passed) / passed  # mean of the decay over a step
        flowing: list[Array] = []

        def law() -> Array:
            if not flowing:
                flowing.extend((s.current.copy(), s.current.copy()))
            now, before = flowing
            now += (1.0 - mean) * s.current + (mean - decayed) * before - (1.0 - decayed) * now
            before[:] = s.current
            return now

        return law

    @staticmethod
    def sized(j: JointMovement, share: float) -> Sizes:
        lag = share * rms(j.current) / rms(j.current_rate)
        if lag > 0.3 * j.damping / j.stiffness:
            raise j.too_large("current_loop_lag", share, "the controller would become unstable")
        return {"T": lag}
