"""Robots that other people drew are accepted as they are: no check fails."""

import pytest

from bench.dataset.robot import load_robot
from bench.robot_check.check import check_robot
from bench.robot_check.outcome import CheckCode
from bench.robot_check.words import detail_of

NAMES = (
    "g1_ankle",
    "gep_5bar",
    "jurmy_delta",
    "kangaroo_leg",
    "monoped_fixed",
    "orbita",
    "reachy_mini",
    "spm",
)
ROUNDED = {"jurmy_delta", "orbita", "reachy_mini", "spm"}


@pytest.mark.parametrize("name", NAMES)
def test_they_are_accepted(name, measured_data):
    folder = measured_data / "foreign" / name
    if not folder.is_dir():
        pytest.skip("the robots that other people drew are not with the measured data (set PARABENCH_DATA)")
    report = check_robot(load_robot(folder))
    assert [detail_of(check) for check in report.failures] == []
    codes = {check.code for check in report.checks}
    assert CheckCode.BASE_PARAMETERS_AGREE in codes
    for check in report.checks:
        if check.code == CheckCode.JOINT_FORCE_NOT_MODELLED:  # what is offered exists
            places = {effect.partition(":")[2] for effect in check.values["effects"]}
            assert places <= {line.name for line in report.joints if line.kind in ("hinge", "slide", "ball")}
            assert places | set(check.values["unfitted"]) == set(check.values["joints"])
    assert (CheckCode.DRAWING_ROUNDED in codes) == (name in ROUNDED)
    home = next(check for check in report.checks if check.code == CheckCode.HOME_CLOSED)
    assert home.values["gap"] < 1e-9
