"""The currents that a model predicts for a planned motion, and the rows of another model for them."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from bench.dataset.recording import Recording
from bench.effects import EffectInstance, RobotSignals, effect_columns
from bench.excitation.bounds import DISCRIMINATION
from bench.excitation.discrimination.rival_models import Rival
from bench.identification.effect_columns import robot_signals
from bench.identification.effect_rows import effect_rows
from bench.identification.filtered import Measured, passive_rates
from bench.identification.observation import Observation, observe
from bench.identification.standstill import interpolated, standstills
from bench.identification.tolerances import TOLERANCES
from bench.model.motion import Motion
from bench.scenario.trajectory import FourierTrajectory
from bench.signals.bounds import DECIMATING
from bench.signals.decimation import decimate


@dataclass(frozen=True)
class PlannedMotion:
    """A planned motion: its samples (N,), and the rows of the fit without currents."""

    measured: Measured
    rows: Observation

    @property
    def row_rate(self) -> float:
        """Rows of the fit a second, Hz."""
        return self.measured.recording.rate / DISCRIMINATION.decimation


def times_of(trajectory: FourierTrajectory, band: float) -> np.ndarray:
    """Times (N,) s at which a planned motion is evaluated, for a fit up to `band` Hz."""
    rate = DISCRIMINATION.decimation * 2.0 * band / DECIMATING.band
    return np.arange(int(trajectory.duration * rate) + 1) / rate


def planned(
    rival: Rival, trajectory: FourierTrajectory, time: np.ndarray, tree: Motion, payload: str | None
) -> PlannedMotion:
    """The rows of a motion that carries a payload or none; time (N,) of `times_of`, tree: all joints then."""
    position, velocity, acceleration = trajectory.evaluate(time)
    current = np.zeros_like(position)
    settings = replace(rival.prepared.settings, decimation=DISCRIMINATION.decimation, border=(0, 0))
    recording = Recording("planned", "identify", payload, time, position, current)
    passive = passive_rates(rival.prepared.model.geometry, tree)
    gaps = standstills(position, velocity, passive, recording.rate, settings.position_cutoff)
    measured = Measured(recording, settings, time, position, velocity, acceleration, current, tree, gaps)
    return PlannedMotion(measured, observe(rival.prepared.model, measured))


def predicted(rival: Rival, plan: PlannedMotion) -> np.ndarray:
    """Currents (N, n) that the model with its effect predicts, drive unit, without noise.

    If an effect, such as a delay, depends on the current, both are computed in turn.
    """
    gains, effects = rival.present.gains, rival.prepared.effects
    rigid = robot_signals(rival.prepared.model, plan.measured, rival.present).torque()
    current = np.asarray(rigid / gains)
    for _ in range(DISCRIMINATION.current_rounds):
        seen = _seen(rival, plan, current)
        columns = np.concatenate([effect_columns(instance, seen) for instance in effects], axis=2)
        before, current = current, np.asarray((rigid + columns @ rival.values) / gains)
        settled = DISCRIMINATION.current_settled * np.abs(current).max()
        if not rival.follows_current or np.abs(current - before).max() <= settled:
            break
    return current


def rows_with(rival: Rival, plan: PlannedMotion, current: np.ndarray) -> tuple[Observation, np.ndarray]:
    """Rows of `rival` if these currents (N, n) were logged, and its tangents (M, n, k)."""
    seen = _seen(rival, plan, current)
    effects = effect_rows(seen, DISCRIMINATION.decimation, rival.prepared.effects)
    seen_current = decimate(interpolated(current, plan.measured.gaps), DISCRIMINATION.decimation)
    rows = replace(plan.rows, current=seen_current, effects=effects)
    return rows, tangents(rival, [seen], DISCRIMINATION.decimation)


def tangents(rival: Rival, seen: Sequence[RobotSignals], decimation: int) -> np.ndarray:
    """Derivatives of the effects' torque by continuous shape parameters, (M, n, k) N*m or N per unit."""
    columns, at = [], 0
    for instance in rival.prepared.effects:
        values = rival.values[at : at + len(instance.effect.parameters)]
        at += len(values)
        for shape in instance.effect.shape:
            if shape.discrete:
                continue
            step = TOLERANCES.shapes.difference * (abs(instance.effect.shape_values()[shape.name]) or 1.0)
            moved = [_moved(instance, shape.name, d) for d in (-step, step)]
            low, high = (
                np.concatenate([effect_rows(signals, decimation, [m]) for signals in seen]) for m in moved
            )
            columns.append((high - low) @ values / (2.0 * step))
    if columns:
        return np.stack(columns, axis=2)
    rows = sum(len(effect_rows(signals, decimation, [])) for signals in seen)
    return np.zeros((rows, len(seen[0].joints), 0))


def _seen(rival: Rival, plan: PlannedMotion, current: np.ndarray) -> RobotSignals:
    return robot_signals(rival.prepared.model, replace(plan.measured, current=current), rival.present)


def _moved(instance: EffectInstance, name: str, step: float) -> EffectInstance:
    value = instance.effect.shape_values()[name] + step
    return replace(instance, effect=replace(instance.effect, **{name: value}))
