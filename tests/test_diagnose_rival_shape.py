"""The shape of an effect that could replace a larger one, but is beside it."""

from dataclasses import replace

import pytest

from bench.diagnosis.with_catalogue import diagnose_with_catalogue
from bench.identification.problem import problem_of
from bench.scenario.scenario import load_scenario
from bench.truth.dataset import as_dataset
from bench.truth.simulate import simulate

NAMES = ("base_tilt", "cogging_torque")
TILT = {"effect": "base_tilt", "about_x": 0.0, "about_y": 0.0137}
COGGING = {"effect": "cogging_torque", "joint": "motor_2", "a": 0.0, "b": 0.0085, "period": 0.126}
DESIGN = {"optimise": False, "span": 0.2, "duration": 10.0}


def test_cogging_is_found_beside_a_tilt_that_slow_waves_could_replace() -> None:
    """A wave of five periods in a turn looks like a tilted weight; the cogging has fifty, and little of the error."""
    scenario = load_scenario("dualv", {"hidden": [TILT, COGGING], "design": DESIGN, "step": 0.0005})
    problem = problem_of(as_dataset(simulate(scenario)))
    found = diagnose_with_catalogue(
        replace(problem, catalogue={name: problem.catalogue[name] for name in NAMES})
    )
    assert found.missing == NAMES
    tilt, cogging = (verdict.actuators for verdict in found.ranking)
    assert tilt == ("motor_1", "motor_2", "motor_3", "motor_4")
    assert cogging == ("motor_2",)
    assert not found.unexplained.significant
    b = found.after.effect_parameters["cogging_torque"]["motor_2"]["b"]
    assert b.value == pytest.approx(COGGING["b"], abs=5 * b.std)
