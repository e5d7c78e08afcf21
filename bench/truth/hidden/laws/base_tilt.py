"""A base that is not level."""

from dataclasses import dataclass

import numpy as np

from bench.truth.hidden.base import Draft, HiddenEffect


@dataclass(frozen=True)
class BaseTilt(HiddenEffect):
    """Gravity in the base frame is Rᵀ g, with R = R_x(about_x) R_y(about_y) and g of the robot's MJCF.

    The base is turned about its y axis and then about the x axis of the floor.

    about_x, about_y: rad.
    """

    name = "base_tilt"
    shares = (0.01, 0.15)
    law = "the base turned about its y axis, then about the x axis of the floor; of the whole machine"
    about_x: float = 0.0
    about_y: float = 0.0

    def change(self, draft: Draft) -> None:
        cx, sx, cy, sy = (f(angle) for angle in (self.about_x, self.about_y) for f in (np.cos, np.sin))
        about_x = np.array([[1, 0, 0], [0, cx, -sx], [0, sx, cx]])
        about_y = np.array([[cy, 0, sy], [0, 1, 0], [-sy, 0, cy]])
        draft.spec.option.gravity = (about_x @ about_y).T @ draft.spec.option.gravity
