"""Trajectories that a sweep has designed, kept for the next start of it."""

from __future__ import annotations

import json
from collections.abc import Mapping
from pathlib import Path

from bench.basics.files.atomic import write_json_atomically
from bench.scenario.trajectory import FourierTrajectory


def keep_design(folder: Path, name: str, trajectories: Mapping[str, FourierTrajectory]) -> None:
    """Write trajectories, by recording name, to the last bit."""
    content = {recording: trajectory.to_dict() for recording, trajectory in trajectories.items()}
    write_json_atomically(folder / f"{name}.json", content)


def kept_design(folder: Path, name: str) -> dict[str, FourierTrajectory] | None:
    """Read them again; None if there are none of that name."""
    path = folder / f"{name}.json"
    if not path.is_file():
        return None
    content = json.loads(path.read_text(encoding="utf-8"))
    return {recording: FourierTrajectory.from_dict(entry) for recording, entry in content.items()}
