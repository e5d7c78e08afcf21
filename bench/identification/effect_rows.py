"""The columns of effects at the rate of the fit, each computed once."""

from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np

from bench.basics.deadline import NEVER, Deadline
from bench.effects import ActuatorEffect, Effect, EffectInstance, RobotSignals
from bench.effects.checked_columns import columns_at_motors
from bench.effects.row_cache import KeptRows
from bench.identification.standstill import whole_interpolation
from bench.identification.tolerances import TOLERANCES
from bench.signals.decimation import decimate, decimate_sparse, decimated_indices


def effect_rows(
    signals: RobotSignals, decimation: int, effects: Sequence[EffectInstance], deadline: Deadline = NEVER
) -> np.ndarray:
    """The columns of effects in one recording, filtered and decimated like the currents, (M, n, ne).

    Raises TimeUpError after the deadline.
    """
    count = sum(len(effect_instance.effect.parameters) for effect_instance in effects)
    kept = len(decimated_indices(signals.length, decimation))
    rows = np.zeros((kept, len(signals.joints), count))
    parts: list[EffectInstance] = []
    places: list[tuple[np.ndarray, float]] = []
    at = 0
    for instance in effects:
        of_instance = rows[:, :, at : at + len(instance.effect.parameters)]
        at += of_instance.shape[2]
        for part, share in made_of(signals, instance):
            parts.append(part)
            places.append((of_instance, share))
    for i, values in _kept_or_computed(signals, decimation, parts, deadline):
        of_instance, share = places[i]
        of_instance += values if share == 1.0 else share * values
    return rows


def _kept_or_computed(
    signals: RobotSignals, decimation: int, effects: Sequence[EffectInstance], deadline: Deadline
) -> Iterator[tuple[int, np.ndarray]]:
    """The rows (M, n, k) of every effect, with its index, computed only where not known yet.

    Known rows come first, one effect at a time, so that not all are held at once. In a search, effects that are tried
    with many shapes or about many models are computed at few samples.
    """
    sources = [_seen_by(signals, instance.effect) for instance in effects]
    missing: list[int] = []
    for i, (seen, instance) in enumerate(zip(sources, effects, strict=True)):
        rows = _kept(seen, decimation, instance)
        if rows is None:
            missing.append(i)
        else:
            yield i, rows
    for seen in {id(sources[i]): sources[i] for i in missing}.values():
        indices = [i for i in missing if sources[i] is seen]
        together: list[tuple[int, np.ndarray, np.ndarray]] = []
        size = 0
        for i in indices:
            deadline.check()
            columns, motors = columns_at_motors(effects[i], seen)
            together.append((i, columns, motors))
            size += columns.nbytes
            if size > TOLERANCES.memory.filtered_bytes or i == indices[-1]:
                for k, rows in _filtered(seen, decimation, together):
                    _keep(seen, decimation, effects[k], rows)
                    yield k, rows
                together, size = [], 0


def _seen_by(signals: RobotSignals, effect: Effect) -> RobotSignals:
    often = bool(effect.shape) or effect.depends_on_model
    return signals.sparsely if often and not effect.every_sample else signals


def _filtered(
    signals: RobotSignals, decimation: int, given: Sequence[tuple[int, np.ndarray, np.ndarray]]
) -> Iterator[tuple[int, np.ndarray]]:
    """Columns (N, m, k) at motors (m,), interpolated and decimated, as rows (M, n, k); all at once."""
    flat = np.concatenate([columns.reshape(len(columns), -1) for _, columns, _ in given], axis=1)
    at_motor = np.concatenate([np.repeat(motors, columns.shape[2]) for _, columns, motors in given])
    decimated = _decimated(signals, decimation, flat, at_motor)
    at = 0
    for i, columns, motors in given:
        of_effect = decimated[:, at : at + columns.shape[1] * columns.shape[2]]
        at += of_effect.shape[1]
        rows = np.zeros((len(of_effect), len(signals.joints), columns.shape[2]))
        rows[:, motors] = of_effect.reshape(len(of_effect), len(motors), -1)
        yield i, rows


def _decimated(
    signals: RobotSignals, decimation: int, columns: np.ndarray, at_motor: np.ndarray
) -> np.ndarray:
    """Columns (N, p) of torques of motors (p,), interpolated in place at standstill, and decimated: (M, p)."""
    sparse = signals.sparse
    for motor in np.unique(at_motor):
        of_motor = np.flatnonzero(at_motor == motor)
        interpolation = whole_interpolation(signals.gaps[motor], len(columns))
        if sparse is None:
            interpolation.put(columns, of_motor)
        else:  # at the edges of a stretch, in proportion to the part inside
            interpolation.put_partly(columns, of_motor, sparse.shares[motor])
    if sparse is None:
        return decimate(columns, decimation)
    return decimate_sparse(columns, sparse.every, sparse.length, decimation)


def _kept(signals: RobotSignals, decimation: int, instance: EffectInstance) -> np.ndarray | None:
    try:
        return _memory(signals, instance).get((instance.effect, instance.joint, decimation))
    except TypeError:  # a user's class need not be hashable
        return None


def _keep(signals: RobotSignals, decimation: int, instance: EffectInstance, rows: np.ndarray) -> None:
    try:
        _memory(signals, instance).keep((instance.effect, instance.joint, decimation), rows)
    except TypeError:  # as above
        return


def _memory(signals: RobotSignals, instance: EffectInstance) -> KeptRows:
    """Where an effect's rows are kept: with the recording, or only while the present model is the same."""
    # it sees the motion of its motor only
    alone = isinstance(instance.effect, ActuatorEffect) and instance.joint in signals.joints
    passing = instance.effect.depends_on_model or not (alone or signals.as_measured)
    return signals.passing if passing else signals.lasting


def made_of(signals: RobotSignals, instance: EffectInstance) -> list[tuple[EffectInstance, float]]:
    """The effects whose columns, times their shares, add up to an effect's: itself, or in a search two at its nodes;
    none if its value is that of another recording.
    """
    if instance.recording:
        share = instance.share(signals.log)
        return (
            [
                (effect_instance, share * factor)
                for effect_instance, factor in made_of(signals, instance.everywhere())
            ]
            if share
            else []
        )
    nodes = instance.effect.nodes(signals, instance.joint) if signals.expands else None
    if nodes is None:
        return [(instance, 1.0)]
    ((name, value),) = instance.effect.about_values().items()
    furthest = TOLERANCES.shapes.expansion * nodes[1]
    if instance.effect.changes_machine and abs(value) > furthest:
        return [(instance, 1.0)]
    share = (float(np.clip(value, -furthest, furthest)) - nodes[0]) / (nodes[1] - nodes[0])
    low, high = (replace(instance, effect=instance.effect.about({name: node})) for node in nodes)
    return [(low, 1.0 - share), (high, share)]
