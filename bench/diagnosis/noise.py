"""What the noise of the currents leaves of the fitted recordings: a model that leaves no more lacks nothing."""

import numpy as np

from bench.diagnosis.normal_equations import System
from bench.identification.current_noise import current_noise
from bench.identification.decision import RULE
from bench.identification.prepare import Prepared
from bench.identification.solve_only import solved_quickly, spread
from bench.identification.tolerances import TOLERANCES


def noise_squares(prepared: Prepared) -> np.ndarray | None:
    """Sum (n,) of the squares that the currents' noise alone leaves of each motor, drive units squared.

    Read off the spectra above the band of the motion, and taken as white. None with redundant motors, whose currents'
    noise reaches the others through the loops.
    """
    if prepared.dataset.robot.redundant:
        return None
    total = np.zeros(len(prepared.present.gains))
    for measured, observation in zip(prepared.measured, prepared.observations, strict=True):
        if observation.use == "identify":
            variance = current_noise(measured.recording, prepared.settings) ** 2
            total += variance * observation.moving.sum(axis=0)
    return total


def leaves_only_noise(system: System, model: Prepared, noise: np.ndarray | None) -> bool:
    """Whether no effect could earn its place in a converged model: what it leaves of the fitted recordings holds
    too few nats beyond the `noise` (n,) of their currents.
    """
    if noise is None:
        return False
    stack, solution = solved_quickly(model)
    weights = solution.weights**2
    residual = float((spread(stack, solution) ** 2 * stack.moving.sum(axis=0)) @ weights)
    least = float(noise @ weights)
    samples = system.fitted.rows / system.autocorrelation_time
    nats = 0.5 * samples * np.log(residual / max(least, np.finfo(float).tiny))
    return bool(TOLERANCES.statistics.white * least < residual and nats < RULE.prior)
