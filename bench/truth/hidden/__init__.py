"""Effects that the simulated machine may have and that its dataset does not declare."""

from collections.abc import Mapping

from bench.basics.class_files import classes_of
from bench.truth.hidden import laws
from bench.truth.hidden.base import HiddenEffect, JointEffect

__all__ = ["HIDDEN_EFFECTS", "HiddenEffect", "JointEffect"]

HIDDEN_EFFECTS: Mapping[str, type[HiddenEffect]] = classes_of(laws)
"""Every effect by the name that a scenario uses, those outside the catalogue included (`in_catalogue`)."""
