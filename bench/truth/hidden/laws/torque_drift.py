"""A slow random torque; not in the catalogue of effects."""

from dataclasses import dataclass

import numpy as np

from bench.truth.hidden.base import JointEffect, JointMovement, Law, Parameters, Signals, Sizes, rms
from bench.truth.streams import stream

WAVES = 12


@dataclass(frozen=True)
class TorqueDrift(JointEffect):
    """size · √(2/K) · Σ cos(ω_k t + φ_k), K = 12 waves; different in every recording and joint.

    ω_k and φ_k are drawn with the seed, the recording's name and the joint: φ_k uniformly over a turn, ω_k T
    uniformly between 0 and 2. The mean square over a long time is size².

    size: N·m or N.  T: s, the faster half of the waves has periods between 3 T and 6 T. seed: an integer.
    """

    name = "torque_drift"
    law = "slow and random, another course in each recording"
    positive = ("T",)
    not_negative = ("seed",)
    in_catalogue = False
    size: float
    T: float
    seed: float = 0.0

    @staticmethod
    def torque(p: Parameters, s: Signals) -> Law:
        draws = np.array(
            [
                [
                    stream(int(seed), "torque_drift", recording, joint).random((2, WAVES))
                    for seed, joint in zip(p["seed"], s.joints, strict=True)
                ]
                for recording in s.recordings
            ]
        )  # (R, m, 2, WAVES)
        omega, phase = 2 * draws[:, :, 0] / p["T"][:, None], 2 * np.pi * draws[:, :, 1]
        size = p["size"] * np.sqrt(2 / WAVES)
        return lambda: size * np.cos(omega * s.clock.time + phase).sum(axis=2)

    @staticmethod
    def sized(j: JointMovement, share: float) -> Sizes:
        return {"size": share * rms(j.torque), "T": j.duration / 20}
