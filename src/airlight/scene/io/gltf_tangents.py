"""Tangents of a glTF file, where its normal maps lie otherwise by them than without.

Without tangents a normal map lies by its texture coordinates, whose directions shaders derive
(Schueler2013). A file's own are unit and at right angles, whatever the coordinates say.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ...errors import SceneError
from ..checks import F32, F64
from ..material import Texture
from .gltf_buffers import Buffers
from .gltf_json import Item
from .gltf_mesh import Primitive

_SAME = 0.02
"""How far axes may differ, as a share of their length: bumps lean by a degree, at most."""


@dataclass(frozen=True, eq=False)
class Tangents:
    """Of the vertices of a primitive as it was read (V, 4), and why there are none."""

    values: F32 | None = None
    problem: str = ""


def read_tangents(primitive: Item, buffers: Buffers, read: Primitive, map_: Texture) -> Tangents:
    """The tangents by which the normal map `map_` lies; none where they say nothing new.

    Without normals in the file there are none either (specification, 3.7.2.1).
    """
    attributes, geometry = primitive.child("attributes"), read.geometry
    if not attributes.has("TANGENT") or geometry.uvs is None or read.is_flat:
        return Tangents()
    try:
        values = buffers.array(attributes, "TANGENT", width=4).astype(np.float32)
    except SceneError as error:
        return Tangents(problem=f"its TANGENT is left out: {error.problem}")
    if len(values) != len(geometry.positions):
        return Tangents(problem="its TANGENT is left out: it has other vertices")
    if not np.isfinite(values).all():
        return Tangents(problem="its TANGENT is left out: it holds NaN or infinite numbers")
    return Tangents() if _say_the_same(values, read, map_) else Tangents(values)


def _say_the_same(tangents: F32, read: Primitive, map_: Texture) -> bool:
    """Whether a normal map leans alike by the tangents and by its texture coordinates."""
    geometry = read.geometry
    assert geometry.uvs is not None
    assert geometry.normals is not None
    # The gradients of u and v in each triangle's plane, the longer one of length 1, as shaders have
    # them; v runs down the image, and green up.
    corners = geometry.indices
    at = geometry.positions.astype(np.float64)[corners]
    uv = (geometry.uvs.astype(np.float64) * map_.scale)[corners]
    (e1, e2), (d1, d2) = ((of[:, 1] - of[:, 0], of[:, 2] - of[:, 0]) for of in (at, uv))
    normal = np.cross(e1, e2)
    across, along = np.cross(e2, normal), np.cross(normal, e1)
    u = across * d1[:, :1] + along * d2[:, :1]
    v = across * d1[:, 1:] + along * d2[:, 1:]
    longest = np.maximum(np.linalg.norm(u, axis=1), np.linalg.norm(v, axis=1))[:, None, None]
    derived = np.stack([u, -v], axis=1) / np.maximum(longest, 1e-30)
    # Those of the file at each corner; a tangent of 0 says nothing.
    for k in range(3):
        given = _axes(tangents[corners[:, k]], geometry.normals[corners[:, k]])
        if (np.abs(given - derived).max(axis=(1, 2)) > _SAME)[given.any(axis=(1, 2))].any():
            return False
    return True


def _axes(tangents: F32, normals: F32) -> F64:
    """(V, 2, 3): where a map's red and green lean, unit and at right angles to the normals."""
    n, t = normals.astype(np.float64), tangents[:, :3].astype(np.float64)
    t = t - n * np.einsum("ij,ij->i", n, t)[:, None]
    t /= np.maximum(np.linalg.norm(t, axis=1, keepdims=True), 1e-30)
    return np.stack([t, np.cross(n, t) * np.sign(tangents[:, 3:])], axis=1)
