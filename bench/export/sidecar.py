"""The file next to an export: what the format cannot hold, for `bench.twin` and people."""

from pathlib import Path
from typing import Any

from bench.basics.files.atomic import write_json_atomically
from bench.basics.files.sidecar_path import sidecar_path
from bench.export.mjcf import Exported
from bench.export.physical import PhysicalSet
from bench.twin.file import FORMAT


def sidecar(physical: PhysicalSet, exported: Exported) -> dict[str, Any]:
    """Motors, remaining effects with their values and shapes, and the source of the bodies."""
    model = physical.model
    return {
        "format": FORMAT,
        "robot": model.robot.name,
        "motors": [
            {"joint": actuator.joint, "gain": float(gain), "unit": actuator.gain_unit, "actuator": name}
            for actuator, gain, name in zip(
                model.robot.actuators, model.gains, exported.actuators, strict=True
            )
        ],
        "tool": model.robot.tool_site,
        "effects": [
            {
                "effect": unplaced.effect.name,
                "place": unplaced.effect.place,
                "values": dict(unplaced.effect.values),
                "shape": unplaced.effect.instance.effect.shape_values(),
                "why": unplaced.why,
            }
            for unplaced in exported.placed.not_placed
        ],
        "effect_files": [str(file.resolve()) for file in model.effect_files],
        "bodies": {"prior": physical.prior, "distance": physical.distance, "guessed": list(physical.guessed)},
        "changed": list(exported.changed),
    }


def write_sidecar(path: Path, content: dict[str, Any]) -> Path:
    """Write it next to `path`, whole or not at all."""
    file = sidecar_path(path)
    write_json_atomically(file, content)
    return file
