"""How far the drive gains depend on being the same in recordings with and without payload.

A payload fixes the gains by what it changes, which is a part of the currents. A drive whose gain differs between these
recordings, as of warmer magnets, moves the estimate by more than its change, and nothing else in the data shows it.
"""

from collections.abc import Mapping

import numpy as np

from bench.identification.bilinear import least
from bench.identification.compressed import Stack
from bench.identification.finding import Code, Finding
from bench.identification.prepare import Prepared
from bench.identification.result import DriveGain
from bench.identification.solution import Solution
from bench.identification.standard_errors import by_unknowns
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

    To first order, by the normal equations of the estimator; zero for gains that are not fitted.
    """
    size, right, system = len(solution.theta), [], []
    for j, (gain, weight) in enumerate(zip(solution.gains, solution.weights, strict=True)):
        current = stack.current[:, j] * (rows & stack.moving[:, j])
        known = current @ stack.kappa[:, j], current @ stack.current[:, j]
        along = np.append(current @ stack.phi[:, j], known)[None] * (
            gain if solution.domain == "torque" else 1.0
        )
        right.append(weight**2 * by_unknowns(along, solution, j)[0])
        system.append(weight * by_unknowns(stack.factors[j], solution, j))
    derivatives = np.concatenate(system)
    step = least(derivatives.T @ derivatives, np.sum(right, axis=0))
    return np.asarray(step[size:] / solution.gains)
