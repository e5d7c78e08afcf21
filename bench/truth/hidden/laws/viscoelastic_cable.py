"""A spring that relaxes with time; not in the catalogue of effects."""

from dataclasses import dataclass

import numpy as np

from bench.truth.hidden.base import JointEffect, JointMovement, Law, Parameters, Signals, Sizes, rms


@dataclass(frozen=True)
class ViscoelasticCable(JointEffect):
    """k z, dz/dt = q̇ - z / T: a cable harness or hose with hysteresis (a Maxwell element).

    Exact for a joint with constant velocity during each step of the simulation.

    k: N·m/rad or N/m, at least 0.  T: relaxation time, s.
    """

    name = "viscoelastic_cable"
    law = "k z, dz/dt = q̇ − z/T"
    positive = ("T",)
    not_negative = ("k",)
    in_catalogue = False
    k: float
    T: float

    @staticmethod
    def torque(p: Parameters, s: Signals) -> Law:
        decay = np.exp(-s.step / p["T"])  # factor of z after a step
        share = (1 - decay) * p["T"] / s.step
        z, before = np.zeros_like(s.position), s.position.copy()

        def law() -> np.ndarray:
            z[:] = decay * z + share * (s.position - before)
            before[:] = s.position
            return p["k"] * z

        return law

    @staticmethod
    def sized(j: JointMovement, share: float) -> Sizes:
        from scipy.signal import lfilter  # noqa: PLC0415 - slow to import, and rarely needed

        relaxation = 0.5
        decay = np.exp(-j.period / relaxation)
        z = lfilter([(1 - decay) * relaxation], [1.0, -decay], j.velocity)
        return {"k": share * rms(j.torque) / rms(z), "T": relaxation}
