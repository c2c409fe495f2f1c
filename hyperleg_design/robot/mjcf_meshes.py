"""MJCF files of which meshes are missing: compiled without the geometry that needs them."""

from __future__ import annotations

import math
from pathlib import Path, PurePosixPath
from typing import Any

from hyperleg_design.errors import InputError, in_short
from hyperleg_design.robot.checks.mesh_files import WITHOUT


def compiled(path: Path, where: str, *, meshes: bool = True) -> Any:
    """Compile an MJCF file.

    Args:
        path: the file.
        where: what errors call it.
        meshes: whether the meshes that it names must be there; otherwise the missing ones are left
            out with the geometry that uses them, and missing pictures of textures and terrain, too.

    Returns:
        MuJoCo's model.

    Raises:
        InputError: MuJoCo refuses it, a mesh is missing that must be there, or the mass of a body
            depends on a missing mesh.
    """
    import mujoco

    try:
        spec = mujoco.MjSpec.from_file(str(path))
        missing = [mesh for mesh in spec.meshes if not _is_there(mesh.file, spec, spec.meshdir)]
        if missing and meshes:
            raise InputError(where, "<mesh file>", missing[0].file, f"is missing; {WITHOUT}")
        if not meshes:
            for mesh in missing:
                _leave_out(mesh, spec, where)
            _leave_out_pictures(spec)
        return spec.compile()
    except (ValueError, RuntimeError, mujoco.FatalError) as error:
        remedy = f"MuJoCo does not compile it: {in_short(error, 200)}"
        raise InputError(where, "<mujoco>", None, remedy) from None


def _is_there(file: str, spec: Any, folder: str) -> bool:
    """Whether a file that an MJCF names is there; what has no file counts as there."""
    name = PurePosixPath(file).name if spec.strippath else file
    return not file or (Path(spec.modelfiledir) / folder / name).is_file()


def _leave_out(mesh: Any, spec: Any, where: str) -> None:
    """Delete a mesh and the geometry made of it.

    Raises:
        InputError: the mass of a body depends on it.
    """
    name = mesh.name or PurePosixPath(mesh.file).stem
    gone = [geom for geom in spec.geoms if geom.meshname == name]
    for geom in gone:
        if _weighs(geom, spec):
            remedy = (
                f"gets its mass from the mesh {mesh.file}, which is missing; add an <inertial> to "
                f"the body, or put the mesh where the file says"
            )
            raise InputError(where, f"body {geom.parent.name}", None, remedy)
    names = {geom.name for geom in gone if geom.name}
    for pair in list(spec.pairs):
        if names & {pair.geomname1, pair.geomname2}:
            spec.delete(pair)
    for geom in gone:
        spec.delete(geom)
    spec.delete(mesh)


def _weighs(geom: Any, spec: Any) -> bool:
    """Whether the compiler takes the inertia of a body of the robot from a geom, too."""
    import mujoco

    rule, body = spec.compiler.inertiafromgeom, geom.parent
    if body.name == "world" or rule == mujoco.mjtInertiaFromGeom.mjINERTIAFROMGEOM_FALSE:
        return False
    if body.explicitinertial and rule == mujoco.mjtInertiaFromGeom.mjINERTIAFROMGEOM_AUTO:
        return False
    first, last = spec.compiler.inertiagrouprange
    weight = geom.density if math.isnan(geom.mass) else geom.mass
    return bool(first <= geom.group <= last and weight > 0)


def _leave_out_pictures(spec: Any) -> None:
    """Textures whose pictures are missing become plain, and terrain of missing pictures goes."""
    import mujoco

    for texture in spec.textures:
        if not all(_is_there(f, spec, spec.texturedir) for f in (texture.file, *texture.cubefiles)):
            texture.file, texture.builtin = "", mujoco.mjtBuiltin.mjBUILTIN_FLAT
            texture.cubefiles = [""] * len(texture.cubefiles)
            texture.width = texture.height = 1
    for field in list(spec.hfields):
        if not _is_there(field.file, spec, spec.meshdir):
            for geom in [geom for geom in spec.geoms if geom.hfieldname == field.name]:
                spec.delete(geom)
            spec.delete(field)
