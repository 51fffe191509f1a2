"""glTF primitives as geometries: attributes, triangle strips and fans, missing normals."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...errors import SceneError
from ..checks import F32
from ..mesh import Geometry, unit_or_up
from .gltf_buffers import Buffers
from .gltf_frames import Surface
from .gltf_json import Item
from .gltf_uv import UvFrame
from .normals import compact, creased_normals

TRIANGLES, TRIANGLE_STRIP, TRIANGLE_FAN = 4, 5, 6
FILE_FRAME = UvFrame()


@dataclass(frozen=True, eq=False)
class Primitive:
    """A primitive's triangles, and the file's vertex (V,) that each of theirs comes from.

    `is_flat`: it had no normals.
    """

    geometry: Geometry
    rows: NDArray[np.int64]
    is_flat: bool

    def with_tangents(self, tangents: F32 | None) -> Primitive:
        """The same with tangents (V, 4) of its vertices, if any."""
        if tangents is None:
            return self
        return replace(self, geometry=replace(self.geometry, tangents=tangents))


def read_primitive(
    primitive: Item, buffers: Buffers, frame: UvFrame | F32 = FILE_FRAME
) -> Primitive | None:
    """The triangles of a primitive, its texture coordinates those of `frame`, or its rows (V, 2).

    Without normals it is shaded flat, as the specification (3.7.2.1) demands.
    Raises SceneError.
    """
    # Points and lines are left out.
    mode = primitive.integer("mode", TRIANGLES)
    attributes = primitive.child("attributes")
    if mode not in (TRIANGLES, TRIANGLE_STRIP, TRIANGLE_FAN):
        if mode > TRIANGLE_FAN:
            raise primitive.error(f"has the unknown mode {mode}")
        return None
    # Triangles over positions.
    positions = buffers.array(attributes, "POSITION", width=3).astype(np.float32)
    if not np.isfinite(positions).all():
        raise attributes.child("POSITION").error("positions hold NaN or infinite numbers")
    triangles = _triangles(primitive, buffers, len(positions), mode)
    # What else each vertex has, one row for each.
    per_vertex = {
        "normals": _normals(attributes, buffers),
        "uvs": _uvs(attributes, buffers, frame),
        "colors": _colors(attributes, buffers),
    }
    for name, values in per_vertex.items():
        if values is not None and len(values) != len(positions):
            raise attributes.error(f"has {len(values)} {name} for {len(positions)} positions")
        if values is not None and not np.isfinite(values).all():
            raise attributes.error(f"its {name} hold NaN or infinite numbers")
    try:
        return _geometry(positions, triangles, per_vertex)
    except SceneError as error:
        raise primitive.error(error.problem) from None


def _geometry(
    positions: F32, triangles: NDArray[np.int64], per_vertex: dict[str, F32 | None]
) -> Primitive:
    # Normals in the file settle the shading; vertices stay as they are.
    if per_vertex["normals"] is not None:
        whole = Geometry(positions, triangles.astype(np.uint32), **per_vertex)
        return Primitive(whole, np.arange(len(positions)), is_flat=False)
    # Without them the specification asks for flat shading: each corner gets its face's normal.
    flat = np.ones(len(triangles), dtype=bool)
    table, index = creased_normals(positions.astype(np.float64), triangles, flat)
    rows, indices = compact(np.stack([triangles, index], axis=-1))
    # A vertex for each pair of position and normal, the other attributes taken along.
    others = {
        name: values[rows[:, 0]]
        for name, values in per_vertex.items()
        if values is not None and name != "normals"
    }
    normals = table[rows[:, 1]].astype(np.float32)
    split = Geometry(positions[rows[:, 0]], indices, normals=normals, **others)
    return Primitive(split, rows[:, 0].astype(np.int64), is_flat=True)


def _triangles(
    primitive: Item, buffers: Buffers, vertex_count: int, mode: int
) -> NDArray[np.int64]:
    # The order of vertices, as listed or as they come.
    if primitive.has("indices"):
        raw = buffers.array(primitive, "indices", width=1)[:, 0]
        if np.issubdtype(raw.dtype, np.floating):
            raise primitive.child("indices").error("indices must be whole numbers")
        order = raw.astype(np.int64)
    else:
        order = np.arange(vertex_count)
    # Indices beyond the vertices are an error of the file, as are too few for a triangle.
    if len(order) and (order.max() >= vertex_count or order.min() < 0):
        raise primitive.child("indices").error(
            f"index {order.max()} is out of range: the primitive has {vertex_count} vertices"
        )
    count = len(order) // 3 if mode == TRIANGLES else max(len(order) - 2, 0)
    if count == 0:
        raise primitive.error("has no triangles")
    if mode == TRIANGLES:
        # All triangles of a fan share its first vertex, which comes last here.
        return order[: 3 * count].reshape(-1, 3)
    k = np.arange(count)
    if mode == TRIANGLE_FAN:
        return np.stack([order[k + 1], order[k + 2], np.full(count, order[0])], axis=1)
    # Every second triangle of a strip runs the other way round.
    odd = k % 2
    strip = np.stack([order[k], order[k + 1 + odd], order[k + 2 - odd]], axis=1)
    # Strips are joined by triangles without an area.
    a, b, c = strip.T
    kept = strip[(a != b) & (b != c) & (a != c)]
    return kept if len(kept) else strip


def _normals(attributes: Item, buffers: Buffers) -> F32 | None:
    normals = _optional(attributes, buffers, "NORMAL", 3)
    return None if normals is None else unit_or_up(normals)


def read_surface(primitive: Item, buffers: Buffers, uv_sets: Iterable[int]) -> Surface:
    """These sets of texture coordinates of a primitive, 0 where it lacks one, and its triangles.

    Raises SceneError.
    """
    attributes = primitive.child("attributes")
    count = len(buffers.array(attributes, "POSITION", width=3))
    sets = {}
    # A set that the primitive lacks is 0 everywhere, as where an image shows one texel.
    for k in uv_sets:
        uvs = _optional(attributes, buffers, f"TEXCOORD_{k}", 2)
        sets[k] = np.zeros((count, 2)) if uvs is None else uvs.astype(np.float64)
        if sets[k].shape != (count, 2) or not np.isfinite(sets[k]).all():
            raise attributes.error(f"TEXCOORD_{k} must be {count} pairs of finite numbers")
    mode = primitive.integer("mode", TRIANGLES)
    return Surface(sets, _triangles(primitive, buffers, count, mode))


def _uvs(attributes: Item, buffers: Buffers, frame: UvFrame | F32) -> F32 | None:
    if not isinstance(frame, UvFrame):
        return frame
    # The frame's own set, turned as the material's images need it.
    uvs = _optional(attributes, buffers, f"TEXCOORD_{frame.uv_set}", 2)
    if uvs is None or frame.matrix is None:
        return uvs
    return _as_float(uvs.astype(np.float64) @ frame.matrix.T)


def _colors(attributes: Item, buffers: Buffers) -> F32 | None:
    """COLOR_0, linear RGBA; RGB gets alpha 1."""
    if not attributes.has("COLOR_0"):
        return None
    # The type tells whether colours have an alpha.
    k = attributes.index("COLOR_0", buffers.accessors, "accessors")
    width = 3 if buffers.accessors[k].text("type") == "VEC3" else 4
    colors = _as_float(buffers.array(attributes, "COLOR_0", width=width))
    if width == 4:
        return colors
    return np.concatenate([colors, np.ones((len(colors), 1), dtype=np.float32)], axis=1)


def _optional(attributes: Item, buffers: Buffers, name: str, width: int) -> F32 | None:
    if not attributes.has(name):
        return None
    return _as_float(buffers.array(attributes, name, width=width))


def _as_float(values: NDArray[Any]) -> F32:
    return values.astype(np.float32)
