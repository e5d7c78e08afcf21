"""Where an exported MJCF has the file of effects that it cannot hold itself."""

from pathlib import Path


def sidecar_path(path: Path) -> Path:
    """Where it lies: NAME.twin.json next to NAME.xml."""
    return path.with_name(f"{path.stem}.twin.json")
