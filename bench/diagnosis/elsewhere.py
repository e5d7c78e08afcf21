"""How recordings that were not fitted differ from those that were: a fitted recording tells nothing of it."""

from collections.abc import Collection, Iterator, Mapping, Sequence

import numpy as np

from bench.diagnosis.values_by_log import Place
from bench.effects import Effect, EffectInstance
from bench.identification.decision import RULE
from bench.identification.effect_rows import effect_rows
from bench.identification.findings import unlike
from bench.identification.prepare import Prepared
from bench.identification.result import Identification


def differing_elsewhere(
    model: Prepared, answer: Identification, catalogue: Mapping[str, Effect]
) -> frozenset[Place]:
    """Where recordings that were not fitted, modelled far worse than those that were, differ from these by a value of
    theirs, which takes most of a motor's error there away: as long as it is there, no effect shows.

    model: with its answer, and without values for each recording at these places.
    """
    if unlike(answer) is None:
        return frozenset()
    varying = [effect for effect in catalogue.values() if effect.varies_by_run]
    places = [(effect, joint) for effect in varying for joint in model.dataset.robot.joints]
    instances = [EffectInstance(effect, joint, f"{effect.name}:{joint}") for effect, joint in places]
    before, after = np.zeros(len(places)), np.zeros(len(places))
    motors = {joint: j for j, joint in enumerate(model.dataset.robot.joints)}
    for error, columns in _elsewhere(model, answer, instances):
        for i, (_, joint) in enumerate(places):
            j = motors[joint]
            before[i] += _residual_norm(error[:, j], columns[:, j, :0]) ** 2
            after[i] += _residual_norm(error[:, j], columns[:, j, i : i + 1]) ** 2
    best = {
        joint: min((i for i, place in enumerate(places) if place[1] == joint), key=lambda i: after[i])
        for _, joint in places
    }
    return frozenset(
        (places[i][0].name, joint) for joint, i in best.items() if after[i] < RULE.most * before[i]
    )


def worse_elsewhere(
    model: Prepared, answer: Identification, other: Identification, places: Collection[Place]
) -> bool:
    """Whether a model's answer explains clearly less of recordings that were not fitted than another, both given the
    values there that suit them best of what differs, by `places`.
    """
    common = {
        (instance.effect.name, instance.joint): instance.everywhere()
        for instance in model.effects
        if (instance.effect.name, instance.joint) in places
    }
    of_answer, of_other = (
        sum(
            _residual_norm(error.ravel(), columns.reshape(error.size, -1)) ** 2
            for error, columns in _elsewhere(model, each, [*common.values()])
        )
        for each in (answer, other)
    )
    return of_other < (1.0 - RULE.material) ** 2 * of_answer


def _elsewhere(
    model: Prepared, answer: Identification, instances: Sequence[EffectInstance]
) -> Iterator[tuple[np.ndarray, np.ndarray]]:
    """For every recording that was not fitted, the errors of the current (M, n) and what a unit of each effect would
    change of them (M, n, k); nothing in parts of fitted ones, whose values are known.
    """
    gains = np.array([answer.drive_gains[joint].value for joint in answer.joints])
    series = {trace.name: trace for trace in answer.recordings}
    for measured, signals in zip(model.measured, model.signals, strict=True):
        recording = measured.recording
        if recording.use == "identify":
            continue
        trace = series[recording.name]
        torque = effect_rows(signals, model.settings.decimation, instances)
        weight = 0.0 if recording.log in model.logs else 1.0
        columns = weight * torque / gains[:, None] * trace.moving[:, :, None]
        yield trace.error * trace.moving, columns


def _residual_norm(error: np.ndarray, columns: np.ndarray) -> float:
    """Length of an error (M,) outside columns (M, k)."""
    if not columns.any():
        return float(np.linalg.norm(error))
    return float(np.linalg.norm(error - columns @ np.linalg.lstsq(columns, error, rcond=None)[0]))
