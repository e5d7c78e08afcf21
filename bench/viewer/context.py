"""What the viewer shows in addition to an identification: earlier models, and the truth of a simulation."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np

from bench.document.numbers import Truth
from bench.identification.effect_torques import EffectTorques
from bench.identification.result import CurrentSeries

if TYPE_CHECKING:
    from bench.export.replay.replay import TwinMotion


@dataclass(frozen=True, eq=False)
class KnownTruth:
    """Known values of one recording, S samples; None if unknown.

    time (S,) s, as logged. reference (S, n) rad or m: the controller's position references. torque (S, n) N*m or N:
    what the hidden effects of a simulated machine require of its motors; loop_gap (S, loops) m: opening of its loops.
    """

    time: np.ndarray
    reference: np.ndarray | None = None
    torque: np.ndarray | None = None
    loop_gap: np.ndarray | None = None

    def within(self, first: float, last: float) -> "KnownTruth":
        """The samples from time `first` to `last`, s."""
        inside = (self.time >= first) & (self.time <= last)
        if inside.all():
            return self
        values = [
            None if column is None else column[inside]
            for column in (self.reference, self.torque, self.loop_gap)
        ]
        return KnownTruth(self.time[inside], *values)


@dataclass(frozen=True, eq=False)
class LadderModel:
    """An earlier model of a diagnosis: a label such as "+ coulomb friction", and its currents."""

    label: str
    recordings: Sequence[CurrentSeries]


@dataclass(frozen=True, eq=False)
class ViewContext:
    """Everything that is shown with an identification.

    steps: the earlier models, the first one first. By recording name, torques: of the model's effects, known: known
    values, simulated: a robot drawn in outline at the place of the measured one. truth: true values to compare with.
    text: Markdown above the summary. label: of the shown model's errors, if there are steps.
    """

    steps: tuple[LadderModel, ...] = ()
    torques: Mapping[str, EffectTorques] = field(default_factory=dict)
    known: Mapping[str, KnownTruth] = field(default_factory=dict)
    truth: Truth | None = None
    text: str = ""
    label: str = "the model shown"
    simulated: Mapping[str, "TwinMotion"] = field(default_factory=dict)
