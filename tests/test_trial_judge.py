"""Cases drawn from seeds, and answers held against them."""

import json
from dataclasses import fields

import numpy as np
import pytest

from bench.basics.errors import BenchError
from bench.dataset.robot import load_robot
from bench.effects import CATALOGUE
from bench.studies.sweep.journal import cell_of
from bench.studies.trial.cases import (
    KINDS,
    SETS_FROM,
    SHARES,
    SHARES_OF,
    Kind,
    TrialPlan,
    datasets_a_seed,
    draw_case,
)
from bench.studies.trial.compatible import compatible, exclusive, expected
from bench.studies.trial.intervals import as_logged, true_values
from bench.studies.trial.judge import Named, judgement_of
from bench.studies.trial.realise import hidden_places
from bench.studies.trial.setup import Setup, make_setup
from bench.studies.trial.summary import A_LAW, NOTHING, SOMETHING, placed, summarised
from bench.studies.trial.target import Share, TargetFigure
from bench.studies.trial.unknown import FAMILIES, LAW
from bench.truth.hidden import HIDDEN_EFFECTS
from bench.truth.hidden.laws.geometric_error import reach_of
from tests.trial_rows import trial_row

WITHOUT_TRUTH = {
    "backlash": {
        "Ia",
        "c",
    },  # the rotor's inertia is partly in the MJCF; the drag of the machine acts in contact, too
    "drive_flexibility": {"zeta"},
    "passive_load_friction": {"mum"},  # a mass of which only the model's parameters tell what it means
    "passive_spring": {"kq0"},  # of springs whose joints move alike, where they are counted from differs
}
"""Parameters of the model without a counterpart in the hidden effect."""


@pytest.fixture(scope="module")
def five_bar() -> Setup:
    return make_setup("five_bar", duration=6.0)


def test_every_parameter_of_the_catalogue_has_a_true_value() -> None:
    for name, effect in CATALOGUE.items():
        known = {one.name for one in effect.parameters} | set(effect.shape_values())
        hidden = {field.name: 2.0 for field in fields(HIDDEN_EFFECTS[name]) if field.name != "joint"}
        assert set(true_values(name, hidden)) == known - WITHOUT_TRUTH.get(name, set()), name


def test_true_values_come_from_the_fields_of_hidden_effects() -> None:
    for name in CATALOGUE:
        hidden = {field.name: 2.0 for field in fields(HIDDEN_EFFECTS[name]) if field.name != "joint"}
        assert all(np.isfinite(value) for value in true_values(name, hidden).values())
    assert true_values("cogging_torque", {"a": 1.0, "b": 2.0, "period": np.pi})["periods"] == pytest.approx(2)
    assert true_values("cogging_torque", {"a": 1.0, "b": 2.0, "period": 0.5}, slide=True)[
        "periods"
    ] == pytest.approx(2)


def test_what_an_encoder_offset_shifts_is_told_in_logged_positions() -> None:
    offset, period, position = 0.07, 0.4, np.linspace(-1, 1, 7)
    hidden = [
        {"effect": "cogging_torque", "joint": "left", "a": 0.3, "b": -0.2, "period": period},
        {"effect": "cogging_torque", "joint": "right", "a": 0.3, "b": -0.2, "period": period},
        {"effect": "encoder_offset", "joint": "left", "offset": offset},
        {"effect": "joint_spring", "joint": "left", "k": 2.0, "q0": 0.5},
        {"effect": "position_dependent_friction", "joint": "left", "a": 0.0, "b": 0.1},
    ]

    def periodic(one: dict[str, float], angle: np.ndarray) -> np.ndarray:
        return one["a"] * np.cos(angle) + one["b"] * np.sin(angle)

    told = as_logged(hidden)
    logged = position + offset
    w = 2 * np.pi / period
    np.testing.assert_allclose(periodic(told[0], w * logged), periodic(hidden[0], w * position))
    assert told[1:3] == hidden[1:3]
    assert told[3]["q0"] == pytest.approx(0.57)
    np.testing.assert_allclose(periodic(told[4], logged), periodic(hidden[4], position))


def test_a_case_is_the_same_in_whatever_order_it_is_drawn(five_bar: Setup) -> None:
    numbers = range(12)
    there = [draw_case(five_bar, "two", i) for i in numbers]
    back = [draw_case(five_bar, "two", i) for i in reversed(numbers)]
    assert there == back[::-1]
    assert len({case.effects for case in there}) > 6
    alone = draw_case(five_bar, "one", 3)
    assert alone == draw_case(five_bar, "one", 0, alone.effects) or alone.index != 0
    assert draw_case(five_bar, "one", 0, alone.effects).hides == alone.hides


@pytest.mark.parametrize("kind", [kind for kind in KINDS if kind != "unknown"])
def test_what_is_hidden_makes_sense(five_bar: Setup, kind: Kind) -> None:
    for index in range(60):
        case = draw_case(five_bar, kind, index)
        assert len(case.effects) == KINDS[kind]
        assert compatible(case.effects)
        for hide in case.hides:
            assert HIDDEN_EFFECTS[hide.effect].in_catalogue is (kind != "outside")
            low, high = SHARES_OF.get(hide.effect, SHARES)
            begin = low * (high / low) ** (SETS_FROM if KINDS[kind] > 1 else 0.0)
            assert 0.999 * begin <= hide.share <= 1.001 * high
            known = (*five_bar.motors, *five_bar.passive)
            assert set(hide.joints) <= set(known)


def test_unknown_laws_go_through_every_family_beside_none_one_or_two_effects(five_bar: Setup) -> None:
    cases = [draw_case(five_bar, "unknown", i) for i in range(3 * len(FAMILIES))]
    assert [len(case.effects) - 1 for case in cases[:6]] == [0, 1, 2, 0, 1, 2]
    assert all(case.effects[0] == LAW and case.hides[0].numbers for case in cases)
    assert len({tuple(name for name, _ in case.hides[0].numbers) for case in cases}) > 8
    assert cases[5] == draw_case(five_bar, "unknown", 5)
    assert five_bar.outside == tuple(name for name in five_bar.outside if name != LAW)


def test_a_set_that_begins_later_has_no_case_in_common(five_bar: Setup) -> None:
    here, apart = TrialPlan(five_bar, "unknown", 1), TrialPlan(five_bar, "unknown", 1, first=10)
    numbers = [run.number for (run,) in apart.tasks(lambda number: number == 12)]
    assert numbers == [10, 11, *range(13, 20)]
    assert not {here.case(i).seed for i in here.numbers} & {apart.case(i).seed for i in apart.numbers}


def test_one_goes_through_every_effect(five_bar: Setup) -> None:
    count = datasets_a_seed(five_bar, "one")
    drawn = {draw_case(five_bar, "one", i).effects[0] for i in range(count)}
    assert drawn == set(CATALOGUE)


def test_nested_effects_are_not_hidden_together() -> None:
    for name, effect in CATALOGUE.items():
        for part in effect.contains:
            assert exclusive(name, part), (name, part)


def test_an_effect_that_the_robot_cannot_have_is_named(five_bar: Setup) -> None:
    with pytest.raises(BenchError, match="nonsense"):
        draw_case(five_bar, "one", 0, ["nonsense"])
    with pytest.raises(BenchError, match="no 2 of these"):
        draw_case(five_bar, "two", 0, ["viscous_friction"])


def test_places_are_those_of_the_model(five_bar: Setup) -> None:
    hidden = [
        {"effect": "viscous_friction", "Fv": 1.0},
        {"effect": "geometric_error", "joint": "left_elbow", "error": 1e-3},
        {"effect": "base_tilt", "about_y": 0.1},
        {"effect": "payload_mass_error", "error": 0.1},
        {"effect": "current_crosstalk", "joint": "left", "c": 0.1},
    ]
    found = [(effect, place) for effect, place, _ in hidden_places(five_bar, hidden)]
    assert found == [
        ("viscous_friction", "left"),
        ("viscous_friction", "right"),
        ("geometric_error", "left_rod"),
        ("base_tilt", ""),
        ("payload_mass_error", "disc"),
    ]


def _named(effect: str, verdict: str = "missing", *alternatives: str) -> Named:
    return Named(effect, verdict, alternatives)


def test_the_right_name_first() -> None:
    answer = [_named("viscous_friction"), _named("base_tilt")]
    found = judgement_of(["viscous_friction"], ["viscous_friction"], answer)
    assert found.first
    assert not found.exact
    assert found.wrong == ("base_tilt",)
    assert judgement_of(["viscous_friction"], ["viscous_friction"], answer[:1]).exact


def test_undecided_counts_only_where_it_is_said() -> None:
    open_answer = [_named("current_delay", "indistinguishable", "current_loop_lag")]
    sure_answer = [_named("current_delay", "missing", "current_loop_lag")]
    found = judgement_of(["current_loop_lag"], ["current_loop_lag"], open_answer)
    assert (found.first, found.first_undecided, found.exact, found.exact_undecided) == (
        False,
        True,
        False,
        True,
    )
    assert found.wrong == ()
    found = judgement_of(["current_loop_lag"], ["current_loop_lag"], sure_answer)
    assert not found.first_undecided
    assert found.wrong == ("current_delay",)


def test_one_undecided_name_does_not_stand_for_two_effects() -> None:
    answer = [
        _named("current_delay", "indistinguishable", "current_loop_lag"),
        _named("encoder_offset", "indistinguishable", "geometric_error"),
    ]
    assert judgement_of(
        ["current_loop_lag", "geometric_error"], ["current_loop_lag", "geometric_error"], answer
    ).exact_undecided
    assert not judgement_of(
        ["current_loop_lag", "base_tilt"], ["current_loop_lag", "base_tilt"], answer
    ).exact_undecided


def test_companions_and_parts_are_neither_firsts_nor_wrong() -> None:
    drawn = ["position_dependent_friction"]
    wanted = expected(drawn)
    assert wanted == ("position_dependent_friction", "coulomb_friction")
    answer = [_named("coulomb_friction"), _named("position_dependent_friction")]
    found = judgement_of(drawn, wanted, answer)
    assert found.first
    assert found.exact
    assert not judgement_of(drawn, wanted, answer[:1]).first
    answer = [_named("drive_flexibility"), _named("backlash")]
    assert judgement_of(["backlash"], ["backlash"], answer).exact


def test_nothing_named_is_wrong_for_something_hidden() -> None:
    found = judgement_of(["viscous_friction"], ["viscous_friction"], [])
    assert not found.first_undecided
    assert not found.exact_undecided
    assert judgement_of([], [], []).exact


def test_shares_carry_their_uncertainty() -> None:
    low, high = Share(0, 50).interval
    assert low == 0.0
    assert high == pytest.approx(0.071, abs=2e-3)
    assert np.isnan(Share(0, 0).value)


def test_figures_of_a_trial() -> None:
    interval = '[{"effect": "viscous_friction", "parameter": "Fv", "truth": 1.0, "value": 1.1, "std": %s}]'
    rows = [
        trial_row("one", "viscous_friction", "viscous_friction", intervals=interval % 0.1),
        trial_row("one", "viscous_friction", "viscous_friction", intervals=interval % 0.01),
        trial_row("one", "viscous_friction", "base_tilt"),
        trial_row("one", "viscous_friction", "", least_own_error_over_floor=1.2),
        trial_row("one", "rotor_inertia", "", absorbed=True),
        trial_row("nothing", "", ""),
        trial_row("nothing", "", "", unexplained=True),
        trial_row("outside", "torque_drift", "", unexplained=True),
        trial_row("outside", "torque_drift", "viscous_friction", unexplained=True),
        trial_row("outside", "current_crosstalk", "", laws=2, **{"error_over_floor.after": 1.01}),
        trial_row("outside", "current_crosstalk", "", laws=1, **{"error_over_floor.after": 4.0}),
        {**trial_row("two", "", ""), "status": "failed", "reason": "lost"},
    ]
    found = summarised("robot", rows)
    targets = {target.figure: target for target in found.targets}
    assert targets[TargetFigure.ONE_FIRST].value == pytest.approx(2 / 3)
    assert targets[TargetFigure.ALARM].value == pytest.approx(0.5)
    assert targets[TargetFigure.OUTSIDE_HONEST].value == pytest.approx(0.75)
    assert targets[TargetFigure.OUTSIDE_LAW].share == Share(1, 2)  # of those in which laws were searched
    assert found.confusion["current_crosstalk"] == {A_LAW: 2}
    assert targets[TargetFigure.INTERVALS].value == pytest.approx(0.5)
    assert found.confusion["viscous_friction"] == {"viscous_friction": 2, "base_tilt": 1}
    assert found.confusion[NOTHING] == {NOTHING: 1, SOMETHING: 1}
    assert found.absorbed["rotor_inertia"] == Share(1, 1)
    assert [one.first.of for one in found.misses] == [1, 0, 3, 0, 0]
    assert found.failed == {"lost": 1}
    assert targets[TargetFigure.TWO_EXACT].reached is None


def test_the_motors_that_are_named_are_held_against_those_that_have_an_effect() -> None:
    def case(hidden: str, joints: str, *named: tuple[str, list[str]]) -> dict[str, object]:
        verdicts = json.dumps([{"effect": name, "actuators": at} for name, at in named])
        return trial_row("one", hidden, cell_of(n for n, _ in named), joints=joints, verdicts=verdicts)

    two = cell_of(("backlash", "viscous_friction"))
    rows = [
        case("viscous_friction", "left,right", ("viscous_friction", ["right", "left"])),
        case("viscous_friction", "left", ("viscous_friction", ["right", "left"])),  # one too many
        case("viscous_friction", "left,right", ("viscous_friction", ["left"])),  # one too few
        case("viscous_friction", "left", ("quadratic_drag", ["left"])),  # another effect
        case("base_tilt", "machine", ("base_tilt", ["left"])),  # at no motor
        case(two, cell_of(("left", "right")), ("viscous_friction", ["right"])),  # found beside a missed one
    ]
    assert placed(rows) == Share(2, 4)


@pytest.mark.parametrize(("robot", "without"), [("wrist", "joint_4"), ("orthoglide", "axis_1")])
def test_a_wrong_length_is_drawn_only_where_a_link_extends_to_one_side(robot: str, without: str) -> None:
    """A link along its hinge's axis, and a carriage with joints on both sides, have no length that may be wrong."""
    setup = make_setup(robot, duration=6.0)
    assert without not in setup.links
    model, tool = load_robot(robot).mjcf_model(), load_robot(robot).tool_site
    assert setup.links
    assert all(np.linalg.norm(reach_of(model, joint, tool)) > 1e-3 for joint in setup.links)
