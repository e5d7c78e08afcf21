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
from bench.identification.effect_columns import encoder_offsets
from bench.identification.filtered import Measured
from bench.identification.layout import known_rows, regressor_rows
from bench.identification.observation import Observation
from bench.identification.observation_matrix import machine_rows
from bench.identification.perturbed_observation import geometry_key
from bench.identification.prepare import Prepared
from bench.identification.tolerances import TOLERANCES
from bench.model.geometry import Geometry
from bench.model.model import IdentificationModel
from bench.model.motion import motion_near
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


def machine_derivatives(
    prepared: Prepared, theta: np.ndarray, parameters: Sequence[tuple[int, int]]
) -> np.ndarray:
    """Derivatives (M, n, k) of the fitted torque by parameters of effects that change the machine, at the machine with
    all of them.

    theta (p,): the layout's unknowns. parameters: indices of an effect and of its parameter. Raises BenchError if the
    loops cannot be closed with the effects.
    """
    rows = sum(len(each.current) for each in prepared.fitted), prepared.fitted[0].current.shape[1]
    nothing = np.zeros(rows)
    derivatives = np.zeros((*rows, len(parameters)))

    def torque(instances: Sequence[EffectInstance]) -> np.ndarray:
        changes = regressor_change(replace(prepared, effects=tuple(instances)))
        return nothing if changes is None else changes[0] @ theta + changes[1]

    here = torque(prepared.effects)
    for column, (i, k) in enumerate(parameters):
        instances = list(prepared.effects)
        instance = instances[i]
        known = instance.effect.about_values()
        name = instance.effect.parameters[k].name
        step = TOLERANCES.shapes.difference * (
            abs(known[name]) or instance.effect.furthest(prepared.model.geometry, instance.joint)
        )
        for there in (step, -step):
            instances[i] = replace(
                instance, effect=instance.effect.about(known | {name: known[name] + there})
            )
            try:
                derivatives[:, :, column] = (torque(instances) - here) / there
            except BenchError:
                continue
            break
    return derivatives


def _changed(prepared: Prepared, index: int) -> Observation | None:
    """A recording's equations with the change of its columns in place of these; None if nothing changes."""
    measured, observation = prepared.measured[index], prepared.observations[index]
    model = prepared.model
    about, log = _about(prepared.effects), measured.recording.log
    geometry, offsets = _machine(model.geometry, about, log), encoder_offsets(about, log)
    shift = np.array([offsets.get(joint, 0.0) for joint in model.geometry.robot.joints])
    if geometry is model.geometry and not shift.any():
        return None
    every, decimation = prepared.signals[index].every, prepared.settings.decimation
    coarse = np.arange(0, len(measured.time), every)
    if prepared.nearby is None:
        change = _at_samples(model, measured, coarse, geometry, shift)
    else:
        knots = measured.time[prepared.nearby.few[index]]
        near = prepared.nearby.machine_change(index, geometry, -shift)
        change = cubic_spline(knots, near)(measured.time[coarse])
    shape = change.shape[1:]
    if len(coarse) < TOLERANCES.motion.sparse_samples:
        at_rows = cubic_spline(measured.time[coarse], change)(observation.time)
    else:
        flat = decimate_sparse(change.reshape(len(change), -1), every, len(measured.time), decimation)
        at_rows = flat.reshape(-1, *shape)
    nb, end = len(model.base.columns), len(model.base.columns) + 10
    redundant = measured.redundant[decimated_indices(len(measured.time), decimation)]
    return replace(
        observation,
        rigid=at_rows[:, :, :nb],
        payload=None if observation.payload is None else at_rows[:, :, nb:end],
        redundant=at_rows[:, :, end:] * redundant[:, None, :],
        effects=np.zeros((*observation.current.shape, prepared.layout.effects)),
    )


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
        rates = measured.velocity[some], measured.acceleration[some]
        there = motion_near(geometry, near, measured.position[some] - shift, *rates)
        measured.few.clear()
        measured.few[AS_MEASURED] = near, unchanged
        measured.few[key] = there, machine_rows(model, geometry, there)
    return measured.few[key][1] - unchanged
