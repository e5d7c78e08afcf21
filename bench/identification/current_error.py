"""The estimator that minimises the error of the measured current itself.

Each motor's modelled current is (Phi theta + kappa) / g. The noise of a current then stays on the left side, where it
arises, whatever the gains. Gauss-Newton steps solve this bilinear problem, first on inner products of the compressed
factors about the starting solution, last on the factors themselves.
"""

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from bench.identification.bilinear import FactorProducts, products_of
from bench.identification.compressed import Stack
from bench.identification.gauss_newton import Until, minimised
from bench.identification.least_squares import weighted_least_squares
from bench.identification.solution import Fitted, NominalGains, Solution, scaled_lstsq
from bench.identification.tolerances import TOLERANCES


def current_error(stack: Stack, start: Solution) -> Solution:
    """Minimise sum_j w_j^2 |v_j - (Phi_j theta + kappa_j) / g_j|^2 from a starting solution.

    The weights are one over each motor's current error. Gains that are not unknowns (start.gains_fitted) are held;
    without unknown gains the problem is linear.
    """
    theta, gains, passes = start.theta, start.gains, _tolerances()
    weights = error_weights(stack, squared_errors(stack.factors, theta, gains))
    products = products_of(stack.factors, weights / gains)
    nearly = from_products(stack, products, start, weights)
    if nearly is not None:
        theta, gains, weights = nearly.theta, nearly.gains, nearly.weights
        passes = [TOLERANCES.steps.converged]
    for tolerance in passes:
        theta, gains = minimum_on_factors(stack.factors, theta, gains, weights, start.gains_fitted, tolerance)
        weights = error_weights(stack, squared_errors(stack.factors, theta, gains))
    return Solution(theta, gains, weights, "current", start.gains_fitted)


def from_best_start(stack: Stack, start: Solution, gains: NominalGains) -> Solution:
    """The minimum reached from the gains of equation 12, or from the nominal ones if these explain the currents better.

    With a payload that hardly shows, the gains of equation 12 fall to zero, from where no search returns.
    """
    solution = current_error(stack, start)
    if not np.any(gains.fitted):
        return solution
    nominal = current_error(stack, weighted_least_squares(stack, replace(gains, fitted=False)))
    if log_likelihood(stack, solution) >= log_likelihood(stack, nominal):
        return solution
    return current_error(stack, replace(nominal, gains_fitted=gains.fitted))


def from_products(
    stack: Stack,
    products: FactorProducts,
    start: Solution,
    weights: np.ndarray,
    *,
    unseen: float = 0.0,
    anew: int = 0,
) -> Solution | None:
    """The solution with the weights (n,) of the last pass, from inner products about the start.

    anew: how often they may be formed again when gains have moved far from the start's; if they may, steps without
    progress end a pass. None if steps diverge or make no progress, so that steps on the equations must continue.
    unseen: see `creeps`.
    """
    near = products.about(start.theta, start.gains)
    values, gains, fit_gains = np.zeros(near.basis.shape[1]), start.gains, start.gains_fitted
    for i, tolerance in enumerate(_tolerances()):
        if i:
            weights = error_weights(stack, near.squares(values, gains))
        until = Until(tolerance, unseen, reach=TOLERANCES.steps.recentred_factor, tolerance_beyond=1.0)
        while True:
            minimum = minimised(near.at(values, gains, fit_gains), near.gains, weights, until)
            (values,), (gains,), (why,) = minimum.values, minimum.gains, minimum.why
            if why == "converged" or (why == "stuck" and anew):
                break
            if why == "unfinished" or not anew:
                return None
            anew -= 1
            near, values = products.about(near.theta_at(values), gains), np.zeros_like(values)
    return Solution(near.theta_at(values), gains, weights, "current", fit_gains)


def error_weights(stack: Stack, squares: np.ndarray) -> np.ndarray:
    """Inverse of each motor's RMS current error (n,), from the sums of squares."""
    return np.asarray(1.0 / np.maximum(np.sqrt(squares / len(stack.current)), current_floor(stack)))


def squared_errors(factors: np.ndarray, theta: np.ndarray, gains: np.ndarray) -> np.ndarray:
    """Sum of squares of every motor's current error, (n,), from factors (n, r, p + 2) of [phi, kappa, current]."""
    p = len(theta)
    modelled = (factors[:, :, :p] @ theta + factors[:, :, p]) / gains[:, None]
    return np.asarray(((factors[:, :, p + 1] - modelled) ** 2).sum(axis=1))


def log_likelihood(stack: Stack, solution: Solution) -> float:
    """Log-likelihood of normal current errors with a deviation per motor, up to a constant."""
    weights = error_weights(stack, squared_errors(stack.factors, solution.theta, solution.gains))
    return float(len(stack.current) * np.log(weights).sum())


@dataclass(frozen=True)
class OnFactors:
    """One problem, at values (1, p) and gains (1, n), from factors (n, r, p + 2) of [phi, kappa, current]; see
    `gauss_newton.Bilinear`.
    """

    factors: np.ndarray
    fit_gains: Fitted
    values: np.ndarray
    gains: np.ndarray

    @cached_property
    def squares(self) -> np.ndarray:
        """Sum of squares (1, n) of every motor's current error."""
        return squared_errors(self.factors, self.values[0], self.gains[0])[None]

    def moved(self, values: np.ndarray, gains: np.ndarray) -> "OnFactors":
        """See `gauss_newton.Bilinear`."""
        return replace(self, values=values, gains=gains)

    def some(self, which: np.ndarray) -> "OnFactors":
        """See `gauss_newton.Bilinear`; there is only one."""
        return replace(self, values=self.values[which], gains=self.gains[which])

    def step(self, weights: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """See `gauss_newton.Bilinear`."""
        (n, r, _), p, gains = self.factors.shape, self.values.shape[1], self.gains[0]
        some = bool(np.any(self.fit_gains))
        scaled = self.factors * (weights / gains)[:, None, None]
        modelled = scaled[:, :, :p] @ self.values[0] + scaled[:, :, p]
        residual = self.factors[:, :, p + 1] * weights[:, None] - modelled
        jacobian = np.zeros((n, r, p + (n if some else 0)))
        jacobian[:, :, :p] = scaled[:, :, :p]
        if some:
            by_gain = -modelled / gains[:, None] * np.reshape(self.fit_gains, (-1, 1))
            jacobian[np.arange(n), :, p + np.arange(n)] = by_gain
        step = scaled_lstsq(jacobian.reshape(n * r, -1), residual.reshape(-1))
        return step[None, :p], step[None, p:] if some else np.zeros_like(self.gains)


def minimum_on_factors(
    factors: np.ndarray,
    theta: np.ndarray,
    gains: np.ndarray,
    weights: np.ndarray,
    fit_gains: Fitted,
    tolerance: float | None = None,
) -> tuple[np.ndarray, np.ndarray]:
    """Theta (p,) and gains (n,) of the least weighted error, by steps on factors (n, r, p + 2) from a start.

    tolerance: relative decrease of the cost in the last step; by default that of a converged model.
    """
    tolerance = TOLERANCES.steps.converged if tolerance is None else tolerance
    start = OnFactors(factors, fit_gains, theta[None], gains[None])
    minimum = minimised(start, gains, weights, Until(tolerance))
    return minimum.values[0], minimum.gains[0]


def current_floor(stack: Stack) -> float:
    """The smallest error of a fit in double precision, in drive units: it bounds the weights."""
    return float(1e-9 * np.sqrt((stack.current**2).mean(axis=0).max()) + np.finfo(float).tiny)


def _tolerances() -> list[float]:
    """Tolerance of the cost in each pass between reweightings; the last ends."""
    bounds = TOLERANCES.steps
    return [bounds.between_weights] * (bounds.reweightings - 1) + [bounds.converged]
