"""MuJoCo's clock for the parts of every step."""

import mujoco


def stop_step_timers() -> None:
    """Do without it for the rest of the process: it is a tenth of a five-bar's time. `MjData.timer` then stays
    constant.

    For processes that the bench starts: MuJoCo has no way to bring its clock back. One that the caller has set stays.
    """
    if mujoco.get_mjcb_time() is None:
        mujoco.set_mjcb_time(None)
