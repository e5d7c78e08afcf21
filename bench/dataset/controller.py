"""The control law of the joints, if it is known: [controller] of dataset.toml."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import numpy as np
import numpy.typing as npt
from pydantic import Field

from bench.basics.errors import BenchError
from bench.basics.files.toml_input import UserTable
from bench.dataset.recording import Recording

Array = npt.NDArray[np.float64]
Number = Annotated[float, Field(strict=True, allow_inf_nan=False)]
PerJoint = Number | dict[str, Number]


class ControllerSpec(UserTable):
    """[controller]: one number for all driven joints, or a table that names each of them."""

    kp: PerJoint
    kv: PerJoint = 0.0
    ka: PerJoint = 0.0
    velocity_delay: Annotated[Number, Field(ge=0, lt=0.1)] = 0.0


@dataclass(frozen=True, eq=False)
class ControlLaw:
    """i = kp (r - q) + kv (dr/dt - dq/dt) + ka d2r/dt2, r the reference position of each joint, arrays (n,).

    kp, kv, ka: drive unit per rad, rad/s and rad/s2, or per m, m/s and m/s2. velocity_delay, s: delay of the velocity
    dq/dt that the law uses; for a backward difference, half the control period.
    """

    kp: Array
    kv: Array
    ka: Array
    velocity_delay: float = 0.0


def reference_column(joint: str) -> str:
    """The column of a recording with the reference position of a joint, rad or m."""
    return f"reference.{joint}"


def controller_of(path: Path, spec: ControllerSpec, joints: Sequence[str]) -> ControlLaw:
    """The law in the [controller] table of the file `path`; BenchError where a joint is missing or unknown."""
    kp, kv, ka = (_per_joint(path, key, getattr(spec, key), joints) for key in ("kp", "kv", "ka"))
    return ControlLaw(kp, kv, ka, spec.velocity_delay)


def references(recording: Recording, joints: Sequence[str]) -> Array:
    """Reference positions (N, n), rad or m. Raises BenchError for a missing column or a value that is not finite."""
    columns = [reference_column(joint) for joint in joints]
    missing = [name for name in columns if name not in recording.extra]
    if missing:
        raise BenchError(
            f"{recording.name}: no column {', '.join(missing)} with the reference that the controller follows"
        )
    values = np.column_stack([recording.extra[name] for name in columns])
    if not np.isfinite(values).all():
        late, joint = np.argwhere(~np.isfinite(values))[0]
        raise BenchError(f"{recording.name}: column {columns[joint]}, sample {late + 1}: not a number")
    return values


def _per_joint(path: Path, key: str, value: float | Mapping[str, float], joints: Sequence[str]) -> Array:
    if not isinstance(value, Mapping):
        return np.full(len(joints), float(value))
    unlike = sorted(set(value) ^ set(joints))
    if unlike:
        raise BenchError(f"{path}: controller.{key}: {', '.join(unlike)}: name each of {', '.join(joints)}")
    return np.array([float(value[joint]) for joint in joints])
