"""Parts of an MJCF that do not affect the robot's motion and would only hinder reading it.

A fixed tendon whose length an equality fixes does no work, so its spring, damping, friction, armature and range have
no effect. A passive hinge with a range of a whole turn has no end stop: exporters write 0 to 2 pi for a pin.
"""

import math
from collections.abc import Collection

import mujoco
import numpy as np

WHOLE_TURN = 6.28  # rad: a whole turn as it is rounded in files


def release_held_tendons(spec: mujoco.MjSpec) -> None:
    """Remove spring, damping, friction, armature and range from fixed tendons whose length an equality fixes."""
    held = {
        equality.name1
        for equality in spec.equalities
        if equality.type == mujoco.mjtEq.mjEQ_TENDON and equality.active and not equality.name2
    }
    for tendon in spec.tendons:
        parts = (tendon.path[i].type for i in range(len(tendon.path)))
        if tendon.name in held and all(part == mujoco.mjtWrap.mjWRAP_JOINT for part in parts):
            tendon.stiffness, tendon.damping = np.zeros_like(tendon.stiffness), np.zeros_like(tendon.damping)
            tendon.frictionloss = tendon.armature = 0.0
            tendon.limited = False


def release_whole_turns(spec: mujoco.MjSpec, driven: Collection[str]) -> None:
    """Remove the range from passive hinges that may turn by a whole turn. driven: names of the joints with a motor."""
    turn = math.degrees(WHOLE_TURN) if spec.compiler.degree else WHOLE_TURN
    stops = {mujoco.mjtLimited.mjLIMITED_TRUE}
    if spec.compiler.autolimits:
        stops.add(mujoco.mjtLimited.mjLIMITED_AUTO)
    for joint in spec.joints:
        passive = joint.type == mujoco.mjtJoint.mjJNT_HINGE and joint.name not in driven
        if passive and joint.limited in stops and joint.range[1] - joint.range[0] >= turn:
            joint.limited = False
