"""Automatic cut-offs and the noise floor on synthetic joints: Fourier motion, Coulomb steps, noise."""

import dataclasses

import numpy as np
import pytest
from scipy.io import loadmat

from bench.basics.errors import BenchError
from bench.signals.decimation import decimate, noise_bandwidth
from bench.signals.filtering import low_pass_gain
from bench.signals.processing import estimate_motion, trim
from bench.signals.settings import FilterSettings, choose_settings, signal_bands
from bench.signals.spectrum import (
    largest_within_octaves,
    noise_floor,
    power_spectrum,
    quantisation_density,
)

RATE = 1000.0
INERTIA, VISCOUS, OFFSET = 0.3, 0.5, 0.2


@dataclasses.dataclass(frozen=True)
class Case:
    """One kind of recording: motion, friction, encoder and noise, and how good an inertia must be."""

    base_frequency: float  # Hz, five harmonics
    coulomb: float
    bits: int | None
    position_noise: float  # rad
    current_noise: float  # share of the RMS
    inertia_error: float

    def __str__(self) -> str:
        encoder = "clean" if self.bits is None else f"{self.bits}bit"
        return f"{self.base_frequency}Hz-coulomb{self.coulomb}-{encoder}-{self.current_noise}"


CASES = [
    Case(0.1, 0.0, None, 0.0, 0.0, 1e-5),
    Case(0.5, 0.0, None, 0.0, 0.0, 1e-5),
    Case(0.5, 1.5, None, 0.0, 0.0, 1e-3),
    Case(0.1, 0.0, 20, 0.0, 0.01, 5e-3),
    Case(0.5, 0.0, 20, 0.0, 0.01, 1e-3),
    Case(0.5, 1.5, 20, 0.0, 0.01, 2e-3),
    Case(0.5, 1.5, 16, 0.0, 0.05, 5e-3),
    Case(0.5, 1.5, 12, 1e-3, 0.2, 3e-2),
    Case(0.5, 0.0, 12, 1e-3, 0.2, 2e-2),
]


def record(case: Case, seed: int, duration: float = 20.0, joints: int = 2) -> tuple[np.ndarray, np.ndarray]:
    """Return measured positions and currents, each (N, joints)."""
    rng = np.random.default_rng(seed)
    t = np.arange(int(duration * RATE)) / RATE
    w = 2 * np.pi * case.base_frequency * np.arange(1, 6)
    amplitude = 0.5 / np.arange(1, 6)[:, None] * rng.uniform(0.5, 1.0, (5, joints))
    phase = rng.uniform(0, 2 * np.pi, (5, joints))
    angle = w[:, None] * t[:, None, None] + phase
    q = (amplitude * np.sin(angle)).sum(axis=1)
    v = (amplitude * w[:, None] * np.cos(angle)).sum(axis=1)
    a = -(amplitude * w[:, None] ** 2 * np.sin(angle)).sum(axis=1)
    current = INERTIA * a + VISCOUS * v + case.coulomb * np.sign(v) + OFFSET
    current += case.current_noise * current.std(axis=0) * rng.standard_normal(q.shape)
    q = q + case.position_noise * rng.standard_normal(q.shape)
    if case.bits is not None:
        step = 2 * np.pi / 2**case.bits
        q = step * np.round(q / step)
    return q, current


def fitted_inertias(q: np.ndarray, current: np.ndarray, settings: FilterSettings) -> np.ndarray:
    motion = estimate_motion(q, RATE, settings)
    current = trim(current, settings)
    found = []
    for j in range(q.shape[1]):
        v, a = motion.velocity[:, j], motion.acceleration[:, j]
        rows = decimate(
            np.column_stack([a, v, np.sign(v), np.ones_like(v), current[:, j]]), settings.decimation
        )
        found.append(np.linalg.lstsq(rows[:, :4], rows[:, 4])[0][0])
    return np.array(found)


@pytest.mark.parametrize("case", CASES, ids=str)
def test_chosen_filters_keep_the_motion_and_give_the_inertia(case: Case) -> None:
    records = [record(case, seed) for seed in (1, 2)]
    settings = choose_settings([q for q, _ in records], [i for _, i in records], RATE)
    band = settings.band(RATE)
    assert 5 * case.base_frequency < band <= RATE / 10
    assert 1 - low_pass_gain(np.array([band]), RATE, settings.position_cutoff)[0] < 1e-4
    assert settings.position_cutoff < RATE / 2
    for q, current in records:
        error = fitted_inertias(q, current, settings) / INERTIA - 1
        assert np.abs(error).max() < case.inertia_error


def test_noise_narrows_the_filters_but_not_below_the_motion() -> None:
    chosen = []
    for bits, noise in [(20, 0.0), (16, 0.0), (12, 0.0), (12, 3e-3)]:
        q, current = record(Case(0.5, 1.5, bits, noise, 0.01, 0.0), seed=3)
        chosen.append(choose_settings([q], [current], RATE))
    bands = [s.band(RATE) for s in chosen]
    cutoffs = [s.position_cutoff for s in chosen]
    assert bands == sorted(bands, reverse=True)
    assert bands[0] > 3 * bands[-1]
    assert cutoffs == sorted(cutoffs, reverse=True)
    assert bands[-1] > 2.5


def test_noise_that_is_not_white_is_no_motion() -> None:
    """Its power falls with the frequency, but that of its acceleration rises above that of the motion."""
    case = Case(0.5, 1.5, None, 0.0, 0.01, 0.0)
    q, current = record(case, seed=5)
    walk = np.cumsum(np.random.default_rng(6).standard_normal(q.shape), axis=0)
    noisy = q + 2e-5 * (walk - walk.mean(axis=0))
    clean, found = (signal_bands([one], [current], RATE) for one in (q, noisy))
    assert clean.motion <= found.motion < 20.0
    settings = choose_settings([noisy], [current], RATE)
    assert np.abs(fitted_inertias(noisy, current, settings) / INERTIA - 1).max() < 0.01


def test_jitter_whose_acceleration_is_level_is_no_motion() -> None:
    """As a controller leaves it: its power outweighs a hundredth of the motion's by its wide band alone."""
    q, current = record(Case(0.5, 0.0, None, 0.0, 0.01, 0.0), seed=5)
    lines = np.fft.rfft(np.random.default_rng(7).standard_normal(q.shape), axis=0)
    frequency = np.fft.rfftfreq(len(q), 1.0 / RATE)[:, None]
    inside = (frequency > 1.0) & (frequency < 300.0)
    jitter = np.fft.irfft(np.where(inside, lines / np.maximum(frequency, 1.0) ** 2, 0.0), len(q), axis=0)
    clean, found = (signal_bands([one], [current], RATE) for one in (q, q + 0.1 * jitter))
    assert clean.motion < 4.0
    assert found.motion < 8.0


def test_a_wide_filter_on_a_coarse_encoder_is_as_wrong_as_the_choice_is_right() -> None:
    case = Case(0.5, 0.0, 12, 1e-3, 0.01, 0.0)
    q, current = record(case, seed=4)
    wide = FilterSettings(position_cutoff=400.0, decimation=4, border=(50, 50))
    assert np.abs(fitted_inertias(q, current, wide) / INERTIA - 1).max() > 0.5
    chosen = choose_settings([q], [current], RATE)
    assert np.abs(fitted_inertias(q, current, chosen) / INERTIA - 1).max() < 5e-3


@pytest.mark.parametrize("coulomb", [0.0, 1.5, 5.0])
@pytest.mark.parametrize("noise", [0.01, 0.05, 0.3])
@pytest.mark.parametrize("base_frequency", [0.1, 0.5])
def test_noise_floor_within_a_twentieth(coulomb: float, noise: float, base_frequency: float) -> None:
    for seed in range(3):
        q, clean = record(Case(base_frequency, coulomb, None, 0.0, 0.0, 0.0), seed)
        level = noise * clean.std(axis=0)
        current = clean + level * np.random.default_rng(seed).standard_normal(q.shape)
        for band in (10.0, 40.0):
            got = noise_floor(current, RATE, band)
            np.testing.assert_allclose(got, level * np.sqrt(band / (RATE / 2)), rtol=0.05)


def test_noise_floor_foretells_the_noise_after_decimation() -> None:
    noise = 0.2 * np.random.default_rng(6).standard_normal((100_000, 3))
    t = np.arange(len(noise))[:, None] / RATE
    floor = noise_floor(noise + np.sin(2 * np.pi * t), RATE, noise_bandwidth(10) * RATE / 2)
    np.testing.assert_allclose(floor, decimate(noise, 10).std(axis=0), rtol=0.03)


def test_noise_floor_of_a_clean_record_is_nothing_beside_the_signal() -> None:
    _, current = record(Case(0.5, 1.5, None, 0.0, 0.0, 0.0), seed=7)
    assert np.all(noise_floor(current, RATE, 40.0) < 1e-8 * current.std(axis=0))


@pytest.mark.parametrize("bits", [12, 16, 20])
def test_quantisation_density_is_that_of_the_rounding_error(bits: int) -> None:
    case = Case(0.5, 0.0, None, 0.0, 0.0, 0.0)
    exact, _ = record(case, seed=8)
    rounded, _ = record(dataclasses.replace(case, bits=bits), seed=8)
    frequency, density = power_spectrum(rounded - exact, RATE)
    band = (frequency > 5) & (frequency < 40)
    ratio = quantisation_density(rounded, RATE) / density[band].mean(axis=0)
    assert np.all((ratio > 0.5) & (ratio < 2.5))


def test_quantisation_density_of_values_that_are_not_rounded_is_nothing() -> None:
    q, _ = record(Case(0.5, 0.0, None, 1e-4, 0.0, 0.0), seed=9)
    assert np.all(quantisation_density(q, RATE) < 1e-6 * 1e-8 / (RATE / 2))


def test_a_still_joint_and_a_constant_current_do_not_decide() -> None:
    q, current = record(Case(0.5, 0.0, 20, 0.0, 0.01, 0.0), seed=10)
    alone = choose_settings([q], [current], RATE)
    for noise in (0.0, 1e-3):
        more = noise * np.random.default_rng(11).standard_normal((len(q), 2))
        still = np.column_stack([q, 0.7 + more[:, 0]])
        steady = np.column_stack([current, 1.3 + more[:, 1]])
        assert choose_settings([still], [steady], RATE) == alone


def test_the_same_signals_in_other_units_give_the_same_settings() -> None:
    q, current = record(Case(0.5, 1.5, 20, 0.0, 0.01, 0.0), seed=11)
    a = choose_settings([q], [current], RATE)
    b = choose_settings([1e-3 * q], [1e3 * current], RATE)
    assert dataclasses.replace(a, position_cutoff=0.1) == dataclasses.replace(b, position_cutoff=0.1)
    assert a.position_cutoff == pytest.approx(b.position_cutoff)


@pytest.mark.parametrize(("rate", "duration"), [(100.0, 20.0), (1000.0, 1.0), (4000.0, 30.0)])
def test_slow_short_and_fast_logs_get_settings_that_work(rate: float, duration: float) -> None:
    t = np.arange(int(rate * duration))[:, None] / rate
    q = np.sin(2 * np.pi * np.array([1.0, 2.0]) * t)
    q += 1e-5 * np.random.default_rng(12).standard_normal(q.shape)
    settings = choose_settings([q], [np.cos(2 * np.pi * t) + 0 * q], rate)
    motion = estimate_motion(q, rate, settings)
    assert 2 < settings.band(rate) < settings.position_cutoff < rate / 2
    assert len(decimate(motion.acceleration, settings.decimation)) >= 40
    exact = -((2 * np.pi * np.array([1.0, 2.0])) ** 2) * np.sin(2 * np.pi * np.array([1.0, 2.0]) * t)
    error = decimate(motion.acceleration - trim(exact, settings), settings.decimation)
    assert np.all(error.std(axis=0) < 0.02 * exact.std(axis=0))


def test_settings_and_records_that_make_no_sense_are_named() -> None:
    for bad, words in [
        ({"position_cutoff": -1.0}, "position_cutoff"),
        ({"decimation": 0}, "decimation"),
        ({"filter_order": 0}, "filter_order"),
        ({"difference_order": 5}, "difference_order"),
        ({"border": (-1, 0)}, "border"),
    ]:
        with pytest.raises(BenchError, match=words):
            dataclasses.replace(FilterSettings(position_cutoff=10.0, decimation=2), **bad)
    with pytest.raises(BenchError, match="pairs"):
        choose_settings([np.zeros((200, 1))], [], RATE)
    with pytest.raises(BenchError, match="99 samples"):
        choose_settings([np.zeros((99, 1))], [np.zeros((99, 1))], RATE)
    with pytest.raises(BenchError, match="band 600 Hz"):
        noise_floor(np.zeros((200, 1)), RATE, 600.0)


def test_measured_emps_gets_what_its_authors_chose(measured_data) -> None:  # type: ignore[no-untyped-def]
    file = measured_data / "emps" / "DATA_EMPS.mat"
    if not file.is_file():
        pytest.skip(f"no measured EMPS data at {file}")
    log = loadmat(file)
    bands = signal_bands([log["qm"]], [log["vir"]], RATE)
    settings = choose_settings([log["qm"]], [log["vir"]], RATE)
    # They took 40 Hz and 100 Hz, and the encoder counts 0.05 micrometres.
    assert 25 < settings.band(RATE) < 50
    assert 80 < settings.position_cutoff < 250
    assert bands.position_noise[0] == pytest.approx((5e-8) ** 2 / 12 / 500, rel=3)


@pytest.mark.parametrize(("first", "last"), [(1, 1), (1, 40), (7, 23), (31, 64)])
def test_the_largest_density_within_each_octave(first: int, last: int) -> None:
    values = np.random.default_rng(first).uniform(size=2 * last + 1)
    expected = [values[i : 2 * i + 1].max() for i in range(first, last + 1)]
    assert largest_within_octaves(values, first, last).tolist() == expected
