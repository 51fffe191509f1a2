"""PLY and STL, read through trimesh."""

from __future__ import annotations

import io
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...errors import SceneError
from ...maths.colour import srgb_decode
from ...maths.weld import welded
from ..material import Material
from ..mesh import Geometry, Mesh
from ..scene import Scene
from .files import read_bytes
from .normals import Ints, compact, creased_normals

GREY = Material(name="grey", base_color=(0.6, 0.6, 0.6))
PAINTED = Material(name="vertex colours", base_color=(1.0, 1.0, 1.0))


def load_mesh_file(path: Path) -> Scene:
    """Read a PLY or STL file into a scene of one mesh, without lights or camera.

    Vertex colours are sRGB in the file. Where there are no normals they are computed over
    vertices at the same place: smooth over gentle bends, sharp at edges. Raises SceneError.
    """
    mesh = _read(path)
    positions, triangles = _shape(mesh, path)
    normals = _file_normals(mesh)
    colors = _colors(mesh)
    del mesh  # its arrays are as large as the file's
    if normals is None:
        rows, indices, normals = _with_normals(positions, triangles, keep=colors is not None)
        positions = positions[rows]
        colors = None if colors is None else colors[rows]
    else:
        indices = triangles.astype(np.uint32)
    geometry = Geometry(
        positions=positions.astype(np.float32),
        indices=indices,
        normals=normals.astype(np.float32),
        colors=colors,
    )
    material = GREY if colors is None else PAINTED
    return Scene(meshes=(Mesh(geometry, material, name=path.stem),), name=path.stem)


def _read(path: Path) -> Any:
    import trimesh

    raw = read_bytes(path)
    kind = path.suffix.lower().lstrip(".")
    try:
        loaded = trimesh.load(io.BytesIO(raw), file_type=kind, process=False)
        if isinstance(loaded, trimesh.Scene):
            loaded = loaded.to_geometry()
    except Exception as error:  # its readers raise KeyError, ValueError, IndexError, ...
        reason = str(error) or type(error).__name__
        raise SceneError(f"not a readable {kind.upper()} file ({reason})", where=path) from None
    if not isinstance(loaded, trimesh.Trimesh) or len(loaded.faces) == 0:
        raise SceneError("it has no triangles", where=path)
    return loaded


def _shape(mesh: Any, path: Path) -> tuple[NDArray[np.float64], NDArray[np.int32]]:
    """Checked positions (V, 3) and triangles (T, 3)."""
    positions = np.asarray(mesh.vertices, dtype=np.float64).view(np.ndarray)
    triangles = np.asarray(mesh.faces).view(np.ndarray)
    if not np.isfinite(positions).all():
        raise SceneError("vertex positions hold NaN or infinite numbers", where=path)
    if triangles.min() < 0 or triangles.max() >= len(positions):
        raise SceneError(
            f"triangle index {triangles.max()} is out of range: "
            f"the file has {len(positions)} vertices",
            where=path,
        )
    return positions, triangles.astype(np.int32)


def _file_normals(mesh: Any) -> NDArray[np.float64] | None:
    """Vertex normals that came with the file; trimesh keeps them in its cache."""
    if "vertex_normals" not in mesh._cache:
        return None
    normals = np.array(mesh.vertex_normals, dtype=np.float64)
    length = np.linalg.norm(normals, axis=1, keepdims=True)
    usable = normals.shape == mesh.vertices.shape and np.isfinite(normals).all()
    return normals / length if usable and (length > 0.0).all() else None


def _colors(mesh: Any) -> NDArray[np.float32] | None:
    """Linear RGBA (V, 4) where the file colours its vertices."""
    if getattr(mesh.visual, "kind", None) != "vertex":
        return None
    encoded = np.asarray(mesh.visual.vertex_colors, dtype=np.float64) / 255.0
    rgb = srgb_decode(encoded[:, :3])
    return np.concatenate([rgb, encoded[:, 3:4]], axis=1).astype(np.float32)


def _with_normals(
    positions: NDArray[np.float64], triangles: NDArray[np.int32], *, keep: bool
) -> tuple[Ints, NDArray[np.uint32], NDArray[np.float64]]:
    """The file's vertex of each new one, triangles and normals, split along creases.

    Vertices at one position become one, unless `keep`, where they may differ in colour.
    """
    # STL repeats a vertex for every triangle; only equal positions make a surface smooth.
    numbers = welded(positions).astype(np.int32)
    merged = numbers[triangles]
    sample = np.zeros(int(numbers.max()) + 1, dtype=np.int32)
    sample[merged.ravel()] = triangles.ravel()
    table, index = creased_normals(positions[sample], merged)
    source = triangles if keep else sample[merged]
    rows, indices = compact(np.stack([source, index], axis=-1))
    return rows[:, 0], indices, table[rows[:, 1]]
