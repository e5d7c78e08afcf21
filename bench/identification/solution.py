"""The result of an estimator, and the torque equations that all share."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy.linalg import lstsq

from bench.identification.compressed import Stack

Fitted = bool | np.ndarray
"""Whether drive gains are unknowns: all or none of them, or for each motor (n,); a factor of the gains' columns."""


@dataclass(frozen=True, eq=False)
class NominalGains:
    """Declared drive gains (n,); fitted: whether they are unknowns, or held."""

    values: np.ndarray
    fitted: Fitted

    @property
    def held(self) -> np.ndarray | None:
        """The held gains, (n,) with NaN for unknowns; None if all are unknowns."""
        if np.all(self.fitted):
            return None
        return np.where(self.fitted, np.nan, self.values)

    @property
    def is_fitted(self) -> np.ndarray:
        """Whether each gain (n,) is an unknown."""
        return np.broadcast_to(self.fitted, self.values.shape)

    def with_fitted(self, fitted_gains: np.ndarray) -> np.ndarray:
        """The gains (n,): estimated for unknowns, else declared; estimates are (n,), or () for none."""
        return np.where(self.fitted, fitted_gains, self.values) if np.any(self.fitted) else self.values


@dataclass(frozen=True)
class Solution:
    """theta (p,) and drive gains (n,), with inputs for their deviations.

    weights (n,): factor of a motor's equation; 1 / (unit of its residual). domain: the residual's unit, "torque"
    (diag(v) g - Phi theta - kappa) or "current" (that divided by -g).

    transform: how the estimator changed the given equations, if it did. dispersion (n,): factor of a motor's error in
    the estimating equations relative to their derivatives (1 for least squares). instruments: for instrumental
    variables, the equations for the estimate's derivatives, in place of these. row_weights (M, n): weight of each row,
    1 where it fits, for a robust estimate.
    """

    theta: np.ndarray
    gains: np.ndarray
    weights: np.ndarray
    domain: str
    gains_fitted: Fitted
    transform: Callable[[Stack], Stack] | None = None
    dispersion: np.ndarray | None = None
    instruments: Callable[[Stack], Stack] | None = None
    row_weights: np.ndarray | None = None


def torque_system(factors: np.ndarray, gains: np.ndarray | None) -> tuple[np.ndarray, np.ndarray]:
    """Rows A and right side b of A x = b in torque, from compressed factors (n, r, p + 2).

    With gains (n,): x = theta, b = diag(v) g - kappa. With None: x = [theta, g], b = kappa (equation 12, the gains
    among the unknowns). With NaN for some: likewise, but the others have zero columns and are in b = kappa - diag(v) g.
    """
    n, r, size = factors.shape
    p = size - 2
    phi, kappa, current = factors[:, :, :p], factors[:, :, p], factors[:, :, p + 1]
    unknown = np.ones(n, dtype=bool) if gains is None else np.isnan(gains)
    if gains is not None and not unknown.any():
        return phi.reshape(-1, p), (current * gains[:, None] - kappa).reshape(-1)
    rows = np.zeros((n, r, p + n))
    rows[:, :, :p] = -phi
    rows[np.arange(n), :, p + np.arange(n)] = current * unknown[:, None]
    right = kappa if gains is None else kappa - current * np.nan_to_num(gains)[:, None]
    return rows.reshape(-1, p + n), right.reshape(-1)


def solved_gains(factors: np.ndarray, solved: np.ndarray, nominal: np.ndarray) -> np.ndarray:
    """Solved drive gains (n,); the nominal one for a motor without rows, which does not determine it.

    factors (n, r, p + 2): the currents last.
    """
    return np.where(np.any(factors[:, :, -1] != 0.0, axis=1), solved, nominal)


def weighted(factors: np.ndarray, weights: np.ndarray) -> np.ndarray:
    """The factors with every motor's equation multiplied by its weight."""
    return factors * weights[:, None, None]


def torque_residual_rms(stack: Stack, theta: np.ndarray, gains: np.ndarray) -> np.ndarray:
    """RMS of diag(v) g - Phi theta - kappa for every motor, (n,), N*m or N."""
    combination = np.broadcast_to(np.append(-theta, [-1.0, 0.0]), (len(gains), len(theta) + 2)).copy()
    combination[:, -1] = gains
    residual = np.einsum("jrc,jc->jr", stack.factors, combination)
    return np.sqrt((residual**2).sum(axis=1) / len(stack.current))


def scaled_lstsq(rows: np.ndarray, right: np.ndarray) -> np.ndarray:
    """Least squares with every column scaled to unit length, so that units do not affect the rank."""
    norms = np.linalg.norm(rows, axis=0)
    norms[norms == 0.0] = 1.0
    solution = lstsq(rows / norms, right, cond=1e-13, lapack_driver="gelsy", check_finite=False)[0]
    return np.asarray(solution / norms)
