"""The change of the regressor by a model's effects on motion, lengths and gravity.

Columns of such effects are changes of the present model's torque, and so change with its parameters. Steps that neglect
this do not converge where the parameters are hardly determined.
"""

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from bench.basics.errors import BenchError
from bench.basics.interpolation import cubic_spline
from bench.effects import EffectInstance
from bench.identification.filtered import Measured
from bench.identification.layout import regressor_rows
from bench.identification.perturbations import few_samples, machine_rows
from bench.identification.perturbed_observation import geometry_key
from bench.identification.prepare import Prepared
from bench.model.geometry import Geometry
from bench.model.model import IdentificationModel
from bench.model.motion import motion_near
from bench.signals.decimation import decimated_indices

AS_MEASURED = b""  # the key of the unchanged machine


def regressor_change(prepared: Prepared) -> np.ndarray | None:
    """Change (M, n, p) of the fitted rows of all columns but those of effects, which are zero, by effects at the values
    about which they are linearised; None if these change nothing, or the loops cannot be closed with them.
    """
    changes = []
    for index, observation in enumerate(prepared.observations):
        if observation.use != "identify":
            continue
        try:
            changes.append(_of_recording(prepared, index))
        except BenchError:  # out of reach, or singular: values that no fit will keep
            return None
    return None if all(change is None for change in changes) else _stacked(prepared, changes)


def _stacked(prepared: Prepared, changes: list[np.ndarray | None]) -> np.ndarray:
    shapes = [(*observation.current.shape, prepared.layout.size) for observation in prepared.fitted]
    return np.concatenate(
        [np.zeros(shape) if change is None else change for shape, change in zip(shapes, changes, strict=True)]
    )


def _of_recording(prepared: Prepared, index: int) -> np.ndarray | None:
    """Computed at few samples, between which the change is smooth."""
    measured, observation = prepared.measured[index], prepared.observations[index]
    model = prepared.model
    geometry, offsets = _machine(model.geometry, prepared.effects, measured.recording.log)
    shift = np.array([offsets.get(joint, 0.0) for joint in model.geometry.robot.joints])
    if geometry is model.geometry and not shift.any():
        return None
    change = (
        _at_few_samples(model, measured, geometry, shift)
        if prepared.nearby is None
        else prepared.nearby.machine_change(index, geometry, -shift)
    )
    nb, end = len(model.base.columns), len(model.base.columns) + 10
    at_rows = cubic_spline(measured.time[few_samples(measured)], change)(observation.time)
    redundant = measured.redundant[decimated_indices(len(measured.time), prepared.settings.decimation)]
    changed = replace(
        observation,
        rigid=at_rows[:, :, :nb],
        payload=None if observation.payload is None else at_rows[:, :, nb:end],
        redundant=at_rows[:, :, end:] * redundant[:, None, :],
        effects=np.zeros((*observation.current.shape, prepared.layout.effects)),
    )
    return regressor_rows(changed, prepared.layout)


def _machine(
    geometry: Geometry, effects: Sequence[EffectInstance], log: str
) -> tuple[Geometry, Mapping[str, float]]:
    """The geometry, and the encoder offsets by joint, in a recording with these effects."""
    machine, offsets = geometry, dict[str, float]()
    for instance in effects:
        share, about = instance.share(log), instance.effect.about_values()
        if not share or not any(about.values()):
            continue
        values = share * np.array([about[parameter.name] for parameter in instance.effect.parameters])
        if offset := instance.effect.position_offset(values):
            offsets[instance.joint] = offsets.get(instance.joint, 0.0) + offset
        machine = instance.effect.machine(machine, instance.joint, values)
    return machine, offsets


def _at_few_samples(
    model: IdentificationModel, measured: Measured, geometry: Geometry, shift: np.ndarray
) -> np.ndarray:
    """Change (K, n, nb + 10 + r) of the regressor by a geometry and encoder offsets (n,); the last one is kept."""
    few = few_samples(measured)
    if AS_MEASURED not in measured.few:
        tree = measured.tree.at(few)
        measured.few[AS_MEASURED] = tree, machine_rows(model, model.geometry, tree)
    near, unchanged = measured.few[AS_MEASURED]
    key = geometry_key(geometry) + shift.tobytes()
    if key not in measured.few:
        rates = measured.velocity[few], measured.acceleration[few]
        there = motion_near(geometry, near, measured.position[few] - shift, *rates)
        measured.few.clear()
        measured.few[AS_MEASURED] = near, unchanged
        measured.few[key] = there, machine_rows(model, geometry, there)
    return measured.few[key][1] - unchanged
