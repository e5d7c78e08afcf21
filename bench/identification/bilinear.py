"""Least squares of the currents' errors from inner products: unknown torques over unknown drive gains.

Every motor's rows are [columns, torque, error]: the columns that the unknown values multiply, and the torque and
current error of a reference solution from which the values are counted. With values x and gains g the current's error
is error + torque (1 / g0 - 1 / g) - columns x / g, and a Gauss-Newton step needs only the rows' inner products. These
are the more exact the nearer the reference is: they hold squares of its error, not of the currents.
"""

from dataclasses import dataclass

import numpy as np
from scipy.linalg import solve_triangular
from scipy.linalg.lapack import dposv, dpstrf

from bench.identification.solution import Fitted
from bench.identification.tolerances import TOLERANCES

TINY = float(np.finfo(float).tiny)


def least(normal: np.ndarray, right: np.ndarray) -> np.ndarray:
    """Solutions (..., k) of normal equations (..., k, k), scaled to a unit diagonal; of minimum norm where singular,
    such as zero for a column of zeros.
    """
    diagonal = np.einsum("...rr->...r", normal)
    there = diagonal > 0.0
    lengths = np.sqrt(np.where(there, diagonal, 1.0))
    scaled = normal / lengths[..., :, None] / lengths[..., None, :]
    np.einsum("...rr->...r", scaled)[...] += ~there
    solutions = right / lengths
    k = right.shape[-1]
    for matrix, vector in zip(scaled.reshape(-1, k, k), solutions.reshape(-1, k), strict=True):
        factor, solved, failed = dposv(matrix.T, vector, lower=1)
        sound = not failed and factor.diagonal().min(initial=1.0) > TOLERANCES.rank.pivot
        vector[:] = solved if sound else _least_norm(matrix, vector)
    return np.asarray(solutions / lengths)


def _least_norm(scaled: np.ndarray, right: np.ndarray) -> np.ndarray:
    """The solution of minimum norm of singular equations with a unit diagonal."""
    values, vectors = np.linalg.eigh(scaled)
    kept = values > TOLERANCES.rank.pivot**2 * values[-1]
    along = vectors[:, kept]
    return np.asarray(along @ ((along.T @ right) / values[kept]))


def independent_of(inner: np.ndarray) -> np.ndarray:
    """Indices, in order, of columns of unit (or zero) length that span all columns.

    From their inner products (k, k), by Cholesky's factorisation with the largest pivot first.
    """
    if not len(inner):
        return np.arange(0)
    _, pivots, rank, _ = dpstrf(inner, tol=TOLERANCES.rank.pivot**2, lower=1)
    return np.sort(pivots[:rank] - 1)


def errors_by(values: np.ndarray, gains: np.ndarray, start: np.ndarray) -> np.ndarray:
    """Coefficients by which every motor's current error is combined from [columns, torque, error]: (..., n, k + 2)."""
    errors = np.ones((*gains.shape, values.shape[-1] + 2))
    errors[..., :-2] = -values[..., None, :] / gains[..., None]
    errors[..., -2] = 1.0 / start - 1.0 / gains
    return errors


def squares_of(inner: np.ndarray, errors: np.ndarray) -> np.ndarray:
    """Sum of squares (..., n) of the errors with coefficients (..., n, k), never below the rounding error."""
    combined = (inner @ errors[..., None])[..., 0]
    return np.asarray(np.maximum((errors * combined).sum(axis=-1), TINY))


@dataclass(frozen=True)
class SharedProducts:
    """Inner products of every motor's [base, added, torque, error] in S problems: b shared columns, c of each problem.

    base (n, b, b); across (S, n, b, c + 2): base by a problem's other columns; within (S, n, c + 2, c + 2).
    """

    base: np.ndarray
    across: np.ndarray
    within: np.ndarray

    def combined(self, errors: np.ndarray) -> np.ndarray:
        """Inner products (S, n, b + c + 2) of all columns with errors of coefficients (S, n, b + c + 2)."""
        b = self.base.shape[1]
        shared, single = errors[..., :b], errors[..., b:, None]
        result = np.empty(errors.shape)
        result[..., :b] = np.matmul(shared.swapaxes(0, 1), self.base).swapaxes(0, 1)
        result[..., :b] += (self.across @ single)[..., 0]
        result[..., b:] = (shared[..., None, :] @ self.across)[..., 0, :]
        result[..., b:] += (self.within @ single)[..., 0]
        return result

    def weighted(self, shares: np.ndarray) -> np.ndarray:
        """The products of columns (S, b + c, b + c), all motors with shares (S, n)."""
        sets, n, b, c = self.across.shape
        c -= 2
        result = np.empty((sets, b + c, b + c))
        result[:, :b, :b] = (shares @ self.base.reshape(n, -1)).reshape(sets, b, b)
        cross = (shares[:, None] @ self.across.reshape(sets, n, -1)).reshape(sets, b, c + 2)[..., :c]
        result[:, :b, b:], result[:, b:, :b] = cross, cross.swapaxes(1, 2)
        among = shares[:, None] @ self.within.reshape(sets, n, -1)
        result[:, b:, b:] = among.reshape(sets, c + 2, c + 2)[:, :c, :c]
        return result

    def of_torque(self, start: np.ndarray) -> np.ndarray:
        """Products (S, n, b + c + 2) of all columns with the measured current, torque / start + error."""
        every = np.concatenate((self.across, self.within), axis=2)
        return np.asarray(every[..., -2] / start[:, None] + every[..., -1])

    def some(self, which: np.ndarray) -> "SharedProducts":
        """Those of some of the problems, (S,) True or False."""
        return SharedProducts(self.base, self.across[which], self.within[which])


@dataclass(frozen=True)
class WholeProducts:
    """As `SharedProducts`, of one problem that shares no column: inner (n, k + 2, k + 2)."""

    inner: np.ndarray

    def combined(self, errors: np.ndarray) -> np.ndarray:
        """See `SharedProducts`."""
        return np.asarray((self.inner @ errors[..., None])[..., 0])

    def weighted(self, shares: np.ndarray) -> np.ndarray:
        """See `SharedProducts`."""
        size = self.inner.shape[1]
        whole = shares @ self.inner.reshape(len(self.inner), -1)
        return np.asarray(whole.reshape(-1, size, size)[:, :-2, :-2])

    def of_torque(self, start: np.ndarray) -> np.ndarray:
        """See `SharedProducts`."""
        return np.asarray(self.inner[None, ..., -2] / start[:, None] + self.inner[None, ..., -1])

    def some(self, which: np.ndarray) -> "WholeProducts":  # noqa: ARG002 - there is only one
        """See `SharedProducts`."""
        return self


@dataclass(frozen=True)
class OnProducts:
    """S problems at values (S, k) and gains (S, n), from their inner products; see `gauss_newton.Bilinear`.

    start (n,): the gains that torque and error belong to. errors (S, n, k + 2): coefficients of the errors; by_error:
    the products of all columns with these.
    """

    products: SharedProducts | WholeProducts
    start: np.ndarray
    fit_gains: Fitted
    values: np.ndarray
    gains: np.ndarray
    errors: np.ndarray
    by_error: np.ndarray
    squares: np.ndarray

    @classmethod
    def at(
        cls,
        products: SharedProducts | WholeProducts,
        start: np.ndarray,
        fit_gains: Fitted,
        values: np.ndarray,
        gains: np.ndarray,
    ) -> "OnProducts":
        """The problems at these values and gains."""
        errors = errors_by(values, gains, start)
        by_error = products.combined(errors)
        squares = np.maximum(np.einsum("snk,snk->sn", errors, by_error), TINY)
        return cls(products, start, fit_gains, values, gains, errors, by_error, squares)

    def moved(self, values: np.ndarray, gains: np.ndarray) -> "OnProducts":
        """See `gauss_newton.Bilinear`."""
        return self.at(self.products, self.start, self.fit_gains, values, gains)

    def some(self, which: np.ndarray) -> "OnProducts":
        """See `gauss_newton.Bilinear`."""
        parts = (self.values, self.gains, self.errors, self.by_error, self.squares)
        return OnProducts(
            self.products.some(which), self.start, self.fit_gains, *(part[which] for part in parts)
        )

    def step(self, weights: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """See `gauss_newton.Bilinear`."""
        k, solution = self.values.shape[1], least(*self.equations(weights))
        gains = solution[:, k:] if np.any(self.fit_gains) else np.zeros_like(self.gains)
        return solution[:, :k], gains

    def equations(self, weights: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Matrices and right sides of a Gauss-Newton step: values, then gains if any is fitted; others do not move."""
        k, n = self.values.shape[1], len(self.start)
        share = weights**2 / self.gains  # of torque in the weighted squares; another of the gains follows
        some = bool(np.any(self.fit_gains))
        size = k + (n if some else 0)
        normal, right = np.zeros((len(share), size, size)), np.empty((len(share), size))
        normal[:, :k, :k] = self.products.weighted(share / self.gains)
        right[:, :k] = (share[:, None] @ self.by_error[..., :k])[:, 0]
        if some:
            fitted = np.reshape(self.fit_gains, (-1, 1))
            by_torque = (self.products.of_torque(self.start) - self.by_error) * fitted
            torque = -self.errors[..., : k + 1]
            torque[..., k] = 1.0 / self.gains
            torque *= fitted
            normal[:, k:, :k] = -(share / self.gains)[..., None] * by_torque[..., :k]
            normal[:, :k, k:] = normal[:, k:, :k].swapaxes(1, 2)
            diagonal = share / self.gains * np.einsum("snk,snk->sn", torque, by_torque[..., : k + 1])
            normal[:, k + np.arange(n), k + np.arange(n)] = np.where(self.fit_gains, diagonal, 1.0)
            right[:, k:] = -share * np.einsum("snk,snk->sn", torque, self.by_error[..., : k + 1])
        return normal, right


@dataclass(frozen=True)
class Centred:
    """Inner products (n, b + 2, b + 2) of every motor's [columns, torque, error]; see bench.identification.bilinear.

    basis (p, b): combines the columns of phi to nearly orthonormal ones; theta (p,) and gains (n,): the reference
    solution, where values (b,) are zero.
    """

    inner: np.ndarray
    basis: np.ndarray
    theta: np.ndarray
    gains: np.ndarray

    def theta_at(self, values: np.ndarray) -> np.ndarray:
        """Theta (p,) for values (b,)."""
        return self.theta + self.basis @ values

    def squares(self, values: np.ndarray, gains: np.ndarray) -> np.ndarray:
        """Sum of squares (n,) of every motor's current error."""
        return squares_of(self.inner, errors_by(values, gains, self.gains))

    def at(self, values: np.ndarray, gains: np.ndarray, fit_gains: Fitted) -> OnProducts:
        """The problem at values (b,) and gains (n,)."""
        return OnProducts.at(WholeProducts(self.inner), self.gains, fit_gains, values[None], gains[None])


@dataclass(frozen=True)
class FactorProducts:
    """Factors (n, r, p + 2) of [phi, kappa, current] whose columns of phi are combined, by a basis (p, b), to nearly
    orthonormal ones: these columns (n, r, b), and their inner products (n, b, b), motor by motor.
    """

    factors: np.ndarray
    basis: np.ndarray
    columns: np.ndarray
    inner: np.ndarray

    def about(self, theta: np.ndarray, gains: np.ndarray) -> Centred:
        """The system counted from a solution."""
        p, b = len(theta), self.basis.shape[1]
        torque = self.factors[:, :, :p] @ theta + self.factors[:, :, p]
        error = self.factors[:, :, p + 1] - torque / gains[:, None]
        rows = np.stack((torque, error), axis=2)
        inner = np.empty((len(gains), b + 2, b + 2))
        inner[:, :b, :b] = self.inner
        inner[:, :b, b:] = self.columns.swapaxes(1, 2) @ rows
        inner[:, b:, :b] = inner[:, :b, b:].swapaxes(1, 2)
        inner[:, b:, b:] = rows.swapaxes(1, 2) @ rows
        return Centred(inner, self.basis, theta, gains)


def products_of(factors: np.ndarray, scale: np.ndarray) -> FactorProducts:
    """Products of factors (n, r, p + 2); their columns are orthonormal if motors are weighted by scale (n,)."""
    phi = factors[:, :, :-2]
    basis = _orthonormal((phi * scale[:, None, None]).reshape(-1, phi.shape[2]))
    columns = phi @ basis
    return FactorProducts(factors, basis, columns, columns.swapaxes(1, 2) @ columns)


def _orthonormal(rows: np.ndarray) -> np.ndarray:
    """Matrix (p, b) that makes columns (R, p) orthonormal, of the same span."""
    lengths = np.linalg.norm(rows, axis=0)
    lengths[lengths == 0.0] = 1.0
    triangle = np.asarray(np.linalg.qr(rows / lengths, mode="r"))
    size = triangle.shape[1]
    if len(triangle) == size and np.abs(np.diag(triangle)).min(initial=1.0) > TOLERANCES.rank.triangle:
        return np.asarray(solve_triangular(triangle, np.eye(size), check_finite=False)) / lengths[:, None]
    _, singular, vectors = np.linalg.svd(triangle, full_matrices=False)
    kept = singular > TOLERANCES.rank.columns * singular.max(initial=0.0)
    return np.asarray(vectors[kept].T / singular[kept] / lengths[:, None])
