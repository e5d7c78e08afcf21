"""Minimum of a function of one variable inside bounds."""

from collections.abc import Callable

import numpy as np

from bench.identification.tolerances import TOLERANCES

GOLDEN = 0.5 * (3.0 - np.sqrt(5.0))
ROUNDING = float(np.sqrt(2.2e-16))  # relative: closer points have the same value


def minimum_between(
    function: Callable[[float], float], low: float, high: float, tolerance: float
) -> tuple[float, float]:
    """Place, to a tolerance, and value of a minimum of the function between two bounds.

    Parabolas through the three best points, golden sections where these do not help (R. P. Brent, "Algorithms for
    Minimization without Derivatives", 1973, chapter 5). scipy.optimize has the same, and takes 0.3 s to import.
    """
    best = second = third = low + GOLDEN * (high - low)
    at_best = at_second = at_third = function(best)
    step = before = 0.0
    for _ in range(TOLERANCES.shapes.values):
        middle = 0.5 * (low + high)
        least = ROUNDING * abs(best) + tolerance / 3.0
        if abs(best - middle) <= 2.0 * least - 0.5 * (high - low):
            break
        parabolic = None
        if abs(before) > least:
            r, q = (best - second) * (at_best - at_third), (best - third) * (at_best - at_second)
            p, q = (best - third) * q - (best - second) * r, 2.0 * (q - r)
            p, q = (-p if q > 0.0 else p), abs(q)
            if abs(p) < abs(0.5 * q * before) and q * (low - best) < p < q * (high - best):
                parabolic = p / q
        if parabolic is None:
            before = (low if best >= middle else high) - best
            step = GOLDEN * before
        else:
            before, step = step, parabolic
            if min(best + step - low, high - best - step) < 2.0 * least:
                step = least if middle >= best else -least
        tried = best + (max(abs(step), least) if step >= 0.0 else -max(abs(step), least))
        value = function(tried)
        if value <= at_best:
            low, high = (best, high) if tried >= best else (low, best)
            third, at_third, second, at_second = second, at_second, best, at_best
            best, at_best = tried, value
            continue
        low, high = (tried, high) if tried < best else (low, tried)
        if value <= at_second or second == best:
            third, at_third, second, at_second = second, at_second, tried, value
        elif value <= at_third or third in (best, second):
            third, at_third = tried, value
    return best, at_best
