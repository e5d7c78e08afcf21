"""Tail of the chi-squared distribution."""

from scipy.special import chdtrc, chdtri

CONFIDENCE = 0.95
WITHIN_95 = 1.959964
"""Number of standard deviations that contain 95 % of a normal distribution."""


def tail(x: float, freedom: float) -> float:
    """Probability of a value above x, for any positive number of degrees of freedom."""
    return float(chdtrc(freedom, max(x, 0.0)))


def exceeded_with(probability: float, freedom: float) -> float:
    """The value that is exceeded with the given probability, between 0 and 1."""
    return float(chdtri(freedom, probability))
