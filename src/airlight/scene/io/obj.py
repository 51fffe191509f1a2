"""Wavefront OBJ with its MTL: one mesh per material.

Polygons are cut into triangles (polygons.py). Corners without a normal get one (normals.py);
`s off` asks for flat shading. v runs upwards in OBJ and downwards in airlight, so it is flipped
here. Colours after a vertex position (`v x y z r g b`) are taken as sRGB, as scanners write them.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from ...errors import SceneError
from ...maths.arrays import F64, I64
from ...maths.colour import srgb_decode
from ..material import DEFAULT_MATERIAL, Material
from ..mesh import Geometry, Mesh, unit_or_up
from ..scene import Scene
from .files import in_utf8, read_bytes
from .mtl import load_mtl
from .normals import compact, creased_normals
from .obj_parse import ObjData, parse_obj
from .polygons import triangulated
from .texture_files import TextureFiles


def load_obj(path: Path) -> Scene:
    """Read an OBJ file and the materials it names into a scene without lights or camera.

    Raises SceneError with file and line for bad numbers and indices, and for no triangles.
    What had to be approximated or replaced is in the scene's warnings.
    """
    data = parse_obj(in_utf8(read_bytes(path)), path)
    textures = TextureFiles(path)
    # What the file says and is not shown.
    if data.unread:
        listed = ", ".join(f"'{keyword}'" for keyword in data.unread)
        textures.warnings.append(f"{path}: its statements {listed} are not read and left out")
    for keyword in data.absent:
        said = f"{path}: its faces name '{keyword}' indices, and it has no '{keyword}'"
        textures.warnings.append(f"{said}: they go without")
    # Polygons are cut only now, with all positions known: concave ones need them.
    materials = _materials(data, path, textures)
    triangles = _triangles(data)
    if len(triangles.corners) == 0:
        raise SceneError("it has no triangles", where=path)
    meshes = _meshes(data, triangles, materials)
    return Scene(meshes=meshes, name=path.stem, warnings=tuple(textures.warnings))


class _Triangles:
    """All polygons cut up: `corners` (T, 3, 3) position, uv, normal; `polygon` (T,)."""

    def __init__(self, corners: I64, polygon: I64, normals: F64) -> None:
        self.corners = corners
        self.polygon = polygon
        self.normals = normals


def _triangles(data: ObjData) -> _Triangles:
    """Polygons cut up; every corner gets a normal."""
    at, polygon = triangulated(data.positions, data.corners[:, 0], data.sizes)
    corners = data.corners[at]
    normals = data.normals
    missing = corners[:, :, 2] < 0
    # Corners without a normal of their own get one, smooth up to a crease.
    if missing.any():
        rows = np.flatnonzero(missing.any(axis=1))
        made, index = creased_normals(
            data.positions, corners[rows, :, 0], data.is_flat[polygon[rows]]
        )
        chosen = np.where(missing[rows], index + len(normals), corners[rows, :, 2])
        corners[rows, :, 2] = chosen
        normals = np.concatenate([normals, made])
    return _Triangles(corners, polygon, normals)


def _meshes(data: ObjData, triangles: _Triangles, materials: list[Material]) -> tuple[Mesh, ...]:
    # Triangles are sorted by material, stably, so that each mesh keeps the file's order.
    material = data.material[triangles.polygon]
    order = np.argsort(material, kind="stable")
    used, starts = np.unique(material[order], return_index=True)
    parts = np.split(order, starts[1:])
    return tuple(
        Mesh(
            _geometry(data, triangles.corners[part], triangles.normals),
            materials[int(k)],
            name=data.material_names[int(k)] or "default",
        )
        for k, part in zip(used, parts, strict=True)
    )


def _geometry(data: ObjData, corners: I64, normals: F64) -> Geometry:
    # A vertex for each combination of position, coordinates and normal.
    rows, indices = compact(corners)
    # Coordinates where any corner has some; v is turned downwards.
    uvs: NDArray[np.float32] | None = None
    if (rows[:, 1] >= 0).any():
        given = np.concatenate([data.uvs, [[0.0, 1.0]]])[rows[:, 1]]  # -1 is the last row
        uvs = np.stack([given[:, 0], 1.0 - given[:, 1]], axis=1).astype(np.float32)
    # Colours of vertices, linear, without alpha.
    colors: NDArray[np.float32] | None = None
    if data.colors is not None:
        rgb = srgb_decode(data.colors[rows[:, 0]])
        colors = np.concatenate([rgb, np.ones((len(rgb), 1))], axis=1).astype(np.float32)
    return Geometry(
        positions=data.positions[rows[:, 0]].astype(np.float32),
        indices=indices,
        normals=unit_or_up(normals[rows[:, 2]]).astype(np.float32),
        uvs=uvs,
        colors=colors,
    )


def _materials(data: ObjData, path: Path, textures: TextureFiles) -> list[Material]:
    """A material for each name the file uses; unknown ones become the default, with a warning."""
    # Later libraries replace materials of the same name.
    known: dict[str, Material] = {}
    for library in _libraries(data, path, textures):
        known.update(load_mtl(library, textures))
    used = set(np.unique(data.material).tolist())
    chosen = []
    for k, name in enumerate(data.material_names):
        if name and name not in known and k in used:
            textures.warnings.append(f"{path}: material '{name}' is not defined, it is grey")
        chosen.append(known.get(name, DEFAULT_MATERIAL))
    return chosen


def _libraries(data: ObjData, path: Path, textures: TextureFiles) -> list[Path]:
    """The material files that exist. One statement may name several, or one with spaces."""
    found: list[Path] = []
    for statement in data.libraries:
        # The whole statement as one name first, as names may hold spaces.
        whole = textures.find(statement)
        several = [whole] if whole else [textures.find(name) for name in statement.split()]
        found += [library for library in several if library is not None]
        if None in several:
            textures.warnings.append(
                f"{path}: material file '{statement}' is missing, its materials are grey"
            )
    return list(dict.fromkeys(found))
