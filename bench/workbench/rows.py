"""Columns of variants of an effect over all recordings, filtered and decimated like the currents."""

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np

from bench.effects import ActuatorEffect, EffectInstance, JointSignals
from bench.identification.effect_columns import robot_signals
from bench.identification.effect_rows import effect_rows
from bench.identification.standstill import bridged_part
from bench.signals.decimation import decimate
from bench.workbench.directions import Directions
from bench.workbench.kinds import Kinds
from bench.workbench.small_perturbations import small_changes
from bench.workbench.variants import Variants


class Rows:
    """Rows (M, n, E D k) of all recordings: E variants, D parts of the present model, k parameters.

    D is one for what does not follow the present model; such rows need no directions.
    """

    def __init__(self, kinds: Kinds, directions: Directions | None = None) -> None:
        found = kinds.model.found
        self._unit, self._found = kinds.unit, found
        self._directions = directions
        self._joints = list(kinds.unit[0].joints)
        self._ticked = kinds.ticked
        self._seen = kinds.seen
        if directions is not None:
            models = directions.rigid_models()
            self._rigid = [robot_signals(found.model, one, models) for one in found.measured]
            self._rigid_seen = self._rigid if kinds.roomy else [small_changes(one) for one in self._rigid]
            self._needed = [
                directions.needed_torques(one, seen)
                for one, seen in zip(found.measured, found.signals, strict=True)
            ]

    def of(self, variants: Variants) -> np.ndarray:
        """The rows of an effect's variants."""
        take = {"rigid": self._through_loops, "needed": self._before_torque}.get(
            variants.follows, self._plain
        )
        return np.concatenate([take(i, variants) for i in range(len(self._unit))])

    def parts(self, variants: Variants) -> int:
        """D: the found model, and the directions in which others differ from it."""
        if self._directions is None or not variants.follows:
            return 1
        if variants.follows == "rigid":
            return 1 + self._directions.rigid.shape[1]
        return 1 + self._directions.needed[self._joints.index(variants.instance.joint)].shape[1]

    def _plain(self, recording: int, variants: Variants) -> np.ndarray:
        every = variants.every
        if not isinstance(every[0].effect, ActuatorEffect):
            signals = (self._found.signals if self._is_ticked(variants) else self._seen)[recording]
            return effect_rows(signals, self._found.settings.decimation, every)
        joint = self._unit[recording].joints[variants.instance.joint]
        return self._own(recording, variants, [joint])

    def _before_torque(self, recording: int, variants: Variants) -> np.ndarray:
        name = variants.instance.joint
        joint = self._unit[recording].joints[name]
        torques = self._needed[recording][self._joints.index(name)]
        return self._own(recording, variants, [replace(joint, needs=_given(one)) for one in torques])

    def _own(self, recording: int, variants: Variants, seen: Sequence[JointSignals]) -> np.ndarray:
        """Rows of an effect at its own motor, for each variant and each way to see the joint."""
        signals = self._unit[recording]
        at = self._joints.index(variants.instance.joint)
        columns = [_torque(one, joint) for one in variants.every for joint in seen]
        own = self._filtered(np.concatenate(columns, axis=1)[:, None], (signals.gaps[at],))
        rows = np.zeros((len(own), len(self._joints), own.shape[2]))
        rows[:, at] = own[:, 0]
        return rows

    def _through_loops(self, recording: int, variants: Variants) -> np.ndarray:
        """Rows of an effect on the rigid-body torque, which has D parts here: columns (N, n, k, D)."""
        seen = (self._rigid if self._is_ticked(variants) else self._rigid_seen)[recording]
        parts = self.parts(variants)
        count = len(variants.instance.effect.parameters)
        columns = []
        for one in variants.every:
            found = one.effect.columns(seen, one.joint)
            if found.ndim == 3:  # the loops cannot be closed: there is no column
                found = np.zeros((*found.shape, parts))
            columns.append(found.swapaxes(2, 3).reshape(*found.shape[:2], parts * count))
        return self._filtered(np.concatenate(columns, axis=2), seen.gaps)

    def _is_ticked(self, variants: Variants) -> bool:
        return (variants.instance.effect.name, variants.instance.joint) in self._ticked

    def _filtered(self, columns: np.ndarray, gaps: tuple[np.ndarray, ...]) -> np.ndarray:
        """Columns (N, n, c), bridged where joints stand still (in place), filtered and decimated."""
        whole = slice(0, len(columns))
        flat = bridged_part(columns, np.arange(len(columns)), whole, gaps, len(columns))
        flat = flat.reshape(len(columns), -1)
        filled = flat.any(axis=0)
        if filled.all():
            rows = decimate(flat, self._found.settings.decimation)
        else:
            kept = decimate(flat[:, filled], self._found.settings.decimation)
            rows = np.zeros((len(kept), flat.shape[1]))
            rows[:, filled] = kept
        return rows.reshape(len(rows), *columns.shape[1:])


def _torque(instance: EffectInstance, joint: JointSignals) -> np.ndarray:
    effect = instance.effect
    if not isinstance(effect, ActuatorEffect):
        raise TypeError(f"{effect.name} is not an effect of one motor")
    return effect.torque(joint)


def _given(torque: np.ndarray) -> Callable[[], np.ndarray]:
    return lambda: torque
