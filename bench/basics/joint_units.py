"""The units at a joint: those of a hinge, N·m and rad, or of a slide, N and m; and what a gain's unit says of them."""

from dataclasses import dataclass


@dataclass(frozen=True)
class JointUnits:
    """effort: of what acts, as in a gain's unit; position: of its coordinate; turn: of what repeats over it."""

    effort: str
    position: str
    turn: str
    rotates: bool

    @property
    def spelled_effort(self) -> str:
        """The effort's unit as it is printed."""
        return self.effort.replace("*", "·")


HINGE, SLIDE = JointUnits("N*m", "rad", "turn", rotates=True), JointUnits("N", "m", "m", rotates=False)


def joint_units(rotates: bool) -> JointUnits:
    """At a hinge (True) or a slide (False)."""
    return HINGE if rotates else SLIDE


def units_of_gain(gain_unit: str) -> JointUnits:
    """At the joint of a motor with such a gain: "N*m/A" is of a hinge, "N/A" of a slide; of a hinge where it does not
    say, as in "1".
    """
    return SLIDE if gain_unit.partition("/")[0] == SLIDE.effort else HINGE


def drive_unit(gain_unit: str) -> str:
    """The unit in which the drive gives its current, as in "A" of "N*m/A"."""
    return gain_unit.partition("/")[2]
