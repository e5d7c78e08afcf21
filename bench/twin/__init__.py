"""An exported robot in MuJoCo with the effects that its MJCF cannot represent: `load_twin`."""

from bench.twin.twin import Twin, load_twin

__all__ = ["Twin", "load_twin"]
