"""Influence of encoder steps on an estimate: errors of positions, differentiated and propagated through the model.

The position of a joint in a log is wrong by up to half a step, nearly at random from sample to sample; the modelled
currents are then wrong by i_q e + i_v e' + i_a e''. In the score of the estimate, the sum over all samples of J' w
(error of the current), summation by parts moves the derivatives to the factors of e: (P - V' + A'')' e with P = J' w
i_q and so on. These are smooth, so the filters of the fit, which pass the motion, do not change them.
"""

import numpy as np

from bench.excitation.bounds import FORECAST
from bench.excitation.experiment.nominal import Nominal, seen
from bench.model.motion import motion_of
from bench.scenario.trajectory import FourierTrajectory


def encoder_score(
    nominal: Nominal, trajectory: FourierTrajectory, load: str | None, weights: np.ndarray
) -> np.ndarray:
    """Covariance (P, P) of the score by the encoders' steps; weights (n,): of the squares of the currents."""
    geometry, rate = nominal.model.geometry, nominal.noise.rate
    highest = trajectory.harmonics * trajectory.base_frequency
    count = int(np.ceil(trajectory.duration * FORECAST.encoder_points * highest)) + 1
    time = np.linspace(0.0, trajectory.duration, count)
    interval = time[1]
    states = list(trajectory.evaluate(time))
    motion = motion_of(geometry, time, *states)
    what = seen(nominal, motion, load)
    weighted = what.jacobian * weights[:, None]
    total = np.zeros((nominal.size,) * 2)
    for joint, step in enumerate(nominal.noise.encoder):
        if step <= 0.0:
            continue
        before = np.zeros((count, nominal.size))
        for order in range(3):
            moved = [state.copy() for state in states]
            moved[order][:, joint] += FORECAST.encoder_difference
            other = seen(nominal, motion_of(geometry, time, *moved, near=motion), load).current
            carried = np.einsum("tjp,tj->tp", weighted, (other - what.current) / FORECAST.encoder_difference)
            for _ in range(order):
                carried = -np.gradient(carried, interval, axis=0)
            before += carried
        total += step**2 / 12.0 * rate * interval * (before.T @ before)
    return total
