"""Fluid drag on the tool, as MuJoCo's drag on a small sphere."""

from dataclasses import dataclass

import mujoco
import numpy as np

from bench.basics.errors import BenchError
from bench.dataset.mjcf_neutral import neutral
from bench.truth.hidden.base import Draft, HiddenEffect, free_name

RADIUS = 0.01  # m
THIN = 1e-9  # kg/m³: a density so low that only the sphere has noticeable drag


@dataclass(frozen=True)
class ToolDrag(HiddenEffect):
    """c |v| v at the tool site, against its velocity v: the drag ρ C A |v| v of a massless sphere with ρ C A = c.

    c: N·s²/m², at least 0.
    """

    name = "tool_drag"
    law = "c v |v| acts against the velocity v of the tool; of the whole machine"
    needs = "tool"
    scaled = ("c", 1.0)
    not_negative = ("c",)
    c: float

    def change(self, draft: Draft) -> None:
        tool = draft.robot.tool_site
        if tool is None:
            raise BenchError(
                f"{self.name}: the robot {draft.robot.name!r} has no [tool] site for it to act on"
            )
        option, site = draft.spec.option, draft.spec.site(tool)
        option.density = option.density or THIN
        sphere = site.parent.add_geom(neutral(), name=free_name(draft, self.name))
        sphere.type = mujoco.mjtGeom.mjGEOM_SPHERE
        sphere.size = [RADIUS, 0.0, 0.0]
        sphere.pos = site.pos
        sphere.mass = 0.0
        sphere.contype = sphere.conaffinity = 0
        sphere.fluid_ellipsoid = 1.0
        sphere.fluid_coefs = [self.c / (option.density * np.pi * RADIUS**2), 0.0, 0.0, 0.0, 0.0]
