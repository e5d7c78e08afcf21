"""What a recording for the viewer may tell beyond an identification: the way to it, and what a simulation knows."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from bench.document.numbers import Truth
from bench.identification.effect_torques import EffectTorques
from bench.identification.result import CurrentSeries


@dataclass(frozen=True, eq=False)
class KnownTruth:
    """What is known of one recording from elsewhere, S samples; what is None is not known.

    time (S,) s, as logged. reference (S, n) rad or m: the positions that the controller was asked for. torque
    (S, n) N*m or N: what hidden effects of a simulated machine ask of its motors; loop_gap (S, loops) m: how far
    its loops open.
    """

    time: np.ndarray
    reference: np.ndarray | None = None
    torque: np.ndarray | None = None
    loop_gap: np.ndarray | None = None

    def within(self, first: float, last: float) -> "KnownTruth":
        """The samples from one time to another, s."""
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
    """A model on the way to the one that is shown: words such as "+ coulomb friction", and its currents."""

    label: str
    recordings: Sequence[CurrentSeries]


@dataclass(frozen=True, eq=False)
class SimulatedPoses:
    """Where a simulated robot was during a recording: time (F,) s, as logged; poses (F, nq), MuJoCo's coordinates."""

    time: np.ndarray
    poses: np.ndarray


@dataclass(frozen=True, eq=False)
class ViewContext:
    """Everything that is shown with an identification.

    steps: the models before it, the first one first. torques: of the model's effects, and known, by recording
    name. truth: true values to compare with. text: Markdown above the summary. label: of the errors
    of the model that is shown, where there are steps. simulated: a robot that is drawn in outline in the place of the
    measured one, by recording name.
    """

    steps: tuple[LadderModel, ...] = ()
    torques: Mapping[str, EffectTorques] = field(default_factory=dict)
    known: Mapping[str, KnownTruth] = field(default_factory=dict)
    truth: Truth | None = None
    text: str = ""
    label: str = "the model shown"
    simulated: Mapping[str, SimulatedPoses] = field(default_factory=dict)
