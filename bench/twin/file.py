"""NAME.twin.json next to an exported MJCF: the motors, and the effects that MJCF cannot represent."""

import json
from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path

from bench.basics.errors import BenchError
from bench.basics.files.sidecar_path import sidecar_path
from bench.effects import Effect, EffectInstance, catalogue_for

FORMAT = 1
STEPS_TO_STICK = (
    4.0  # time constant of dry friction, time steps: MuJoCo's default of 20 ms lets a joint creep
)
STIFF = [0.99, 0.999, 1e-4, 0.5, 2.0]


@dataclass(frozen=True)
class SidecarMotor:
    """A driven joint. gain: N*m or N per unit of current; actuator: name of the motor in the MJCF."""

    joint: str
    gain: float
    actuator: str


@dataclass(frozen=True)
class TwinFile:
    """motors: in actuator order; effects: with the values of their linear parameters; tool: its site, or None."""

    path: Path
    motors: tuple[SidecarMotor, ...]
    effects: tuple[tuple[EffectInstance, Mapping[str, float]], ...]
    tool: str | None


def load_twin_file(mjcf: Path) -> TwinFile:
    """Read the file next to an exported MJCF. Raises BenchError naming the file and its fault."""
    path = sidecar_path(mjcf)
    try:
        content = json.loads(path.read_text(encoding="utf-8"))
    except OSError as error:
        raise BenchError(
            f"{path}: {error.strerror or error}: `bench export` writes it next to the MJCF"
        ) from None
    except (json.JSONDecodeError, UnicodeDecodeError) as error:
        raise BenchError(f"{path}: not a twin file ({error})") from None
    if not isinstance(content, dict) or content.get("format") != FORMAT:
        raise BenchError(f"{path}: not a twin file that `bench export` wrote")
    try:
        catalogue = catalogue_for([Path(file) for file in content["effect_files"]])
        return TwinFile(
            path=path,
            motors=tuple(
                SidecarMotor(motor["joint"], float(motor["gain"]), motor["actuator"])
                for motor in content["motors"]
            ),
            effects=tuple(_effect(path, effect, catalogue) for effect in content["effects"]),
            tool=content["tool"],
        )
    except (KeyError, TypeError, ValueError, AttributeError) as error:
        raise BenchError(f"{path}: damaged twin file: {type(error).__name__} at {error}") from None


def _effect(
    path: Path, entry: Mapping[str, object], catalogue: Mapping[str, Effect]
) -> tuple[EffectInstance, Mapping[str, float]]:
    name, place = str(entry["effect"]), str(entry["place"])
    if name not in catalogue:
        raise BenchError(f"{path}: unknown effect {name!r}")
    values, shape = entry["values"], entry["shape"]
    if not isinstance(values, dict) or not isinstance(shape, dict):
        raise TypeError(f"values of {name}")
    whole = replace(catalogue[name], **shape).about(values)
    for effect in (whole, *whole.in_single_joints):
        if set(values) == {parameter.name for parameter in effect.parameters}:
            return EffectInstance(effect, place, name), values
    wanted = ", ".join(sorted(parameter.name for parameter in whole.parameters))
    raise BenchError(f"{path}: {name}: values of {', '.join(values)} instead of {wanted}")
