"""The shapes of a robot's bodies, and their poses during a recording with closed loops."""

from collections.abc import Iterator
from dataclasses import dataclass

import mujoco
import numpy as np
import rerun as rr

from bench.basics.errors import BenchError
from bench.dataset.recording import Recording
from bench.dataset.robot import Robot
from bench.model.geometry import Geometry, read_geometry, rotation_matrix, to_mujoco
from bench.model.motion import motion_of
from bench.model.nodes import of_recording
from bench.robot_check.loops import active_equalities, equality_ends
from bench.signals.processing import estimate_motion, trim
from bench.signals.settings import FilterSettings

HIDDEN_GROUPS = 3  # MuJoCo's viewer does not draw geom groups from this one on: mostly collision shapes
DARKEST = 0.30  # luminance below which a colour is lightened, so that it is visible on a dark background
SEEN_THROUGH = 90  # opacity of a mesh in outline, 0 to 255
PLAIN = (0.5, 0.5, 0.5, 1.0)  # MuJoCo's default colour, which a material's colour replaces

_DRAWN = {
    int(mujoco.mjtGeom.mjGEOM_BOX): "boxes",
    int(mujoco.mjtGeom.mjGEOM_CAPSULE): "capsules",
    int(mujoco.mjtGeom.mjGEOM_CYLINDER): "cylinders",
    int(mujoco.mjtGeom.mjGEOM_SPHERE): "ellipsoids",
    int(mujoco.mjtGeom.mjGEOM_ELLIPSOID): "ellipsoids",
    int(mujoco.mjtGeom.mjGEOM_MESH): "mesh",
}

Colour = tuple[int, int, int, int]
"""Red, green, blue and opacity, 0 to 255."""

FRAME_RATE = 50.0  # Hz: smooth to the eye


@dataclass(frozen=True)
class GeomShape:
    """A shape of one body: its name, unique for this body, and the viewer's components."""

    body: int
    name: str
    archetypes: tuple[rr.AsComponents, ...]


def visible_geoms(model: mujoco.MjModel) -> np.ndarray:
    """Indices of the drawn geoms: of a kind in `_DRAWN` (no planes), not transparent, not in a hidden group."""
    return np.array(
        [
            geom
            for geom in range(model.ngeom)
            if int(model.geom_type[geom]) in _DRAWN
            and model.geom_group[geom] < HIDDEN_GROUPS
            and _colour(model, geom)[3] > 0
        ],
        dtype=int,
    )


def shapes(model: mujoco.MjModel, outline: Colour | None = None) -> Iterator[GeomShape]:
    """The visible geoms of every body, in its frame; geoms of one kind together, except meshes.

    outline: colour of a wireframe drawn instead of solids; a mesh is drawn translucent instead.
    """
    geoms = visible_geoms(model)
    for body in range(model.nbody):
        of_body = geoms[model.geom_bodyid[geoms] == body]
        by_kind: dict[str, list[int]] = {}
        for geom in of_body:
            by_kind.setdefault(_DRAWN[int(model.geom_type[geom])], []).append(int(geom))
        for kind, members in by_kind.items():
            if kind == "mesh":
                for number, geom in enumerate(members):
                    yield GeomShape(body, f"mesh_{number}", _mesh(model, geom, outline))
            else:
                yield GeomShape(body, kind, (_solids(model, kind, np.array(members), outline),))


def _solids(model: mujoco.MjModel, kind: str, geoms: np.ndarray, outline: Colour | None) -> rr.AsComponents:
    size, centers = model.geom_size[geoms], model.geom_pos[geoms]
    quaternions = np.roll(model.geom_quat[geoms], -1, axis=1)
    colors = [outline or _colour(model, geom) for geom in geoms]
    fill = rr.components.FillMode.Solid if outline is None else rr.components.FillMode.MajorWireframe
    common = {"quaternions": quaternions, "colors": colors, "fill_mode": fill}
    if kind == "boxes":
        return rr.Boxes3D(half_sizes=size, centers=centers, **common)
    if kind == "ellipsoids":
        spheres = model.geom_type[geoms] == int(mujoco.mjtGeom.mjGEOM_SPHERE)
        size = np.where(spheres[:, None], size[:, :1], size)
        return rr.Ellipsoids3D(half_sizes=size, centers=centers, **common)
    common |= {"lengths": 2.0 * size[:, 1], "radii": size[:, 0]}
    if kind == "cylinders":
        return rr.Cylinders3D(centers=centers, **common)
    # Rerun places a capsule by its first end, MuJoCo by its centre.
    axes = np.array([rotation_matrix(quaternion)[:, 2] for quaternion in model.geom_quat[geoms]])
    return rr.Capsules3D(translations=centers - axes * size[:, 1:2], **common)


def _mesh(model: mujoco.MjModel, geom: int, outline: Colour | None) -> tuple[rr.AsComponents, ...]:
    mesh = int(model.geom_dataid[geom])
    vertices = slice(model.mesh_vertadr[mesh], model.mesh_vertadr[mesh] + model.mesh_vertnum[mesh])
    faces = slice(model.mesh_faceadr[mesh], model.mesh_faceadr[mesh] + model.mesh_facenum[mesh])
    points, triangles = model.mesh_vert[vertices], model.mesh_face[faces]
    # One normal per face, with corners not shared, keeps edges sharp.
    corners = points[triangles]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    normals /= np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-12)
    return (
        rr.Mesh3D(
            vertex_positions=corners.reshape(-1, 3),
            vertex_normals=np.repeat(normals, 3, axis=0),
            triangle_indices=np.arange(3 * len(triangles)).reshape(-1, 3),
            albedo_factor=_colour(model, geom) if outline is None else (*outline[:3], SEEN_THROUGH),
        ),
        rr.Transform3D(
            translation=model.geom_pos[geom],
            quaternion=rr.Quaternion(xyzw=np.roll(model.geom_quat[geom], -1)),
        ),
    )


def _colour(model: mujoco.MjModel, geom: int) -> Colour:
    """The colour of a geom, light enough for a dark background."""
    colour, material = model.geom_rgba[geom], int(model.geom_matid[geom])
    rgba = model.mat_rgba[material] if material >= 0 and np.allclose(colour, PLAIN) else colour
    color = np.asarray(rgba[:3], dtype=float)
    luminance = float(color @ (0.2126, 0.7152, 0.0722))
    if luminance < DARKEST:
        color = color + (1.0 - color) * (DARKEST - luminance) / (1.0 - luminance)
    red, green, blue = (round(255 * float(value)) for value in np.clip(color, 0.0, 1.0))
    return red, green, blue, round(255 * float(rgba[3]))


@dataclass(frozen=True)
class BodyMotion:
    """Poses of all bodies in the world.

    time (F,) s, as logged; positions (F, nbody, 3) m; quaternions (F, nbody, 4), x y z w; tool_position
    (F, 3) m and tool_quaternion (F, 4), None without a tool; loop_gap (F, loops) m: opening of each loop as drawn; low,
    high (3,) m: the box that contains all shapes in all frames.
    """

    time: np.ndarray
    positions: np.ndarray
    quaternions: np.ndarray
    tool_position: np.ndarray | None
    tool_quaternion: np.ndarray | None
    loop_gap: np.ndarray
    low: np.ndarray
    high: np.ndarray


def body_motion(
    model: mujoco.MjModel, geometry: Geometry, recording: Recording, settings: FilterSettings
) -> BodyMotion:
    """Filter the positions as in the fit, close the loops and place all bodies, about FRAME_RATE times a second.

    Raises BenchError naming the recording and the time of a sample that is out of reach or singular.
    """
    motion = estimate_motion(recording.position, recording.rate, settings)
    time = trim(recording.time, settings)
    step = max(1, round(recording.rate / FRAME_RATE))
    states = [x[::step] for x in (time, motion.position, motion.velocity, motion.acceleration)]
    try:
        tree = motion_of(geometry, *states)
    except BenchError as error:
        raise of_recording(recording.name, error) from None
    return placed(model, geometry.robot.tool_site, time[::step], to_mujoco(geometry.joints, tree.q))


def recorded_motion(robot: Robot, recording: Recording, settings: FilterSettings) -> BodyMotion:
    """`body_motion` of one recording; reads the robot's MJCF and geometry."""
    return body_motion(robot.mjcf_model(), read_geometry(robot), recording, settings)


def tool_path(
    model: mujoco.MjModel, geometry: Geometry, time: np.ndarray, position: np.ndarray
) -> np.ndarray | None:
    """Tool positions (F, 3), m, at positions (F, n) of the actuated joints, for example a controller's references.

    None without a tool or with fewer than two samples. Raises BenchError for a sample out of reach or singular.
    """
    if geometry.robot.tool_site is None or len(time) < 2:
        return None
    velocity = np.gradient(position, time, axis=0)
    tree = motion_of(geometry, time, position, velocity, np.gradient(velocity, time, axis=0))
    return placed(model, geometry.robot.tool_site, time, to_mujoco(geometry.joints, tree.q)).tool_position


def placed(model: mujoco.MjModel, tool_site: str | None, time: np.ndarray, qpos: np.ndarray) -> BodyMotion:
    """The bodies at MuJoCo positions qpos (F, nq)."""
    data = mujoco.MjData(model)
    site = -1 if tool_site is None else mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_SITE, tool_site)
    geoms = visible_geoms(model)
    center, half = model.geom_aabb[geoms, :3, None], model.geom_aabb[geoms, 3:, None]
    count = len(time)
    positions, quaternions = np.empty((count, model.nbody, 3)), np.empty((count, model.nbody, 4))
    tool_position, tool_quaternion = np.empty((count, 3)), np.empty((count, 4))
    loops, _ = active_equalities(model)
    gap = np.zeros((count, len(loops)))
    low, high = np.full(3, np.inf), np.full(3, -np.inf)
    for frame in range(count):
        data.qpos[:] = qpos[frame]
        mujoco.mj_kinematics(model, data)
        positions[frame], quaternions[frame] = data.xpos, data.xquat
        if site >= 0:
            tool_position[frame] = data.site_xpos[site]
            mujoco.mju_mat2Quat(tool_quaternion[frame], data.site_xmat[site])
        for k, loop in enumerate(loops):
            (first, _), (second, _) = equality_ends(model, data, loop)
            gap[frame, k] = np.linalg.norm(first - second)
        if len(geoms):
            turn = data.geom_xmat[geoms].reshape(-1, 3, 3)
            middle = data.geom_xpos[geoms] + (turn @ center)[..., 0]
            reach = (np.abs(turn) @ half)[..., 0]
            low = np.minimum(low, (middle - reach).min(axis=0))
            high = np.maximum(high, (middle + reach).max(axis=0))
    if not len(geoms):
        low, high = positions.min(axis=(0, 1)), positions.max(axis=(0, 1))
    return BodyMotion(
        time=time,
        positions=positions,
        quaternions=np.roll(quaternions, -1, axis=2),
        tool_position=tool_position if site >= 0 else None,
        tool_quaternion=np.roll(tool_quaternion, -1, axis=1) if site >= 0 else None,
        loop_gap=gap,
        low=low,
        high=high,
    )
