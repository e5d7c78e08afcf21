"""Long logs: in parts the same answer as in one piece, a window that ends, and memory that does not follow."""

import tracemalloc
from dataclasses import replace

import numpy as np
import pytest

from bench.dataset.dataset import load_dataset
from bench.dataset.recording import Recording
from bench.dataset.robot import load_robot
from bench.diagnosis.base_model import base_model_of
from bench.diagnosis.candidates import propose
from bench.diagnosis.rounds import system_about
from bench.identification import filtered as measured
from bench.identification import observation
from bench.identification.filtered import measure
from bench.identification.identify import fit
from bench.identification.observation import all_currents, observe
from bench.identification.prepare import prepare
from bench.identification.problem import problem_of
from bench.identification.standard_errors import _autocorrelated, _covariances
from bench.identification.standstill import around, interpolated, interpolated_part
from bench.identification.tolerances import TOLERANCES
from bench.model.model import build_model
from bench.model.motion import LongMotion
from bench.signals.decimation import Decimation, decimate
from bench.signals.settings import FilterSettings
from tests.bounds_kit import with_bounds
from tests.workbench_kit import write_dataset

SETTINGS = FilterSettings(position_cutoff=40.0, decimation=20, border=(50, 50))


@pytest.mark.parametrize("factor", [1, 3, 24, 25, 300])
@pytest.mark.parametrize("columns", [1, 7])
@pytest.mark.parametrize("cuts", [(), (1, 2, 20, 26, 27, 700), (30, 999), tuple(range(97, 1900, 97))])
def test_decimation_of_parts_is_that_of_the_whole(factor, columns, cuts):
    x = np.random.default_rng(1).normal(size=(1900, columns)).cumsum(axis=0)
    parts = Decimation(len(x), factor)
    for part in np.split(x, cuts):
        parts.push(part)
    whole = decimate(x, factor)
    assert parts.finish() == pytest.approx(whole, rel=1e-12, abs=1e-12 * np.abs(whole).max())


def test_a_standstill_over_many_parts_is_bridged_as_in_one_piece():
    random = np.random.default_rng(2)
    rows = random.normal(size=(1000, 2, 3)).cumsum(axis=0)
    left = [[0, 30, 20], [40, 45, 20], [60, 700, 20], [980, 1000, 20]]
    gaps = (np.array(left), np.array([[100, 110, 20]]))
    whole = interpolated(rows, gaps)
    for size in (1000, 333, 50, 7):
        parts = [slice(a, min(a + size, 1000)) for a in range(0, 1000, size)]
        seen = [around(part, gaps, 1000) for part in parts]
        pieces = [
            interpolated_part(rows[one].copy(), one, part, gaps, 1000)
            for one, part in zip(seen, parts, strict=True)
        ]
        assert np.concatenate(pieces) == pytest.approx(whole, abs=1e-12)
        assert max(map(len, seen)) <= size + 4 * 2 * 20  # two sides of every standstill that a part meets


def test_a_log_in_parts_gives_the_answer_of_one_piece(tmp_path, monkeypatch):
    dataset = load_dataset(write_dataset(tmp_path / "d"))
    once = prepare(problem_of(dataset))
    monkeypatch.setattr(measured, "TOLERANCES", with_bounds("memory", motion_numbers=0))
    monkeypatch.setattr(observation, "TOLERANCES", with_bounds("memory", samples=700))
    parts = prepare(problem_of(dataset))
    assert all(isinstance(one.tree, LongMotion) for one in parts.measured)
    for a, b in zip(once.observations, parts.observations, strict=True):
        for name in ("current", "rigid", "position", "velocity", "acceleration"):
            expected = getattr(a, name)
            assert getattr(b, name) == pytest.approx(expected, rel=1e-7, abs=1e-9 * np.abs(expected).max())
        assert (a.moving == b.moving).all()
    for a, b in zip(once.measured, parts.measured, strict=True):
        assert all_currents(b) == pytest.approx(all_currents(a), abs=1e-12)
        assert b.tree.jacobian == pytest.approx(a.tree.jacobian, rel=1e-7, abs=1e-9)
    first, second = fit(once), fit(parts)
    for x, y in zip(first.rows(), second.rows(), strict=True):
        assert y["value"] == pytest.approx(x["value"], abs=1e-6 * x["std"])
        assert y["std"] == pytest.approx(x["std"], rel=1e-6)


def test_rows_in_parts_give_the_factors_of_one_piece():
    random = np.random.default_rng(3)
    phi, kappa, current = random.normal(size=(500, 2, 4)), *random.normal(size=(2, 500, 2))
    from bench.identification import compressed as stack

    once = stack.compress(phi, kappa, current)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(stack, "TOLERANCES", with_bounds("memory", compressed_rows=64))
        parts = stack.compress(phi, kappa, current)
    assert parts.swapaxes(1, 2) @ parts == pytest.approx(once.swapaxes(1, 2) @ once, abs=1e-9)


@pytest.mark.parametrize("lags", [0, 6, 40])
@pytest.mark.parametrize("samples", [41, 1000])
def test_the_band_of_the_covariance_is_multiplied_as_the_whole_matrix(samples, lags):
    random = np.random.default_rng(4)
    jacobian, covariances = random.normal(size=(samples, 3)), random.normal(size=lags + 1)
    apart = np.abs(np.subtract.outer(np.arange(samples), np.arange(samples)))
    band = np.where(apart <= lags, covariances[np.minimum(apart, lags)], 0.0)
    assert _autocorrelated(jacobian, covariances) == pytest.approx(jacobian.T @ band @ jacobian, abs=1e-9)


def test_the_window_of_the_deviations_ends_however_long_the_log():
    random = np.random.default_rng(5)
    for samples in (100_000, 400_000):
        slow = np.convolve(random.normal(size=samples), np.ones(500) / 500, mode="same")
        found = _covariances(slow, np.ones(samples, dtype=bool), (0, samples // 2))
        assert len(found) == TOLERANCES.statistics.most_lags + 1
    assert TOLERANCES.statistics.most_lags > TOLERANCES.statistics.low_pass_lags


def _long(seconds: float) -> Recording:
    """A slow movement of the five-bar at 1 kHz; its currents mean nothing."""
    robot = load_robot("five_bar")
    time = np.arange(0.0, seconds, 1e-3)
    home = np.asarray(build_model(robot).geometry.home[build_model(robot).geometry.active_configuration])
    offset = build_model(robot).geometry.active_offset
    swing = 0.3 * np.sin(2.0 * np.pi * np.outer(time, [0.31, 0.23]))
    return Recording("long.csv", "identify", None, time, home + offset + swing, np.cos(swing))


def _peak(seconds: float) -> tuple[int, int]:
    """Most bytes above what the recording takes, and samples."""
    model, recording = build_model(load_robot("five_bar")), _long(seconds)
    observe(model, measure(model, replace(recording), SETTINGS))  # what is kept from one time to the next
    tracemalloc.start()
    try:
        seen = observe(model, measure(model, recording, SETTINGS))
        assert len(seen.time) == -(-(len(recording.time) - 100) // 20)
        return tracemalloc.get_traced_memory()[1], len(recording.time)
    finally:
        tracemalloc.stop()


def test_memory_of_a_long_log_is_that_of_its_signals_not_of_its_columns(monkeypatch):
    monkeypatch.setattr(measured, "TOLERANCES", with_bounds("memory", motion_numbers=0))
    (short, few), (long, many) = _peak(20.0), _peak(120.0)
    more = (long - short) / (many - few)
    # Signals, their derivatives and the passive joints' rates; all columns would take 8 * 2 * 11 bytes, twice.
    assert more < 200


def test_a_motion_that_was_forgotten_is_worked_out_again_the_very_same(tmp_path, monkeypatch):
    monkeypatch.setattr(measured, "TOLERANCES", with_bounds("memory", lasting_numbers=0))
    entries = prepare(problem_of(load_dataset(write_dataset(tmp_path / "d")))).measured
    names = ("q", "v", "a", "jacobian")
    before = [{name: getattr(entry.tree, name) for name in names} for entry in entries]
    measured.forget_motions(entries)
    for entry, known in zip(entries, before, strict=True):
        assert isinstance(entry.tree, LongMotion)
        few = entry.tree.at(slice(3, None, 7))
        for name in names:
            np.testing.assert_allclose(getattr(few, name), known[name][3::7], rtol=1e-9, atol=1e-12)
            assert getattr(entry.tree, name) is not known[name]
            np.testing.assert_array_equal(getattr(entry.tree, name), known[name])


def test_what_a_long_motion_takes_is_gone_when_a_system_is_made(tmp_path, monkeypatch):
    monkeypatch.setattr(measured, "TOLERANCES", with_bounds("memory", lasting_numbers=0))
    problem = problem_of(load_dataset(write_dataset(tmp_path / "d")))
    base_model = base_model_of(prepare(problem))
    systems = [
        system_about(
            base_model, base_model.start, propose(base_model.context(base_model.start), problem.catalogue)
        )
        for _ in range(2)
    ]
    for entry in base_model.start.measured:
        assert isinstance(entry.tree, LongMotion)
        assert "_whole" not in vars(entry.tree)
        assert not entry.held
        assert not any((entry.perturbed.nbytes, entry.reshaped.nbytes, entry.reactions.nbytes))
        assert entry.kept.nbytes > 0
    for signals in base_model.nearby.signals(base_model.start.present, base_model.start.signals):
        assert not signals.noted
    np.testing.assert_array_equal(systems[0].fitted.inner, systems[1].fitted.inner)
