"""Meshes, textures and height fields of an MJCF or URDF whose files cannot be read: the robot is read without them.

Identification needs bodies, joints, sites and closures only. A simulation needs masses too, so that a body whose mass
is that of such a mesh is refused by name.
"""

from __future__ import annotations

import re
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path, PurePosixPath
from typing import TYPE_CHECKING

from bench.basics.errors import BenchError

if TYPE_CHECKING:
    import mujoco

KEPT = 32  # files: a command reads the same one again and again
OPENING = re.compile(r"Error opening file '(.+?)'")
# of a mesh or a picture in a format that MuJoCo does not read, or not a mesh at all
ASSETS = re.compile(r"decoder")
ELEMENT = re.compile(r"Element name '(.+?)'")
MASSLESS = "mass and inertia of moving bodies"


@dataclass(frozen=True)
class Unreadable:
    """files: what cannot be read, as the MJCF names it; bodies: the moving ones whose mass was, or may have been, that
    of shapes from these files.
    """

    files: tuple[str, ...] = ()
    bodies: tuple[str, ...] = ()


def read_spec(path: Path) -> mujoco.MjSpec:
    """The file without the shapes, textures and height fields that cannot be read.

    Raises ValueError where MuJoCo refuses the file, BenchError for a body that has no mass without them.
    """
    import mujoco  # noqa: PLC0415 - slow to import: only once a robot is really read

    spec = mujoco.MjSpec.from_file(str(path))
    if _parts(spec):
        for file in unreadable(path).files:
            _remove(spec, file)
    return spec


def unreadable(path: Path) -> Unreadable:
    """What `read_spec` leaves out. Raises as it does."""
    return _unreadable(path, path.stat().st_mtime_ns)


@lru_cache(maxsize=KEPT)
def _unreadable(path: Path, _changed: int) -> Unreadable:
    import mujoco  # noqa: PLC0415 - likewise

    spec = mujoco.MjSpec.from_file(str(path))
    files: list[str] = []
    bodies: list[str] = []
    for _ in range(len(_parts(spec)) + 1):
        try:
            spec.compile()
        except ValueError as error:
            if files and MASSLESS in str(error):
                body = ELEMENT.search(str(error))
                name = f"body {body.group(1)!r}" if body else "a body"
                raise BenchError(
                    f"{path.name}: {name} has no mass without the mesh files, of which {files[0]!r} cannot be read: "
                    "add the files, or give the body an <inertial>"
                ) from None
            file = _at_fault(spec, str(error))
            if file is None:
                raise
            files.append(file)
            bodies += _remove(spec, file)
        else:
            break
    return Unreadable(tuple(files), tuple(dict.fromkeys(bodies)))


def names_a_file(message: str) -> bool:
    """Whether MuJoCo's message is about a mesh, texture or height field that cannot be read."""
    return "XML Error" not in message and bool(OPENING.search(message) or ASSETS.search(message))


def _parts(
    spec: mujoco.MjSpec,
) -> list[mujoco.MjsMesh | mujoco.MjsTexture | mujoco.MjsHField | mujoco.MjsSkin]:
    """What a file names others for."""
    return [part for part in (*spec.meshes, *spec.textures, *spec.hfields, *spec.skins) if part.file]


def _at_fault(spec: mujoco.MjSpec, message: str) -> str | None:
    """The file of the part that a message is about."""
    if not names_a_file(message):
        return None
    opening, element = OPENING.search(message), ELEMENT.search(message)
    for part in _parts(spec):
        if opening and PurePosixPath(part.file).name == PurePosixPath(opening.group(1)).name:
            return str(part.file)
        if not opening and element and part.name == element.group(1):
            return str(part.file)
    return None


def _moves(body: mujoco.MjsBody) -> bool:
    """Whether a joint of this body or of one that carries it moves it."""
    while body.name != "world":
        if body.first_joint() is not None:
            return True
        body = body.parent
    return False


def _remove(spec: mujoco.MjSpec, file: str) -> list[str]:
    """Remove all that needs this file; the names of the moving bodies whose mass is that of their shapes."""
    import mujoco  # noqa: PLC0415 - likewise

    gone = [part for part in _parts(spec) if part.file == file]
    names = {type(part): {other.name for other in gone if type(other) is type(part)} for part in gone}
    meshes, fields = names.get(mujoco.MjsMesh, set()), names.get(mujoco.MjsHField, set())
    bodies = []
    for geom in [geom for geom in spec.geoms if geom.meshname in meshes or geom.hfieldname in fields]:
        from_shapes = spec.compiler.inertiafromgeom == mujoco.mjtInertiaFromGeom.mjINERTIAFROMGEOM_TRUE
        if (from_shapes or not geom.parent.explicitinertial) and _moves(geom.parent):
            bodies.append(geom.parent.name)
        spec.delete(geom)
    textures = names.get(mujoco.MjsTexture, set())
    for material in spec.materials:
        material.textures = ["" if name in textures else name for name in material.textures]
    for part in gone:
        spec.delete(part)
    return bodies
