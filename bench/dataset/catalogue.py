"""Where the built-in robots and scenarios are, from any working folder.

In a checkout they are next to the package, in ``robots/`` and ``scenarios/``;
a wheel carries the same folders inside the package, in ``bench/_catalogue/``.
"""

from collections.abc import Mapping
from pathlib import Path

_PACKAGE = Path(__file__).resolve().parents[1]


def catalogue_folder(kind: str) -> Path:
    """Folder of the built-in `kind` ("robots" or "scenarios"); it may not exist."""
    installed = _PACKAGE / "_catalogue" / kind
    return installed if installed.is_dir() else _PACKAGE.parent / kind


def built_in_robots() -> Mapping[str, Path]:
    """Name -> folder of every built-in robot, sorted by name."""
    descriptions = sorted(catalogue_folder("robots").glob("*/robot.toml"))
    return {description.parent.name: description.parent for description in descriptions}


def built_in_scenarios() -> Mapping[str, Path]:
    """Name -> TOML file of every built-in scenario, sorted by name."""
    paths = sorted(catalogue_folder("scenarios").glob("*.toml"))
    return {path.stem: path for path in paths}
