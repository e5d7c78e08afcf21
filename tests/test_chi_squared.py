"""The chi-squared tail beside that of scipy."""

import numpy as np
import pytest
from scipy.stats import chi2

from bench.basics.chi_squared import exceeded_with, tail

FREEDOM = (0.3, 1.0, 2.0, 7.5, 40.0, 900.0, 30_000.0)


@pytest.mark.parametrize("freedom", FREEDOM)
def test_the_tail_is_that_of_scipy(freedom):
    for x in freedom * np.geomspace(1e-3, 20.0, 40):
        assert tail(float(x), freedom) == pytest.approx(float(chi2.sf(x, freedom)), rel=1e-9, abs=1e-200)
    assert tail(0.0, freedom) == 1.0
    assert tail(np.inf, freedom) == 0.0


@pytest.mark.parametrize("freedom", FREEDOM)
@pytest.mark.parametrize("probability", [0.9, 0.5, 0.01, 1e-6])
def test_the_value_that_is_exceeded_is_that_of_scipy(freedom, probability):
    expected = float(chi2.isf(probability, freedom))
    assert exceeded_with(probability, freedom) == pytest.approx(expected, rel=1e-9, abs=1e-12)
