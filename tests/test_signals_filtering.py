"""Zero-phase low-pass and parallel filtering against their closed forms."""

import numpy as np
import pytest
from scipy import signal

from bench.basics.errors import BenchError
from bench.signals.decimation import decimate, decimated_indices, fit_band, noise_bandwidth
from bench.signals.filtering import forward_backward, low_pass, low_pass_gain

RATE = 1000.0


def sines(frequencies: list[float], samples: int = 20000) -> np.ndarray:
    t = np.arange(samples) / RATE
    return np.column_stack([np.sin(2 * np.pi * f * t + 0.3) for f in frequencies])


@pytest.mark.parametrize(("cutoff", "order"), [(10.0, 4), (100.0, 4), (100.0, 2), (400.0, 4)])
def test_low_pass_scales_each_sine_by_its_gain_and_shifts_none(cutoff: float, order: int) -> None:
    frequencies = [0.5 * cutoff, cutoff, 1.2 * cutoff]
    x = sines(frequencies)
    y = low_pass(x, RATE, cutoff, order)
    inner = slice(5000, 15000)
    np.testing.assert_allclose(
        y[inner], low_pass_gain(np.array(frequencies), RATE, cutoff, order) * x[inner], atol=1e-9
    )


def test_low_pass_gain_is_a_half_at_the_cutoff_and_within_1e_4_of_one_at_a_third() -> None:
    gain = low_pass_gain(np.array([100.0, 100 / 3.2]), RATE, 100.0)
    assert gain[0] == pytest.approx(0.5)
    assert 0 < 1 - gain[1] < 1e-4


def test_low_pass_extends_the_ends_as_published_results_do() -> None:
    x = np.random.default_rng(1).standard_normal(500).cumsum()
    b, a = signal.butter(4, 0.2)
    np.testing.assert_allclose(low_pass(x, RATE, 100.0), signal.filtfilt(b, a, x, padlen=12), atol=1e-10)


@pytest.mark.parametrize(
    ("samples", "cutoff", "order", "words"),
    [
        (100, 500.0, 4, "500 Hz"),
        (100, 0.0, 4, "0 Hz"),
        (12, 100.0, 4, "12 samples"),
        (100, 50.0, 0, "order 0"),
    ],
)
def test_low_pass_names_what_is_wrong(samples: int, cutoff: float, order: int, words: str) -> None:
    with pytest.raises(BenchError, match=words):
        low_pass(np.zeros((samples, 2)), RATE, cutoff, order)


@pytest.mark.parametrize("factor", [2, 7, 10, 50])
def test_decimate_passes_the_band_and_stops_what_would_fold_back(factor: int) -> None:
    nyquist = RATE / 2 / factor
    x = sines([0.5 * nyquist, 0.75 * nyquist, 1.25 * nyquist, 1.7 * nyquist][: 3 if factor == 2 else 4])
    y = decimate(x, factor)
    kept = decimated_indices(len(x), factor)
    inner = slice(len(y) // 4, -len(y) // 4)
    assert np.abs(y - x[kept])[inner, :2].max() < 0.012  # a ripple of 0.05 dB each way
    assert np.abs(y[inner, 2:]).max() < 1e-4
    assert fit_band(RATE, factor) == pytest.approx(0.8 * nyquist)


@pytest.mark.parametrize("samples", [991, 999, 1000])
def test_decimate_keeps_the_last_sample(samples: int) -> None:
    kept = decimated_indices(samples, 10)
    assert kept[-1] == samples - 1
    assert len(kept) == -(-samples // 10)
    assert set(np.diff(kept)) == {10}
    assert len(decimate(np.zeros(samples), 10)) == len(kept)


@pytest.mark.parametrize("samples", [25, 97, 700, 2011])
@pytest.mark.parametrize("factor", [2, 5, 12, 40, 100, 300])
def test_blocks_give_what_the_run_over_all_samples_gives(samples: int, factor: int) -> None:
    x = np.random.default_rng(8).normal(size=(samples, 5)).cumsum(axis=0) + 7.0
    sections = signal.cheby1(8, 0.05, 0.8 / factor, output="sos")
    whole = forward_backward(sections, x, 8, "test")
    kept = decimated_indices(samples, factor)
    np.testing.assert_allclose(decimate(x, factor), whole[kept], rtol=0, atol=1e-10 * np.abs(whole).max())


def test_decimate_treats_every_column_alike_and_is_linear() -> None:
    rng = np.random.default_rng(2)
    w = rng.standard_normal((400, 3, 5))
    chi = rng.standard_normal(5)
    out = decimate(w, 4)
    assert out.shape == (100, 3, 5)
    np.testing.assert_allclose(out @ chi, decimate(w @ chi, 4), atol=1e-12)
    np.testing.assert_allclose(out[:, 1, 2], decimate(w[:, 1, 2], 4), atol=1e-13)


def test_decimate_by_one_changes_nothing_and_gives_a_copy() -> None:
    x = np.arange(5.0)
    y = decimate(x, 1)
    np.testing.assert_array_equal(y, x)
    assert not np.shares_memory(x, y)


def test_decimate_names_what_is_wrong() -> None:
    with pytest.raises(BenchError, match="24 samples are too few"):
        decimate(np.zeros(24), 3)
    with pytest.raises(BenchError, match="factor 0"):
        decimate(np.zeros(100), 0)


@pytest.mark.parametrize("factor", [1, 2, 10, 40])
def test_noise_bandwidth_is_the_variance_that_is_left_of_white_noise(factor: int) -> None:
    noise = np.random.default_rng(3).standard_normal((100_000, 4))
    left = decimate(noise, factor).var()
    assert left == pytest.approx(noise_bandwidth(factor), rel=4 * np.sqrt(2 / (4e5 * 0.8 / factor)))
