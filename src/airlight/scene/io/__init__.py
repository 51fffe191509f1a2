"""Scene files, and everything they name, to scenes and back.

toml          the scene format of airlight      mitsuba      a subset of Mitsuba's XML
obj, mtl      Wavefront                         gltf         glTF 2.0 and GLB
meshfile      PLY and STL                       images       textures, radiance maps, images
volumes       density grids                     volume_scene one of them on its own
defaults      the camera and the daylight of a file that has none
files, ledger what may be read, and what was    doubts       warnings of unlikely values
"""

from __future__ import annotations

import functools
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

from ...errors import SceneError, nearest
from ..camera import Camera
from ..limits import check_extent
from ..scene import Scene
from .files import naming, regular_file

BUILTIN_PREFIX = "builtin:"
MESH_SUFFIXES = (".obj", ".glb", ".gltf", ".ply", ".stl")
VOLUME_SUFFIXES = (".npy", ".npz", ".vol", ".nvdb", ".vdb")
SCENE_SUFFIXES = (".toml", ".xml", *MESH_SUFFIXES, *VOLUME_SUFFIXES)


def load(path: str | Path) -> Scene:
    """A scene from a file, or from `builtin:NAME`.

    Mesh files (OBJ, glTF, PLY, STL) without light get a default sun and sky, and without a
    camera one that frames them, as density grids (NumPy, VDB, Mitsuba .vol) do; scene files
    (TOML, Mitsuba XML) say themselves. What was dropped, replaced or approximated is in the
    scene's `warnings`. Raises SceneError.
    """
    written = str(path)
    if written.startswith(BUILTIN_PREFIX):
        from ..builtin import builtin_scene

        return builtin_scene(written.removeprefix(BUILTIN_PREFIX))
    file = Path(path)
    with naming(file):
        scene = _loaded(file)
        check_extent(scene)
    return scene


def _loaded(file: Path) -> Scene:
    suffix = file.suffix.lower()
    if suffix == ".toml":
        from .doubts import doubts
        from .toml import load_toml

        scene = load_toml(file)
        return replace(scene, warnings=(*scene.warnings, *doubts(scene)))
    if suffix == ".xml":
        from .mitsuba import load_mitsuba

        return load_mitsuba(file)
    if suffix in VOLUME_SUFFIXES:
        from .volume_scene import load_volume_scene

        return with_defaults(load_volume_scene(file))
    return with_defaults(load_meshes(file))


def load_meshes(file: Path) -> Scene:
    """What a mesh file says and nothing more: no default light; Camera() where it has none.

    Raises SceneError.
    """
    with naming(file):
        return _mesh_reader(file)(file)


def _mesh_reader(file: Path) -> Callable[[Path], Scene]:
    suffix = file.suffix.lower()
    if suffix == ".obj":
        from .obj import load_obj

        return load_obj
    if suffix in (".glb", ".gltf"):
        from .gltf import load_gltf

        return load_gltf
    if suffix in (".ply", ".stl"):
        from .meshfile import load_mesh_file

        return load_mesh_file
    if not suffix:
        try:
            regular_file(file)
        except SceneError as error:
            raise SceneError(
                error.problem,
                where=file,
                remedy="For a scene that ships with airlight, write builtin:NAME.",
            ) from None
    raise SceneError(
        f"a scene file cannot end in '{file.suffix}'",
        where=file,
        remedy=nearest(suffix, SCENE_SUFFIXES),
    )


def with_defaults(scene: Scene) -> Scene:
    """The scene with a framing camera, and a sun and a sky, where it has none.

    A camera like Camera() counts as none; lights, an environment, or bright surfaces in a room
    as light. An added sun is exposed by the image where the camera's exposure is 0.
    """
    from .defaults import with_default_camera, with_default_lights
    from .probe import Probe

    # Both look at the same triangles; of large meshes the largest take a while to find.
    probe = functools.cache(lambda: Probe.of(scene))
    framed = with_default_camera(scene, probe) if scene.camera == Camera() else scene
    return with_default_lights(framed, probe)


__all__ = [
    "MESH_SUFFIXES",
    "SCENE_SUFFIXES",
    "VOLUME_SUFFIXES",
    "load",
    "load_meshes",
    "with_defaults",
]
