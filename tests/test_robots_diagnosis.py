"""One hidden effect in the robots that people own: it is named, where it is, and nothing else is."""

from dataclasses import dataclass

import pytest

from bench.diagnosis.with_catalogue import diagnose_with_catalogue
from bench.identification.problem import problem_of
from bench.scenario.scenario import load_scenario
from bench.truth.dataset import as_dataset
from bench.truth.simulate import simulate

SHORT = {"optimise": False, "duration": 4.0}
# Random movements (rad), where the design's own would leave what can be reached; long enough that friction along the
# position is another thing than friction.
STEPS = {"three_rrr": 0.00025}  # s, where its loops or what is hidden ask for less than 0.5 ms
OTHER = {"dualv": {"span": 0.2, "duration": 10.0}}
EXACT = 0.02  # of a parameter's true value


@dataclass(frozen=True)
class Case:
    """What is hidden at some joints of a robot, and what the model must find there; sizes as its motors have them."""

    robot: str
    effect: str
    joints: tuple[str, ...]
    hidden: dict[str, float]
    found: dict[str, float]


CASES = {
    "dry friction at the redundant motor of a DualV": Case(
        "dualv", "coulomb_friction", ("motor_4",), {"Fc": 0.03}, {"Fc": 0.03}
    ),
    "a spring at the elbow of a palletiser": Case(
        "palletiser", "passive_spring", ("elbow",), {"k": 400.0, "q0": -1.5}, {"k": 400.0, "kq0": -600.0}
    ),
    "dry friction that takes most of a wrist's torque": Case(
        "wrist", "coulomb_friction", ("motor_4", "motor_5", "motor_6"), {"Fc": 0.04}, {"Fc": 0.04}
    ),
    "an eccentric encoder of a 3-RRR": Case(
        "three_rrr",
        "transmission_error",
        ("motor_2",),
        {"a": 3e-4, "b": -4e-4, "period": 0.2},
        {"a": 3e-4, "b": -4e-4},
    ),
}


@pytest.mark.parametrize("name", CASES)
def test_what_is_hidden_is_named_where_it_is(name: str) -> None:
    case = CASES[name]
    hidden = [{"effect": case.effect, "joint": joint, **case.hidden} for joint in case.joints]
    design, step = SHORT | OTHER.get(case.robot, {}), STEPS.get(case.robot, 0.0005)
    scenario = load_scenario(case.robot, {"hidden": hidden, "design": design, "step": step})
    found = diagnose_with_catalogue(problem_of(as_dataset(simulate(scenario))))
    assert found.missing == (case.effect,)
    assert found.ranking[0].verdict == "missing"
    assert found.ranking[0].actuators == case.joints
    assert not found.unexplained.significant
    for joint in case.joints:
        for symbol, value in case.found.items():
            one = found.after.effect_parameters[case.effect][joint][symbol]
            assert one.value == pytest.approx(value, abs=5 * one.std + EXACT * abs(value)), symbol
