"""The units at a joint, N·m and rad at a hinge or N and m at a slide, their relation to the unit of a gain, and
positions in them.
"""

from dataclasses import dataclass


@dataclass(frozen=True)
class JointUnits:
    """effort: unit of torque or force, as in a gain's unit; position: unit of the coordinate; turn: unit of periods
    over it.
    """

    effort: str
    position: str
    turn: str
    rotates: bool

    @property
    def spelled_effort(self) -> str:
        """The effort's unit for display."""
        return self.effort.replace("*", "·")


HINGE, SLIDE = JointUnits("N*m", "rad", "turn", rotates=True), JointUnits("N", "m", "m", rotates=False)


def joint_units(rotates: bool) -> JointUnits:
    """The units at a hinge (True) or a slide (False)."""
    return HINGE if rotates else SLIDE


def units_of_gain(gain_unit: str) -> JointUnits:
    """The units at the joint of a motor with such a gain: a slide for "N/A", a hinge for "N*m/A" and for units
    without an effort, such as "1".
    """
    return SLIDE if gain_unit.partition("/")[0] == SLIDE.effort else HINGE


def drive_unit(gain_unit: str) -> str:
    """The unit of the drive's current reference, such as "A" from "N*m/A"."""
    return gain_unit.partition("/")[2]


def written_position(position: float) -> float:
    """A joint position, rad or m, as it is written to a file: without the rounding errors of its computation."""
    return round(position, 12) + 0.0
