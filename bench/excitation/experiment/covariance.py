"""Standard errors from the equations of a fit, and the undetermined directions."""

from dataclasses import dataclass

import numpy as np

from bench.excitation.bounds import FORECAST
from bench.excitation.experiment.nominal import Equations


@dataclass(frozen=True)
class Determined:
    """covariance (P, P) of determined unknowns; undetermined (P,): which unknowns are part of an undetermined
    direction; directions: for each such direction, indices of these unknowns.
    """

    covariance: np.ndarray
    undetermined: np.ndarray
    directions: tuple[tuple[int, ...], ...]


def determined(fit: Equations) -> Determined:
    """The covariance of a fit, direction by direction."""
    resolved = _resolved(fit.normal)
    directions = []
    undetermined = np.zeros(len(resolved.lengths), dtype=bool)
    for direction in _sparse(resolved.loose):
        taking = np.abs(direction) > FORECAST.takes_part * np.abs(direction).max()
        undetermined |= taking
        directions.append(tuple(int(i) for i in np.flatnonzero(taking)))
    covariance = resolved.inverse @ fit.score @ resolved.inverse
    return Determined(covariance, undetermined, tuple(directions))


@dataclass(frozen=True)
class ErrorSlopes:
    """Derivatives of the errors by changes dN of the normal matrix and dS of the score, to first order.

    Of each error: for each column of factor (L) and by_normal, (P, m), L' dN by_normal + L' dS L. Of their mean:
    trace(mean_by_normal dN) + trace(mean_by_score dS), (P, P), symmetric. A single error, which equals its mean, has no
    columns.
    """

    factor: np.ndarray
    by_normal: np.ndarray
    mean_by_normal: np.ndarray
    mean_by_score: np.ndarray


@dataclass(frozen=True)
class RelativeErrors:
    """Criterion of targets (k,), indices: logarithms of their standard errors over sizes (P,) of all unknowns."""

    sizes: np.ndarray
    targets: np.ndarray

    def __call__(self, fit: Equations) -> np.ndarray:
        """The logarithms (k,)."""
        return np.asarray(0.5 * np.log(self._variances(_relative(fit, self.sizes))))

    def slopes(self, fit: Equations, near: np.ndarray) -> ErrorSlopes:
        """About a fit, separately for errors that are `near` (k,); zero if nothing is determined."""
        relative = _relative(fit, self.sizes)
        inverse, noise = _sides(self, relative)
        scale = np.sqrt(0.5 / self._variances(relative))
        inverse, noise = inverse * scale, noise * scale
        mean = inverse / len(self.targets)
        return ErrorSlopes(
            inverse[:, near],
            noise[:, near],
            _symmetric(mean @ noise.T),
            _symmetric(mean @ inverse.T),
        )

    def _variances(self, relative: "_Relative") -> np.ndarray:
        return np.maximum(np.diag(relative.covariance)[self.targets], np.finfo(float).tiny)


@dataclass(frozen=True)
class Volume:
    """Criterion of targets (k,), indices, with sizes (P,) of all unknowns: the logarithm of the geometric mean of the
    axes of their relative error ellipsoid: D-optimality.
    """

    sizes: np.ndarray
    targets: np.ndarray

    def __call__(self, fit: Equations) -> np.ndarray:
        """The logarithm (1,)."""
        return np.array(
            [0.5 * np.linalg.slogdet(self._block(_relative(fit, self.sizes)))[1] / len(self.targets)]
        )

    def slopes(self, fit: Equations, _: np.ndarray) -> ErrorSlopes:
        """About a fit; zero if nothing is determined."""
        relative = _relative(fit, self.sizes)
        inverse, noise = _sides(self, relative)
        left_factor = inverse @ np.linalg.inv(self._block(relative)) * (0.5 / len(self.targets))
        none = np.zeros((len(left_factor), 0))
        return ErrorSlopes(none, none, _symmetric(left_factor @ noise.T), _symmetric(left_factor @ inverse.T))

    def _block(self, relative: "_Relative") -> np.ndarray:
        return relative.covariance[np.ix_(self.targets, self.targets)]


Errors = RelativeErrors | Volume
"""What is minimised, for the fit of all recordings together: the largest of logarithms (k,)."""


def _sides(errors: Errors, relative: "_Relative") -> tuple[np.ndarray, np.ndarray]:
    """Columns (P, k) of the targets: of N^-1, and of -2 N^-1 S N^-1. The covariance N^-1 S N^-1 changes, for symmetric
    changes, by -2 N^-1 dN N^-1 S N^-1 + N^-1 dS N^-1.
    """
    inverse = relative.inverse[:, errors.targets] * errors.sizes[:, None]
    noise = relative.noise[:, errors.targets] * errors.sizes[:, None]
    return inverse, -2.0 * noise


def _symmetric(matrix: np.ndarray) -> np.ndarray:
    return 0.5 * (matrix + matrix.T)


@dataclass(frozen=True)
class _Resolved:
    """The inverse (P, P) of a normal matrix in its determined directions. lengths (P,): of the equations' columns; with
    columns of unit length, loose (P, k) are the other directions.
    """

    inverse: np.ndarray
    lengths: np.ndarray
    loose: np.ndarray


def _resolved(normal: np.ndarray) -> _Resolved:
    """Columns of unit length have the least rounding: with others, unknowns of small effect are lost in it."""
    lengths = np.sqrt(np.diag(normal))
    lengths = np.where(lengths > 0.0, lengths, 1.0)
    scales = np.outer(lengths, lengths)
    values, vectors = np.linalg.eigh(normal / scales)
    kept = values > FORECAST.undetermined * values[-1]
    inverse = (vectors[:, kept] / values[kept]) @ vectors[:, kept].T / scales
    return _Resolved(inverse, lengths, vectors[:, ~kept])


@dataclass(frozen=True)
class _Relative:
    """The covariance (P, P) over sizes, with large but finite errors of undetermined unknowns; without these, the
    inverse of the normal matrix, and the score by noise.
    """

    covariance: np.ndarray
    inverse: np.ndarray
    noise: np.ndarray


def _relative(fit: Equations, sizes: np.ndarray) -> _Relative:
    scales = np.outer(sizes, sizes)
    resolved = _resolved(fit.normal)
    inverse = resolved.inverse / scales
    noise = inverse @ (fit.score * scales) @ inverse
    loose, _ = np.linalg.qr(resolved.loose / (resolved.lengths * sizes)[:, None])
    return _Relative(noise + FORECAST.open**2 * loose @ loose.T, inverse, noise)


def _sparse(space: np.ndarray) -> np.ndarray:
    """A basis (k, P) of the columns of `space` (P, k) of few unknowns each: reduced echelon form."""
    rows = space.T.copy()
    for place in range(len(rows)):
        remaining = np.abs(rows[place:])
        at = int(np.argmax(remaining.max(axis=0)))
        pivot = place + int(np.argmax(remaining[:, at]))
        rows[[place, pivot]] = rows[[pivot, place]]
        rows[place] /= rows[place, at]
        others = np.arange(len(rows)) != place
        rows[others] -= np.outer(rows[others, at], rows[place])
    return rows
