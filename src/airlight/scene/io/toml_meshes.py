"""A [[mesh]] of a scene file: load or make it, place it, replace its colours."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any, cast

import numpy as np
from numpy.typing import NDArray

from ...errors import SceneError
from ...maths.transforms import rotation_xyz
from ..animation import Animation
from ..camera import Camera
from ..checks import F64
from ..material import SIDES, Material, Texture
from ..mesh import Mesh
from ..placing import moved_camera
from ..scene import Scene
from ..shapes import box, quad, sphere
from .files import named_file, regular_file
from .toml_animation import mesh_tracks

_SHAPES = {"box": box, "sphere": sphere, "plane": quad, "quad": quad}
_Z_UP = np.array([[1.0, 0, 0, 0], [0, 0, 1.0, 0], [0, -1.0, 0, 0], [0, 0, 0, 1.0]])
_UPRIGHT: dict[str, F64] = {"y": np.eye(4), "z": _Z_UP}
"""y-up from the file's axes: what pointed along +Z points along +Y, +X stays."""
_RED_GREEN_BLUE = (0, 1, 2)
_ROUGHNESS_CHANNEL, _METALLIC_CHANNEL = (1,), (2,)  # glTF 2.0, section 3.9.2


def placed_mesh(
    values: Mapping[str, Any], label: str, folder: Path, keys: Sequence[Any] = ()
) -> Scene:
    """The meshes, lights, camera and motion of one [[mesh]] table whose keys are checked.

    `keys` are its keyframes, unchecked. Raises SceneError where neither or both of file and shape
    are given, matrix stands beside other transforms, or the file cannot be read.
    """
    # Exactly one of the two says what the mesh is.
    if ("file" in values) == ("shape" in values):
        raise SceneError(f"{label} needs either a file or a shape")
    if "file" in values:
        scene = _read(folder, values, label)
    elif "variant" in values:
        raise SceneError(f"{label} has a variant, and a shape has none")
    else:
        shape = values["shape"]
        scene = Scene(meshes=(Mesh(_SHAPES[shape](), name=shape),))
    return _coloured(placed(scene, values, keys, label), values)


def placed(
    scene: Scene, values: Mapping[str, Any], keys: Sequence[Any] = (), label: str = ""
) -> Scene:
    """What a mesh file says, turned upright and where the keys `values` and `keys` put it.

    Raises SceneError where matrix stands beside other transforms.
    """
    upright = upright_from_file(values)
    matrix = world_from_mesh(values, label) @ upright
    tracks = mesh_tracks(scene, values, keys, matrix, upright, label)
    return replace(_moved(scene, matrix), animation=Animation(tracks) if tracks else None)


def existing_file(written: str, label: str, folder: Path) -> Path:
    """The file that a scene file in `folder` calls `written`. Raises SceneError, by that name."""
    path = named_file(written, "", folder)
    try:
        return regular_file(path)
    except SceneError as error:
        missing = error.problem == "file not found"
        what = "does not exist" if missing else error.problem.removeprefix("this ")
        raise SceneError(
            f"{label}: file '{written}' {what}",
            remedy="Paths are relative to the scene file.",
        ) from None


def upright_from_file(values: Mapping[str, Any]) -> F64:
    """(4, 4): the turn that the key `up` asks for, before anything else."""
    return _UPRIGHT[values.get("up", "y")]


def world_from_mesh(values: Mapping[str, Any], label: str) -> F64:
    """(4, 4): `matrix`, or translate * rotate Z * rotate Y * rotate X * scale."""
    parts = [name for name in ("translate", "rotate_deg", "scale") if name in values]
    if "matrix" in values:
        if parts:
            raise SceneError(
                f"{label} has matrix beside {' and '.join(parts)}",
                remedy="Use matrix alone, or translate, rotate_deg and scale.",
            )
        return cast(F64, values["matrix"])
    # Scale first: it acts along the mesh's own axes, before those are turned.
    matrix = np.eye(4)
    rotation = rotation_xyz(values.get("rotate_deg", (0.0, 0.0, 0.0)))
    matrix[:3, :3] = rotation * np.array(values.get("scale", (1.0, 1.0, 1.0)))
    matrix[:3, 3] = values.get("translate", (0.0, 0.0, 0.0))
    return matrix


def _read(folder: Path, values: Mapping[str, Any], label: str) -> Scene:
    from . import MESH_SUFFIXES, load_meshes

    written = values["file"]
    if Path(written).suffix.lower() not in MESH_SUFFIXES:
        raise SceneError(
            f"{label}: file '{written}' is not a mesh file",
            remedy=f"Known endings: {', '.join(MESH_SUFFIXES)}.",
        )
    return load_meshes(existing_file(written, label, folder), values.get("variant"))


def _moved(scene: Scene, world_from_file: F64) -> Scene:
    meshes = (
        replace(mesh, world_from_object=world_from_file @ mesh.world_from_object)
        for mesh in scene.meshes
    )
    return replace(
        scene,
        meshes=tuple(meshes),
        lights=tuple(light.moved(world_from_file) for light in scene.lights),
        camera=_moved_camera(scene.camera, world_from_file),
    )


def _moved_camera(camera: Camera, matrix: F64) -> Camera:
    """The file's camera, moved; the default one stays, because it says that the file has none."""
    return camera if camera == Camera() else moved_camera(camera, matrix)


def _coloured(scene: Scene, values: Mapping[str, Any]) -> Scene:
    """The scene with its materials' factors, and the texture channels behind them, replaced."""
    # What the table says of the material.
    names = ("base_color", "roughness", "metallic", "specular", "emission", "transmission")
    factors = {name: values[name] for name in names if name in values}
    if "opacity" in values:
        factors |= {"alpha": values["opacity"], "is_blended": True}
    factors |= SIDES[values["sides"]] if "sides" in values else {}
    if not factors:
        return scene
    # Materials once each, so that meshes go on sharing them.
    made: dict[int, Material] = {}
    meshes = []
    for mesh in scene.meshes:
        key = id(mesh.material)
        if key not in made:
            made[key] = _with_factors(mesh.material, factors)
        # Colours of vertices would go on tinting the colour that replaces them.
        geometry = mesh.geometry
        if "base_color" in factors and geometry.colors is not None:
            white = geometry.colors.copy()
            white[:, :3] = 1.0
            geometry = replace(geometry, colors=white)
        meshes.append(replace(mesh, material=made[key], geometry=geometry))
    return replace(scene, meshes=tuple(meshes))


def _with_factors(material: Material, factors: Mapping[str, Any]) -> Material:
    # Textures give way where a factor replaces them, each in its own channels.
    changes: dict[str, Any] = dict(factors)
    if "base_color" in factors:
        changes["base_color_texture"] = _whitened(material.base_color_texture, _RED_GREEN_BLUE)
    rough_metal = material.metallic_roughness_texture
    if "roughness" in factors:
        rough_metal = _whitened(rough_metal, _ROUGHNESS_CHANNEL)
    if "metallic" in factors:
        rough_metal = _whitened(rough_metal, _METALLIC_CHANNEL)
    changes["metallic_roughness_texture"] = rough_metal
    if "alpha" in factors and material.alpha > 0.0:
        # Holes of a cut-out stay where they are: the cut is of alpha times the texture's.
        changes["alpha_cutoff"] = min(
            material.alpha_cutoff * factors["alpha"] / material.alpha, 1.0
        )
    if "emission" in factors:
        changes["emission_texture"] = None
    return replace(material, **changes)


def _whitened(texture: Texture | None, channels: tuple[int, ...]) -> Texture | None:
    """The texture with these channels at 1, so that the factor alone holds; alpha stays."""
    if texture is None:
        return None
    pixels: NDArray[np.uint8] = texture.pixels.copy()
    pixels[..., channels] = 255
    return replace(texture, pixels=pixels)
