"""The shapes of a robot, from the geoms of its MJCF to the viewer's solids."""

from collections.abc import Iterator
from dataclasses import dataclass

import mujoco
import numpy as np
import rerun as rr

HIDDEN_GROUPS = 3  # geom groups from this one on are not drawn by MuJoCo's viewer: collision shapes, mostly
DARKEST = 0.30  # luminance below which a colour is lifted, to be seen on a dark ground
SEEN_THROUGH = 90  # opacity of a mesh in outline, 0 to 255
PLAIN = (0.5, 0.5, 0.5, 1.0)  # MuJoCo's default colour: a material's colour replaces it

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


@dataclass(frozen=True)
class GeomShape:
    """What is drawn for one body: a name among that body's shapes, and what the viewer takes."""

    body: int
    name: str
    archetypes: tuple[rr.AsComponents, ...]


def visible_geoms(model: mujoco.MjModel) -> np.ndarray:
    """Indices of the geoms that are drawn: not transparent, not in a hidden group, not an endless plane."""
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
    """The visible geoms of every body, in its frame; all boxes of a body together, and so on.

    outline: the colour of lines to draw in place of solids; a mesh is then seen through.
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
    if kind == "boxes":
        return rr.Boxes3D(
            half_sizes=size, centers=centers, quaternions=quaternions, colors=colors, fill_mode=fill
        )
    if kind == "ellipsoids":
        spheres = model.geom_type[geoms] == int(mujoco.mjtGeom.mjGEOM_SPHERE)
        size = np.where(spheres[:, None], size[:, :1], size)
        return rr.Ellipsoids3D(
            half_sizes=size, centers=centers, quaternions=quaternions, colors=colors, fill_mode=fill
        )
    if kind == "cylinders":
        return rr.Cylinders3D(
            lengths=2.0 * size[:, 1],
            radii=size[:, 0],
            centers=centers,
            quaternions=quaternions,
            colors=colors,
            fill_mode=fill,
        )
    # A capsule starts at its first end, and is centred in MuJoCo.
    axes = np.array([_rotation(quaternion)[:, 2] for quaternion in model.geom_quat[geoms]])
    return rr.Capsules3D(
        lengths=2.0 * size[:, 1],
        radii=size[:, 0],
        translations=centers - axes * size[:, 1:2],
        quaternions=quaternions,
        colors=colors,
        fill_mode=fill,
    )


def _mesh(model: mujoco.MjModel, geom: int, outline: Colour | None) -> tuple[rr.AsComponents, ...]:
    mesh = int(model.geom_dataid[geom])
    vertices = slice(model.mesh_vertadr[mesh], model.mesh_vertadr[mesh] + model.mesh_vertnum[mesh])
    faces = slice(model.mesh_faceadr[mesh], model.mesh_faceadr[mesh] + model.mesh_facenum[mesh])
    points, triangles = model.mesh_vert[vertices], model.mesh_face[faces]
    # One normal a face: corners are not shared, so that edges stay sharp.
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
    """Red, green, blue and opacity, 0 to 255, light enough for a dark ground."""
    colour, material = model.geom_rgba[geom], int(model.geom_matid[geom])
    rgba = model.mat_rgba[material] if material >= 0 and np.allclose(colour, PLAIN) else colour
    color = np.asarray(rgba[:3], dtype=float)
    luminance = float(color @ (0.2126, 0.7152, 0.0722))
    if luminance < DARKEST:
        color = color + (1.0 - color) * (DARKEST - luminance) / (1.0 - luminance)
    red, green, blue = (round(255 * float(value)) for value in np.clip(color, 0.0, 1.0))
    return red, green, blue, round(255 * float(rgba[3]))


def _rotation(quaternion: np.ndarray) -> np.ndarray:
    matrix = np.empty(9)
    mujoco.mju_quat2Mat(matrix, quaternion)
    return matrix.reshape(3, 3)
