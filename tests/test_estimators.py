"""What each estimator is there for: bad seconds, noise in the observation matrix, a controller whose law is known."""

import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from bench.basics.errors import BenchError
from bench.benchmarks.peers.problems import make_problem
from bench.dataset.dataset import Dataset, load_dataset
from bench.dataset.recording import Recording
from bench.identification.errors_in_variables import noise_share
from bench.identification.finding import Code
from bench.identification.findings import runaway
from bench.identification.identify import identify
from bench.identification.prepare import prepare
from bench.identification.problem import problem_of
from bench.identification.result import Identification
from bench.identification.robust import degrees_of_freedom
from bench.scenario.tables import Sensors
from bench.truth.dataset import as_dataset, write_simulation
from bench.truth.resense import sense_again
from bench.truth.simulate import Simulation


@pytest.fixture(scope="module")
def simulation() -> Simulation:
    """A five-bar, two recordings of 5 s."""
    return make_problem("five_bar", 1, friction=False).simulation


def sensed(simulation: Simulation, **sensors: float) -> Dataset:
    settings = simulation.scenario.settings
    scenario = replace(
        simulation.scenario, settings=settings.model_copy(update={"sensors": Sensors(**sensors)})
    )
    return as_dataset(sense_again(simulation, scenario))


def with_bad_second(dataset: Dataset) -> Dataset:
    """The left motor's current is stuck for a second of each recording, and that of the right one off for half."""
    recordings = []
    for one in dataset.recordings:
        current = one.current.copy()
        current[1500:2500, 0] = current[1500, 0]
        current[3000:3500, 1] += 2.0 * current[:, 1].std()
        recordings.append(replace(one, current=current))
    return replace(dataset, recordings=tuple(recordings))


def off(result: Identification, true: np.ndarray) -> tuple[float, float]:
    """Largest relative error of a gain, and largest error over its deviation."""
    gains = result.drive_gains.values()
    error = np.array([one.value for one in gains]) - true
    return float(np.abs(error / true).max()), float(np.abs(error / [one.std for one in gains]).max())


@pytest.fixture(scope="module")
def true(simulation: Simulation) -> np.ndarray:
    return make_problem("five_bar", 1, friction=False).gains


def test_bad_seconds_move_least_squares_and_not_the_robust_estimator(
    simulation: Simulation, true: np.ndarray
) -> None:
    clean = sensed(simulation, encoder_bits=20, current_noise_ratio=0.01)
    bad = with_bad_second(clean)
    result = identify(prepare(problem_of(bad)), method="robust")
    found = [one for one in result.findings if one.code == Code.BAD_STRETCH]
    assert {one.names for one in found} == {
        (joint, f"{name}.csv") for joint in ("left", "right") for name in ("unloaded", "loaded")
    }
    for one in found:
        start, end = (1.5, 2.5) if one.names[0] == "left" else (3.0, 3.5)
        assert start - 0.1 < one.numbers["start"] < one.numbers["end"] < end + 0.1
    error, z = off(result, true)
    assert error < 0.005
    assert z < 3.0
    assert off(identify(prepare(problem_of(bad))), true)[0] > 10.0 * error


def test_on_clean_data_the_robust_estimator_is_least_squares(simulation: Simulation) -> None:
    clean = sensed(simulation, encoder_bits=20, current_noise_ratio=0.01)
    robust = identify(prepare(problem_of(clean)), method="robust")
    assert not [one for one in robust.findings if one.code == Code.BAD_STRETCH]
    for one, other in zip(
        identify(prepare(problem_of(clean))).drive_gains.values(),
        robust.drive_gains.values(),
        strict=True,
    ):
        assert other.value == pytest.approx(one.value, abs=0.3 * one.std)
        assert other.std == pytest.approx(one.std, rel=0.15)


@pytest.mark.parametrize("nu", [2.0, 5.0])
def test_degrees_of_freedom_are_those_of_the_errors(nu: float) -> None:
    errors = np.random.default_rng(1).standard_t(nu, 20_000)
    assert degrees_of_freedom(errors)[0] == pytest.approx(nu, rel=0.15)


def test_behind_a_wrong_filter_instruments_keep_the_noise_out(
    simulation: Simulation, true: np.ndarray
) -> None:
    noisy = sensed(simulation, encoder_bits=14, current_noise_ratio=0.01)
    filters = {"position_cutoff": 160.0, "decimation": 4}
    error, z = off(identify(prepare(problem_of(noisy, filters=filters)), method="iv"), true)
    assert error < 0.02
    assert z < 3.0
    assert off(identify(prepare(problem_of(noisy, filters=filters))), true)[0] > 5.0 * error


def test_noise_of_the_currents_does_not_bias_instrumental_variables(
    simulation: Simulation, true: np.ndarray
) -> None:
    noisy = sensed(simulation, encoder_bits=20, current_noise_ratio=0.2)
    error, z = off(identify(prepare(problem_of(noisy)), method="iv"), true)
    assert z < 3.0
    assert off(identify(prepare(problem_of(noisy)), method="ls"), true)[0] > 2.0 * error


def declared(simulation: Simulation) -> Dataset:
    """The same with the controller's law told, and references logged."""
    settings = simulation.scenario.settings
    controller = settings.controller.model_copy(update={"declared": True})
    scenario = replace(simulation.scenario, settings=settings.model_copy(update={"controller": controller}))
    return as_dataset(replace(simulation, scenario=scenario))


def test_a_known_law_of_the_controller_makes_gains_a_tenth_as_uncertain(
    simulation: Simulation, true: np.ndarray
) -> None:
    dataset = declared(simulation)
    error, z = off(identify(prepare(problem_of(dataset)), method="oe"), true)
    assert error < 2e-4
    assert z < 3.0
    assert off(identify(prepare(problem_of(dataset))), true)[0] > 4.0 * error


def test_output_error_is_as_exact_behind_a_filter_that_is_too_wide(
    simulation: Simulation, true: np.ndarray
) -> None:
    filters = {"position_cutoff": 160.0, "decimation": 4}
    error, z = off(identify(prepare(problem_of(declared(simulation), filters=filters)), method="oe"), true)
    assert error < 1e-3
    assert z < 3.0


def test_what_the_law_commands_is_not_taken_for_less_behind_a_filter_that_is_too_narrow(
    simulation: Simulation, true: np.ndarray
) -> None:
    filters = {"position_cutoff": 5.0}
    error, z = off(identify(prepare(problem_of(declared(simulation), filters=filters)), method="oe"), true)
    assert error < 4e-4
    assert z < 3.0


@pytest.mark.parametrize(("key", "factor"), [("kp", [1.0, 1.01]), ("kv", [0.9, 1.0])])
def test_a_law_that_did_not_make_the_currents_is_refused(
    key: str, factor: list[float], simulation: Simulation
) -> None:
    dataset = declared(simulation)
    assert dataset.controller is not None
    wrong = replace(dataset.controller, **{key: getattr(dataset.controller, key) * factor})
    with pytest.raises(BenchError, match=f"controller of joint {['left', 'right'][factor[0] == 1.0]}"):
        identify(prepare(problem_of(replace(dataset, controller=wrong))), method="oe")


def test_without_a_law_output_error_is_refused(simulation: Simulation) -> None:
    with pytest.raises(BenchError, match=r"oe.*controller.*reference\.JOINT"):
        identify(prepare(problem_of(sensed(simulation, encoder_bits=20))), method="oe")


def test_a_written_dataset_has_law_and_references(simulation: Simulation, tmp_path: Path) -> None:
    settings = simulation.scenario.settings
    controller = settings.controller.model_copy(update={"declared": True})
    scenario = replace(simulation.scenario, settings=settings.model_copy(update={"controller": controller}))
    written = replace(simulation, scenario=scenario)
    write_simulation(written, tmp_path / "data")
    dataset, own = load_dataset(tmp_path / "data"), as_dataset(written)
    assert dataset.controller is not None
    assert own.controller is not None
    for key in ("kp", "kv", "ka", "velocity_delay"):
        assert np.array_equal(getattr(dataset.controller, key), getattr(own.controller, key))
    for one, other in zip(dataset.recordings, own.recordings, strict=True):
        assert np.array_equal(one.extra["reference.left"], other.extra["reference.left"])
    toml = tmp_path / "data" / "dataset.toml"
    text = toml.read_text()
    for old, new, culprit in (
        ("kp = {left", "kp = {lft", r"controller\.kp: left, lft"),
        ("kv = {", "kw = {", "kw"),
    ):
        toml.write_text(text.replace(old, new))
        with pytest.raises(BenchError, match=culprit):
            load_dataset(tmp_path / "data")
    toml.write_text(text)
    table = tmp_path / "data" / "loaded.csv"
    table.write_text(table.read_text().replace("reference.left", "wanted.left", 1))
    with pytest.raises(BenchError, match=r"loaded\.csv: no column reference\.left"):
        load_dataset(tmp_path / "data")


@pytest.mark.parametrize("method", ["iv", "robust"])
def test_effects_and_nominal_gains_are_fitted_by_every_estimator(
    method: str, simulation: Simulation, true: np.ndarray
) -> None:
    clean = sensed(simulation, encoder_bits=20, current_noise_ratio=0.01)
    effects = ["viscous_friction", "coulomb_friction:left", "current_delay:right"]
    fitted, plain = (
        identify(prepare(problem_of(clean, effects)), method),
        identify(prepare(problem_of(clean, effects))),
    )
    for joint, one in plain.effect_parameters["viscous_friction"].items():
        other = fitted.effect_parameters["viscous_friction"][joint]["Fv"]
        assert other.value == pytest.approx(one["Fv"].value, abs=2.0 * one["Fv"].std)
        assert 0.5 < other.std / one["Fv"].std < 2.0
    nominal = identify(prepare(problem_of(clean, fit_gains=False)), method=method)
    assert not nominal.gains_fitted
    assert all(one.value == one.nominal for one in nominal.drive_gains.values())


@pytest.mark.parametrize("method", ["current", "ls", "robust"])
def test_noise_that_given_filters_let_through_is_told_and_held_by_the_intervals(
    simulation: Simulation, true: np.ndarray, method: str
) -> None:
    coarse = sensed(simulation, encoder_bits=14, current_noise_ratio=0.01)
    wide = {"position_cutoff": 160.0, "decimation": 4}
    loud = identify(prepare(problem_of(coarse, filters=wide)), method=method)
    error, in_stds = off(loud, true)
    assert error > 0.1
    assert in_stds < 2.0
    assert runaway(loud) == loud.findings[0]
    assert loud.findings[0].code == Code.NOISE_DECIDES
    assert "instrumental variables" in loud.notes[0]
    quiet = identify(prepare(problem_of(coarse)), method=method)
    assert not {one.code for one in quiet.findings} & {Code.NOISE_DECIDES, Code.NOISE_LET_THROUGH}
    assert off(quiet, true)[0] < 0.01


def test_spectra_that_chose_the_filters_are_not_read_again_for_the_noise(
    simulation: Simulation, monkeypatch: pytest.MonkeyPatch
) -> None:
    fine = sensed(simulation, encoder_bits=20, current_noise_ratio=0.01)
    chosen = prepare(problem_of(fine))
    given = prepare(problem_of(fine, filters=chosen.settings))
    assert (given.bands, noise_share(given)) == (None, noise_share(chosen))
    monkeypatch.setattr("bench.identification.errors_in_variables.signal_bands", None)
    assert 0.0 < noise_share(chosen) < 1e-4
    with pytest.raises(TypeError):
        noise_share(given)


def test_a_given_low_pass_gets_the_border_that_it_needs(simulation: Simulation, true: np.ndarray) -> None:
    whole = sensed(simulation, encoder_bits=20, current_noise_ratio=0.01)
    fine = replace(whole, recordings=tuple(map(amid_the_motion, whole.recordings)))
    low = identify(prepare(problem_of(fine, filters={"position_cutoff": 8.0})))
    assert low.settings.border == (733, 733)  # 5.8 periods, and 8 samples
    given = {"position_cutoff": 8.0, "border": (150, 150)}
    disturbed = identify(prepare(problem_of(fine, filters=given)))
    assert disturbed.settings.border == (150, 150)
    assert low.error.identify is not None
    assert disturbed.error.identify is not None
    assert low.error.identify < 0.9 * disturbed.error.identify
    assert off(low, true)[1] < 3.0


def amid_the_motion(recording: Recording) -> Recording:
    part = slice(700, 4700)
    return replace(
        recording,
        time=recording.time[part],
        position=recording.position[part],
        current=recording.current[part],
    )


def test_a_little_noise_biases_least_squares_and_its_intervals_hold_that(
    simulation: Simulation, true: np.ndarray
) -> None:
    fine = sensed(simulation, encoder_bits=20, current_noise_ratio=0.001)
    result = identify(
        prepare(problem_of(fine, filters={"position_cutoff": 160.0, "decimation": 4})), method="ls"
    )
    assert result.findings[0].code == Code.NOISE_LET_THROUGH
    assert runaway(result) is None
    assert result.std_from == "instruments"
    assert off(result, true)[1] < 2.0
    std = np.sqrt(np.diag(result.covariance))
    gains = [i for i, one in enumerate(result.covariance_rows) if one.kind == "gain"]
    assert np.allclose(std[gains], [one.std for one in result.drive_gains.values()])


def test_an_estimator_has_two_places(project_root: Path) -> None:
    """Its own module aside, the names of estimators stand in one file alone: every list is taken from there."""
    quoted = re.compile(r'"wtls"|"tls"|"wls"')
    naming = {
        path.relative_to(project_root).as_posix()
        for path in (project_root / "bench").rglob("*.py")
        if quoted.search(path.read_text(encoding="utf-8"))
    }
    assert naming - {"bench/identification/estimators.py"} == set()
