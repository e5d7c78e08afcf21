"""Whether a payload is mounted the same way in all recordings that name it."""

from dataclasses import replace

import pytest

from bench.dataset.dataset import Dataset
from bench.diagnosis.mounting import mounted_otherwise
from bench.identification.finding import Code, Finding
from bench.identification.finding_words import note
from bench.identification.prepare import prepare
from bench.identification.problem import problem_of
from bench.scenario.scenario import load_scenario
from bench.truth.dataset import as_dataset
from bench.truth.simulate import simulate

OFF = 0.08  # m, by which the payload's centre is off the tool, to either side


@pytest.fixture(scope="module")
def turned() -> Dataset:
    """An arm that carries a payload, and carries it turned by half a turn."""
    ball = {"mass": 1.0, "center_of_mass": [OFF, 0.0, 0.0], "inertia": [4e-4, 4e-4, 4e-4, 0.0, 0.0, 0.0]}
    recordings = [
        {"name": "free", "use": "identify", "design": {"seed": 1}},
        {"name": "held", "use": "identify", "payload": "ball", "design": {"seed": 2}},
        {"name": "again", "use": "validate", "payload": "ball", "design": {"seed": 3}},
        {"name": "turned", "use": "validate", "payload": "other", "design": {"seed": 4}},
    ]
    changes = {
        "design": {"optimise": False, "duration": 5.0, "ramp": 0.5},
        "payloads": {"ball": ball, "other": {**ball, "center_of_mass": [-OFF, 0.0, 0.0]}},
        "recordings": recordings,
    }
    dataset = as_dataset(simulate(load_scenario("two_link", changes), threads=1))
    one_name = [replace(one, payload=one.payload and "ball") for one in dataset.recordings]
    return replace(dataset, recordings=tuple(one_name))


def found_in(dataset: Dataset, chosen: list[int], effects: tuple[str, ...] = ()) -> list[Finding]:
    some = replace(dataset, recordings=tuple(dataset.recordings[i] for i in chosen))
    return mounted_otherwise(prepare(problem_of(some, effects)))


@pytest.mark.parametrize("effects", [(), ("viscous_friction", "constant_offset")])
@pytest.mark.parametrize("known", [True, False])
def test_a_payload_that_was_turned_is_told_with_both_estimates(turned, known: bool, effects) -> None:
    dataset = turned
    if not known:
        ball = replace(turned.payloads["ball"], center_of_mass=None, inertia=None)
        dataset = replace(turned, payloads={"ball": ball})
    (one,) = found_in(dataset, [0, 1, 3], effects)
    assert one.code is Code.MOUNTED_OTHERWISE
    assert one.names[0] == "ball"
    assert set(one.names[2:]) == {"held.csv", "turned.csv"}
    values = dict(zip(one.names[2:], (one.numbers["first"], one.numbers["second"]), strict=True))
    difference = values["held.csv"] - values["turned.csv"]
    assert abs(difference) == pytest.approx(2.0 * OFF, rel=0.1), one.names[1]
    said = note(one)
    assert said.startswith("The payload ball is not mounted the same way in all recordings: m")
    assert {"held.csv", "turned.csv"} <= set(said.replace(".csv.", ".csv").split())


@pytest.mark.parametrize("chosen", [[0, 1, 2], [0, 1], [0, 1, 2, 2]])
def test_nothing_is_said_where_it_is_mounted_alike(turned, chosen: list[int]) -> None:
    names = iter("abcdef")
    dataset = replace(
        turned, recordings=tuple(replace(turned.recordings[i], name=next(names)) for i in chosen)
    )
    assert found_in(dataset, list(range(len(chosen)))) == []
