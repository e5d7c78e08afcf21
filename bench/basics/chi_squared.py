"""Tail of the chi-squared distribution. scipy.special has the same, and takes 0.05 s to import."""

from math import exp, inf, lgamma, log

WITHIN_95 = 1.959964
"""Standard deviations within which 95 % of a normal distribution lie."""

PRECISION = 1e-15
TINY = 1e-300
MOST = 100_000  # terms


def tail(x: float, freedom: float) -> float:
    """Probability of more than x, for any positive number of degrees of freedom.

    The incomplete gamma function by its series below its mean and by its continued fraction above (M. Abramowitz
    and I. A. Stegun, "Handbook of Mathematical Functions", 1964, 6.5.29 and 6.5.31).
    """
    a, y = 0.5 * freedom, 0.5 * x
    if y <= 0.0:
        return 1.0
    if y == inf:
        return 0.0
    size = exp(a * log(y) - y - lgamma(a))
    return 1.0 - size * _series(a, y) if y < a + 1.0 else size * _fraction(a, y)


def exceeded_with(probability: float, freedom: float) -> float:
    """The value that is exceeded with a probability between 0 and 1."""
    low, high = 0.0, max(freedom, 1.0)
    while tail(high, freedom) > probability:
        low, high = high, 2.0 * high
    while high - low > 4.0 * PRECISION * high:
        middle = 0.5 * (low + high)
        if middle in (low, high):
            break
        low, high = (middle, high) if tail(middle, freedom) > probability else (low, middle)
    return 0.5 * (low + high)


def _series(a: float, y: float) -> float:
    term = total = 1.0 / a
    for k in range(1, MOST):
        term *= y / (a + k)
        total += term
        if term < PRECISION * total:
            break
    return total


def _fraction(a: float, y: float) -> float:
    """Evaluated from its beginning (Lentz's method)."""
    b = y + 1.0 - a
    c, d = 1.0 / TINY, 1.0 / b
    value = d
    for k in range(1, MOST):
        b += 2.0
        d = 1.0 / ((-k * (k - a) * d + b) or TINY)
        c = (b - k * (k - a) / c) or TINY
        value *= c * d
        if abs(c * d - 1.0) < PRECISION:
            break
    return value
