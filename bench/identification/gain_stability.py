"""How far the drive gains depend on being the same in recordings with and without payload.

A payload fixes the gains by what it changes, which is a part of the currents. A drive whose gain differs between these
recordings, as of warmer magnets, moves the estimate by more than its change, and nothing else in the data shows it.
"""

from collections.abc import Mapping

import numpy as np

from bench.identification.compressed import Stack
from bench.identification.finding import Code, Finding
from bench.identification.prepare import Prepared
from bench.identification.result import DriveGain
from bench.identification.solution import Solution
from bench.identification.tolerances import TOLERANCES


def hangs_on_equal_gains(
    prepared: Prepared, stack: Stack, solution: Solution, gains: Mapping[str, DriveGain]
) -> list[Finding]:
    """The gain that moves most, if it moves by more than its standard error where the currents with payload change by
    what a kelvin makes of them; none without recordings of both kinds.
    """
    loaded = [observation.payload_name is not None for observation in prepared.fitted]
    if not np.any(solution.gains_fitted) or all(loaded) or not any(loaded):
        return []
    lengths = [len(observation.time) for observation in prepared.fitted]
    drift = TOLERANCES.findings.gain_drift
    moves = drift * np.abs(moved_by_currents(stack, solution, np.repeat(loaded, lengths)))
    joints = prepared.dataset.robot.joints
    j = int(np.argmax(moves))
    gain = gains[joints[j]]
    if not gain.determined or moves[j] * abs(gain.value) <= gain.std:
        return []
    return [
        Finding(Code.GAINS_ASSUMED_EQUAL, (joints[j],), numbers={"drift": drift, "move": float(moves[j])})
    ]


def moved_by_currents(stack: Stack, solution: Solution, rows: np.ndarray) -> np.ndarray:
    """Relative change (n,) of the drive gains by a relative change of all currents in some rows (M,) of the stack.

    To first order, by the normal equations in the current domain; zero for gains that are not fitted.
    """
    gains, weights, size = solution.gains, solution.weights, len(solution.theta)
    fitted = np.flatnonzero(np.broadcast_to(solution.gains_fitted, gains.shape))
    unknown = np.append(solution.theta, 1.0)  # of [phi, kappa]
    if solution.domain == "torque":
        weights = weights * gains
    by_rows, right = [], np.zeros(size + len(gains))
    for j, gain in enumerate(gains):
        current = stack.current[rows, j] * stack.moving[rows, j]
        torque = stack.phi[rows, j] @ solution.theta + stack.kappa[rows, j]
        right[:size] += weights[j] ** 2 / gain * (current @ stack.phi[rows, j])
        right[size + j] = -(weights[j] ** 2) / gain**2 * (current @ torque)
        model = stack.factors[j, :, : size + 1]
        derivatives = np.zeros((len(model), size + len(gains)))
        derivatives[:, :size] = model[:, :size] / gain
        derivatives[:, size + j] = -(model @ unknown) / gain**2
        by_rows.append(weights[j] * derivatives)
    kept = np.append(np.arange(size), size + fitted)
    system = np.concatenate(by_rows)[:, kept]
    scale = np.linalg.norm(system, axis=0)
    scale[scale == 0.0] = 1.0
    values, directions = np.linalg.eigh((system / scale).T @ (system / scale))
    determined = values > np.finfo(float).eps * len(values) * values[-1]
    part = directions[:, determined]
    step = part @ ((part.T @ (right[kept] / scale)) / values[determined]) / scale
    moved = np.zeros(len(gains))
    moved[fitted] = step[size:] / gains[fitted]
    return moved
