"""The loop closures of MuJoCo, of Pinocchio and of the model itself, compared at closed poses.

All three are brought to one form: second anchor minus first, in world axes, with the rotation for a weld.
"""

import mujoco
import numpy as np
import pinocchio as pin

from bench.model.closure import loop_jacobian, loop_residual
from bench.model.follow import loop_constraints
from bench.model.geometry import rotation_matrix
from bench.model.motion import Motion
from bench.model.supported import CLOSURES
from bench.robot_check.bounds import AGREEMENT
from bench.robot_check.machine import CheckedMachine, set_pose
from bench.robot_check.outcome import Check, CheckCode

FIRST = np.array([1.0, -8.0, 0.0, 8.0, -1.0]) / 12.0  # differences of fourth order
SECOND = np.array([-1.0, 16.0, -30.0, 16.0, -1.0]) / 12.0


def active_equalities(compiled: mujoco.MjModel) -> tuple[list[int], list[int]]:
    """MuJoCo's indices of the active loop closures, and of the active couplings, in the geometry's order."""
    active = np.flatnonzero(compiled.eq_active0)
    closing = np.isin(compiled.eq_type[active], CLOSURES)
    return active[closing].tolist(), active[~closing].tolist()


def check_constraints(machine: CheckedMachine, poses: np.ndarray) -> Check:
    """Residual and Jacobian of every loop and coupling at the closed configurations poses (N, nq)."""
    geometry = machine.geometry
    loops, couplings = active_equalities(machine.compiled)
    if len(loops) != len(geometry.loops):
        counts = {"mujoco": len(loops), "model": len(geometry.loops)}
        return Check(CheckCode.LOOP_COUNTS_DIFFER, "failed", counts)
    names = [*(loop.name for loop in geometry.loops), *(coupling.name for coupling in geometry.couplings)]
    worst = np.zeros((len(names), 2))
    for q in poses:
        turn = set_pose(machine, q)
        rows = np.hstack(
            (loop_residual(geometry, q[:, None]), loop_jacobian(geometry, q[:, None])[:, :, 0] @ turn)
        )
        pinocchio = _pinocchio_rows(machine, q, turn)
        row = 0
        for index, equality in enumerate((*loops, *couplings)):
            theirs = _mujoco_rows(machine, equality)
            # a residual in a frame that rotates adds to one of the Jacobians
            turning = 2.0 * np.abs(theirs[:, 0]).max() if index < len(loops) else 0.0
            for ours in (rows[row : row + len(theirs)], *pinocchio[index : index + 1]):
                apart = np.abs(ours - theirs)
                worst[index] = np.maximum(
                    worst[index], (apart[:, 0].max(), max(apart[:, 1:].max() - turning, 0.0))
                )
            row += len(theirs)
    if worst.max() < AGREEMENT.closed:
        agreed = {"poses": len(poses), "difference": float(worst.max())}
        return Check(CheckCode.LOOP_CLOSURES_AGREE, "ok", agreed)
    at = int(np.argmax(worst.max(axis=1)))
    residual, jacobian = worst[at].tolist()
    offender = {"closure": names[at], "residual": residual, "jacobian": jacobian}
    return Check(CheckCode.LOOP_CLOSURES_DIFFER, "failed", offender)


def check_closed_motion(machine: CheckedMachine, motion: Motion) -> Check:
    """Whether velocities and accelerations keep MuJoCo's loops closed, by differences of its residuals in time."""
    worst = np.zeros(2)
    for q, v, a in zip(motion.q, motion.v, motion.a, strict=True):
        residuals = np.array(
            [
                _mujoco_residual(machine, pin.integrate(machine.model, q, v * t + 0.5 * a * t * t))
                for t in AGREEMENT.moment * np.arange(-2, 3)
            ]
        )
        speed = float(np.abs(v).max())
        opening = FIRST @ residuals / AGREEMENT.moment / max(1.0, speed)
        bending = SECOND @ residuals / AGREEMENT.moment**2 / max(1.0, speed**2, float(np.abs(a).max()))
        worst = np.maximum(worst, (np.abs(opening).max(), np.abs(bending).max()))
    velocity, acceleration = worst.tolist()
    return Check(
        CheckCode.LOOP_OPENING_IN_MOTION,
        "ok" if worst.max() < AGREEMENT.rates else "failed",
        {"velocity": velocity, "acceleration": acceleration},
    )


def _mujoco_residual(machine: CheckedMachine, q: np.ndarray) -> np.ndarray:
    set_pose(machine, q)
    loops, couplings = active_equalities(machine.compiled)
    return np.concatenate([_mujoco_rows(machine, index)[:, 0] for index in (*loops, *couplings)])


def _mujoco_rows(machine: CheckedMachine, equality: int) -> np.ndarray:
    """MuJoCo's residual and Jacobian (1, 3 or 6, 1 + nv) of one equality, in the model's form."""
    compiled, state = machine.compiled, machine.state
    kind = compiled.eq_type[equality]
    rows = (state.efc_type == mujoco.mjtConstraint.mjCNSTR_EQUALITY) & (state.efc_id == equality)
    both = np.hstack((state.efc_pos[rows, None], state.efc_J.reshape(-1, compiled.nv)[rows]))
    if kind not in CLOSURES:
        return both
    weld = kind == mujoco.mjtEq.mjEQ_WELD
    if not len(both):  # MuJoCo omits a loop that nothing can move
        return np.zeros((6 if weld else 3, 1 + compiled.nv))
    both = -both  # MuJoCo has first minus second
    if weld:
        # MuJoCo's rows are half the rotation vector times torquescale, in the frame of the second end; after a whole
        # turn relative to the drawing, its quaternion and these rows have the opposite sign
        scale = compiled.eq_data[equality, 10] * (
            1.0 if _weld_quaternion(machine, equality)[0] > 0.0 else -1.0
        )
        _, (_, second) = equality_ends(compiled, state, equality)
        both[3:] = second @ both[3:] * (2.0 / scale)
    return both


def _weld_quaternion(machine: CheckedMachine, equality: int) -> np.ndarray:
    """MuJoCo's quaternion (4,) of the first end of a weld in the frame of the second."""
    compiled, state = machine.compiled, machine.state
    ends = int(compiled.eq_obj1id[equality]), int(compiled.eq_obj2id[equality])
    if compiled.eq_objtype[equality] == mujoco.mjtObj.mjOBJ_SITE:
        turned = [
            _product(state.xquat[compiled.site_bodyid[site]], compiled.site_quat[site]) for site in ends
        ]
    else:
        turned = [_product(state.xquat[ends[0]], compiled.eq_data[equality, 6:10]), state.xquat[ends[1]]]
    return _product(turned[1] * np.array([1.0, -1.0, -1.0, -1.0]), turned[0])


def _product(first: np.ndarray, second: np.ndarray) -> np.ndarray:
    product = np.zeros(4)
    mujoco.mju_mulQuat(product, first, second)
    return product


def _pinocchio_rows(machine: CheckedMachine, q: np.ndarray, turn: np.ndarray) -> list[np.ndarray]:
    """Pinocchio's residual and Jacobian (3 or 6, 1 + nv) of every loop, rotated from its first anchor to the world."""
    model, data = machine.model, machine.data
    pin.computeJointJacobians(model, data, q)
    blocks = []
    for loop, constraint in zip(
        machine.geometry.loops, loop_constraints(machine.geometry, model), strict=True
    ):
        scratch = constraint.createData()
        constraint.calc(model, data, scratch)
        error = np.asarray(scratch.constraint_position_error).reshape(-1, 1)
        rows = np.hstack((error, constraint.jacobian(model, data, scratch) @ turn))
        first = data.oMi[loop.first.joint + 1].rotation @ loop.first.placement.rotation
        blocks.append(np.vstack([first @ rows[at : at + 3] for at in range(0, loop.size, 3)]))
    return blocks


def gaps(machine: CheckedMachine, q: np.ndarray) -> list[tuple[float, float]]:
    """The opening of each loop at q (nq,) from MuJoCo's body poses: m between the points, rad for a weld, else 0."""
    set_pose(machine, q)
    distances = []
    for equality in active_equalities(machine.compiled)[0]:
        (first, first_turn), (second, second_turn) = equality_ends(machine.compiled, machine.state, equality)
        angle = 0.0
        if machine.compiled.eq_type[equality] == mujoco.mjtEq.mjEQ_WELD:
            turn = first_turn.T @ second_turn
            axis = 0.5 * np.array([turn[2, 1] - turn[1, 2], turn[0, 2] - turn[2, 0], turn[1, 0] - turn[0, 1]])
            angle = float(np.arctan2(np.linalg.norm(axis), (np.trace(turn) - 1.0) / 2.0))
        distances.append((float(np.linalg.norm(second - first)), angle))
    return distances


def equality_ends(
    compiled: mujoco.MjModel, state: mujoco.MjData, equality: int
) -> list[tuple[np.ndarray, np.ndarray]]:
    """Position (3,) m and rotation (3, 3) in the world of both ends that a connect or weld holds together."""
    ids = int(compiled.eq_obj1id[equality]), int(compiled.eq_obj2id[equality])
    if compiled.eq_objtype[equality] == mujoco.mjtObj.mjOBJ_SITE:
        return [(state.site_xpos[site], state.site_xmat[site].reshape(3, 3)) for site in ids]
    parts, turns = compiled.eq_data[equality], [np.eye(3), np.eye(3)]
    anchors = [parts[0:3], parts[3:6]]
    if compiled.eq_type[equality] == mujoco.mjtEq.mjEQ_WELD:
        # eq_data begins with a weld's second anchor; its elements 6 to 9 rotate a weld's first end
        anchors, turns[0] = anchors[::-1], rotation_matrix(parts[6:10])
    ends = []
    for body, anchor, turn in zip(ids, anchors, turns, strict=True):
        rotation = state.xmat[body].reshape(3, 3)
        ends.append((state.xpos[body] + rotation @ anchor, rotation @ turn))
    return ends
