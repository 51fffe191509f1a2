"""PLY and STL, read through trimesh."""

from __future__ import annotations

import io
from collections.abc import Iterator, Sequence
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
from .mesh_headers import check_counts
from .normals import Ints, compact, creased_normals
from .polygons import triangulated

GREY = Material(name="grey", base_color=(0.6, 0.6, 0.6))
_INDEX_NAMES = ("vertex_indices", "vertex_index")
_VERTEX_NAMES = (
    *("x", "y", "z", "nx", "ny", "nz"),
    *("red", "green", "blue", "alpha", "r", "g", "b", "a"),
    *("diffuse_red", "diffuse_green", "diffuse_blue"),
)
PAINTED = Material(name="vertex colours", base_color=(1.0, 1.0, 1.0))


def load_mesh_file(path: Path) -> Scene:
    """Read a PLY or STL file into a scene of one mesh, without lights or camera.

    Vertex colours are sRGB in the file. Where there are no normals they are computed over
    vertices at the same place: smooth over gentle bends, sharp at edges. Raises SceneError.
    """
    # What the file has, as arrays of its own rows.
    mesh = _read(path)
    positions, triangles = _shape(mesh, path)
    normals = _file_normals(mesh)
    colors = _colors(mesh)
    warnings = tuple(f"{path}: {line}" for line in _unread(mesh))
    del mesh  # its arrays are as large as the file's
    # Normals of its own, or computed: smooth over gentle bends, sharp at edges.
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
    return Scene(
        meshes=(Mesh(geometry, material, name=path.stem),), name=path.stem, warnings=warnings
    )


def _read(path: Path) -> Any:
    import trimesh

    # Counts are checked before trimesh takes memory for them.
    raw = read_bytes(path)
    kind = path.suffix.lower().lstrip(".")
    check_counts(raw, kind, path)
    try:
        # Vertices stay as the file numbers them, whatever texture coordinates it has.
        more = {"fix_texture": False} if kind == "ply" else {}
        loaded = trimesh.load(io.BytesIO(raw), file_type=kind, process=False, **more)
        # A file of several meshes becomes one, placed.
        if isinstance(loaded, trimesh.Scene):
            loaded = loaded.to_geometry()
    except Exception as error:  # its readers raise KeyError, ValueError, IndexError, ...
        reason = str(error) or type(error).__name__
        raise SceneError(f"not a readable {kind.upper()} file ({reason})", where=path) from None
    # A PLY file of strips has no faces, and comes as points.
    if isinstance(loaded, trimesh.PointCloud):
        loaded = _of_strips(loaded, path)
    if not isinstance(loaded, trimesh.Trimesh) or len(loaded.faces) == 0:
        raise SceneError("it has no triangles", where=path)
    return loaded


def _of_strips(points: Any, path: Path) -> Any:
    """The mesh of a PLY file that has triangle strips instead of faces; else `points` itself."""
    import trimesh

    # trimesh drops strips and shows their points alone.
    listed, vertices = _corner_lists(points, "tristrips"), _ply_data(points, "vertex")
    if listed is None:
        return points
    # Restarts (-1) are gone from the triangles: whatever is out of range now is damage.
    triangles = strip_triangles([np.asarray(strip, dtype=np.int64).ravel() for strip in listed])
    if len(triangles) and (triangles.min() < 0 or triangles.max() >= len(points.vertices)):
        raise SceneError(
            f"strip index {triangles.max()} is out of range: "
            f"the file has {len(points.vertices)} vertices",
            where=path,
        )
    # What trimesh read of the vertices itself is taken along.
    own: dict[str, Any] = {}
    if {"nx", "ny", "nz"} <= {*_names(vertices)}:
        own["vertex_normals"] = np.stack([vertices[name] for name in ("nx", "ny", "nz")], axis=1)
    if len(getattr(points, "colors", ())) == len(points.vertices):
        own["vertex_colors"] = points.colors
    return trimesh.Trimesh(
        points.vertices, triangles, process=False, metadata=points.metadata, **own
    )


def strip_triangles(strips: Sequence[NDArray[np.int64]]) -> NDArray[np.int64]:
    """The triangles (T, 3) of strips of corners; -1 begins another one within a strip.

    Each corner after the second makes one with the two before it, every other of them turned.
    Those with a corner twice lead from strip to strip, and are no surface.
    """
    found = [np.zeros((0, 3), dtype=np.int64)]
    for strip in strips:
        # Parts after the first begin with the restart that they were split at.
        for part in np.split(strip, np.flatnonzero(strip == -1)):
            corners = part[1:] if len(part) and part[0] == -1 else part
            triangles = np.stack([corners[:-2], corners[1:-1], corners[2:]], axis=-1)
            triangles[1::2] = triangles[1::2, ::-1]
            a, b, c = triangles.T
            found.append(triangles[(a != b) & (b != c) & (c != a)])
    return np.concatenate(found)


def _shape(mesh: Any, path: Path) -> tuple[NDArray[np.float64], NDArray[np.int32]]:
    """Checked positions (V, 3) and triangles (T, 3)."""
    positions = np.asarray(mesh.vertices, dtype=np.float64).view(np.ndarray)
    triangles = np.asarray(mesh.faces).view(np.ndarray)
    # Indices and positions are checked before anything is computed with them.
    if not np.isfinite(positions).all():
        raise SceneError("vertex positions hold NaN or infinite numbers", where=path)
    if triangles.min() < 0 or triangles.max() >= len(positions):
        raise SceneError(
            f"triangle index {triangles.max()} is out of range: "
            f"the file has {len(positions)} vertices",
            where=path,
        )
    # Polygons are cut here, because trimesh makes fans of concave ones.
    polygons = _polygons(mesh)
    if polygons is not None:
        corners, sizes = polygons
        triangles = corners[triangulated(positions, corners, sizes)[0]]
    return positions, triangles.astype(np.int32)


def _polygons(mesh: Any) -> tuple[NDArray[np.int64], NDArray[np.int64]] | None:
    """Corners one after the other and their number per face of a PLY file that has others than
    triangles; None where it has not. (trimesh cuts them into fans, concave ones wrongly.)"""
    # trimesh's own lists, from before it cut them.
    listed = _corner_lists(mesh, "face")
    if listed is None:
        return None
    # Faces of one size come as a matrix, others as a list of lists.
    if getattr(listed, "ndim", 1) == 2:
        sizes = np.full(len(listed), listed.shape[1], dtype=np.int64)
        corners = listed.reshape(-1)
    else:
        sizes = np.array([len(face) for face in listed], dtype=np.int64)
        corners = np.concatenate(list(listed))
    # Triangles alone need no cutting.
    if not len(sizes) or sizes.max() <= 3:
        return None
    return corners.astype(np.int64), sizes


def _unread(mesh: Any) -> Iterator[str]:
    """What a PLY file holds that is not used."""
    elements = mesh.metadata.get("_ply_raw", {})
    for element, known in (("vertex", _VERTEX_NAMES), ("face", _INDEX_NAMES)):
        unknown = [name for name in _names(_ply_data(mesh, element)) if name not in known]
        if unknown:
            yield f"the {element} properties {', '.join(unknown)} are not read"
    read = ("vertex", "face" if "face" in elements else "tristrips")
    others = [name for name in elements if name not in read]
    if others:
        yield f"the elements {', '.join(others)} are not read"


def _ply_data(mesh: Any, element: str) -> Any:
    """A PLY element's values by property; empty for another kind of file."""
    return mesh.metadata.get("_ply_raw", {}).get(element, {}).get("data", {})


def _corner_lists(mesh: Any, element: str) -> Any:
    """The corners of each face or strip; None without."""
    data = _ply_data(mesh, element)
    listed: Any = next((data[name] for name in _names(data) if name in _INDEX_NAMES), None)
    # In a binary file: count and corners.
    names = getattr(getattr(listed, "dtype", None), "names", None)
    return listed["f1"] if names else listed


def _names(data: Any) -> list[str]:
    if isinstance(data, dict):
        return list(data)
    return list(getattr(getattr(data, "dtype", None), "names", None) or ())


def _file_normals(mesh: Any) -> NDArray[np.float64] | None:
    """Vertex normals that came with the file; trimesh keeps them in its cache."""
    if "vertex_normals" not in mesh._cache:
        # Normals are used if there is one of a length for each vertex; else they are computed.
        return None
    normals = np.array(mesh.vertex_normals, dtype=np.float64)
    length = np.linalg.norm(normals, axis=1, keepdims=True)
    usable = normals.shape == mesh.vertices.shape and np.isfinite(normals).all()
    return normals / length if usable and (length > 0.0).all() else None


def _colors(mesh: Any) -> NDArray[np.float32] | None:
    """Linear RGBA (V, 4) where the file colours its vertices."""
    if getattr(mesh.visual, "kind", None) != "vertex":
        return None
    # Colours of images are sRGB-encoded; alpha is linear.
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
    # For each welded position one of the file's vertices.
    sample = np.zeros(int(numbers.max()) + 1, dtype=np.int32)
    sample[merged.ravel()] = triangles.ravel()
    table, index = creased_normals(positions[sample], merged)
    # Colours belong to the file's vertices, so those keep theirs where there are any.
    source = triangles if keep else sample[merged]
    rows, indices = compact(np.stack([source, index], axis=-1))
    return rows[:, 0], indices, table[rows[:, 1]]
