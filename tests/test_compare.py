"""Where a model fails: errors made to order are found where they were put, and chance alone is not."""

import json
from dataclasses import replace

import numpy as np
import pytest

from bench.effects import CATALOGUE
from bench.identification.wording import with_error
from bench.residuals.as_json import where_json
from bench.residuals.autocorrelation import autocorrelation, correlations, integrated_autocorrelation_time
from bench.residuals.motor import compared, relative_error_of, relative_noise
from bench.residuals.opposing_motion import changes
from bench.residuals.periods import lines, position_spectrum, time_spectrum
from bench.residuals.profile import binned, dependences, profile
from bench.residuals.regions import concentrations, regions, shares
from bench.residuals.residuals import errors_by_motor
from bench.residuals.words import dependence_words, where_sentences, whole_sentences
from bench.signals.decimation import noise_bandwidth
from tests.compared_kit import (
    EVERY,
    NOISE,
    RATE,
    ROWS,
    SETTINGS,
    coloured,
    filtered,
    made,
    one_recording,
    robot,
    white,
)


def friction(row):
    return np.sign(row["velocity"])


def at_reversals(row, random):
    near = np.flatnonzero(np.diff(friction(row)) != 0)
    found = white(random)
    for i in near:
        found[i : i + 2] += 0.3 * random.choice((-1.0, 1.0))
    return found


def found_of(what, joint="left"):
    return next(one for one in errors_by_motor(what).motors if one.joint == joint)


def test_errors_at_reversals_are_found_there_and_said_so():
    motor = found_of(made(at_reversals))
    (one,) = motor.concentrations
    assert one.where.name == "reversals"
    assert one.error_share > 0.8
    assert one.time_share < 0.2
    assert (
        f"motor left, at reversals: {one.error_share:.0%} of the squared error in "
        f"{one.time_share:.0%} of the time".replace("%", " %")
        in where_sentences(errors_by_motor(made(at_reversals)))
    )


def test_whole_sentences_begin_with_a_capital_but_keep_the_name_of_a_joint():
    motor = found_of(made(at_reversals))
    assert all(line.startswith("Motor left") and line.endswith(".") for line in whole_sentences(motor))
    named = replace(motor, joint="motor_1", concentrations=(), dependences=(), lines=(), changes=(), alike=())
    assert whole_sentences(named)[0].startswith("motor_1: error ")


REGIONS = {
    "high speed": lambda row, random: white(random) * np.abs(row["velocity"]) ** 2,
    "low speed": lambda row, random: white(random) * (1.0 + 9.0 * (np.abs(row["velocity"]) < 0.5)),
    "high acceleration": lambda row, random: white(random) * np.abs(row["acceleration"]) ** 2,
    "forwards": lambda row, random: white(random) * (1.0 + 5.0 * (row["velocity"] > 0)),
    "start": lambda row, random: white(random) * (1.0 + 9.0 * (row["time"] < 4.0)),
    "high position": lambda row, random: white(random) * (1.0 + 9.0 * (row["position"] > 0.6)),
    "with payload disc": lambda row, random: white(random) * (8.0 if row["payload"] else 1.0),
}


@pytest.mark.parametrize("name", REGIONS)
def test_where_the_error_is_large_is_named_first(name):
    what = made(REGIONS[name], payloads=(None, "disc"))
    named = found_of(what).concentrations
    assert named
    assert named[0].where.name == name
    error, time = shares(
        what.of("left"), next(one for one in regions(what.of("left"), "rad", "A") if one.where.name == name)
    )
    assert (named[0].error_share, named[0].time_share) == (error, time)
    assert error > 1.5 * time


def test_a_second_region_is_looked_for_outside_the_first():
    def error(row, random):
        quiet = np.where(row["time"] < 4.0, 8.0, 1.0) * np.where(row["position"] > 0.6, 5.0, 1.0)
        return white(random) * quiet

    first, second = found_of(made(error)).concentrations
    assert {first.where.name, second.where.name} == {"start", "high position"}
    assert not first.of_rest
    assert second.of_rest


def test_shares_of_opposite_regions_are_one():
    what = made(at_reversals)
    series = what.of("left")
    found = {one.where.name: one for one in regions(series, "rad", "A")}
    for pair in (("forwards", "backwards"), ("recording 0.csv", "recording 1.csv")):
        both = np.array([shares(series, found[name]) for name in pair])
        np.testing.assert_allclose(both.sum(axis=0), 1.0)
    assert "without payload" not in found  # all of it


@pytest.mark.parametrize("alike", [0.0, 0.7, 0.9])
def test_errors_that_depend_on_nothing_are_said_to_be_spread(alike):
    """An autocorrelated error is no more than chance, whatever its size is."""
    random = np.random.default_rng(5)  # goes on, so that every data set is another one
    for _ in range(25):
        what = made(lambda row, _random: coloured(random, alike))
        (sentence,) = where_sentences(errors_by_motor(what))
        assert sentence.startswith("motor left: error ")
        assert sentence.endswith("spread over the whole motion")


def test_currents_that_are_noisier_above_the_band_hide_no_friction_in_it():
    """The noise of the current is read off above the band; the errors in its upper half say that it is less there."""
    floor = NOISE * np.sqrt(noise_bandwidth(EVERY))
    motor = found_of(made(lambda row, random: 0.9 * floor * friction(row) + filtered(random, 0.2 * floor)))
    assert motor.above_noise
    assert motor.error > 2.0 * motor.noise


def test_an_error_as_small_as_the_noise_is_not_looked_into():
    floor = NOISE * np.sqrt(noise_bandwidth(EVERY))
    what = made(lambda row, random: 0.2 * floor * friction(row) + filtered(random, 0.95 * floor))
    motor = found_of(what)
    assert relative_noise(what.of("left")) * np.sqrt(
        np.mean(what.of("left")[0].measured ** 2)
    ) == pytest.approx(floor, rel=0.05)
    assert not motor.above_noise
    assert not motor.dependences
    assert where_sentences(errors_by_motor(what))[0].endswith("nothing to explain")


DEPENDENCES = {
    "velocity": (lambda row: 0.05 * row["velocity"], "rad/s"),
    "position": (lambda row: 0.1 * np.cos(3.0 * row["position"]), "rad"),
    "acceleration": (lambda row: 0.004 * row["acceleration"] ** 2, "rad/s²"),
    "direction": (lambda row: 0.1 * friction(row), "backwards"),
    "time": (lambda row: 0.1 * np.sin(2.0 * np.pi * row["time"] / 18.0), "s"),
}


@pytest.mark.parametrize("variable", DEPENDENCES)
def test_what_the_error_follows_is_named_with_its_share(variable):
    follows, unit = DEPENDENCES[variable]
    what = made(lambda row, random: follows(row) + white(random))
    one = found_of(what).dependences[0]
    assert one.variable == variable
    series = what.of("left")
    errors = np.concatenate([each.error for each in series])
    share = 1.0 - 0.02**2 / np.mean(errors**2)  # all but the white part
    assert one.error_share == pytest.approx(share, abs=0.08)
    assert any(
        f"follows the {variable}" in line and unit in line for line in where_sentences(errors_by_motor(what))
    )


def test_a_constant_error_is_an_offset_and_follows_nothing():
    motor = found_of(made(lambda row, random: 0.1 + white(random)))
    (one,) = motor.dependences
    assert one.variable == "constant"
    assert dependence_words(one, motor.units).endswith("squared error is a constant offset of +0.1 A")


def test_friction_is_told_by_direction_with_its_sign():
    one = found_of(made(lambda row, random: 0.1 * friction(row) + white(random))).dependences[0]
    assert (one.low, one.high) == (pytest.approx(-0.1, abs=0.01), pytest.approx(0.1, abs=0.01))
    assert one.low_at < one.high_at


def test_friction_is_told_by_direction_where_a_little_that_is_left_lasts_long():
    """A slow swing of a twentieth of it is alike for long, which says nothing of how surely the friction is found."""

    def error(row, random):
        return 0.1 * friction(row) + 0.005 * np.sin(2 * np.pi * 0.05 * row["time"]) + 0.05 * white(random)

    first = found_of(made(error)).dependences[0]
    assert first.variable == "direction"
    assert first.error_share > 0.99


def test_what_repeats_over_position_is_found_with_its_period():
    what = made(lambda row, random: 0.06 * np.sin(40.0 * row["position"]) + white(random))
    (one,) = [line for line in lines(what.of("left")) if line.over == "position"]
    assert 2.0 * np.pi * one.frequency == pytest.approx(40.0, rel=0.02)
    assert one.amplitude == pytest.approx(0.06, rel=0.15)
    assert one.error_share == pytest.approx(0.06**2 / 2 / (0.06**2 / 2 + 0.02**2), rel=0.15)
    (said,) = [line for line in where_sentences(errors_by_motor(what)) if "times per turn" in line]
    turn = 2.0 * np.pi * one.resolution
    assert (
        f"{with_error(2.0 * np.pi * one.frequency, turn)} times per turn, as far as the travelled range shows"
        in said
    )


@pytest.mark.parametrize("times", [13.1, 17.0, 29.3, 40.0])
def test_a_period_is_known_within_half_a_cycle_of_the_travelled_range(times):
    what = made(
        lambda row, random: (
            0.06 * np.sin(times * row["position"]) + 0.05 * row["position"] ** 2 + white(random)
        )
    )
    (found,) = [line for line in lines(what.of("left")) if line.over == "position"]
    position = np.concatenate([trace.position for trace in what.of("left")])
    assert found.resolution == pytest.approx(0.5 / np.ptp(position))
    assert abs(found.frequency - times / (2.0 * np.pi)) < found.resolution


def test_what_swings_in_time_is_found_with_its_frequency_whatever_its_phase():
    what = made(
        lambda row, random: (
            0.06 * np.sin(2 * np.pi * 7.3 * row["time"] + random.uniform(0, 6)) + white(random)
        )
    )
    (one,) = [line for line in lines(what.of("left")) if line.over == "time"]
    assert one.frequency == pytest.approx(7.3, rel=0.003)
    assert one.resolution == pytest.approx(0.5 / 20.0, rel=0.01)
    assert one.amplitude == pytest.approx(0.06, rel=0.15)


def test_an_error_that_swings_as_the_robot_does_is_no_line():
    what = made(lambda row, random: 0.1 * row["velocity"] + white(random, 0.002))
    assert [line for line in lines(what.of("left")) if line.over == "time"] == []


def test_friction_that_warms_up_and_friction_that_grows_with_the_load():
    what = made(lambda row, random: 0.2 * np.exp(-row["time"] / 5.0) * friction(row) + white(random))
    (one,) = changes(what.of("left"))
    assert one.first.mean == pytest.approx(
        0.2 * 5.0 * (1 - np.exp(-20 / 15)) / (20 / 3), rel=0.05
    )  # of a third of 20 s
    assert one.second.mean < 0.01
    assert any("during warm-up" in line for line in where_sentences(errors_by_motor(what)))
    what = made(
        lambda row, random: (0.1 if row["payload"] else 0.0) * friction(row) + white(random),
        payloads=(None, "disc"),
    )
    (one,) = changes(what.of("left"))
    assert (one.first.part, one.second.part) == ("without payload", "with payload disc")
    assert one.second.mean - one.first.mean == pytest.approx(0.1, abs=0.01)


def test_memory_of_an_autoregressive_error_is_the_known_one():
    random = np.random.default_rng(1)
    values = [coloured(random, 0.8, rows=20000) for _ in range(3)]
    rows = [np.arange(20000)] * 3
    found = correlations(rows, values)
    np.testing.assert_allclose(found[:6], 0.8 ** np.arange(6), atol=0.02)
    assert integrated_autocorrelation_time(found) == pytest.approx((1 + 0.8) / (1 - 0.8), rel=0.1)
    # every third row missing: correlations are over time, not over what is left
    kept = np.flatnonzero(np.arange(20000) % 3)
    np.testing.assert_allclose(correlations([kept], [values[0][kept]])[:6], 0.8 ** np.arange(6), atol=0.04)


def test_white_errors_lie_within_the_band():
    what = made(lambda row, random: white(random))
    found = autocorrelation(what.of("left"))
    assert found.band == pytest.approx(1.959964 / np.sqrt(2 * ROWS))
    assert np.mean(np.abs(found.value[1:]) < found.band) > 0.85
    assert found.lag[1] == pytest.approx(EVERY / RATE)


def test_spectrum_over_time_holds_the_error_s_power():
    what = made(lambda row, random: coloured(random, 0.5))
    found = time_spectrum(what.of("left"))
    errors = np.concatenate([one.error for one in what.of("left")])
    assert np.trapezoid(found.density, found.frequency) == pytest.approx(np.mean(errors**2), rel=0.1)


def test_spectrum_over_position_has_the_amplitude_of_a_sinusoid():
    what = made(lambda row, random: 0.06 * np.sin(40.0 * row["position"]))
    found = position_spectrum(what.of("left"))
    assert found.amplitude.max() == pytest.approx(0.06, rel=0.1)
    assert found.share.max() > 0.9


def test_bins_hold_equal_counts_and_the_means_of_their_rows():
    random = np.random.default_rng(0)
    values, errors = random.normal(size=1200), random.normal(size=1200)
    found = profile(values, errors)
    assert set(found.count) == {100}
    assert (found.count * found.mean).sum() == pytest.approx(errors.sum())
    total = (found.count * (found.spread**2 + found.mean**2)).sum()
    assert total == pytest.approx((errors**2).sum())
    empty = binned(values, errors, np.array([0.0, 1.0, 100.0, 200.0]))
    assert np.isnan(empty.mean[2])
    assert empty.count[2] == 0


def test_standstill_is_left_out_and_does_not_make_a_reversal():
    def moving_but(still):
        moving = np.ones((ROWS, 1), dtype=bool)
        moving[still] = False
        return moving

    _, plain = one_recording(lambda row, random: white(random))
    reversal = int(np.flatnonzero(np.diff(np.sign(plain.velocity[:, 0])))[2])
    recording, series = one_recording(
        lambda row, random: white(random), moving=moving_but(slice(reversal - 5, reversal + 7))
    )
    what = compared(robot(), [recording], [series], SETTINGS)
    (one,) = what.of("left")
    assert len(one.time) == ROWS - 12
    assert one.near_standstill.sum() == 4
    assert not one.at_reversal[one.near_standstill].any()


@pytest.mark.parametrize("rows", [0, 5])
def test_a_motor_that_hardly_moves_is_passed_over(rows):
    still = np.zeros((ROWS, 2), dtype=bool)
    still[:, 0] = True
    still[100 : 100 + rows, 1] = True
    recording, series = one_recording(
        lambda row, random: white(random), joints=("left", "right"), moving=still
    )
    where = errors_by_motor(compared(robot(("left", "right")), [recording], [series], SETTINGS))
    assert [one.joint for one in where.motors] == ["left"]


def test_errors_and_noise_are_those_of_all_rows():
    what = made(at_reversals)
    series = what.of("left")
    errors, measured = (
        np.concatenate([getattr(one, name) for one in series]) for name in ("error", "measured")
    )
    assert relative_error_of(series) == pytest.approx(np.sqrt((errors**2).mean() / (measured**2).mean()))


def test_the_answer_is_plain_data_with_every_sentence():
    where = errors_by_motor(made(lambda row, random: 0.1 * friction(row) + at_reversals(row, random)))
    answer = json.loads(json.dumps(where_json(where), allow_nan=False))
    motor = answer["where"]["left"]
    told = [
        motor["text"],
        *(one["text"] for kind in ("concentrated", "follows", "repeats", "changes") for one in motor[kind]),
    ]
    assert told == answer["sentences"] == where_sentences(where)
    assert motor["by_recording"]["0.csv"]["error"] > motor["by_recording"]["0.csv"]["noise"] > 0


def test_the_same_series_give_the_same_answer():
    assert where_json(errors_by_motor(made(at_reversals))) == where_json(errors_by_motor(made(at_reversals)))


def test_few_rows_are_no_reason_to_fail():
    series = made(at_reversals).of("left")
    assert concentrations(series, []) == []
    assert isinstance(dependences(series[:1]), list)


ARM = {name: effect for name, effect in CATALOGUE.items() if effect.place != "passive"}


def alike_of(error, has=()):
    (motor,) = errors_by_motor(made(error), ARM, has).motors
    return motor.alike


def test_a_friction_is_said_to_look_like_the_frictions_of_the_atlas():
    first = alike_of(lambda row, random: 0.1 * friction(row) + white(random))[0]
    assert (first.seen, first.question) == ("opposes", 1)
    assert first.effects[0] == "coulomb_friction"
    assert "viscous_friction" not in first.effects
    first = alike_of(lambda row, random: 0.1 * row["velocity"] + white(random))[0]
    assert (first.seen, first.effects[0]) == ("velocity", "viscous_friction")
    first = alike_of(lambda row, random: 0.1 * np.sin(12.0 * row["position"]) + white(random))[0]
    assert first.seen == "repeats"
    assert {"cogging_torque", "torque_ripple", "transmission_error"} <= set(first.effects)
    assert alike_of(lambda row, random: white(random)) == ()


def test_what_the_model_has_already_is_no_candidate():
    def error(row, random):
        return 0.1 * friction(row) + white(random)

    assert "coulomb_friction" not in alike_of(error, ["coulomb_friction:left"])[0].effects
    assert "coulomb_friction" not in alike_of(error, ["coulomb_friction@recording"])[0].effects
    assert alike_of(error, ["coulomb_friction:right"])[0].effects[0] == "coulomb_friction"


def test_candidates_are_named_in_words_with_the_question_of_the_atlas():
    where = errors_by_motor(made(lambda row, random: 0.1 * friction(row) + white(random)), ARM)
    (said,) = [one for one in where_sentences(where) if "question 1" in one]
    assert said.startswith("motor left: Coulomb friction, ")
    assert said.endswith(" more would cause such an error (atlas of effects, question 1)")
    (told,) = [one for one in where_json(where)["where"]["left"]["looks_like"] if one["question"] == 1]
    assert told["text"] == said
    assert "coulomb_friction" in told["effects"]
