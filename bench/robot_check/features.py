"""What an MJCF may hold and the model does not: refused where it bends the answer unseen, otherwise told."""

from collections.abc import Iterator, Mapping

import mujoco
import numpy as np

from bench.dataset.robot import Robot
from bench.effects import CATALOGUE
from bench.effects.effect import MjcfTerm, Place
from bench.model.supported import label_of, unsupported_features
from bench.robot_check.report import Check

FORCES: Mapping[MjcfTerm, tuple[str, tuple[str, ...]]] = {  # in words, and the fields of MuJoCo's model
    "stiffness": ("spring (stiffness)", ("jnt_stiffness", "jnt_stiffnesspoly")),
    "damping": ("damping", ("dof_damping", "dof_dampingpoly")),
    "frictionloss": ("friction (frictionloss)", ("dof_frictionloss",)),
}
LARGE = 20.0  # m: no robot is so large


def check_features(compiled: mujoco.MjModel) -> Check:
    """Nothing in the MJCF that the model cannot represent."""
    name = "supported MJCF"
    refused = list(unsupported_features(compiled))
    if refused:
        more = f" (and {len(refused) - 1} more: {'; '.join(refused[1:])})" if len(refused) > 1 else ""
        return Check(name, "failed", refused[0] + more)
    return Check(name, "ok", "bodies, joints and supported equalities alone")


def notes(compiled: mujoco.MjModel, robot: Robot) -> list[Check]:
    """What the simulator adds and the model does not know; no error, but it is told."""
    return [Check("note", "note", text) for text in _notes(compiled, robot)]


def _notes(compiled: mujoco.MjModel, robot: Robot) -> Iterator[str]:
    for index in range(compiled.neq):
        if not compiled.eq_active0[index]:
            label = label_of(compiled, mujoco.mjtObj.mjOBJ_EQUALITY, index)
            yield f"equality {label!r} is inactive and ignored"
    for term, (what, fields) in FORCES.items():
        named = _joints_with(compiled, fields)
        if not named:
            continue
        asked = [
            f"{_effect_of(term, 'actuator' if name in robot.driven else 'passive')}:{name}"
            for name in sorted(named, key=lambda name: name not in robot.driven)
        ]
        yield (
            f"{what} on {', '.join(named)}: the simulator will add it, the model does not know it; fit it with "
            f"--with {' --with '.join(asked)}"
        )
    rotors = [name for name in _joints_with(compiled, ("dof_armature",)) if name not in robot.driven]
    if rotors:
        yield f"rotor inertia (armature) on the passive {', '.join(rotors)}: the model does not know it"
    if (size := _furthest(compiled)) > LARGE:
        yield (
            f"lengths of up to {size:.3g} m: an MJCF is in metres, and lengths look like millimetres or inches; "
            "divide every pos by 1000, or by 39.37"
        )
    if compiled.opt.density or compiled.opt.viscosity:
        yield "the air (density, viscosity) slows bodies in the simulator, the model does not know it"
    if compiled.nplugin:
        yield f"{compiled.nplugin} plug-ins of MuJoCo: the model does not know what they do"
    if compiled.nactuator:
        yield f"{compiled.nactuator} actuators of the MJCF are not used: robot.toml names the motors"
    held = compiled.eq_type == int(mujoco.mjtEq.mjEQ_TENDON)
    used = set(np.concatenate((compiled.eq_obj1id[held], compiled.eq_obj2id[held])).tolist())
    for tendon in set(range(compiled.ntendon)) - used:
        yield f"tendon {label_of(compiled, mujoco.mjtObj.mjOBJ_TENDON, tendon)!r} is ignored"


def _effect_of(term: MjcfTerm, place: Place) -> str:
    """The effect of the catalogue that has the law of a term, in a joint with a motor or without."""
    return next(name for name, effect in CATALOGUE.items() if (effect.in_mjcf, effect.place) == (term, place))


def _furthest(compiled: mujoco.MjModel) -> float:
    """The longest way from a body or site to its parent, m."""
    places = [
        np.linalg.norm(part, axis=1).max(initial=0.0) for part in (compiled.body_pos, compiled.site_pos)
    ]
    return float(max(places))


def _joints_with(compiled: mujoco.MjModel, fields: tuple[str, ...]) -> list[str]:
    names = []
    for joint in range(compiled.njnt):
        first = int(compiled.jnt_dofadr[joint])
        for field in fields:
            values = getattr(compiled, field)
            if np.any(values[joint] if field.startswith("jnt_") else values[first]):
                names.append(label_of(compiled, mujoco.mjtObj.mjOBJ_JOINT, joint))
                break
    return names
