"""The change of the regressor by a model's effects on motion, lengths and gravity.

Columns of such effects are changes of the present model's torque, and so change with its parameters. Steps that neglect
this do not converge where the parameters are hardly determined.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from bench.basics.errors import BenchError
from bench.basics.interpolation import cubic_spline
from bench.effects import EffectInstance
from bench.identification.effect_columns import combined_torque, encoder_offsets
from bench.identification.filtered import Measured
from bench.identification.layout import known_rows, payload_columns, regressor_rows
from bench.identification.observation import Observation
from bench.identification.observation_matrix import machine_rows
from bench.identification.perturbed_observation import geometry_key, motion_in
from bench.identification.prepare import Prepared
from bench.identification.tolerances import TOLERANCES
from bench.model.geometry import Geometry
from bench.model.model import IdentificationModel
from bench.signals.decimation import decimate_sparse, decimated_indices

AS_MEASURED = b""  # the key of the unchanged machine


def regressor_change(prepared: Prepared) -> tuple[np.ndarray, np.ndarray] | None:
    """Changes of the fitted rows by effects at the values about which they are linearised: (M, n, p) of all columns but
    those of effects, which are zero, and (M, n) of the known torque; None if these effects change nothing.

    Raises BenchError if the loops cannot be closed with them.
    """
    changed = [
        _changed(prepared, index) if observation.use == "identify" else None
        for index, observation in enumerate(prepared.observations)
    ]
    if all(observation is None for observation in changed):
        return None
    layout, payloads = prepared.layout, prepared.dataset.payloads
    columns, known = [], []
    for observation, change in zip(prepared.observations, changed, strict=True):
        if observation.use == "identify":
            shape = observation.current.shape
            columns.append(
                np.zeros((*shape, layout.size)) if change is None else regressor_rows(change, layout)
            )
            known.append(np.zeros(shape) if change is None else known_rows(change, payloads))
    return np.concatenate(columns), np.concatenate(known)


def machine_derivatives(prepared: Prepared, theta: np.ndarray) -> np.ndarray:
    """Derivatives (M, n, k) of the fitted torque by all parameters of effects that change the machine, at the machine
    with all of them.

    theta (p,): the layout's unknowns. Zero where the loops cannot be closed with a small step; raises BenchError if
    they cannot be closed with the effects.
    """
    fitted = [
        index for index, observation in enumerate(prepared.observations) if observation.use == "identify"
    ]

    def torques(instances: Sequence[EffectInstance]) -> list[np.ndarray]:
        changed = replace(prepared, effects=tuple(instances))
        return [_changed_torque(changed, index, theta) for index in fitted]

    every, here = [], torques(prepared.effects)
    share = TOLERANCES.shapes.difference
    parameters = [
        (i, parameter.name)
        for i, instance in enumerate(prepared.effects)
        if instance.effect.changes_machine
        for parameter in instance.effect.parameters
    ]
    for i, name in parameters:
        instances = list(prepared.effects)
        effect, joint = instances[i].effect, instances[i].joint
        known, furthest = effect.about_values(), effect.furthest(prepared.model.geometry, joint)
        # a value of nearly zero gives no step that rounding leaves
        step_size = share * (abs(known[name]) if abs(known[name]) > share * furthest else furthest)
        derivatives = [np.zeros_like(torque) for torque in here]
        for step in (step_size, -step_size):
            instances[i] = replace(instances[i], effect=effect.about(known | {name: known[name] + step}))
            try:
                moved = torques(instances)
            except BenchError:  # at the edge of reach
                continue
            derivatives = [(after - before) / step for after, before in zip(moved, here, strict=True)]
            break
        every.append(
            np.concatenate(
                [_at_rows(prepared, index, rows) for index, rows in zip(fitted, derivatives, strict=True)]
            )
        )
    return np.stack(every, axis=2)


def check_closed(prepared: Prepared) -> None:
    """Raise BenchError if the loops cannot be closed with the effects at the values about which they are linearised."""
    for index, observation in enumerate(prepared.observations):
        if observation.use == "identify":
            _change(prepared, index)


def _changed_torque(prepared: Prepared, index: int, theta: np.ndarray) -> np.ndarray:
    """Change of a recording's torque (K, n) at the samples of `_change`; redundant motors at theirs."""
    measured, observation = prepared.measured[index], prepared.observations[index]
    layout, change = prepared.layout, _change(prepared, index)
    some = _samples(prepared, index)
    if change is None:
        return np.zeros((len(some), observation.current.shape[1]))
    load, name = np.zeros(10), observation.payload_name
    if name is not None:
        load = payload_columns(prepared.dataset.payloads[name]).known.copy()
        load[layout.payloads[name]] += theta[layout.payload_slice(name)]
    fitted = theta[layout.redundant_slice] if layout.redundant else 0.0  # else the gains stay nominal
    redundant_torque = measured.redundant[some] * (observation.nominal + fitted)
    return combined_torque(change, np.append(theta[: layout.base], load), redundant_torque)


def _changed(prepared: Prepared, index: int) -> Observation | None:
    """A recording's equations with the change of its columns in place of these; None if nothing changes."""
    measured, observation = prepared.measured[index], prepared.observations[index]
    change = _change(prepared, index)
    if change is None:
        return None
    at_rows = _at_rows(prepared, index, change)
    nb, end = prepared.layout.base, prepared.layout.base + 10
    redundant = measured.redundant[decimated_indices(len(measured.time), prepared.settings.decimation)]
    return replace(
        observation,
        rigid=at_rows[:, :, :nb],
        payload=None if observation.payload is None else at_rows[:, :, nb:end],
        redundant=at_rows[:, :, end:] * redundant[:, None, :],
        effects=np.zeros((*observation.current.shape, prepared.layout.effects)),
    )


def _change(prepared: Prepared, index: int) -> np.ndarray | None:
    """Change (K, n, nb + 10 + r) of a recording's regressor at few samples; None if nothing changes.

    Raises BenchError if the loops cannot be closed.
    """
    measured, model = prepared.measured[index], prepared.model
    about, log = _about(prepared.effects), measured.recording.log
    geometry, offsets = _machine(model.geometry, about, log), encoder_offsets(about, log)
    shift = np.array([offsets.get(joint, 0.0) for joint in model.geometry.robot.joints])
    if geometry is model.geometry and not shift.any():
        return None
    if prepared.nearby is None:
        return _at_samples(model, measured, _samples(prepared, index), geometry, shift)
    return prepared.nearby.machine_change(index, geometry, -shift)


def _samples(prepared: Prepared, index: int) -> np.ndarray:
    """Samples (K,) of `_change`."""
    if prepared.nearby is not None:
        return prepared.nearby.few[index]
    return np.arange(0, len(prepared.measured[index].time), prepared.signals[index].every)


def _at_rows(prepared: Prepared, index: int, values: np.ndarray) -> np.ndarray:
    """Values (K, ...) at the samples of `_change`, at the rows of a recording (M, ...)."""
    measured, decimation = prepared.measured[index], prepared.settings.decimation
    every, time = prepared.signals[index].every, measured.time
    coarse = time[::every]
    if prepared.nearby is not None:
        values = cubic_spline(time[prepared.nearby.few[index]], values)(coarse)
    if len(coarse) < TOLERANCES.motion.sparse_samples:
        return cubic_spline(coarse, values)(prepared.observations[index].time)
    flat = decimate_sparse(values.reshape(len(values), -1), every, len(time), decimation)
    return flat.reshape(-1, *values.shape[1:])


def _machine(geometry: Geometry, effects: Sequence[tuple[EffectInstance, np.ndarray]], log: str) -> Geometry:
    """The geometry in a recording with these effects at their values (p,)."""
    for instance, values in effects:
        if share := instance.share(log):
            geometry = instance.effect.machine(geometry, instance.joint, share * values)
    return geometry


def _about(effects: Sequence[EffectInstance]) -> list[tuple[EffectInstance, np.ndarray]]:
    """Effects with the values (p,) about which they are linearised, without those that are about nothing."""
    listed = []
    for instance in effects:
        about = instance.effect.about_values()
        if any(about.values()):
            names = [parameter.name for parameter in instance.effect.parameters]
            listed.append((instance, np.array([about[name] for name in names])))
    return listed


def _at_samples(
    model: IdentificationModel, measured: Measured, some: np.ndarray, geometry: Geometry, shift: np.ndarray
) -> np.ndarray:
    """Change (K, n, nb + 10 + r) of the regressor by a geometry and encoder offsets (n,) at samples (K,); the last one
    is kept.
    """
    if AS_MEASURED not in measured.few:
        tree = measured.tree.at(some)
        measured.few[AS_MEASURED] = tree, machine_rows(model, model.geometry, tree)
    near, unchanged = measured.few[AS_MEASURED]
    key = geometry_key(geometry) + shift.tobytes()
    if key not in measured.few:
        active = measured.position[some], measured.velocity[some], measured.acceleration[some]
        there = motion_in(geometry, model.geometry, near, *active, -shift)
        measured.few.clear()
        measured.few[AS_MEASURED] = near, unchanged
        measured.few[key] = there, machine_rows(model, geometry, there)
    return measured.few[key][1] - unchanged
