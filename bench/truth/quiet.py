"""MuJoCo without its clock, and without its warnings."""

from collections.abc import Iterator
from contextlib import contextmanager

import mujoco


def stop_step_timers() -> None:
    """Do without it for the rest of the process: it is a tenth of a five-bar's time. `MjData.timer` then stays
    constant.

    For processes that the bench starts: MuJoCo has no way to bring its clock back. One that the caller has set stays.
    """
    if mujoco.get_mjcb_time() is None:
        mujoco.set_mjcb_time(None)


@contextmanager
def unwarned() -> Iterator[None]:
    """No warning goes to the screen and to a file MUJOCO_LOG.TXT: the error that `simulate` raises says it."""
    before = mujoco.get_mju_user_warning()
    mujoco.set_mju_user_warning(lambda _: None)
    try:
        yield
    finally:
        mujoco.set_mju_user_warning(before)
