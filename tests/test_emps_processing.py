"""The published EMPS least squares, repeated from the raw file with bench.signals and numpy alone.

What the figures imply, found by trying (each item moves a printed digit): the Butterworth filter extends the
ends by 3 * order samples, the Chebyshev filter too; the acceleration is the central difference of the
velocity; the first 49 rows are dropped (the first row kept has the index 50, counted from one) and none at
the end; the standard deviation of the residual is about its mean and divides by r - 1, whatever the number of
parameters. Whether the sign is that of the filtered velocity cannot be seen in the figures.
"""

from pathlib import Path

import numpy as np
import pytest
from scipy.io import loadmat

from bench.signals.decimation import decimate
from bench.signals.differentiation import central_difference
from bench.signals.filtering import low_pass


@pytest.fixture(scope="module")
def estimate(measured_data: Path) -> dict[str, np.ndarray]:
    file = measured_data / "emps" / "DATA_EMPS.mat"
    if not file.is_file():
        pytest.skip(f"no measured EMPS data at {file}")
    log = loadmat(file, squeeze_me=True)
    position = low_pass(log["qm"], rate=1000.0, cutoff=100.0, order=4)
    velocity = central_difference(position, 1e-3, order=2)
    acceleration = central_difference(velocity, 1e-3, order=2)
    columns = [acceleration, velocity, np.sign(velocity), np.ones_like(velocity), log["gtau"] * log["vir"]]
    rows = decimate(np.column_stack(columns)[49:], 10)
    w, y = rows[:, :4], rows[:, 4]
    chi = np.linalg.lstsq(w, y)[0]
    residual = y - w @ chi
    deviation = np.std(residual, ddof=1) * np.sqrt(np.diag(np.linalg.inv(w.T @ w)))
    return {
        "chi": chi,
        "deviation": deviation,
        "condition": np.linalg.cond(w),
        "error": 100 * np.linalg.norm(residual) / np.linalg.norm(y),
    }


def test_parameters_as_published(estimate: dict[str, np.ndarray]) -> None:
    assert [f"{v:.4f}" for v in estimate["chi"]] == ["95.1089", "203.5034", "20.3935", "-3.1648"]


def test_deviations_as_published(estimate: dict[str, np.ndarray]) -> None:
    assert [f"{v:.4f}" for v in estimate["deviation"]] == ["0.1085", "1.1460", "0.1012", "0.0444"]


def test_condition_and_error_as_published(estimate: dict[str, np.ndarray]) -> None:
    assert f"{estimate['condition']:.4f}" == "25.9883"
    assert f"{estimate['error']:.4f}" == "4.0834"
