"""Joints that move alike: the answer says that an effect may sit in any of them."""

from collections.abc import Mapping

import pytest

from bench.api.diagnose import diagnose
from bench.diagnosis.as_json import diagnosis_json
from bench.diagnosis.result import Diagnosis
from bench.diagnosis.summary import summary_sentences
from bench.scenario.scenario import load_scenario
from bench.truth.dataset import as_dataset
from bench.truth.simulate import simulate

EFFECT = "passive_viscous_friction"


def diagnosed(scenario: str, changes: Mapping[str, object], joint: str, size: float) -> Diagnosis:
    hidden = [{"effect": EFFECT, "joint": joint, "Fv": size}]
    drawn = {"design": {"optimise": False, "duration": 6.0}, "hidden": hidden, **changes}
    return diagnose(as_dataset(simulate(load_scenario(scenario, drawn))), discover=False)


@pytest.fixture(scope="module")
def parallelogram() -> Diagnosis:
    """A palletiser, whose elbow turns as the rod does that drives it."""
    return diagnosed("palletiser", {}, "crank_rod", 40.0)


def test_a_friction_in_a_joint_that_moves_like_others_may_be_in_these(parallelogram: Diagnosis) -> None:
    (verdict,) = (each for each in parallelogram.ranking if each.effect == EFFECT)
    assert verdict.effect in parallelogram.missing
    possible = {place: {place, *others} for place, others in verdict.alike.items()}
    assert any({"elbow", "crank_rod"} <= every for every in possible.values())
    entries = {entry["effect"]: entry for entry in diagnosis_json(parallelogram)["ranking"]}
    assert entries[EFFECT]["alike_places"] == {place: list(others) for place, others in verdict.alike.items()}
    for place, others in verdict.alike.items():
        shares = [verdict.places[each] for each in (place, *others)]
        assert sum(shares) == pytest.approx(1.0)
        assert min(shares) == max(shares)
    assert any("could also be at" in sentence for sentence in summary_sentences(parallelogram))


def test_a_joint_that_moves_like_no_other_is_named_alone() -> None:
    """An elbow of a five-bar."""
    answer = diagnosed("five_bar", {}, "left_elbow", 0.3)
    (verdict,) = (each for each in answer.ranking if each.effect == EFFECT)
    assert verdict.actuators == ("left_elbow",)
    assert verdict.alike == {}
    assert not any("could also be at" in sentence for sentence in summary_sentences(answer))


def test_which_of_two_payloads_was_weighed_wrongly_is_open_and_the_gains_cover_both() -> None:
    """Their masses fix the gains by their ratio alone: a lighter one of them is a heavier other one."""
    wrong = {"mass": 2.0, "center_of_mass": [0.01, 0.0, 0.0], "inertia": [4e-3, 4e-3, 5e-3, 0, 0, 0]}
    declared = {"mass": 1.94, "center_of_mass": [0.01, 0.0, 0.0]}
    loads = {"unloaded": None, "loaded": "disc", "loaded2": "lump"}
    recordings = [
        {"name": name, "use": "identify", "design": {"seed": seed}} | ({"payload": load} if load else {})
        for seed, (name, load) in enumerate(loads.items(), 1)
    ]
    changes = {
        "design": {"optimise": False, "duration": 6.0},
        "payloads": {"lump": wrong | {"declared": declared}},
        "recordings": recordings,
    }
    simulation = simulate(load_scenario("five_bar", changes))
    answer = diagnose(as_dataset(simulation), discover=False)
    (verdict,) = (each for each in answer.ranking if each.effect == "payload_mass_error")
    assert verdict.effect in answer.missing
    assert {*verdict.alike, *(other for others in verdict.alike.values() for other in others)} == {
        "disc",
        "lump",
    }
    for gain, true in zip(
        answer.after.drive_gains.values(), simulation.machine.drive.true_gains, strict=True
    ):
        assert abs(gain.value - true) < 1.5 * gain.std
