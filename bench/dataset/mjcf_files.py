"""Read a robot without the meshes, textures and height fields whose files cannot be read.

Identification needs only bodies, joints, sites and closures. A simulation also needs masses, so a body whose mass
would come from such a mesh is refused by name.
"""

import re
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path, PurePosixPath

import mujoco

from bench.basics.errors import BenchError

KEPT = 32  # files: a command reads the same one repeatedly
OPENING = re.compile(r"Error opening file '(.+?)'")
# for a mesh or a picture in a format that MuJoCo does not read, or a file that is not a mesh
ASSETS = re.compile(r"decoder")
ELEMENT = re.compile(r"Element name '(.+?)'")
MASSLESS = "mass and inertia of moving bodies"


@dataclass(frozen=True)
class Unreadable:
    """files: as the MJCF names them; bodies: moving ones whose mass comes, or may come, from shapes in these."""

    files: tuple[str, ...] = ()
    bodies: tuple[str, ...] = ()


def read_spec(path: Path) -> mujoco.MjSpec:
    """The file without the shapes, textures and height fields that cannot be read.

    Raises ValueError if MuJoCo refuses the file, BenchError for a body that has no mass without them.
    """
    spec = mujoco.MjSpec.from_file(str(path))
    if _parts(spec):
        for file in unreadable(path).files:
            _remove(spec, file)
    return spec


def unreadable(path: Path) -> Unreadable:
    """What `read_spec` omits. Raises the same errors."""
    return _unreadable(path, path.stat().st_mtime_ns)


@lru_cache(maxsize=KEPT)
def _unreadable(path: Path, _changed: int) -> Unreadable:
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
    """Whether MuJoCo's message reports a mesh, texture or height field that cannot be read."""
    return "XML Error" not in message and bool(OPENING.search(message) or ASSETS.search(message))


def _parts(
    spec: mujoco.MjSpec,
) -> list[mujoco.MjsMesh | mujoco.MjsTexture | mujoco.MjsHField | mujoco.MjsSkin]:
    """The parts of a file that refer to other files."""
    return [part for part in (*spec.meshes, *spec.textures, *spec.hfields, *spec.skins) if part.file]


def _at_fault(spec: mujoco.MjSpec, message: str) -> str | None:
    """The file of the part that a message reports, None if it reports none."""
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
    """Whether this body or one of its ancestors has a joint."""
    while body.name != "world":
        if body.first_joint() is not None:
            return True
        body = body.parent
    return False


def _remove(spec: mujoco.MjSpec, file: str) -> list[str]:
    """Remove all parts that need this file; return the moving bodies whose mass comes from the removed shapes."""
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
