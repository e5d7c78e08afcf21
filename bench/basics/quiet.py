"""MuJoCo without its timers, and without its warnings."""

from collections.abc import Iterator
from contextlib import contextmanager

import mujoco


def stop_step_timers() -> None:
    """Disable MuJoCo's timers for the rest of the process: they take a tenth of the time of a five-bar.

    `MjData.timer` then stays constant. This is only for processes that the bench starts, since MuJoCo cannot restore
    its default clock. A clock that the caller has set is kept.
    """
    if mujoco.get_mjcb_time() is None:
        mujoco.set_mjcb_time(None)


@contextmanager
def unwarned() -> Iterator[None]:
    """Suppress MuJoCo's warnings on the screen and in the file MUJOCO_LOG.TXT: `simulate` raises an error instead."""
    before = mujoco.get_mju_user_warning()
    mujoco.set_mju_user_warning(lambda _: None)
    try:
        yield
    finally:
        mujoco.set_mju_user_warning(before)
