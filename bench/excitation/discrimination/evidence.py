"""Evidence in the given data: whether an effect shows in them, and the size of the model's error."""

from collections.abc import Sequence

import numpy as np

from bench.excitation.discrimination.rival_models import Rival
from bench.identification.current_noise import current_noise
from bench.identification.standard_errors import residual_series, uncertainty


def estimate_of_rival(rival: Rival) -> tuple[np.ndarray, np.ndarray]:
    """Parameters (k,) of the rival's effect, and their covariance (k, k) with correlated errors."""
    size = len(rival.solution.theta)
    first = size - sum(len(instance.effect.parameters) for instance in rival.instances)
    spread = uncertainty(rival.stack, rival.solution, "autocorrelated")
    return rival.solution.theta[first:], spread.covariance[first:size, first:size]


def shown_nats(rival: Rival) -> float:
    """Nats of the given data that the effect explains, less those that it would explain of noise.

    Half of Wald's statistic (1943) of its parameters, less half their number; at least 0.
    """
    values, covariance = estimate_of_rival(rival)
    lengths = np.sqrt(np.maximum(np.diag(covariance), 0.0))
    known = lengths > 0.0
    if not known.any():
        return 0.0
    scaled = values[known] / lengths[known]
    alike = covariance[np.ix_(known, known)] / np.outer(lengths[known], lengths[known])
    wald = float(scaled @ np.linalg.pinv(alike, rcond=1e-10, hermitian=True) @ scaled)
    return max(0.5 * (wald - float(known.sum())), 0.0)


def error_over_noise(rivals: Sequence[Rival]) -> float:
    """RMS of the smallest error of these models over RMS of the currents' noise in the fit's band.

    The noise is read off the spectra of the logged currents above the motion's band, as `bench diagnose` does. 0 for
    currents without noise.
    """
    return min(_over_noise(rival) for rival in rivals)


def _over_noise(rival: Rival) -> float:
    stack, prepared = rival.stack, rival.prepared
    error = residual_series(stack, rival.solution)
    ends = (*stack.starts[1:], len(error))
    noise = 0.0
    for measured, a, b in zip(prepared.measured, stack.starts, ends, strict=True):
        variance = current_noise(measured.recording, prepared.settings) ** 2
        noise += float((variance * stack.moving[a:b].sum(axis=0)).sum())
    return float(np.sqrt(np.sum(error**2) / noise)) if noise > 0.0 else 0.0
