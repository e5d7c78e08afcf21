"""More motors than degrees of freedom: choose those that move independently, in the order of robot.toml."""

from collections.abc import Sequence

import mujoco
import numpy as np

from bench.basics.errors import BenchError
from bench.basics.sentence import and_list
from bench.dataset.home_qpos import home_qpos
from bench.dataset.locked_couplings import held_bodies

DEPENDENT = 1e-4  # of the largest singular value, equalities of unit length: smaller ones are due to rounding

OF_MOTORS = "rotor:"  # prefix of the names of equalities that tie motors to the parts that they drive


def independent_motors(model: mujoco.MjModel, joints: Sequence[str]) -> tuple[str, ...]:
    """The driven joints that move independently in the home pose, the first ones if there is a choice; all of them if
    they are no more than the degrees of freedom.

    Raises BenchError if they are more and one of them cannot move at all.
    """
    free = _motions(_closures(model)[0])
    if len(free) >= len(joints):
        return tuple(joints)
    still = np.abs(free).max(axis=0, initial=0.0) < DEPENDENT
    chosen: list[str] = []
    places: list[int] = []
    for joint in joints:
        place = int(model.joint(joint).dofadr[0])
        if still[place]:
            why = f"the loop closures lock it{_unlocking(model, joints, joint)}"
            raise BenchError(f"joint {joint!r} cannot move in the home pose: {why}")
        if _rank(free[:, [*places, place]]) > len(places):
            chosen.append(joint)
            places.append(place)
    return tuple(chosen)


def welds_to_connect(model: mujoco.MjModel, joints: Sequence[str]) -> tuple[str, ...]:
    """Welds that restrict these driven joints; replaced by connects, they would let all of them move independently.

    A weld at a pin of a planar linkage is an example, since it fixes the orientation as well. Empty if the joints
    already move independently, or if connects would add other motions with the motors held.
    """
    rows, owners = _closures(model)
    places = [int(model.joint(joint).dofadr[0]) for joint in joints]
    free = _motions(rows)
    moving = _rank(free[:, places])
    if moving == len(joints):
        return ()
    welds = [int(owner) for owner in np.unique(owners) if _is_weld(model, int(owner))]
    for changed in (*((weld,) for weld in welds), tuple(welds)):
        turning = [row for weld in changed for row in np.flatnonzero(owners == weld)[3:]]
        other = _motions(np.delete(rows, turning, axis=0))
        if _rank(other[:, places]) == len(joints) and len(other) - len(joints) == len(free) - moving:
            return tuple(_equality(model, weld) for weld in changed)
    return ()


def use_connect(welds: Sequence[str]) -> str:
    """The cure for welds that fix too much."""
    return f"use <connect> instead of weld {listed(welds)}, which holds the orientation of its bodies, too"


def listed(names: Sequence[str]) -> str:
    """Quoted names as in "'a', 'b' and 'c'"."""
    return and_list([repr(name) for name in names])


def _unlocking(model: mujoco.MjModel, joints: Sequence[str], joint: str) -> str:
    """The end of the message on a locked driven joint: the cure, or the closures without any of which it moves."""
    welds = welds_to_connect(model, joints)
    if welds:
        return f"; {use_connect(welds)}"
    rows, owners = _closures(model)
    place = int(model.joint(joint).dofadr[0])
    locking = [
        int(owner)
        for owner in np.unique(owners)
        if np.abs(_motions(rows[owners != owner])[:, place]).max(initial=0.0) >= DEPENDENT
    ]
    still = _still_ends(model, locking)
    names = [name for owner in locking if not (name := _equality(model, owner)).startswith(OF_MOTORS)]
    said = f" ({listed(names)})" if names else ""
    if still:
        mocap = model.body(still[0]).mocapid[0] >= 0
        which, instead = ("mocap body", 'without mocap="true"') if mocap else ("body", "")
        cure = f"no joint moves {which} {still[0]!r}, to which they tie it: if it should move, give it a <freejoint/>"
        return f"{said}; {cure} {instead}".rstrip()
    turning = [_equality(model, owner) for owner in locking if _is_weld(model, owner)]
    at_pins = f"; at a pin, {use_connect(turning)}" if turning else ""
    return f"{said}; a closure is one too many, a joint is missing, or home is a singular pose{at_pins}"


def _is_weld(model: mujoco.MjModel, equality: int) -> bool:
    return int(model.eq_type[equality]) == int(mujoco.mjtEq.mjEQ_WELD)


def _equality(model: mujoco.MjModel, index: int) -> str:
    return model.equality(index).name or f"equality_{index}"


def _still_ends(model: mujoco.MjModel, equalities: Sequence[int]) -> list[str]:
    """Bodies in these closures that neither move nor carry a moving body: platforms without a joint."""
    carrying = set(np.flatnonzero((model.body_weldid > 0) & (model.body_mocapid < 0)).tolist())
    for body in range(model.nbody - 1, 0, -1):  # a parent has a lower number than its children
        if body in carrying:
            carrying.add(int(model.body_parentid[body]))
    bodies = []
    for index in equalities:
        if int(model.eq_type[index]) not in (int(mujoco.mjtEq.mjEQ_CONNECT), int(mujoco.mjtEq.mjEQ_WELD)):
            continue
        still = [body for body in held_bodies(model, index) if body and body not in carrying]
        bodies += [model.body(body).name for body in still]
    return bodies


def _motions(closures: np.ndarray) -> np.ndarray:
    """An orthonormal basis (k, nv) of the velocities that closures (m, nv) allow."""
    _, values, motions = np.linalg.svd(closures)
    return np.asarray(motions[int((values > DEPENDENT * values.max(initial=0.0)).sum()) :])


def _rank(motions: np.ndarray) -> int:
    values = np.linalg.svd(motions, compute_uv=False)
    return int((values > DEPENDENT * values.max(initial=0.0)).sum())


def _closures(model: mujoco.MjModel) -> tuple[np.ndarray, np.ndarray]:
    """Rows (m, nv) of the active equalities in the home pose, scaled so that the longest row of each has unit length,
    and the index (m,) of the equality of each row.
    """
    data = mujoco.MjData(model)
    data.qpos[:] = home_qpos(model)
    mujoco.mj_fwdPosition(model, data)
    closing = np.asarray(data.efc_type) == int(mujoco.mjtConstraint.mjCNSTR_EQUALITY)
    full = np.zeros((data.nefc, model.nv))
    if mujoco.mj_isSparse(model):
        mujoco.mju_sparse2dense(full, data.efc_J, data.efc_J_rownnz, data.efc_J_rowadr, data.efc_J_colind)
    else:
        full[:] = np.asarray(data.efc_J).reshape(data.nefc, model.nv)
    rows, owners = full[closing], np.asarray(data.efc_id)[closing]
    for owner in np.unique(owners):
        of_owner = owners == owner
        rows[of_owner] /= max(np.linalg.norm(rows[of_owner], axis=1).max(), np.finfo(float).tiny)
    return np.asarray(rows), owners
