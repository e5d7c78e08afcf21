"""Whether a motor turns or slides is read off its gain's unit in one place."""

import re
from pathlib import Path

import pytest

from bench.basics.joint_units import HINGE, SLIDE, drive_unit, joint_units, units_of_gain


@pytest.mark.parametrize(
    ("unit", "at", "drive"),
    [
        ("N*m/A", HINGE, "A"),
        ("N*m/V", HINGE, "V"),
        ("N/A", SLIDE, "A"),
        ("N*m/(N*m)", HINGE, "(N*m)"),
        ("N/N", SLIDE, "N"),
        ("1", HINGE, ""),  # as a file may say of a log of torques; a tendon's joint is a hinge then
    ],
)
def test_a_gains_unit_tells_the_joint_and_the_drive(unit, at, drive):
    assert (units_of_gain(unit), drive_unit(unit)) == (at, drive)
    assert units_of_gain(unit) is joint_units(at.rotates)


def test_no_other_place_reads_it():
    reads = re.compile(r"""startswith\("N(\*m|/)|partition\("/"\)|"rad" if |"m" if .* else "rad\"""")
    apart = {"joint_units.py", "guard.py", "home.py"}  # an address; a gap in m or rad, whatever the joint
    found = [
        str(path)
        for path in Path("bench").rglob("*.py")
        if path.name not in apart and reads.search(path.read_text(encoding="utf-8"))
    ]
    assert not found
