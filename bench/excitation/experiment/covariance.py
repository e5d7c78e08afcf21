"""From the equations of a fit to standard errors, and the directions that stay undetermined."""

from dataclasses import dataclass

import numpy as np

from bench.excitation.experiment.nominal import Equations

UNSEEN = 1e-12  # of the largest eigenvalue, columns of unit length: a direction with less is not determined
TAKES_PART = 0.1  # of the largest entry of a direction: unknowns with less do not take part in it
OPEN = 1e6  # times its size: the standard error of what is not determined, in a search


@dataclass(frozen=True)
class Determined:
    """covariance (P, P) of what is determined; undetermined (P,): which unknowns take part in a direction that is not;
    directions: of each such direction the unknowns that take part, by number.
    """

    covariance: np.ndarray
    undetermined: np.ndarray
    directions: tuple[tuple[int, ...], ...]


def determined(fit: Equations) -> Determined:
    """The covariance of a fit, direction by direction."""
    lengths = np.sqrt(np.diag(fit.normal))
    lengths = np.where(lengths > 0.0, lengths, 1.0)
    scales = np.outer(lengths, lengths)
    values, vectors = np.linalg.eigh(fit.normal / scales)
    kept = values > UNSEEN * values[-1]
    inverse = (vectors[:, kept] / values[kept]) @ vectors[:, kept].T
    directions = []
    undetermined = np.zeros(len(lengths), dtype=bool)
    for direction in _sparse(vectors[:, ~kept]):
        taking = np.abs(direction) > TAKES_PART * np.abs(direction).max()
        undetermined |= taking
        directions.append(tuple(int(i) for i in np.flatnonzero(taking)))
    covariance = inverse @ (fit.score / scales) @ inverse / scales
    return Determined(covariance, undetermined, tuple(directions))


def relative_errors(fit: Equations, sizes: np.ndarray, targets: np.ndarray) -> np.ndarray:
    """Logarithms (k,) of the relative standard errors of the targets."""
    variances = np.diag(_relative(fit, sizes))[targets]
    return np.asarray(0.5 * np.log(np.maximum(variances, np.finfo(float).tiny)))


def volume(fit: Equations, sizes: np.ndarray, targets: np.ndarray) -> np.ndarray:
    """Logarithm (1,) of the geometric mean of the axes of the targets' error ellipsoid, relative: D-optimality."""
    block = _relative(fit, sizes)[np.ix_(targets, targets)]
    return np.array([0.5 * np.linalg.slogdet(block)[1] / len(targets)])


def _relative(fit: Equations, sizes: np.ndarray) -> np.ndarray:
    """The covariance over sizes, with a large but finite error where nothing is determined."""
    scales = np.outer(sizes, sizes)
    values, vectors = np.linalg.eigh(fit.normal * scales)
    floor = max(OPEN**-2, 1e-15 * float(values[-1]))
    inverse = (vectors / np.maximum(values, floor)) @ vectors.T
    noise = inverse @ (fit.score * scales) @ inverse
    loose = vectors[:, values < floor]
    return np.asarray(noise + OPEN**2 * loose @ loose.T)


def _sparse(space: np.ndarray) -> np.ndarray:
    """A basis (k, P) of the columns of `space` (P, k) of few unknowns each: reduced echelon form."""
    rows = space.T.copy()
    for place in range(len(rows)):
        left = np.abs(rows[place:])
        at = int(np.argmax(left.max(axis=0)))
        pivot = place + int(np.argmax(left[:, at]))
        rows[[place, pivot]] = rows[[pivot, place]]
        rows[place] /= rows[place, at]
        others = np.arange(len(rows)) != place
        rows[others] -= np.outer(rows[others, at], rows[place])
    return rows
