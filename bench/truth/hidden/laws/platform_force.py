"""A force at the tool, as actuators without command."""

from dataclasses import dataclass

import mujoco
import numpy as np

from bench.basics.errors import BenchError
from bench.dataset.mjcf_neutral import neutral
from bench.truth.hidden.base import Draft, HiddenEffect, free_name


@dataclass(frozen=True)
class PlatformForce(HiddenEffect):
    """f - k (x - x_home) on the robot at its tool site: a hose, a cable, a gas spring.

    x: position of the tool in the base frame, x_home: in the pose `home`. The force does not rotate with the tool.

    fx, fy, fz: N, in the base frame.  k: N/m, at least 0. Each 0 if omitted.
    """

    name = "platform_force"
    shares = (0.02, 0.3)
    law = "f − k (x − x_home) acts on the tool; of the whole machine"
    needs = "tool"
    not_negative = ("k",)
    fx: float = 0.0
    fy: float = 0.0
    fz: float = 0.0
    k: float = 0.0

    def change(self, draft: Draft) -> None:
        tool = draft.robot.tool_site
        if tool is None:
            raise BenchError(
                f"{self.name}: the robot {draft.robot.name!r} has no [tool] site for it to act on"
            )
        data = mujoco.MjData(draft.plain)
        data.qpos[:] = draft.home
        mujoco.mj_kinematics(draft.plain, data)
        base = draft.spec.worldbody.add_site(neutral(), name=free_name(draft, "base"))
        for axis, force in enumerate((self.fx, self.fy, self.fz)):
            actuator = draft.spec.add_actuator(neutral(), name=free_name(draft, self.name), target=tool)
            actuator.trntype = mujoco.mjtTrn.mjTRN_SITE
            actuator.refsite = base.name
            actuator.gear = np.eye(6)[axis]
            actuator.gaintype = mujoco.mjtGain.mjGAIN_FIXED
            actuator.gainprm[0] = 0.0
            actuator.biastype = mujoco.mjtBias.mjBIAS_AFFINE
            actuator.biasprm[0] = force + self.k * data.site(tool).xpos[axis]
            actuator.biasprm[1] = -self.k
