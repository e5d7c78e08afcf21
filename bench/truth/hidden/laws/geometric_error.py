"""A link that is longer than in its MJCF."""

from dataclasses import dataclass

import mujoco
import numpy as np

from bench.basics.errors import BenchError
from bench.truth.hidden.base import Draft, JointEffect

ONE_TO_THREE = slice(0, 3)
FOUR_TO_SIX = slice(3, 6)


@dataclass(frozen=True)
class GeometricError(JointEffect):
    """The link that the joint moves is longer by `error`; its centre of mass stays where it was.

    The parts fixed on the link beyond its joint (other joints, ends of loops and the tool) are shifted by `error`.
    The direction is from the hinge axis, for a slide from the joint's origin, towards the mean position of the next
    joints and ends of loops (of the tool, if there are none).

    error: m, either sign.
    """

    name = "geometric_error"
    shares = (0.001, 0.01)
    law = "the link that the joint moves is longer than in the MJCF; for any joint"
    scaled = ("error", 1e-3)
    where = "any"
    error: float

    def adjust(self, model: mujoco.MjModel, draft: Draft) -> None:
        joint = model.joint(self.joint)
        body = int(joint.bodyid[0])
        tool = -1 if draft.robot.tool_site is None else model.site(draft.robot.tool_site).id
        bodies = [i for i in range(1, model.nbody) if model.body_parentid[i] == body]
        sites, anchors = _ends_of_loops(model, body)
        reach = reach_of(model, self.joint, draft.robot.tool_site)
        if np.allclose(reach, 0.0):
            raise BenchError(
                f"{self.name}: the link of joint {self.joint} has no length: nothing is fixed to it"
            )
        move = self.error * reach / np.linalg.norm(reach)
        for i in bodies:
            model.body_pos[i] += move
        if tool >= 0 and model.site_bodyid[tool] == body:
            sites = sorted({*sites, tool})
        for i in sites:
            model.site_pos[i] += move
        data = model.eq_data.copy()
        for i, part in anchors:
            data[i, part] += move
        mujoco.mj_setConst(model, mujoco.MjData(model))
        model.eq_data[:] = data  # mj_setConst closed the loops again in the reference pose


def reach_of(model: mujoco.MjModel, joint: str, tool: str | None) -> np.ndarray:
    """Vector (3,), m, from a joint to the mean position of the parts on its link; for a hinge, perpendicular to its
    axis.

    tool: name of the tool site, or None.
    """
    at = model.joint(joint)
    body = int(at.bodyid[0])
    sites, anchors = _ends_of_loops(model, body)
    ends = [
        model.body_pos[i]
        for i in range(1, model.nbody)
        if model.body_parentid[i] == body and model.body_jntnum[i] > 0
    ]
    ends += [model.site_pos[i] for i in sites] + [model.eq_data[i, part] for i, part in anchors]
    if not ends and tool is not None and model.site_bodyid[model.site(tool).id] == body:
        ends = [model.site_pos[model.site(tool).id]]
    reach = np.mean(ends, axis=0) - at.pos if ends else np.zeros(3)
    if at.type[0] == int(mujoco.mjtJoint.mjJNT_HINGE):
        reach = reach - (reach @ at.axis) * at.axis
    return np.asarray(reach)


def _ends_of_loops(model: mujoco.MjModel, body: int) -> tuple[list[int], list[tuple[int, slice]]]:
    """Ends of loops on a body: sites, and (equality, slice of its data) of anchors."""
    sites, anchors = [], []
    for i in range(model.neq):
        ids = (int(model.eq_obj1id[i]), int(model.eq_obj2id[i]))
        if model.eq_objtype[i] == int(mujoco.mjtObj.mjOBJ_SITE):
            sites += [site for site in ids if model.site_bodyid[site] == body]
            continue
        # connect: anchors in body 1 and body 2; weld: anchor in body 2 first, then its position in body 1
        parts = [ONE_TO_THREE, FOUR_TO_SIX]
        if model.eq_type[i] == int(mujoco.mjtEq.mjEQ_WELD):
            parts.reverse()
        anchors += [(i, part) for other, part in zip(ids, parts, strict=True) if other == body]
    return sorted(set(sites)), anchors
