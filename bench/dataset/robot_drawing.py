"""Correct rounding errors of a drawing when a robot is read.

A CAD export rounds positions and directions. Loops are then slightly open in the home pose, and redundant closures
(of a planar or spherical linkage in space) contradict one another slightly in all poses. Newton's method closes the
home pose. If closures contradict one another, the smallest changes of the poses of bodies and sites are applied that
make them agree in many poses at once. Both corrections stay within ROUNDING; a larger error is a mistake that `bench
robot check` reports.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import mujoco
import numpy as np

from bench.basics.joint_units import joint_units
from bench.dataset.home_qpos import home_qpos

ROUNDING = 1e-5  # m or rad: largest gap from the rounding of a drawing; a wider gap is a mistake
CLOSED = 1e-9  # m or rad: a smaller gap counts as closed
DEPENDENT = (
    1e-4  # of the largest singular value: equations below are redundant, apart from rounding of the drawing
)
POSES, MANY_POSES = 10, 60  # number of poses for comparing loops, and for making them agree
STEP = 0.1  # rad or m: standard deviation of each free motion from one pose to the next
PERTURBATION = 1e-6  # m or rad: of a body's or site's pose, for the derivatives
MOST_STEPS = 20
SEED = 20120607


@dataclass(frozen=True)
class _Closures:
    """A compiled file with only its equalities, and scratch space."""

    model: mujoco.MjModel
    data: mujoco.MjData

    def at(self, qpos: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Gaps of the equalities (m,) [m, rad] at qpos (nq,), and their Jacobian (m, nv)."""
        self.data.qpos[:] = qpos
        mujoco.mj_kinematics(self.model, self.data)
        mujoco.mj_comPos(self.model, self.data)
        mujoco.mj_tendon(self.model, self.data)
        mujoco.mj_makeConstraint(self.model, self.data)
        return np.array(self.data.efc_pos), np.array(self.data.efc_J).reshape(self.data.nefc, self.model.nv)

    def closed(self, qpos: np.ndarray) -> np.ndarray:
        """The pose (nq,) near qpos that closes the loops in the least-squares sense."""
        for _ in range(MOST_STEPS):
            gap, jacobian = self.at(qpos)
            move = -np.linalg.lstsq(jacobian, gap, rcond=DEPENDENT)[0]
            qpos = qpos.copy()
            mujoco.mj_integratePos(self.model, qpos, move, 1.0)
            if np.abs(move).max(initial=0.0) < CLOSED * ROUNDING:
                break
        return qpos

    def poses(self, home: np.ndarray, count: int) -> list[np.ndarray]:
        """Closed poses, each a random free step from the previous one, or home again if that cannot be closed."""
        random = np.random.default_rng(SEED)
        poses, pose = [], home
        for _ in range(count):
            _, jacobian = self.at(pose)
            _, values, motions = np.linalg.svd(jacobian)
            free = motions[int((values > DEPENDENT * values.max(initial=0.0)).sum()) :]
            qpos = pose.copy()
            mujoco.mj_integratePos(self.model, qpos, STEP * random.normal(size=len(free)) @ free, 1.0)
            qpos = self.closed(qpos)
            pose = qpos if self.open_by(qpos) < ROUNDING else home
            poses.append(pose)
        return poses

    def turns(self, row: int) -> bool:
        """Whether a row of the gaps is an angle: the last three of a weld, and a coupling of hinges."""
        equality = int(self.data.efc_id[row])
        kind, first = int(self.model.eq_type[equality]), int(self.model.eq_obj1id[equality])
        if kind == int(mujoco.mjtEq.mjEQ_WELD):
            return row - int(np.argmax(self.data.efc_id == equality)) >= 3
        if kind == int(mujoco.mjtEq.mjEQ_TENDON):
            kind = int(mujoco.mjtEq.mjEQ_JOINT)
            first = int(self.model.wrap_objid[self.model.tendon_adr[first]])
        hinge = int(mujoco.mjtJoint.mjJNT_HINGE)
        return kind == int(mujoco.mjtEq.mjEQ_JOINT) and int(self.model.jnt_type[first]) == hinge

    def open_by(self, qpos: np.ndarray) -> float:
        """The widest gap, m or rad."""
        return float(np.abs(self.at(qpos)[0]).max(initial=0.0))


def take_up_rounding(spec: mujoco.MjSpec) -> mujoco.MjSpec:
    """The file with a closed home and consistent loops; unchanged if exact to CLOSED or off by more than ROUNDING."""
    closures = _closures(spec)
    if not closures.model.neq:
        return spec
    home = home_qpos(closures.model)
    closed = closures.closed(home)
    if closures.open_by(home) > ROUNDING or closures.open_by(closed) > ROUNDING:
        return spec
    if max(closures.open_by(pose) for pose in closures.poses(closed, POSES)) > CLOSED:
        corrected = _with_agreeing_loops(spec.copy(), home)
        if corrected is not None:
            spec = corrected
            closures = _closures(spec)
            closed = closures.closed(home)
    if closures.open_by(home) > CLOSED:
        key = next((key for key in spec.keys if key.name == "home"), None) or spec.add_key(name="home")
        key.qpos = closed.tolist()
    return spec


def home_gap(spec: mujoco.MjSpec) -> tuple[float, str]:
    """The widest gap of the equalities in the home pose of a file, and its unit: m or rad."""
    closures = _closures(spec)
    gaps = np.abs(closures.at(home_qpos(closures.model))[0]) if closures.model.neq else np.zeros(0)
    if not len(gaps):
        return 0.0, "m"
    row = int(np.argmax(gaps))
    return float(gaps[row]), joint_units(closures.turns(row)).position


def _closures(spec: mujoco.MjSpec) -> _Closures:
    model = spec.compile()
    model.opt.jacobian = mujoco.mjtJacobian.mjJAC_DENSE
    for flag in ("CONTACT", "LIMIT", "FRICTIONLOSS"):
        model.opt.disableflags |= int(getattr(mujoco.mjtDisableBit, f"mjDSBL_{flag}"))
    return _Closures(model, mujoco.MjData(model))


def _with_agreeing_loops(spec: mujoco.MjSpec, home: np.ndarray) -> mujoco.MjSpec | None:
    """The file with bodies and sites moved by the smallest changes that make its loops agree; None if no changes
    within ROUNDING do, or a body or site is in a <frame>.
    """
    _anchors_as_sites(spec)
    closures = _closures(spec)
    model = closures.model
    parts = (*spec.bodies[1:], *spec.sites)
    if any(part.frame is not None for part in parts):
        return None
    places = [(model.body_pos, model.body_quat, body) for body in range(1, model.nbody)]
    places += [(model.site_pos, model.site_quat, site) for site in range(model.nsite)]
    poses = closures.poses(closures.closed(home), MANY_POSES)
    for _ in range(MOST_STEPS):
        open_by, sensitive = [], []
        for pose in poses:
            gap, jacobian = closures.at(pose)
            vectors, values, _ = np.linalg.svd(jacobian)
            repeated = vectors[:, int((values > DEPENDENT * values.max(initial=0.0)).sum()) :].T
            open_by.append(repeated @ gap)
            sensitive.append(repeated @ _sensitivity(closures, places, pose, gap))
        change = -np.linalg.lstsq(np.vstack(sensitive), np.concatenate(open_by), rcond=DEPENDENT)[0]
        if np.abs(change).max() > ROUNDING:
            return None
        for place, step in zip(places, change.reshape(-1, 6), strict=True):
            _move(place, step)
        poses = [closures.closed(pose) for pose in poses]
        if max(closures.open_by(pose) for pose in poses) < CLOSED:
            for part, (positions, quaternions, index) in zip(parts, places, strict=True):
                part.alt.type = mujoco.mjtOrientation.mjORIENTATION_QUAT
                part.pos, part.quat = positions[index], quaternions[index]
            return spec
    return None


_Place = tuple[np.ndarray, np.ndarray, int]


def _sensitivity(
    closures: _Closures, places: Sequence[_Place], pose: np.ndarray, gap: np.ndarray
) -> np.ndarray:
    """Derivative (m, 6 places) of the gaps at a pose with respect to the shift [m] and rotation [rad] of each place."""
    columns = []
    for place in places:
        positions, quaternions, index = place
        before = positions[index].copy(), quaternions[index].copy()
        for direction in np.eye(6):
            _move(place, PERTURBATION * direction)
            columns.append((closures.at(pose)[0] - gap) / PERTURBATION)
            positions[index], quaternions[index] = before
    return np.array(columns).T


def _move(place: _Place, change: np.ndarray) -> None:
    """Shift a place in its parent's frame by change[:3], and rotate it in its body frame by change[3:]."""
    positions, quaternions, index = place
    positions[index] += change[:3]
    turned = quaternions[index].copy()
    mujoco.mju_quatIntegrate(turned, change[3:], 1.0)
    quaternions[index] = turned


def _anchors_as_sites(spec: mujoco.MjSpec) -> None:
    """Replace the bodies in closures by sites, since MuJoCo derives the second anchor of bodies from qpos0."""
    model = spec.compile()
    identity = [1.0, 0.0, 0.0, 0.0]
    for index, equality in enumerate(spec.equalities):
        kind, bodies = equality.type, equality.objtype == mujoco.mjtObj.mjOBJ_BODY
        if not bodies or kind not in (mujoco.mjtEq.mjEQ_CONNECT, mujoco.mjtEq.mjEQ_WELD):
            continue
        data = model.eq_data[index]
        first, second = (data[0:3], identity), (data[3:6], identity)
        if kind == mujoco.mjtEq.mjEQ_WELD:
            first, second = (data[3:6], data[6:10]), (data[0:3], identity)
        equality.objtype = mujoco.mjtObj.mjOBJ_SITE
        equality.name1, equality.name2 = names = f"closure:{index}:first", f"closure:{index}:second"
        ends = (model.eq_obj1id[index], model.eq_obj2id[index])
        for name, body, (pos, quat) in zip(names, ends, (first, second), strict=True):
            spec.bodies[int(body)].add_site(name=name, pos=pos, quat=quat)
