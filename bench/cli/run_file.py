"""run.json in a folder of results: which command wrote it, on which data, so that others can show it again."""

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from bench.errors import BenchError
from bench.files import finite, write_json_atomically

RUN_FILE = "run.json"
COMMANDS = ("identify", "compare", "diagnose")


@dataclass(frozen=True)
class RunFile:
    """A command as it was given. folder: of its results.

    options: of the command by name, filters among them. model: the model file that was applied. steps: for a
    diagnosis the effects of the model after each rung of the ladder, as requests such as coulomb_friction:left.
    text: what was found, as Markdown.
    """

    folder: Path
    command: str
    dataset: Path
    effects: tuple[str, ...] = ()
    effect_files: tuple[Path, ...] = ()
    options: Mapping[str, Any] = field(default_factory=dict)
    model: Path | None = None
    steps: tuple[tuple[str, ...], ...] = ()
    text: str = ""


def write_run_file(run: RunFile) -> Path:
    """Write run.json; paths are kept absolute, as the folder may be moved apart from the data."""
    content = {
        "command": run.command,
        "dataset": str(run.dataset.resolve()),
        "effects": list(run.effects),
        "effect_files": [str(one.resolve()) for one in run.effect_files],
        "options": finite(dict(run.options)),
        "model": None if run.model is None else str(run.model.resolve()),
        "steps": [list(one) for one in run.steps],
        "text": run.text,
    }
    path = run.folder / RUN_FILE
    write_json_atomically(path, content)
    return path


def read_run_file(folder: Path) -> RunFile:
    """Read run.json of a folder. Raises BenchError where it is missing or damaged, or the data have gone."""
    path = folder / RUN_FILE
    try:
        content = json.loads(path.read_text(encoding="utf-8"))
    except FileNotFoundError:
        wrote = " or ".join(f"`bench {name} -o`" for name in COMMANDS)
        raise BenchError(
            f"{folder}: neither a dataset (dataset.toml) nor a folder that {wrote} wrote (run.json)"
        ) from None
    except (OSError, json.JSONDecodeError, UnicodeDecodeError) as error:
        raise BenchError(f"{path}: cannot be read ({error})") from None
    try:
        run = RunFile(
            folder=folder,
            command=str(content["command"]),
            dataset=Path(content["dataset"]),
            effects=_texts(content.get("effects", ())),
            effect_files=tuple(map(Path, _texts(content.get("effect_files", ())))),
            options=_options(content.get("options", {})),
            model=Path(content["model"]) if content.get("model") else None,
            steps=tuple(map(_texts, content.get("steps", ()))),
            text=str(content.get("text", "")),
        )
    except (KeyError, TypeError, ValueError, AttributeError) as error:
        raise BenchError(f"{path}: damaged: {type(error).__name__} at {error}") from None
    if not run.dataset.is_dir():
        raise BenchError(f"{path}: its dataset {run.dataset} is not there any more")
    return run


def _texts(values: Sequence[Any]) -> tuple[str, ...]:
    if isinstance(values, str):
        raise TypeError(f"{values!r} is not a list")
    return tuple(str(one) for one in values)


def _options(values: Mapping[str, Any]) -> dict[str, Any]:
    return {str(key): tuple(one) if isinstance(one, list) else one for key, one in values.items()}
