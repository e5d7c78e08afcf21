"""The file beside an export: what the format does not hold, for `bench.twin` and for people."""

from pathlib import Path
from typing import Any

from bench.export.physical import PhysicalSet
from bench.export.placed import Left
from bench.files import write_json_atomically

FORMAT = 1


def sidecar_path(path: Path) -> Path:
    """Where it lies: NAME.twin.json beside NAME.xml."""
    return path.with_name(f"{path.stem}.twin.json")


def sidecar(physical: PhysicalSet, left: tuple[Left, ...], changed: tuple[str, ...]) -> dict[str, Any]:
    """Motors, effects that are left with their values and shapes, and where the bodies are from."""
    model = physical.model
    return {
        "format": FORMAT,
        "robot": model.robot.name,
        "motors": [
            {"joint": actuator.joint, "gain": float(gain), "unit": actuator.gain_unit}
            for actuator, gain in zip(model.robot.actuators, model.gains, strict=True)
        ],
        "effects": [
            {
                "effect": one.effect.name,
                "place": one.effect.place,
                "values": dict(one.effect.values),
                "shape": one.effect.instance.effect.shape_values(),
                "why": one.why,
            }
            for one in left
        ],
        "effect_files": [str(file.resolve()) for file in model.effect_files],
        "bodies": {
            "prior": physical.prior,
            "distance": physical.distance,
            "guessed": list(physical.guessed),
        },
        "changed": list(changed),
    }


def write_sidecar(path: Path, content: dict[str, Any]) -> Path:
    """Write it beside `path`, whole or not at all."""
    beside = sidecar_path(path)
    write_json_atomically(beside, content)
    return beside
