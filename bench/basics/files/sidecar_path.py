"""The file for effects that an exported MJCF cannot contain."""

from pathlib import Path


def sidecar_path(path: Path) -> Path:
    """Its path: NAME.twin.json next to NAME.xml."""
    return path.with_name(f"{path.stem}.twin.json")
