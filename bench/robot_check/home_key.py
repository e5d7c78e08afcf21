"""The keyframe home as an MJCF element."""

from collections.abc import Sequence

from bench.basics.joint_units import written_position


def home_key(qpos: Sequence[float]) -> str:
    """The element with all joint positions, in MuJoCo's order."""
    return f'<key name="home" qpos="{" ".join(f"{written_position(value):.15g}" for value in qpos)}"/>'
