"""The twin simulated along every recording, as exported or with a change of its MJCF."""

import tempfile
from collections import defaultdict
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path

import numpy as np

from bench.basics.progress import Progress
from bench.effects import JointSignals
from bench.effects.effect import ActuatorEffect
from bench.export.identified import IdentifiedModel
from bench.export.mjcf import write_mjcf
from bench.export.physical import PhysicalSet
from bench.export.replay.track import FileChange, Lost, Tracked, track
from bench.export.sidecar import sidecar, write_sidecar
from bench.identification.filtered import Measured
from bench.identification.observation import all_currents
from bench.identification.prepare import Prepared
from bench.identification.result import CurrentSeries, relative_error
from bench.model.configuration import configuration_rates
from bench.model.geometry import Geometry, to_mujoco
from bench.model.motion import Motion
from bench.robot_check.contacts import GeomPair
from bench.twin import load_twin


@dataclass(frozen=True, eq=False)
class Recorded:
    """What a twin is compared with: the equations of all recordings, the exported bodies with their model, and the
    model's currents in each recording.
    """

    prepared: Prepared
    physical: PhysicalSet
    modelled: tuple[CurrentSeries, ...]


@dataclass(frozen=True, eq=False)
class Simulated:
    """The twin along the recordings, to the end or until it is lost.

    series: measured currents and those of the twin, at the fit's rate; tracked: of each recording up to that in which
    it is lost; left_out: effects of the model that the twin lacks.
    """

    series: tuple[CurrentSeries, ...]
    tracked: tuple[Tracked, ...]
    left_out: tuple[str, ...]

    @property
    def lost(self) -> Lost | None:
        """Where the twin no longer follows; None if it does."""
        return self.tracked[-1].lost if self.tracked else None

    @property
    def error(self) -> float:
        """Relative error of all currents; infinite if the twin is lost."""
        return float("inf") if self.lost is not None else relative_error(self.series) or 0.0

    @property
    def opened(self) -> float:
        """Largest opening of a loop or coupling, m or rad."""
        return max((tracked.opened for tracked in self.tracked), default=0.0)

    @property
    def touching(self) -> tuple[GeomPair, ...]:
        """Geoms that push each other, those with the largest impulse first."""
        impulses: defaultdict[GeomPair, float] = defaultdict(float)
        for tracked in self.tracked:
            for pair, impulse in tracked.touching.items():
                impulses[pair] += impulse
        return tuple(sorted(impulses, key=lambda pair: -impulses[pair]))


def simulate(recorded: Recorded, change: FileChange, progress: Progress) -> Simulated:
    """Export the model, with a change of the MJCF, and simulate it along every recording until it is lost."""
    physical, prepared = recorded.physical, recorded.prepared
    identified = physical.model
    series: list[CurrentSeries] = []
    tracked: list[Tracked] = []
    left_out: tuple[str, ...] = ()
    progress.phase(change.phase, len(recorded.modelled))
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "twin.xml"
        for measurement, modelled in zip(prepared.measured, recorded.modelled, strict=True):
            recording = measurement.recording
            exported = write_mjcf(path, physical, recording.payload, recording.log)
            write_sidecar(path, sidecar(physical, exported))
            twin = load_twin(path, partial=True)
            left_out = _left_out(identified, twin.left_out)
            start = _start(prepared.model.geometry, measurement.tree.at(slice(0, 1)))
            tracked.append(track(twin, identified.gains, measurement, start, change))
            if tracked[-1].lost is not None:
                break
            # interpolated at standstill, filtered and decimated as the measured currents are
            rows = all_currents(replace(measurement, current=_currents(identified, measurement, tracked[-1])))
            currents = np.asarray(np.diagonal(rows, axis1=1, axis2=2))
            series.append(replace(modelled, modelled=currents, by_effect={}))
            progress.advance()
    return Simulated(tuple(series), tuple(tracked), left_out)


def _start(geometry: Geometry, first: Motion) -> tuple[np.ndarray, np.ndarray]:
    """qpos and qvel at the first sample, in MuJoCo's coordinates."""
    velocity = first.v[0].copy()
    rates = configuration_rates(geometry, first.q.T, first.v.T, first.a.T)[0]
    for joint in geometry.joints:
        if joint.kind == "free":  # in MuJoCo, its linear velocity is along the world's axes
            velocity[joint.v.start : joint.v.start + 3] = rates[joint.q.start : joint.q.start + 3, 0]
    return to_mujoco(geometry.joints, first.q)[0], velocity


def _currents(identified: IdentifiedModel, measured: Measured, tracked: Tracked) -> np.ndarray:
    """Currents (N, n) that give these torques, through the effects between them."""
    total = tracked.torque.copy()
    rate = measured.recording.rate
    for fitted_effect in identified.effects_in(measured.recording.log):
        effect = fitted_effect.instance.effect
        if not effect.before_torque or not isinstance(effect, ActuatorEffect):
            continue
        j = identified.robot.joints.index(fitted_effect.place)
        needed = tracked.torque[:, j]
        signals = JointSignals(
            time=measured.time - measured.recording.time[0],
            position=measured.position[:, j],
            velocity=measured.velocity[:, j],
            acceleration=measured.acceleration[:, j],
            current=needed / identified.gains[j],
            gain=float(identified.gains[j]),
            speed=float(np.sqrt((measured.velocity[:, j] ** 2).mean())),
            rate=rate,
            band=measured.settings.band(rate),
            rotates=identified.model.geometry.active_joints[j].kind != "slide",
            needs=partial(np.asarray, needed),
        )
        total[:, j] += effect.torque(signals) @ np.array(list(fitted_effect.values.values()))
    return np.asarray(total / identified.gains)


def _left_out(identified: IdentifiedModel, by_twin: Sequence[str]) -> tuple[str, ...]:
    """What the twin omits, except effects between current and torque, which are computed afterwards."""
    between = {
        f"{effect.name} at {effect.place}"
        for effect in identified.effects
        if effect.instance.effect.before_torque and isinstance(effect.instance.effect, ActuatorEffect)
    }
    return tuple(name for name in by_twin if name not in between)
