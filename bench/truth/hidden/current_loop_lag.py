"""A drive whose current follows its reference with a lag."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from bench.truth.hidden.base import Array, JointEffect
from bench.truth.hidden.signals import Law, Parameters, Signals


@dataclass(frozen=True)
class CurrentLoopLag(JointEffect):
    """T di/dt = i_ref - i, τ = g i: a current loop of first order.

    Exact for a reference that stands still during each step of the simulation.

    T: time constant, s.
    """

    name: ClassVar[str] = "current_loop_lag"
    positive: ClassVar[tuple[str, ...]] = ("T",)
    T: float

    @staticmethod
    def current(p: Parameters, s: Signals) -> Law:
        follow = -np.expm1(-s.step / p["T"])
        flowing: list[Array] = []

        def law() -> Array:
            if not flowing:
                flowing.append(s.current.copy())
            flowing[0] += follow * (s.current - flowing[0])
            return flowing[0]

        return law
