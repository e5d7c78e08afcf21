"""Tables that a person reads: every number is there, at every width."""

import io
import re
from dataclasses import replace

import numpy as np
import pytest
from rich.cells import cell_len
from rich.console import Console

from bench.dataset.robot import load_robot
from bench.document.numbers import (
    deviations_away,
    off_by,
    other_terms,
    percent,
    pretty_unit,
    rounded_terms,
    settings_lines,
    value_and_std,
)
from bench.document.table import Column
from bench.document.terminal.identification import comparison_report, identification_report
from bench.document.terminal.tables import Strip, fit_strips
from bench.identification.model_file import Comparison
from bench.identification.result import CurrentSeries, DriveGain, Quantity, relative_error
from tests.shown import LONG, dataset_of, identification_of

TRUTH = {"left": 3.3021, "mx(left_crank)": 0.35465, "viscous_friction:left.Fv": 0.114}


@pytest.fixture(scope="module")
def result():
    return identification_of(dataset_of(load_robot("five_bar")), effects=True, left_out=("mz(right_rod)",))


def printed(result, width=80, **options):
    console = Console(file=io.StringIO(), width=width, force_terminal=False)
    identification_report(result, console, **options)
    return console.file.getvalue()


@pytest.mark.parametrize(
    ("unit", "expected"),
    [("N*m/A", "N·m/A"), ("kg*m^2", "kg·m²"), ("N*m*s/rad", "N·m·s/rad"), ("s^-1", "s⁻¹"), ("kg", "kg")],
)
def test_units_are_printed_with_their_signs(unit, expected):
    assert pretty_unit(unit) == expected


@pytest.mark.parametrize(
    ("value", "std", "expected"),
    [
        (3.301345, 0.00149, ("3.3013", "0.0015")),
        (3.301345, 0.0996, ("3.30", "0.10")),
        (-0.0035812, 0.00057, ("-0.00358", "0.00057")),
        (-1.0e-8, 0.000066, ("0.000000", "0.000066")),
        (123.4, 17.2, ("123", "17")),
        (1234.5, 172.0, ("1234", "172")),
        (2.5, 0.0, ("2.5", "given")),
        (1.0e-9, 3.0e-11, ("1.0000e-09", "3.0e-11")),
    ],
)
def test_a_value_has_the_digits_that_its_deviation_supports(value, std, expected):
    assert value_and_std(value, std) == expected


@pytest.mark.parametrize(
    ("share", "expected"),
    [
        (None, "–"),
        (float("nan"), "–"),
        (0.0, "0.000 %"),
        (0.00126, "0.126 %"),
        (0.0996, "9.96 %"),
        (0.15892, "15.89 %"),
        (4.313, "431 %"),
        (float("inf"), ">1000 %"),
        (-23.0, "<-1000 %"),
        (3e-7, "3.0e-05 %"),
    ],
)
def test_percentages(share, expected):
    assert percent(share) == expected


def test_what_is_off_is_said_in_percent_and_in_deviations():
    quantity = Quantity(1.02, 0.01, "kg")
    negative = replace(quantity, value=-1.02)
    off = [off_by(quantity, 1.0), off_by(negative, -1.0), off_by(quantity, 0.0)]
    assert Column("off by", off, "change").texts == [
        "+2.00 %",
        "-2.00 %",
        "–",
    ]  # of one sign with the deviations
    away = [deviations_away(quantity, 1.0), deviations_away(replace(quantity, std=0.0), 1.0)]
    assert Column("in std", away, "sigma").texts == ["+2.0 σ", "–"]


def test_a_grouping_is_taken_apart_without_its_own_parameter():
    assert other_terms("m(left_rod)", LONG) == [
        "+ 0.25 m(right_rod)",
        "- 3.33333 Iyy(right_rod)",
        "+ 0.123457 mx(left_crank)",
    ]
    assert rounded_terms(["- 3.33333 Iyy(a)", "+ Iyy(a)", "+ 1234.56 m(b)"]) == [
        "- 3.33 Iyy(a)",
        "+ Iyy(a)",
        "+ 1.23e+03 m(b)",
    ]


@pytest.mark.parametrize("width", [60, 80, 100, 120, 200])
@pytest.mark.parametrize("truth", [None, TRUTH])
def test_the_report_fits_and_cuts_no_name(result, width, truth):
    text = printed(result, width, truth=truth)
    assert max(cell_len(line) for line in text.splitlines()) <= width
    if width >= 80:
        for word in (
            "left",
            "right",
            "mx(left_crank)",
            "mz(left_rod)",
            "Fv",
            "N·m·s/rad",
            "unloaded.csv",
            "kg·m²",
        ):
            assert re.search(rf"(?<![\w(.]){re.escape(word)}(?![\w).])", text), word
        assert "0.35535 ± 0.00070" in text
        assert "3.3000 ± 0.0015" in text
        assert not re.search(r"\S…", text)  # cut between terms, never inside a word


def test_gains_with_nominal_change_and_truth(result):
    line = next(line for line in printed(result, truth=TRUTH).splitlines() if line.startswith("left"))
    assert line.split() == [
        "left",
        "3.3000",
        "±",
        "0.0015",
        "0.045",
        "%",
        "N·m/A",
        "3",
        "+10.00",
        "%",
        "3.3021",
        "-0.064",
        "%",
        "-1.4",
        "σ",
    ]


def test_what_has_no_known_truth_is_left_blank(result):
    line = next(line for line in printed(result, truth=TRUTH).splitlines() if line.startswith("right"))
    assert line.split() == ["right", "3.3000", "±", "0.0015", "0.045", "%", "N·m/A", "3", "+10.00", "%"]


def test_poorly_determined_parameters_are_marked(result):
    lines = printed(result).splitlines()
    assert [line.split()[0] for line in lines if "! 60.06 %" in line] == ["mz(left_rod)"]
    assert "! 1 of 3 poorly determined: standard error above 30 % of the value" in lines


def test_groupings_are_shortened_by_whole_terms_and_full_when_asked(result):
    short = printed(result, 90)
    assert "+ 0.25 m(right_rod) … 2 more" in short
    assert "+ 0.2 m(left_rod) …" in printed(result, 80)
    assert LONG not in short
    assert LONG in printed(result, 120, verbose=True)


def test_errors_are_those_of_the_recordings_by_motor_and_in_all(result):
    lines = printed(result, 100).splitlines()
    fitted = [one for one in result.recordings if one.use == "identify"]
    expected = [*(percent(relative_error(fitted, j)) for j in (0, 1)), percent(result.error.identify)]
    assert (
        next(line for line in lines if line.startswith("all fitted")).split()[5:]
        == " ".join(expected).split()
    )
    seconds, rows = sum(np.ptp(one.time) for one in fitted), sum(len(one.time) for one in fitted)
    assert f"all fitted {seconds:.3g} s {rows} " in " ".join(" ".join(lines).split())
    check = next(line for line in lines if line.startswith("check.csv"))
    assert "not fitted" in check
    assert check.endswith(percent(result.error.validate))


def test_what_is_absorbed_has_no_value(result):
    nothing = Quantity(0.0, float("inf"), "kg*m^2")
    effects = {"rotor_inertia": {"left": {"Ia": nothing}}}
    line = next(
        one for one in printed(replace(result, effect_parameters=effects), 100).splitlines() if " Ia " in one
    )
    assert "absorbed" in line
    assert "inf" not in line


def test_many_motors_get_a_table_of_their_own(result):
    names = [f"axis_number_{i}" for i in range(8)]
    gain = DriveGain(2.2, 0.01, "N/V", 2.0)
    many = replace(
        result, drive_gains=dict.fromkeys(names, gain), recordings=tuple(map(widened, result.recordings))
    )
    text = printed(many)
    assert "The same by motor" in text
    for j, name in enumerate(names):
        line = text[text.index("The same by motor") :].split(name, 1)[1].splitlines()[0]
        wanted = percent(relative_error([one for one in many.recordings if one.use == "identify"], j))
        assert line.strip().startswith(wanted)


def widened(series: CurrentSeries) -> CurrentSeries:
    measured = np.tile(series.measured, (1, 4))
    moving = np.tile(series.moving, (1, 4))
    return replace(series, measured=measured, modelled=measured + 0.01 * np.arange(8), moving=moving)


def test_gains_that_were_not_fitted_are_said_to_be_nominal():
    result = identification_of(dataset_of(load_robot("five_bar")), gains_fitted=False)
    text = printed(result)
    assert "Drive gains, kept at their nominal values" in text
    line = next(line for line in text.splitlines() if line.startswith("left"))
    assert line.split() == ["left", "3", "N·m/A"]


def test_settings_say_rank_conditioning_and_rates(result):
    equations, still, condition, filters = settings_lines(result)
    rows = sum(one.measured.size for one in result.recordings if one.use == "identify") - 12
    assert equations == f"{rows} equations, 5 unknowns, rank 5"
    assert still == "12 more equations excluded because a joint stands still"
    assert "312.4" in condition
    assert "41.5" in condition
    assert filters == "positions low-passed at 40 Hz, fit at 40 Hz (one sample in 25)"


def test_notes_and_what_was_left_out_are_told(result):
    text = " ".join(printed(result).split())
    assert result.notes[0] in text
    assert "omitted because the data do not need them: mz(right_rod)" in text


def test_a_comparison_is_told_by_recording_and_motor(result):
    console = Console(file=io.StringIO(), width=80)
    comparison_report(Comparison("five_bar", "model.json", result.recordings, result.error), console)
    text = console.file.getvalue()
    assert "model model.json" in text
    for name, error in result.error.by_recording.items():
        assert re.search(rf"{re.escape(name)} .*{re.escape(percent(error))}", text)


def test_columns_of_the_highest_rank_go_first():
    columns = [Strip("a", ["x" * 10]), Strip("b", ["y" * 10], rank=1), Strip("c", ["z" * 10], rank=2)]
    assert [column.header for column in fit_strips(columns, 34).strips] == ["a", "b", "c"]
    assert fit_strips(columns, 34).gap == 2
    assert fit_strips(columns, 32).gap == 1
    assert [column.header for column in fit_strips(columns, 31).strips] == ["a", "b"]
    assert [column.header for column in fit_strips(columns, 5).strips] == ["a"]
    assert fit_strips(columns, 5).room == -5
