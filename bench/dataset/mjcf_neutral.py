"""Keep parts that are added to an MJCF unaffected by its default classes and its compiler settings for masses."""

from functools import lru_cache

import mujoco
import numpy as np


def neutral() -> mujoco.MjsDefault:
    """MuJoCo's defaults, for `add_joint` etc.: without them, a part inherits the default class of its body."""
    return _empty().default


@lru_cache(maxsize=1)
def _empty() -> mujoco.MjSpec:
    return mujoco.MjSpec()


def keep_masses(spec: mujoco.MjSpec) -> None:
    """Give every body explicitly the mass and inertia by the compiler's settings, and reset these.

    Otherwise `inertiafromgeom="true"` would give an added body without shapes no mass, `settotalmass` would
    distribute the mass of a payload over all bodies, and `boundmass` would make a rotor heavy.
    """
    compiler, plain = spec.compiler, _empty().compiler
    changing = ("balanceinertia", "boundmass", "boundinertia", "settotalmass", "inertiafromgeom")
    if all(getattr(compiler, name) == getattr(plain, name) for name in changing):
        return
    copy = spec.copy()
    copy.compiler.fusestatic = False
    compiled = copy.compile()
    for body, same in zip(spec.bodies, copy.bodies, strict=True):
        if same.id == 0:
            continue
        body.explicitinertial = True
        body.mass, body.ipos = float(compiled.body_mass[same.id]), compiled.body_ipos[same.id]
        body.inertia, body.iquat = compiled.body_inertia[same.id], compiled.body_iquat[same.id]
        body.ialt.type, body.fullinertia = mujoco.mjtOrientation.mjORIENTATION_QUAT, np.full(6, np.nan)
    for name in changing:
        setattr(compiler, name, getattr(plain, name))
