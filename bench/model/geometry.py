"""Read geometry, joints, gravity and loop closures from an MJCF, and nothing else.

Masses and inertias of the file are never read: they are the simulator's truth or a user's CAD values.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Literal

import mujoco
import numpy as np

from bench.basics.errors import BenchError
from bench.dataset.home_qpos import home_qpos
from bench.dataset.robot import Robot
from bench.dataset.robot_mjcf import ROTOR
from bench.model.cures import cure_in_words, floating_base, joints_in_words, no_motor_in_words, what_to_do
from bench.model.supported import unsupported_features

JointKind = Literal["hinge", "slide", "ball", "free"]
KINDS: dict[int, JointKind] = {
    int(mujoco.mjtJoint.mjJNT_HINGE): "hinge",
    int(mujoco.mjtJoint.mjJNT_SLIDE): "slide",
    int(mujoco.mjtJoint.mjJNT_BALL): "ball",
    int(mujoco.mjtJoint.mjJNT_FREE): "free",
}
CONFIGURATION_SIZE: dict[JointKind, int] = {"hinge": 1, "slide": 1, "ball": 4, "free": 7}
COUPLINGS = (int(mujoco.mjtEq.mjEQ_JOINT), int(mujoco.mjtEq.mjEQ_TENDON))
POWERS = 5  # coefficients of an equality's polynomial
VELOCITY_SIZE: dict[JointKind, int] = {"hinge": 1, "slide": 1, "ball": 3, "free": 6}


@dataclass(frozen=True)
class Placement:
    """A pose: rotation (3, 3) and translation (3,) in m, of a frame in its parent frame."""

    rotation: np.ndarray
    translation: np.ndarray

    def __matmul__(self, other: "Placement") -> "Placement":
        return Placement(self.rotation @ other.rotation, self.rotation @ other.translation + self.translation)

    def inverse(self) -> "Placement":
        """The parent frame in this frame."""
        return Placement(self.rotation.T, -self.rotation.T @ self.translation)


@dataclass(frozen=True)
class Joint:
    """One joint of the opened tree.

    The joint frame has the orientation of its body and its origin on the joint; `placement` is this frame in the frame
    of the joint `parent` (-1: the world) at zero joint position. `body` names the body that the joint carries, None if
    another joint of this body follows or only a rotor turns. `offset` is the MuJoCo joint position at which the model's
    position is zero; `limits` are in the file's coordinate, rad or m.
    """

    name: str
    kind: JointKind
    parent: int
    placement: Placement
    axis: np.ndarray
    body: str | None
    q: slice
    v: slice
    offset: float
    limits: tuple[float, float] | None


@dataclass(frozen=True)
class Anchor:
    """A point fixed to joint frame `joint` (-1: the world), with the orientation for a weld."""

    joint: int
    placement: Placement


@dataclass(frozen=True)
class Loop:
    """A loop closure: `connect` holds two points together (3 equations), `weld` two frames (6)."""

    name: str
    kind: Literal["connect", "weld"]
    first: Anchor
    second: Anchor

    @property
    def size(self) -> int:
        """Number of equations."""
        return 3 if self.kind == "connect" else 6


@dataclass(frozen=True)
class Coupling:
    """A gear, a belt, a differential: one equation, sum of first = p(sum of second).

    first, second: (joint, factor) of hinges and slides, whose positions count from `Joint.offset`; polynomial: the
    coefficients of p, that of the lowest power first [rad or m for rad or m].
    """

    name: str
    first: tuple[tuple[int, float], ...]
    second: tuple[tuple[int, float], ...]
    polynomial: tuple[float, ...]


# compared by identity, so that results can be cached by geometry
@dataclass(frozen=True, eq=False)
class Geometry:
    """All that identification knows of a robot except for measurements.

    `home` is the assembled pose (nq,) in Pinocchio's coordinates (quaternions x y z w); `active` are the
    velocity indices (n,) of the actuated joints that move independently, in actuator order, `redundant` those (r,) of
    the other joints with a motor, which count as passive; `tool` is where a payload is fixed;
    `body_frames` has for every body of the file the joint that moves it (-1: none) and its frame in that joint's.
    """

    robot: Robot
    joints: tuple[Joint, ...]
    loops: tuple[Loop, ...]
    couplings: tuple[Coupling, ...]
    gravity: np.ndarray
    home: np.ndarray
    active: np.ndarray
    redundant: np.ndarray
    tool: Anchor | None
    body_frames: Mapping[str, tuple[int, Placement]]

    @property
    def nq(self) -> int:
        """Size of a configuration."""
        return self.joints[-1].q.stop

    @property
    def nv(self) -> int:
        """Size of a velocity: the degrees of freedom of the opened tree."""
        return self.joints[-1].v.stop

    @property
    def closed(self) -> bool:
        """Whether loops or couplings determine the motion of joints."""
        return bool(self.loops or self.couplings)

    @cached_property
    def passive(self) -> np.ndarray:
        """Velocity indices that the loop closures determine."""
        return np.setdiff1d(np.arange(self.nv), self.active)

    @cached_property
    def active_joints(self) -> tuple[Joint, ...]:
        """The joints of `active`, in actuator order."""
        by_velocity = {joint.v.start: joint for joint in self.joints}
        return tuple(by_velocity[int(index)] for index in self.active)

    @cached_property
    def active_configuration(self) -> np.ndarray:
        """Configuration indices of the actuated joints, in actuator order."""
        return np.array([joint.q.start for joint in self.active_joints])

    @cached_property
    def active_offset(self) -> np.ndarray:
        """(n,) MuJoCo positions of the actuated joints at which the model's positions are zero, rad or m."""
        return np.array([joint.offset for joint in self.active_joints])

    @property
    def bodies(self) -> tuple[tuple[int, str], ...]:
        """(joint index, body name) of every moving body."""
        return tuple((i, joint.body) for i, joint in enumerate(self.joints) if joint.body is not None)

    def joint_at(self, v: int) -> Joint:
        """The joint of a velocity, by its index."""
        return next(joint for joint in self.joints if joint.v.start <= v < joint.v.stop)

    def joint_index(self, name: str) -> int:
        """Index of a joint by its name; BenchError if there is none."""
        for i, joint in enumerate(self.joints):
            if joint.name == name:
                return i
        known = ", ".join(joint.name for joint in self.joints)
        raise BenchError(f"robot {self.robot.name}: no joint {name!r}; joints: {known}")


def read_geometry(robot: Robot) -> Geometry:
    """Compile the robot's MJCF and keep its geometry.

    Raises BenchError naming the joint or the equality that is not supported.
    """
    try:
        compiled = robot.mjcf_model()
    except ValueError as error:
        raise BenchError(f"{robot.model_path}: {str(error).splitlines()[0]}") from None
    for fault in unsupported_features(compiled):
        raise BenchError(f"robot {robot.name}: {fault}")
    joints, frames = _joints(compiled)
    if not joints:
        raise BenchError(f"{robot.model_path}: the model has no joint")
    loops = _loops(compiled, frames)
    names = {joint.name: joint for joint in joints}
    for actuator in robot.motors:
        if actuator.joint not in names:
            raise BenchError(f"{robot.model_path}: no joint {actuator.joint!r}, which robot.toml actuates")
    geometry = Geometry(
        robot=robot,
        joints=joints,
        loops=loops,
        couplings=_couplings(compiled),
        gravity=compiled.opt.gravity.copy(),
        home=from_mujoco(joints, home_qpos(compiled)[None, :])[0],
        active=np.array([names[actuator.joint].v.start for actuator in robot.actuators]),
        redundant=np.array([names[actuator.joint].v.start for actuator in robot.redundant], dtype=int),
        tool=_tool(robot, compiled, frames),
        body_frames={
            _name(compiled, mujoco.mjtObj.mjOBJ_BODY, body, f"body_{body}"): frame
            for body, frame in frames.items()
        },
    )
    if (floating := floating_base(geometry)) is not None:
        raise BenchError(f"robot {robot.name}: {cure_in_words(floating)}")
    if len(geometry.passive) and not geometry.closed:
        free = [joint for joint in joints if joint.v.start not in geometry.active]
        cure = what_to_do(geometry, [joint.name for joint in free], np.zeros((0, len(geometry.passive))), 0)
        said = f"{joints_in_words(free)} {no_motor_in_words(len(free))}"
        raise BenchError(f"robot {robot.name}: {said}{cure_in_words(cure)}")
    return geometry


def _joints(compiled: mujoco.MjModel) -> tuple[tuple[Joint, ...], dict[int, tuple[int, Placement]]]:
    """The joints in tree order, and for every body its (joint index, placement in that joint's frame)."""
    world = Placement(np.eye(3), np.zeros(3))
    frames: dict[int, tuple[int, Placement]] = {0: (-1, world)}
    joints: list[Joint] = []
    nq = nv = 0
    for body in range(1, compiled.nbody):
        carried = _name(compiled, mujoco.mjtObj.mjOBJ_BODY, body, f"body_{body}")
        parent, placement = frames[int(compiled.body_parentid[body])]
        frame = placement @ Placement(
            rotation_matrix(compiled.body_quat[body]), compiled.body_pos[body].copy()
        )
        first = int(compiled.body_jntadr[body])
        count = int(compiled.body_jntnum[body])
        for index in range(first, first + count):
            kind = KINDS[int(compiled.jnt_type[index])]
            point = np.zeros(3) if kind == "free" else compiled.jnt_pos[index].copy()
            at = world if kind == "free" else frame @ Placement(np.eye(3), point)
            limits = compiled.jnt_range[index] if compiled.jnt_limited[index] else None
            joints.append(
                Joint(
                    name=_name(compiled, mujoco.mjtObj.mjOBJ_JOINT, index, f"joint_{index}"),
                    kind=kind,
                    parent=parent,
                    placement=at,
                    axis=compiled.jnt_axis[index].copy(),
                    body=carried if index == first + count - 1 and not carried.startswith(ROTOR) else None,
                    q=slice(nq, nq + CONFIGURATION_SIZE[kind]),
                    v=slice(nv, nv + VELOCITY_SIZE[kind]),
                    offset=float(compiled.qpos0[compiled.jnt_qposadr[index]])
                    if kind in ("hinge", "slide")
                    else 0.0,
                    limits=None if limits is None else (float(limits[0]), float(limits[1])),
                )
            )
            nq += CONFIGURATION_SIZE[kind]
            nv += VELOCITY_SIZE[kind]
            parent, frame = len(joints) - 1, Placement(np.eye(3), -point)
        frames[body] = (parent, frame)
    return tuple(joints), frames


def _loops(compiled: mujoco.MjModel, frames: dict[int, tuple[int, Placement]]) -> tuple[Loop, ...]:
    loops = []
    for index in range(compiled.neq):
        name = _name(compiled, mujoco.mjtObj.mjOBJ_EQUALITY, index, f"equality_{index}")
        if not compiled.eq_active0[index]:
            continue
        kind = int(compiled.eq_type[index])
        if kind in COUPLINGS:
            continue
        connect = kind == int(mujoco.mjtEq.mjEQ_CONNECT)
        ids = int(compiled.eq_obj1id[index]), int(compiled.eq_obj2id[index])
        if int(compiled.eq_objtype[index]) == int(mujoco.mjtObj.mjOBJ_SITE):
            bodies = tuple(int(compiled.site_bodyid[site]) for site in ids)
            local = tuple(
                Placement(rotation_matrix(compiled.site_quat[site]), compiled.site_pos[site].copy())
                for site in ids
            )
        else:
            bodies, data = ids, compiled.eq_data[index]
            local = (
                (Placement(np.eye(3), data[0:3].copy()), Placement(np.eye(3), data[3:6].copy()))
                if connect
                else (
                    Placement(rotation_matrix(data[6:10]), data[3:6].copy()),
                    Placement(np.eye(3), data[0:3].copy()),
                )
            )
        ends = []
        for body, place in zip(bodies, local, strict=True):
            joint, frame = frames[body]
            ends.append(Anchor(joint, frame @ place))
        loops.append(Loop(name, "connect" if connect else "weld", ends[0], ends[1]))
    return tuple(loops)


def _couplings(compiled: mujoco.MjModel) -> tuple[Coupling, ...]:
    couplings = []
    for index in range(compiled.neq):
        if not compiled.eq_active0[index] or int(compiled.eq_type[index]) not in COUPLINGS:
            continue
        by_tendon = int(compiled.eq_type[index]) == int(mujoco.mjtEq.mjEQ_TENDON)
        ends = [
            () if end < 0 else _tendon_joints(compiled, end) if by_tendon else ((end, 1.0),)
            for end in (int(compiled.eq_obj1id[index]), int(compiled.eq_obj2id[index]))
        ]
        polynomial = compiled.eq_data[index, :POWERS] if ends[1] else compiled.eq_data[index, :1]
        name = _name(compiled, mujoco.mjtObj.mjOBJ_EQUALITY, index, f"equality_{index}")
        couplings.append(Coupling(name, ends[0], ends[1], tuple(np.trim_zeros(polynomial, "b").tolist())))
    return tuple(couplings)


def _tendon_joints(compiled: mujoco.MjModel, tendon: int) -> tuple[tuple[int, float], ...]:
    first = int(compiled.tendon_adr[tendon])
    wraps = range(first, first + int(compiled.tendon_num[tendon]))
    return tuple((int(compiled.wrap_objid[wrap]), float(compiled.wrap_prm[wrap])) for wrap in wraps)


def from_mujoco(joints: tuple[Joint, ...], qpos: np.ndarray) -> np.ndarray:
    """MuJoCo positions (N, nq) in Pinocchio's coordinates: offsets subtracted, quaternions x y z w."""
    q = np.array(qpos, dtype=float)
    for joint in joints:
        if joint.kind in ("hinge", "slide"):
            q[:, joint.q] -= joint.offset
        else:
            quaternion = slice(joint.q.stop - 4, joint.q.stop)
            q[:, quaternion] = np.roll(q[:, quaternion], -1, axis=1)
    return q


def to_mujoco(joints: tuple[Joint, ...], q: np.ndarray) -> np.ndarray:
    """Positions (N, nq) in Pinocchio's coordinates in MuJoCo's; the inverse of `from_mujoco`."""
    qpos = np.array(q, dtype=float)
    for joint in joints:
        if joint.kind in ("hinge", "slide"):
            qpos[:, joint.q] += joint.offset
        else:
            quaternion = slice(joint.q.stop - 4, joint.q.stop)
            qpos[:, quaternion] = np.roll(qpos[:, quaternion], 1, axis=1)
    return qpos


def _tool(robot: Robot, compiled: mujoco.MjModel, frames: dict[int, tuple[int, Placement]]) -> Anchor | None:
    if robot.tool_site is None:
        return None
    site = mujoco.mj_name2id(compiled, mujoco.mjtObj.mjOBJ_SITE, robot.tool_site)
    if site < 0:
        raise BenchError(
            f"{robot.model_path}: no site {robot.tool_site!r}, which robot.toml names as the tool"
        )
    joint, frame = frames[int(compiled.site_bodyid[site])]
    if joint < 0:
        moving = [
            _name(compiled, mujoco.mjtObj.mjOBJ_SITE, other, "")
            for other in range(compiled.nsite)
            if frames[int(compiled.site_bodyid[other])][0] >= 0
        ]
        named = ", ".join(repr(name) for name in moving if name)
        raise BenchError(
            f"{robot.model_path}: the tool site {robot.tool_site!r} does not move, since no joint carries it; "
            + (f"sites that move: {named}" if named else 'write <site name="tool"/> into a body that moves')
        )
    place = Placement(rotation_matrix(compiled.site_quat[site]), compiled.site_pos[site].copy())
    return Anchor(joint, frame @ place)


def rotation_matrix(quaternion: np.ndarray) -> np.ndarray:
    """The rotation matrix (3, 3) of a quaternion w x y z."""
    matrix = np.empty(9)
    mujoco.mju_quat2Mat(matrix, np.asarray(quaternion, dtype=float))
    return matrix.reshape(3, 3)


def _name(compiled: mujoco.MjModel, kind: mujoco.mjtObj, index: int, otherwise: str) -> str:
    return mujoco.mj_id2name(compiled, kind, index) or otherwise
