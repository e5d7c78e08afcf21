"""What a diagnosis finds in machines whose hidden effects are hard to tell from their neighbours."""

from dataclasses import replace

import pytest

from bench.dataset.dataset import Dataset
from bench.diagnosis.result import Diagnosis
from bench.diagnosis.with_catalogue import diagnose_with_catalogue
from bench.effects import CATALOGUE, EffectInstance
from bench.excitation.scenario import designer
from bench.identification.identify import fit
from bench.identification.nonlinear import converged
from bench.identification.prepare import prepare, with_effects
from bench.identification.problem import problem_of
from bench.identification.tolerances import LawBounds, Tolerances, bounded_by
from bench.scenario.scenario import load_scenario, resolve_trajectories
from bench.truth.dataset import as_dataset
from bench.truth.simulate import simulate
from tests.hidden_kit import STEP

NOISE_LEFT = 1.15  # times the noise floor: the largest error on recordings not fitted, with all effects found
PERIODS = 31.54  # a turn


def measured(*hidden: dict[str, object]) -> Dataset:
    """Measurements of a five-bar with these hidden effects."""
    changes = {"design": {"optimise": False, "duration": 8.0}, "hidden": list(hidden), "step": STEP}
    scenario = load_scenario("five_bar", changes)
    return as_dataset(simulate(scenario, resolve_trajectories(scenario, designer)))


def left_over_floor(found: Diagnosis) -> float:
    """Error on recordings not fitted after the last step of the ladder, over what the noise leaves."""
    assert found.ladder[-1].validate is not None
    return found.ladder[-1].validate / found.unexplained.noise_floor


@pytest.fixture(scope="module")
def cogging() -> Dataset:
    """Strong cogging of both motors."""
    sizes = {"left": 0.29, "right": 0.28}
    period = 0.1992
    return measured(
        *(
            {"effect": "cogging_torque", "joint": joint, "a": 0.0, "b": size, "period": period}
            for joint, size in sizes.items()
        )
    )


def test_strong_cogging_of_two_motors_needs_no_other_effect_beside_it(cogging: Dataset) -> None:
    found = diagnose_with_catalogue(problem_of(cogging))
    assert found.missing == ("cogging_torque",)
    assert left_over_floor(found) < NOISE_LEFT
    for joint in ("left", "right"):
        periods = found.after.effect_parameters["cogging_torque"][joint]["periods"]
        assert periods.value == pytest.approx(PERIODS, rel=1e-3)


def test_a_neighbour_of_the_same_periods_does_not_drive_an_effect_from_its_place(cogging: Dataset) -> None:
    """Torque ripple of the same periods takes most of the cogging up; what is left peaks elsewhere."""
    start = prepare(problem_of(cogging))
    known = {joint: (31.55, 31.61)[joint == "right"] for joint in ("left", "right")}
    instances = [
        EffectInstance(replace(CATALOGUE[name], periods=periods), joint, f"{name}:{joint}")
        for name in ("cogging_torque", "torque_ripple")
        for joint, periods in known.items()
    ]
    result = fit(converged(with_effects(start, instances)))
    for joint in known:
        periods = result.effect_parameters["cogging_torque"][joint]["periods"]
        assert periods.value == pytest.approx(PERIODS, rel=1e-3)


def test_a_passive_joint_that_sticks_does_not_look_like_other_effects() -> None:
    """The motors give way where an elbow sticks; sliding friction alone would leave twice the noise there."""
    found = diagnose_with_catalogue(
        problem_of(
            measured(
                {"effect": "passive_coulomb_friction", "joint": "right_elbow", "Fc": 0.1647},
                {"effect": "quadratic_drag", "joint": "left", "c": 0.068},
            )
        )
    )
    assert set(found.missing) == {"passive_coulomb_friction", "quadratic_drag"}
    assert left_over_floor(found) < NOISE_LEFT
    friction = found.after.effect_parameters["passive_coulomb_friction"]["right_elbow"]["Fc"]
    assert friction.value == pytest.approx(0.1647, rel=0.01)


def test_the_shadow_of_an_unknown_effect_is_not_taken_for_a_known_one() -> None:
    """Viscous friction that varies around the turn: most of it looks like plain viscous friction."""
    found = diagnose_with_catalogue(
        problem_of(
            measured(
                {"effect": "position_dependent_viscous_friction", "joint": "left", "a": -0.197, "b": 0.0035}
            )
        )
    )
    assert found.unexplained.significant
    named = {one.effect: one.verdict for one in found.ranking if one.effect in found.missing}
    assert "missing" not in named.values(), named


def test_a_friction_shows_beside_a_drift_that_has_taken_its_part() -> None:
    """A drift of long time constant stands for a friction that stays and one that fades, until both may move."""
    hidden = (
        {"effect": "thermal_friction_drift", "Fv": 0.1, "T": 2.4},
        {"effect": "viscous_friction", "Fv": 0.06},
    )
    dataset = measured(*hidden)
    with bounded_by(Tolerances(laws=LawBounds(of_time=5.0))):
        found = diagnose_with_catalogue(problem_of(dataset))
    assert set(found.missing) == {one["effect"] for one in hidden}
    assert left_over_floor(found) < NOISE_LEFT
    for place in found.after.effect_parameters["thermal_friction_drift"].values():
        assert place["T"].value == pytest.approx(2.4, rel=0.15)
