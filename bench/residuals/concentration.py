"""The part of the motion in which a motor's squared error is concentrated, far beyond chance."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from bench.residuals.autocorrelation import correlations
from bench.residuals.bounds import NAMING
from bench.residuals.motor import MotorSeries
from bench.residuals.regions import Region, RegionPlace


@dataclass(frozen=True)
class Concentration:
    """A share of a motor's squared error in a share of its time.

    evidence: nats against an error that is spread evenly. of_rest: shares are of the residual outside the
    regions named before.
    """

    joint: str
    where: RegionPlace
    error_share: float
    time_share: float
    evidence: float
    of_rest: bool


def concentrations(series: Sequence[MotorSeries], candidates: Sequence[Region]) -> list[Concentration]:
    """The regions that hold far more of one motor's squared error than of its time, the most telling first.

    A second one is looked for outside the first, since many regions overlap.
    """
    squares = [trace.error**2 for trace in series]
    remaining = [np.ones(len(square), dtype=bool) for square in squares]
    named: list[Concentration] = []
    while len(named) < NAMING.regions:
        independent = _independent_squares(series, squares, remaining)
        best = max(
            (
                _concentration(series[0].joint, region, squares, remaining, independent, bool(named))
                for region in candidates
            ),
            key=lambda concentration: _divergence(concentration.error_share, concentration.time_share),
            default=None,
        )
        if best is None or not _counts(best, len(candidates)):
            break
        named.append(best)
        region = next(candidate for candidate in candidates if candidate.where == best.where)
        remaining = [kept & ~rows for kept, rows in zip(remaining, region.rows, strict=True)]
    return named


def shares(series: Sequence[MotorSeries], region: Region) -> tuple[float, float]:
    """The share of one motor's squared error that lies in a region, and the region's share of the time."""
    everywhere = [np.ones(len(trace.time), dtype=bool) for trace in series]
    return _shares([trace.error**2 for trace in series], region.rows, everywhere)


def _shares(
    squares: Sequence[np.ndarray], inside: Sequence[np.ndarray], remaining: Sequence[np.ndarray]
) -> tuple[float, float]:
    """Shares of squares and of rows inside among the remaining ones."""
    both = [rows & kept for rows, kept in zip(inside, remaining, strict=True)]
    whole = sum(float(square[kept].sum()) for square, kept in zip(squares, remaining, strict=True))
    part = sum(float(square[rows].sum()) for square, rows in zip(squares, both, strict=True))
    rows, all_rows = sum(int(entry.sum()) for entry in both), sum(int(values.sum()) for values in remaining)
    return part / whole if whole else 0.0, rows / all_rows if all_rows else 1.0


def _concentration(
    joint: str,
    region: Region,
    squares: Sequence[np.ndarray],
    remaining: Sequence[np.ndarray],
    independent: float,
    of_rest: bool,
) -> Concentration:
    error_share, time_share = _shares(squares, region.rows, remaining)
    evidence = independent * _divergence(error_share, time_share)
    return Concentration(joint, region.where, error_share, time_share, evidence, of_rest)


def _counts(concentration: Concentration, tried: int) -> bool:
    telling = _divergence(concentration.error_share, concentration.time_share) > NAMING.region_nats
    return telling and concentration.evidence > NAMING.regions_nats + float(np.log(tried))


def _divergence(error_share: float, time_share: float) -> float:
    """How far the squared error is from an even spread: Kullback and Leibler's divergence, nats; zero below it.

    So large a share or larger comes about by chance with a probability of at most exp(-n divergence) for n
    independent squares (Chernoff).
    """
    if not 0.0 < time_share < 1.0 or error_share <= time_share:
        return 0.0
    outside = (
        (1.0 - error_share) * np.log((1.0 - error_share) / (1.0 - time_share)) if error_share < 1 else 0.0
    )
    return float(error_share * np.log(error_share / time_share) + outside)


def _independent_squares(
    series: Sequence[MotorSeries], squares: Sequence[np.ndarray], remaining: Sequence[np.ndarray]
) -> float:
    """Effective number of remaining independent squares: of blocks as long as their autocorrelation time, weighed by
    their size.

    The squares of normal errors are correlated by the square of the errors' correlation.
    """
    alike = correlations([trace.row for trace in series], [trace.error for trace in series]) ** 2
    length = max(int(np.ceil(2.0 * alike.sum() - 1.0)), 1)
    kept = [square[rows] for square, rows in zip(squares, remaining, strict=True) if rows.any()]
    if not kept:
        return 0.0
    blocks = np.concatenate([np.add.reduceat(entry, np.arange(0, len(entry), length)) for entry in kept])
    energy = float(blocks @ blocks)
    return float(blocks.sum() ** 2 / energy) if energy else 0.0
