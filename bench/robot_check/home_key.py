"""The keyframe home, as it is written in an MJCF."""

from collections.abc import Sequence


def home_key(qpos: Sequence[float]) -> str:
    """The element with the positions of all joints, in MuJoCo's order."""
    return f'<key name="home" qpos="{" ".join(f"{value:.16g}" for value in qpos)}"/>'
