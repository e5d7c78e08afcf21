"""A payload whose estimated inertia no body has: said, and not believed."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from bench.dataset.dataset import Dataset, load_dataset
from bench.excitation.scenario import designer
from bench.identification.decision import DecisionRule
from bench.identification.finding import Code
from bench.identification.identify import fit, identify
from bench.identification.prepare import prepare
from bench.identification.problem import problem_of
from bench.identification.result import Identification
from bench.scenario.scenario import load_scenario, resolve_trajectories
from bench.truth.dataset import as_dataset
from bench.truth.simulate import simulate
from tests.hidden_kit import STEP

TRUE = np.array([0.02, 0.03, 0.06])


@pytest.fixture(scope="module")
def wrist() -> Dataset:
    """Two short recordings of a wrist, its payload's inertia not declared."""
    short = {"optimise": False, "duration": 6.0, "base_frequency": 0.5}
    recordings = [
        {"name": "unloaded", "use": "identify", "design": {"seed": 1}},
        {"name": "loaded", "use": "identify", "payload": "tool", "design": {"seed": 2}},
    ]
    scenario = load_scenario("wrist", {"recordings": recordings, "design": short, "step": STEP})
    return as_dataset(simulate(scenario, resolve_trajectories(scenario, designer)))


def carrying(dataset: Dataset, center: np.ndarray) -> Dataset:
    payload = replace(dataset.payloads["tool"], center_of_mass=center, inertia=None)
    return replace(dataset, payloads={"tool": payload})


def codes(result: Identification) -> set[Code]:
    return {one.code for one in result.findings}


def test_a_payload_as_declared_is_believed(wrist: Dataset) -> None:
    prepared = prepare(problem_of(carrying(wrist, TRUE)))
    result = identify(prepared)
    assert not codes(result) & {Code.PAYLOAD_IMPOSSIBLE, Code.PAYLOAD_TAKEN_AS_POINT}
    assert result.drive_gains == fit(prepared).drive_gains


def test_a_centre_too_far_away_makes_an_inertia_that_no_body_has(wrist: Dataset) -> None:
    prepared = prepare(problem_of(carrying(wrist, 1.5 * TRUE)))
    free, result = fit(prepared), identify(prepared)
    (found,) = [one for one in result.findings if one.code == Code.PAYLOAD_IMPOSSIBLE]
    assert found.names == ("tool",)
    assert found.numbers["least"] < -3.0 * found.numbers["std"]
    assert "physically impossible" in result.notes[0]
    for joint, gain in result.drive_gains.items():  # the inertia is needed: the gains stay, less certain
        assert gain.value == free.drive_gains[joint].value
        assert gain.std >= free.drive_gains[joint].std


def test_where_a_point_is_as_good_the_payload_is_one(wrist: Dataset, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(DecisionRule, "material", np.inf)
    center = 1.5 * TRUE
    dataset = carrying(wrist, center)
    prepared = prepare(problem_of(dataset))
    free, result = fit(prepared), identify(prepared)
    point = fit(
        prepare(
            problem_of(
                replace(dataset, payloads={"tool": replace(dataset.payloads["tool"], inertia=np.zeros(6))})
            )
        )
    )
    assert Code.PAYLOAD_TAKEN_AS_POINT in codes(result)
    assert result.error == point.error
    for joint, gain in result.drive_gains.items():
        assert gain.value == pytest.approx(point.drive_gains[joint].value, rel=1e-9)
        assert gain.std >= abs(gain.value - free.drive_gains[joint].value)
        assert gain.std >= free.drive_gains[joint].std
    values = {one.name: one for one in result.parameters}
    assert values["Izz(tool)"].value == pytest.approx(1.2 * (center[0] ** 2 + center[1] ** 2))
    assert [one.name for one in result.parameters] == [one.name for one in free.parameters]
    at = {one.place: i for i, one in enumerate(result.covariance_rows) if one.kind == "gain"}
    for joint, i in at.items():
        assert np.sqrt(result.covariance[i, i]) == pytest.approx(result.drive_gains[joint].std)


def test_the_surgical_arm_s_gains(measured_data: Path) -> None:
    folder = measured_data / "psm"
    if not folder.is_dir():
        pytest.skip("no measured logs of the surgical arm")
    result = identify(
        prepare(problem_of(load_dataset(folder), ["viscous_friction", "coulomb_friction", "constant_offset"]))
    )
    assert Code.PAYLOAD_TAKEN_AS_POINT in codes(result)
    for joint in ("j1", "j2"):
        gain = result.drive_gains[joint]
        assert abs(gain.value - 1.0) < min(0.05, 2.0 * gain.std)


def test_a_payload_that_is_taken_as_a_point_is_judged_in_the_same_rows(
    wrist: Dataset, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Rows that a diagnosis does not judge stay so: its models are compared, and written, row by row."""
    monkeypatch.setattr(DecisionRule, "material", np.inf)
    prepared = prepare(problem_of(carrying(wrist, 1.5 * TRUE)))
    first, *others = prepared.observations
    few = first.moving & (np.arange(len(first.moving)) % 3 > 0)[:, None]
    narrowed = replace(prepared, observations=(replace(first, moving=few), *others))
    result = identify(narrowed)
    assert Code.PAYLOAD_TAKEN_AS_POINT in codes(result)
    for series, observation in zip(result.recordings, narrowed.observations, strict=True):
        np.testing.assert_array_equal(series.moving, observation.moving)
