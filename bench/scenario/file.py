"""Read a scenario file: merge its base, resolve relative paths, and apply the defaults of designed trajectories."""

import json
import tomllib
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from bench.basics.errors import BenchError, meant
from bench.basics.files.toml_input import one_line
from bench.dataset.catalogue import built_in_robots, built_in_scenarios


def find_scenario(scenario: str | Path, folder: Path | None = None) -> Path:
    """The file of a built-in scenario or of a path relative to `folder` (the working folder if None).

    Raises BenchError if there is none.
    """
    built_in = built_in_scenarios()
    if isinstance(scenario, str) and scenario in built_in:
        return built_in[scenario]
    path = (folder or Path.cwd()) / Path(scenario).expanduser()
    if not path.is_file():
        hint = meant(str(scenario), built_in, f"there is no {path}, and built-in are")
        raise BenchError(f"scenario {str(scenario)!r}: neither a built-in scenario nor a file: {hint}")
    return path


def read_with_bases(path: Path, seen: tuple[Path, ...] = ()) -> dict[str, Any]:
    """The content of a file merged over that of its `base`, with absolute paths. Raises BenchError."""
    if path.resolve() in seen:
        raise BenchError(f"{path}: base: leads back to this file")
    content = with_absolute_paths(read_table(path), path.parent)
    base = content.pop("base", None)
    if base is None:
        return content
    if not isinstance(base, str):
        raise BenchError(f"{path}: base: should be the name or the path of a scenario, got {base!r}")
    return merged(read_with_bases(find_scenario(base, path.parent), (*seen, path.resolve())), content)


def read_table(path: Path) -> dict[str, Any]:
    """The content of a TOML file, or of a JSON file by its suffix; BenchError in one line."""
    try:
        text = path.read_text(encoding="utf-8-sig")
        content = json.loads(text) if path.suffix == ".json" else tomllib.loads(text)
    except OSError as error:
        raise BenchError(f"{path}: cannot be read: {error.strerror or error}") from error
    except UnicodeDecodeError as error:
        raise BenchError(f"{path}: not UTF-8 text (byte {error.start})") from error
    except (tomllib.TOMLDecodeError, json.JSONDecodeError) as error:
        raise BenchError(f"{path}: not valid {path.suffix[1:].upper()}: {one_line(error)}") from error
    if not isinstance(content, dict):
        raise BenchError(f"{path}: should be a table")
    return content


def merged(base: Mapping[str, Any], change: Mapping[str, Any]) -> dict[str, Any]:
    """`base` with the keys of `change`; tables on both sides are merged, anything else is replaced.

    Tolerances are replaced as a whole, since they apply to one experiment, not to those based on it.
    """
    result = dict(base)
    for key, value in change.items():
        below = result.get(key)
        if isinstance(below, Mapping) and isinstance(value, Mapping) and key != "tolerances":
            result[key] = merged(below, value)
        else:
            result[key] = value
    return result


def with_absolute_paths(content: dict[str, Any], folder: Path) -> dict[str, Any]:
    """The content with relative paths made absolute, changed in place, so that a file may have a base in another
    folder.
    """
    robot = content.get("robot")
    if isinstance(robot, str) and robot and robot not in built_in_robots():
        content["robot"] = str((folder / Path(robot).expanduser()).resolve())
    recordings = content.get("recordings")
    for recording in recordings if isinstance(recordings, list) else []:
        if isinstance(recording, dict) and isinstance(recording.get("trajectory_file"), str):
            recording["trajectory_file"] = str((folder / recording["trajectory_file"]).resolve())
    hidden = content.get("hidden")
    for entry in hidden if isinstance(hidden, list) else []:
        if isinstance(entry, dict) and isinstance(entry.get("file"), str):
            entry["file"] = str((folder / Path(entry["file"]).expanduser()).resolve())
    return content


def with_design_defaults(content: Mapping[str, Any]) -> dict[str, Any]:
    """The content without the table `design`, whose keys become defaults for the design of every recording that has
    one.
    """
    worked = dict(content)
    defaults = worked.pop("design", {})
    if not isinstance(defaults, Mapping):
        raise BenchError(f"design: should be a table, got {defaults!r}")
    recordings = worked.get("recordings")
    if isinstance(recordings, Sequence):
        worked["recordings"] = [
            {**r, "design": {**defaults, **r["design"]}}
            if isinstance(r, Mapping) and isinstance(r.get("design"), Mapping)
            else r
            for r in recordings
        ]
    return worked
