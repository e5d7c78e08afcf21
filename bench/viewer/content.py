"""One recording with everything shown of it, and the sending of values to the viewer."""

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import rerun as rr
import rerun.blueprint as rrb

from bench.basics.files.atomic import atomic_path
from bench.dataset.payload import Payload
from bench.dataset.recording import Recording
from bench.document.colours import rgb
from bench.identification.effect_torques import EffectTorques
from bench.identification.result import CurrentSeries
from bench.viewer.body_motion import BodyMotion
from bench.viewer.context import KnownTruth

TIMELINE = "time"


@dataclass(frozen=True)
class Motor:
    """A driven joint: its name, its part of an entity path, the units of current, position and torque, its gain."""

    name: str
    entity: str
    current_unit: str
    position_unit: str
    effort_unit: str
    gain: float


@dataclass(frozen=True, eq=False)
class ShownContent:
    """One recording. root: the entity above all of its data; deviation (n,): of the fitted errors, drive unit.

    steps: labels and currents of earlier models; label: of the model that is shown. reference_path (F, 3) m: the
    controller's reference for the tool, at the times of the motion. simulated: motion of a robot drawn in outline.
    """

    root: str
    recording: Recording
    series: CurrentSeries
    motion: BodyMotion
    deviation: np.ndarray
    payload: Payload | None
    steps: tuple[tuple[str, CurrentSeries], ...] = ()
    label: str = ""
    torques: EffectTorques | None = None
    known: KnownTruth | None = None
    reference_path: np.ndarray | None = None
    simulated: BodyMotion | None = None

    @property
    def start(self) -> float:
        """The logged time of the first sample, s: time 0 in the viewer."""
        return float(self.recording.time[0])

    @property
    def has_torques(self) -> bool:
        """Whether there is a torque of effects to draw, identified or known."""
        by_effect = self.torques is not None and bool(self.torques.by_effect)
        return by_effect or (self.known is not None and self.known.torque is not None)

    def column(self, time: np.ndarray) -> rr.TimeColumn:
        """Logged times as whole nanoseconds since the first sample."""
        return rr.TimeColumn(TIMELINE, duration=nanoseconds(time - self.start))

    def send(
        self, stream: rr.RecordingStream, entity: str, time: np.ndarray, values: np.ndarray, curve: "Curve"
    ) -> None:
        """Send one curve of values (N,) at logged times (N,) to an entity below `root`."""
        path = f"{self.root}/{entity}"
        style = rr.SeriesLines(names=curve.name, colors=rgb(curve.colour), widths=curve.width)
        stream.log(path, style, static=True)
        columns = rr.Scalars.columns(scalars=values)
        stream.send_columns(path, indexes=[self.column(time)], columns=columns)


@contextmanager
def rrd_stream(
    path: str | Path, application: str, name: str, views: rrb.Blueprint
) -> Iterator[rr.RecordingStream]:
    """A stream into an .rrd file, written whole or not at all. The viewer keeps one layout for each application."""
    with atomic_path(path) as partial:
        stream = rr.RecordingStream(application)
        stream.save(partial, default_blueprint=views)
        stream.send_recording_name(name)
        yield stream
        stream.flush()
        stream.disconnect()


@dataclass(frozen=True)
class Curve:
    """How a series is drawn; width in points."""

    name: str
    colour: str
    width: float


def nanoseconds(seconds: np.ndarray) -> np.ndarray:
    """Times in whole nanoseconds, the type of the viewer's timeline."""
    return np.rint(seconds * 1e9).astype("timedelta64[ns]")
