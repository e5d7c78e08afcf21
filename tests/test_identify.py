"""The main job: simulated measurements with known truth, and the identification that must recover it."""

import json
import shutil
from dataclasses import astuple, replace
from pathlib import Path

import numpy as np
import pytest

from bench.basics.errors import BenchError
from bench.dataset.catalogue import built_in_robots
from bench.dataset.dataset import Dataset
from bench.dataset.robot import load_robot
from bench.excitation.scenario import designer
from bench.identification.estimators import ESTIMATORS
from bench.identification.finding import Code
from bench.identification.identify import fit, identify
from bench.identification.model_file import apply_model, load_model, save_model
from bench.identification.model_json import to_json
from bench.identification.prepare import Prepared, prepare
from bench.identification.problem import problem_of
from bench.scenario.scenario import load_scenario, resolve_trajectories
from bench.studies.sweep.accuracy import accuracy, true_base_parameters
from bench.truth.dataset import as_dataset
from bench.truth.report import truth
from bench.truth.simulate import Simulation, simulate

GAIN_TARGET = {"five_bar": 0.0002, "delta": 0.001}
DURATION = {
    "five_bar_clean": 10.0,
    "delta_clean": 5.0,
}  # s, of which the gains are a tenth of their targets off
STEP = 0.001  # s


def simulated(name: str, overrides: dict[str, object]) -> Simulation:
    scenario = load_scenario(name, overrides)
    return simulate(scenario, resolve_trajectories(scenario, designer))


@pytest.fixture(scope="module", params=["five_bar_clean", "delta_clean"])
def clean(request: pytest.FixtureRequest) -> Simulation:
    duration = DURATION[request.param]
    return simulated(request.param, {"design": {"optimise": False, "duration": duration}, "step": STEP})


@pytest.fixture(scope="module")
def equations(clean: Simulation) -> Prepared:
    """Of the recordings without noise; nothing changes them."""
    return prepare(problem_of(as_dataset(clean)))


@pytest.fixture(scope="module")
def noisy(five_bar_simulation: Simulation) -> Simulation:
    return five_bar_simulation


def test_without_noise_gains_and_base_parameters_are_the_true_ones(
    clean: Simulation, equations: Prepared
) -> None:
    prepared = equations
    result = fit(prepared)
    assert accuracy(clean, result)["gain_error"] < GAIN_TARGET[clean.robot.name]
    expected = true_base_parameters(prepared.model, truth(clean))
    found = np.array([one.value for one in result.parameters])
    # what an error of a parameter does to the torque, as a share of the torque's RMS
    stack = np.concatenate([one.rigid for one in prepared.fitted]).reshape(-1, len(found))
    effect = np.linalg.norm(stack * (found - expected), axis=0) / np.linalg.norm(stack @ expected)
    assert effect.max() < 1e-3
    assert result.rank == result.unknowns


@pytest.mark.parametrize("method", sorted(set(ESTIMATORS) - {"oe"}))  # which needs a law: test_estimators.py
def test_every_estimator_recovers_the_gains_without_noise(
    method: str, clean: Simulation, equations: Prepared
) -> None:
    result = identify(equations, method=method)
    assert accuracy(clean, result)["gain_error"] < GAIN_TARGET[clean.robot.name]


@pytest.mark.parametrize("method", sorted(set(ESTIMATORS) - {"oe"}))  # which needs a law: test_estimators.py
def test_with_noise_gains_and_error_reach_the_noise(
    method: str, noisy: Simulation, five_bar_equations: Prepared
) -> None:
    metrics = accuracy(noisy, identify(five_bar_equations, method=method))
    assert metrics["gain_error"] < 0.004
    assert metrics["validate_error_over_noise_floor"] < 1.1


def test_the_answer_does_not_depend_on_the_masses_in_the_file(
    noisy: Simulation, five_bar_equations: Prepared, tmp_path: Path
) -> None:
    """Nor on when it is computed: from the same data, prepared anew, it is the same to the last bit."""
    shutil.copytree(built_in_robots()["five_bar"], tmp_path / "five_bar")
    model = tmp_path / "five_bar" / "five_bar.xml"
    text = model.read_text()
    changed = text.replace('mass="', 'mass="7').replace('fullinertia="', 'fullinertia="1')
    assert changed != text
    model.write_text(changed)
    dataset = as_dataset(noisy)
    other = replace(dataset, robot=load_robot(tmp_path / "five_bar"))
    assert to_json(identify(five_bar_equations)) == to_json(identify(prepare(problem_of(other))))


def only(dataset: Dataset, *names: str) -> Dataset:
    return replace(dataset, recordings=tuple(one for one in dataset.recordings if one.name in names))


def test_without_a_payload_the_gains_stay_nominal_and_the_answer_says_so(noisy: Simulation) -> None:
    result = identify(prepare(problem_of(only(as_dataset(noisy), "unloaded.csv", "unloaded_check.csv"))))
    assert not result.gains_fitted
    assert all(gain.value == gain.nominal and gain.std == 0 for gain in result.drive_gains.values())
    assert any("nominal" in note for note in result.notes)
    with pytest.raises(BenchError, match=r"tls.*payload of known mass"):
        identify(prepare(problem_of(only(as_dataset(noisy), "unloaded.csv"))), method="tls")


def test_a_loaded_recording_alone_gives_no_scale(noisy: Simulation) -> None:
    alone = only(as_dataset(noisy), "loaded.csv")
    result = identify(prepare(problem_of(alone)))
    assert not result.gains_fitted
    (found,) = [told for told in result.findings if told.code is Code.GAINS_NOT_FIXED]
    assert [unknown.place for unknown in found.of] == ["left", "right"]
    assert found.numbers == {"unloaded": 2.0}
    with pytest.raises(BenchError, match=r"cannot be fitted.* Also record a motion without it\."):
        prepare(problem_of(alone, fit_gains=True))


@pytest.mark.parametrize(
    ("center", "inertia", "unknown"),
    [(None, None, 3), ([0, 0, 0.02], None, 1), ([0, 0, 0.02], [1e-3, 1e-3, 2e-3, 0, 0, 0], 0)],
)
def test_unknown_payload_parameters_are_estimated(
    noisy: Simulation, center: list[float] | None, inertia: list[float] | None, unknown: int
) -> None:
    dataset = as_dataset(noisy)
    payload = replace(
        dataset.payloads["disc"],
        center_of_mass=None if center is None else np.array(center),
        inertia=None if inertia is None else np.array(inertia),
    )
    result = identify(prepare(problem_of(replace(dataset, payloads={"disc": payload}))))
    names = [one.name for one in result.parameters if "disc" in one.name]
    assert len(names) == unknown  # of a planar robot's payload: two first moments and one inertia at most
    metrics = accuracy(noisy, result)
    assert metrics["gain_error"] < 0.006
    assert metrics["validate_error_over_noise_floor"] < 1.1


def test_essential_parameters_fit_as_well(clean: Simulation) -> None:
    scenario = load_scenario(clean.scenario.name.removesuffix("_clean"))
    from bench.truth.resense import sense_again

    noisy = sense_again(clean, scenario)
    prepared = prepare(problem_of(as_dataset(noisy)))
    every, essential = fit(prepared), fit(prepared, essential=True)
    assert len(essential.parameters) + len(essential.left_out) == len(every.parameters)
    assert essential.error.validate < 1.02 * every.error.validate
    assert all(one.relative_std < 0.3 for one in essential.parameters)


def test_a_saved_model_gives_the_same_errors_again(noisy: Simulation, tmp_path: Path) -> None:
    dataset = as_dataset(noisy)
    result = identify(prepare(problem_of(dataset, ["viscous_friction", "coulomb_friction:left"])))
    save_model(result, tmp_path / "model.json")
    comparison = apply_model(problem_of(dataset), load_model(tmp_path / "model.json"))
    assert comparison.error.by_recording == pytest.approx(result.error.by_recording, rel=1e-9)
    content = json.loads((tmp_path / "model.json").read_text())
    assert content["drive_gains"]["left"]["nominal"] == 3.0
    assert content["effect_parameters"]["viscous_friction"]["left"]["Fv"]["unit"] == "N*m*s/rad"


def test_a_model_file_gives_back_the_answer_with_its_covariance_named(
    noisy: Simulation, tmp_path: Path
) -> None:
    dataset = as_dataset(noisy)
    result = identify(prepare(problem_of(dataset, ["stribeck_friction:left", "current_delay:right"])))
    save_model(result, tmp_path / "model.json")
    again = load_model(tmp_path / "model.json").applied_to(dataset, result.recordings)
    assert to_json(again) == to_json(result)
    stds = {("parameter", one.name, "", ""): one.std for one in result.parameters}
    stds |= {("gain", "gain", joint, ""): gain.std for joint, gain in result.drive_gains.items()}
    for effect, places in result.effect_parameters.items():
        for place, values in places.items():
            stds |= {("effect", name, place, effect): one.std for name, one in values.items()}
    del stds["effect", "delta", "left", "stribeck_friction"]  # a whole number, chosen
    rows = {
        astuple(one): std
        for one, std in zip(again.covariance_rows, np.sqrt(np.diag(again.covariance)), strict=True)
    }
    assert rows == pytest.approx(stds)


def test_hidden_friction_is_recovered_with_its_effects() -> None:
    hidden = [
        {"effect": "viscous_friction", "Fv": 0.12},
        {"effect": "coulomb_friction", "Fc": 0.2},
        {"effect": "constant_offset", "joint": "left", "c": -0.07},
    ]
    brief = {"design": {"optimise": False, "duration": 10.0}, "step": STEP}
    simulation = simulated("five_bar", {"hidden": hidden, **brief})
    dataset = as_dataset(simulation)
    plain = identify(prepare(problem_of(dataset)))
    result = identify(
        prepare(problem_of(dataset, ["viscous_friction", "coulomb_friction", "constant_offset"]))
    )
    assert plain.error.validate > 5 * result.error.validate
    assert accuracy(simulation, result)["gain_error"] < 0.005 < accuracy(simulation, plain)["gain_error"]
    for effect, name, value in (("viscous_friction", "Fv", 0.12), ("coulomb_friction", "Fc", 0.2)):
        for joint in ("left", "right"):
            assert result.effect_parameters[effect][joint][name].value == pytest.approx(value, rel=0.03)
    offsets = result.effect_parameters["constant_offset"]
    assert offsets["left"]["c"].value == pytest.approx(-0.07, abs=4 * offsets["left"]["c"].std)
    assert offsets["right"]["c"].value == pytest.approx(0.0, abs=4 * offsets["right"]["c"].std)
    assert max(one["c"].std for one in offsets.values()) < 0.01


@pytest.mark.parametrize(("factor", "asked"), [(1000.0, "in grams?"), (0.001, "in mA?")])
def test_a_payload_in_grams_is_asked_for(noisy: Simulation, factor: float, asked: str) -> None:
    dataset = only(as_dataset(noisy), "unloaded.csv", "loaded.csv")
    payloads = {
        name: replace(one, mass=factor * one.mass, inertia=factor * one.inertia)
        for name, one in dataset.payloads.items()
    }
    result = identify(prepare(problem_of(replace(dataset, payloads=payloads))))
    (note,) = [one for one in result.notes if "The estimated drive gains are about" in one]
    assert asked in note
    assert not any("far from its nominal" in one for one in result.notes)
