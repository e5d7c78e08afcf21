"""Which drive gains the payloads of the fitted recordings fix, as a value."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from enum import StrEnum, auto
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from bench.identification.solution import Fitted


class ScaleCase(StrEnum):
    """What the fitted recordings determine of the gains."""

    NOT_WANTED = auto()
    NO_PAYLOAD = auto()
    MASS_UNKNOWN = auto()
    NOT_FIXED = auto()
    FIXED_FOR_SOME = auto()
    FIXED = auto()


class ScaleRemedy(StrEnum):
    """What would fix gains: declaring more of the payload, mounting it elsewhere, other recordings."""

    MASS = auto()
    CENTER_OF_MASS = auto()
    INERTIA = auto()
    ELSEWHERE = auto()
    UNLOADED = auto()
    MOTION = auto()


@dataclass(frozen=True)
class Scale:
    """Which drive gains are unknowns of the fit.

    payloads: of the fitted recordings; open: joints whose gains these do not fix; held: joints whose gains stay
    nominal. remedies: the fewest changes that fix the most gains, and how many of `open` each fixes.
    """

    case: ScaleCase
    payloads: tuple[str, ...] = ()
    open: tuple[str, ...] = ()
    held: tuple[str, ...] = ()
    remedies: Mapping[tuple[ScaleRemedy, ...], int] = field(default_factory=dict)

    @property
    def complete(self) -> bool:
        """Whether all gains are unknowns."""
        return self.case is ScaleCase.FIXED

    def fitted(self, joints: Sequence[str]) -> Fitted:
        """Whether the gains of these joints are unknowns: all, none, or (n,) which."""
        if self.case is ScaleCase.FIXED_FOR_SOME:
            return np.array([joint not in self.held for joint in joints])
        return self.complete


NOT_WANTED = Scale(ScaleCase.NOT_WANTED)
