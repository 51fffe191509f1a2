"""PLY as Mitsuba writes and reads it: normals, uv and float colours, vertices kept as they are.

Little-endian binary of triangles only; other PLY files go through meshfile.py, which keeps
less.
"""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from ...errors import SceneError
from ..checks import F32
from ..mesh import Geometry
from .files import read_bytes
from .mesh_headers import check_counts

_TYPES = {
    "char": "i1",
    "int8": "i1",
    "uchar": "u1",
    "uint8": "u1",
    "short": "<i2",
    "int16": "<i2",
    "ushort": "<u2",
    "uint16": "<u2",
    "int": "<i4",
    "int32": "<i4",
    "uint": "<u4",
    "uint32": "<u4",
    "float": "<f4",
    "float32": "<f4",
    "double": "<f8",
    "float64": "<f8",
}
_LIST = "list "


def read_ply(path: Path, attribute: str = "") -> Geometry:
    """The mesh of a PLY file; uv as stored, colours linear where they are floats.

    `attribute`: what a scene calls the colours that its material asks for, as Mitsuba names the
    properties NAME_0 to NAME_2: vertex_NAME or face_NAME. Raises SceneError.
    """
    # What Mitsuba itself writes is read here, all else by the general reader.
    raw = read_bytes(path)
    check_counts(raw, "ply", path)
    parts = _header(raw)
    if parts is None:
        return _by_meshfile(path)
    vertex_count, vertex_type, face_count, face_type, start = parts
    # Rows are taken as they lie in the file.
    needed = start + vertex_count * vertex_type.itemsize + face_count * face_type.itemsize
    if len(raw) < needed:
        raise SceneError(f"it ends after {len(raw):,} bytes of {needed:,}", where=path)
    vertices = np.frombuffer(raw, vertex_type, vertex_count, start)
    faces = np.frombuffer(raw, face_type, face_count, start + vertices.nbytes)
    # Rows of one size hold triangles only: any other count shifts all that follows.
    if face_count and (faces["count"] != 3).any():
        return _by_meshfile(path)
    try:
        return _geometry(vertices, faces, attribute)
    except SceneError as error:
        raise SceneError(error.problem, where=path, remedy=error.remedy) from None


def _header(
    raw: bytes,
) -> tuple[int, np.dtype[np.void], int, np.dtype[np.void], int] | None:
    """Counts, row types and the start of the data; None for a kind that is not read here."""
    end = raw.find(b"end_header\n", 0, 1 << 16)
    if not raw.startswith(b"ply\n") or end < 0:
        return None
    # The header is text, also before binary rows.
    lines = raw[:end].decode("ascii", "replace").splitlines()
    if "format binary_little_endian 1.0" not in lines:
        return None
    # Elements, and the types of their fields.
    counts: dict[str, int] = {}
    fields: dict[str, list[tuple[str, str]]] = {}
    current = ""
    for line in lines:
        words = line.split()
        if words[:1] == ["element"] and len(words) == 3 and words[2].isdigit():
            current = words[1]
            counts[current], fields[current] = int(words[2]), []
        elif words[:1] == ["property"] and current and len(words) >= 3:
            fields[current].append((words[-1], " ".join(words[1:-1])))
    # Vertices and triangles of types that one row each can have.
    if list(counts) != ["vertex", "face"] or not fields["face"]:
        return None
    kind = fields["face"][0][1]
    # A list's count is a byte, and its indices of any type that is known.
    index_type = _TYPES.get(kind.removeprefix("list uchar ").removeprefix("list uint8 "))
    if not kind.startswith(_LIST) or index_type is None:
        return None
    if not all(kind in _TYPES for _, kind in (*fields["vertex"], *fields["face"][1:])):
        return None
    # One row type each; faces may have attributes behind their corners.
    vertex = np.dtype([(name, _TYPES[kind]) for name, kind in fields["vertex"]])
    more = [(name, _TYPES[kind]) for name, kind in fields["face"][1:]]
    face = np.dtype([("count", "u1"), ("index", index_type, (3,)), *more])
    return counts["vertex"], vertex, counts["face"], face, end + len(b"end_header\n")


def _columns(rows: NDArray[np.void], *names: str) -> F32 | None:
    if not set(names) <= set(rows.dtype.names or ()):
        return None
    return np.stack([rows[name].astype(np.float32) for name in names], axis=1)


def _geometry(vertices: NDArray[np.void], faces: NDArray[np.void], attribute: str) -> Geometry:
    positions = _columns(vertices, "x", "y", "z")
    if positions is None:
        raise SceneError("its vertices have no x, y, z")
    # Texture coordinates go by one of two pairs of names.
    uvs = _columns(vertices, "u", "v")
    if uvs is None:
        uvs = _columns(vertices, "s", "t")
    normals = _columns(vertices, "nx", "ny", "nz")
    indices = np.asarray(faces["index"])
    # Only float colours are taken for reflectances; they are there whether or not they are asked.
    colors = _columns(vertices, "r", "g", "b")
    if colors is not None and vertices.dtype["r"].kind != "f":
        colors = None
    # What a material asks for by name, of the vertices or of the faces.
    of, _, name = attribute.partition("_")
    channels = [f"{name}_{k}" for k in range(3)]
    asked = _columns(faces if of == "face" else vertices, *channels)
    if asked is None:
        return _coloured(Geometry(positions, indices, normals=normals, uvs=uvs), colors)
    if of == "vertex":
        return _coloured(Geometry(positions, indices, normals=normals, uvs=uvs), asked)
    # Faces of colours of their own share no vertices.
    corners = indices.astype(np.int64).ravel()
    apart = Geometry(
        positions[corners],
        np.arange(len(corners), dtype=np.uint32).reshape(-1, 3),
        normals=None if normals is None else normals[corners],
        uvs=None if uvs is None else uvs[corners],
    )
    return _coloured(apart, np.repeat(asked, 3, axis=0))


def _coloured(geometry: Geometry, colors: F32 | None) -> Geometry:
    if colors is None:
        return geometry
    opaque = np.ones((len(colors), 1), np.float32)
    return replace(geometry, colors=np.concatenate([colors, opaque], axis=1))


def _by_meshfile(path: Path) -> Geometry:
    from .meshfile import load_mesh_file

    return load_mesh_file(path).meshes[0].geometry
