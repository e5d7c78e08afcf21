"""The expected machine before any measurement, and the information of its currents on each unknown."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from bench.basics.errors import BenchError
from bench.dataset.payload import Payload
from bench.dataset.recording import Recording
from bench.effects import EffectInstance, effect_columns
from bench.excitation.bounds import FORECAST
from bench.identification.effect_columns import PresentModel, robot_signals
from bench.identification.filtered import Measured
from bench.identification.finding import Finding
from bench.identification.layout import ParameterLayout, payload_columns
from bench.identification.standstill import no_gaps
from bench.model.model import IdentificationModel
from bench.model.motion import Motion
from bench.model.regressor import UNITS, projected_regressor
from bench.signals.settings import FilterSettings


@dataclass(frozen=True)
class Noise:
    """Expected noise of the log. current (n,): standard deviation, drive unit, or None for `ratio` times the RMS
    current of each recording; encoder (n,): its steps, rad or m; rate: samples per second; recorded: whether current
    noise is from recordings.
    """

    current: np.ndarray | None
    ratio: float
    encoder: np.ndarray
    rate: float
    recorded: bool = False

    def deviation(self, current: np.ndarray) -> np.ndarray:
        """Standard deviation (n,) of a recording's currents (N, n)."""
        if self.current is not None:
            return self.current
        return np.asarray(self.ratio * np.sqrt(np.mean(current**2, axis=0)))


@dataclass(frozen=True)
class Nominal:
    """A model with values: base parameters (nb,), gains (n,), payloads by name, and effects as further unknowns.

    layout: of the parameters; the gains follow if `gains_fitted`, when some payload's mass is known. source: of the
    values, in words. scale: why the declared payloads leave all gains open; None if they do not. doubts: reasons
    against values that recordings gave.
    """

    model: IdentificationModel
    base: np.ndarray
    gains: np.ndarray
    payloads: dict[str, Payload]
    layout: ParameterLayout
    effects: tuple[EffectInstance, ...]
    gains_fitted: bool
    noise: Noise
    source: str
    scale: Finding | None = None
    doubts: tuple[Finding, ...] = ()

    @property
    def size(self) -> int:
        """Number of unknowns."""
        return self.layout.size + (len(self.gains) if self.gains_fitted else 0)


@dataclass(frozen=True)
class SeenMotion:
    """Currents of a motion: derivatives (N, n, P) by the unknowns, and the currents (N, n)."""

    jacobian: np.ndarray
    current: np.ndarray

    @property
    def by_motor(self) -> np.ndarray:
        """The derivatives (n, P, N), as they lie in memory."""
        return self.jacobian.transpose(1, 2, 0)


def seen(nominal: Nominal, motion: Motion, payload: str | None) -> SeenMotion:
    """Currents along a motion, and their derivatives by every unknown."""
    return seen_each(nominal, motion, len(motion.time), payload)[0]


def seen_each(nominal: Nominal, motions: Motion, samples: int, payload: str | None) -> list[SeenMotion]:
    """The same for concatenated motions of `samples` each."""
    model, layout = nominal.model, nominal.layout
    columns = model.base.columns
    if payload is not None:
        columns = np.concatenate((columns, model.payload_columns))
    regressor = projected_regressor(model.geometry, motions, columns).transpose(
        1, 2, 0
    )  # (n, p, N), as it is made
    nb, n = layout.base, len(regressor)
    torque = nominal.base @ regressor[:, :nb]  # (n, N)
    jacobian = np.zeros((n, nominal.size, regressor.shape[2]))
    jacobian[:, :nb] = regressor[:, :nb]
    if payload is not None:
        if model.payload is None:
            raise BenchError(f"robot {model.geometry.robot.name}: a payload needs [tool] site in robot.toml")
        loads = model.payload.T @ regressor[:, nb:]
        torque += payload_columns(nominal.payloads[payload]).known @ loads
        if payload in layout.payloads:
            jacobian[:, layout.payload_slice(payload)] = loads[:, layout.payloads[payload]]
    each = [slice(at, at + samples) for at in range(0, torque.shape[1], samples)]
    if nominal.effects:
        for motion in each:  # an effect may have a memory
            columns = _effects(nominal, motions.at(motion), payload)
            jacobian[:, layout.effect_slice, motion] = columns.transpose(1, 2, 0)
    jacobian[:, : layout.size] /= nominal.gains[:, None, None]
    current = torque.T / nominal.gains
    if nominal.gains_fitted:
        own = np.arange(n)
        jacobian[own, layout.size + own] = -(current / nominal.gains).T
    return [SeenMotion(jacobian[:, :, motion].transpose(2, 0, 1), current[motion]) for motion in each]


def _effects(nominal: Nominal, motion: Motion, payload: str | None) -> np.ndarray:
    """Columns (N, n, ne) of all effects along a motion."""
    geometry = nominal.model.geometry
    active = geometry.active
    position = motion.q[:, geometry.active_configuration] + geometry.active_offset
    velocity, acceleration = motion.v[:, active], motion.a[:, active]
    current = np.zeros_like(position)
    rate = (len(motion.time) - 1) / float(motion.time[-1] - motion.time[0])
    settings = FilterSettings(position_cutoff=0.4 * rate, decimation=1)
    recording = Recording("planned", "identify", payload, motion.time, position, current)
    gaps = no_gaps(position.shape[1])
    measured = Measured(
        recording, settings, motion.time, position, velocity, acceleration, current, motion, gaps
    )
    declared = {name: payload_columns(load).known for name, load in nominal.payloads.items()}
    speeds = np.sqrt(np.mean(velocity**2, axis=0))
    present = PresentModel(nominal.gains, nominal.base, declared, declared, speeds)
    signals = robot_signals(nominal.model, measured, present)
    return np.concatenate([effect_columns(instance, signals) for instance in nominal.effects], axis=2)


@dataclass(frozen=True)
class Evidence:
    """Of a recording. grams (n, P, P): of the derivatives of each motor's currents, summed over the samples of the log;
    variance (n,) of its currents; samples of its log.
    """

    grams: np.ndarray
    variance: np.ndarray
    samples: float


@dataclass(frozen=True)
class Equations:
    """The fit of all recordings: its normal matrix (P, P), and the covariance (P, P) of its right side by noise."""

    normal: np.ndarray
    score: np.ndarray


def evidence(nominal: Nominal, what: SeenMotion, duration: float) -> Evidence:
    """Evidence of such a recording on all unknowns."""
    samples = nominal.noise.rate * duration
    grams = what.by_motor @ what.by_motor.transpose(0, 2, 1) * (samples / len(what.current))
    return Evidence(grams, nominal.noise.deviation(what.current) ** 2, samples)


def equations(recordings: Sequence[Evidence]) -> Equations:
    """The fit of the estimator, which weights each motor by its error over all recordings."""
    weight = 1.0 / pooled_variance(recordings)[:, None, None]
    normal = np.sum([(recording.grams * weight).sum(axis=0) for recording in recordings], axis=0)
    score = np.sum(
        [
            (recording.grams * weight**2 * recording.variance[:, None, None]).sum(axis=0)
            for recording in recordings
        ],
        axis=0,
    )
    return Equations(normal, score)


def pooled_variance(recordings: Sequence[Evidence]) -> np.ndarray:
    """The variance (n,) of each motor's currents over all recordings."""
    share = np.array([recording.samples for recording in recordings])
    return np.asarray(share @ np.array([recording.variance for recording in recordings]) / share.sum())


def reference_sizes(nominal: Nominal, recordings: Sequence[SeenMotion]) -> np.ndarray:
    """The size (P,) to which each unknown's standard error is relative.

    Of a gain: its value. Of a base parameter: its value, but at least a share of the largest of its unit. Of a
    payload's or an effect's: the value that gives a share of the RMS torque of a motor, over `recordings`.
    """
    layout = nominal.layout
    sizes = np.zeros(nominal.size)
    units = np.array(nominal.model.base.units)
    magnitudes = np.abs(nominal.base)
    largest = _largest_by_unit(magnitudes, units)
    sizes[: layout.base] = np.maximum(magnitudes, [FORECAST.smallest_size * largest[unit] for unit in units])
    torque = np.concatenate([motion.current * nominal.gains for motion in recordings])
    rms = np.sqrt(np.mean(torque**2, axis=0))
    columns = np.concatenate([motion.jacobian for motion in recordings]) * nominal.gains[:, None]
    for at in range(layout.base, layout.size):
        strength = np.sqrt(np.mean(columns[:, :, at] ** 2, axis=0))
        share = np.max(strength / rms)
        sizes[at] = FORECAST.effect_share / share if share > 0.0 else 1.0
    if nominal.gains_fitted:
        sizes[layout.size :] = nominal.gains
    return np.where(sizes > 0.0, sizes, 1.0)


def _largest_by_unit(magnitudes: np.ndarray, units: np.ndarray) -> dict[str, float]:
    """The largest magnitude (P,) of each unit.

    A body with mass m, inertia I and its centre of mass at a joint has the first moment s = 0, up to rounding in the
    file. Others of the same m and I have up to s = sqrt(m I): the largest s is taken to be at least that.
    """
    largest = {str(unit): float(magnitudes[units == unit].max()) for unit in sorted(set(units))}
    mass, first, inertia = dict.fromkeys(UNITS)
    if {mass, first, inertia} <= largest.keys():
        largest[first] = max(largest[first], float(np.sqrt(largest[mass] * largest[inertia])))
    return largest
