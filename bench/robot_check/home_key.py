"""The keyframe home as an MJCF element."""

from collections.abc import Sequence


def home_key(qpos: Sequence[float]) -> str:
    """The element with all joint positions, in MuJoCo's order."""
    return f'<key name="home" qpos="{" ".join(f"{value:.16g}" for value in qpos)}"/>'
