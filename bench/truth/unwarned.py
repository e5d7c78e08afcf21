"""MuJoCo without its warnings."""

from collections.abc import Iterator
from contextlib import contextmanager

import mujoco


@contextmanager
def unwarned() -> Iterator[None]:
    """No warning goes to the screen and to a file MUJOCO_LOG.TXT: the error that `simulate` raises says it."""
    before = mujoco.get_mju_user_warning()
    mujoco.set_mju_user_warning(lambda _: None)
    try:
        yield
    finally:
        mujoco.set_mju_user_warning(before)
