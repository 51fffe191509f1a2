"""Whether a glTF file's tangents say what its texture coordinates say of a normal map.

Normal maps lie by their texture coordinates here, whose directions shaders derive (Schueler2013).
Files mostly have tangents that were made of the same coordinates; others would look different.
"""

from __future__ import annotations

import numpy as np

from ...errors import SceneError
from .gltf_buffers import Buffers
from .gltf_json import Item
from .gltf_mesh import Primitive

_APART_DEG = 20.0
_SHARE = 0.05
"""Of the surface, that may lie otherwise without a word: seams, and what is smoothed over them."""


def tangents_apart(primitive: Item, buffers: Buffers, read: Primitive) -> str:
    """A warning where tangents point elsewhere than along the image's u; "" where they do not."""
    attributes, geometry = primitive.child("attributes"), read.geometry
    if not attributes.has("TANGENT") or geometry.uvs is None:
        return ""
    try:
        tangents = buffers.array(attributes, "TANGENT", width=4).astype(np.float64)[:, :3]
    except SceneError as error:
        return f"its TANGENT is left out: {error.problem}"
    if len(tangents) <= int(read.rows.max(initial=0)):
        return "its TANGENT is left out: it has other vertices"
    # How the point changes along u on each triangle: a b = d(position), as d(u, v) has it.
    at, uv = (a.astype(np.float64)[geometry.indices] for a in (geometry.positions, geometry.uvs))
    (e1, e2), (d1, d2) = ((of[:, 1] - of[:, 0], of[:, 2] - of[:, 0]) for of in (at, uv))
    det = d1[:, 0] * d2[:, 1] - d1[:, 1] * d2[:, 0]
    along = (e1 * d2[:, 1:] - e2 * d1[:, 1:]) * np.sign(det)[:, None]
    # The file's, of the triangle's corners together, in its plane.
    said = tangents[read.rows[geometry.indices]].sum(axis=1)
    normal = np.cross(e1, e2)
    area = np.linalg.norm(normal, axis=1)
    normal = normal / np.maximum(area, 1e-30)[:, None]
    said = said - normal * np.einsum("ij,ij->i", said, normal)[:, None]
    sizes = np.linalg.norm(along, axis=1) * np.linalg.norm(said, axis=1)
    is_told = (sizes > 0.0) & np.isfinite(sizes) & (det != 0.0)
    cosine = np.einsum("ij,ij->i", along, said)[is_told] / sizes[is_told]
    is_apart = cosine < np.cos(np.radians(_APART_DEG))
    share = float(area[is_told][is_apart].sum() / max(float(area[is_told].sum()), 1e-30))
    if share <= _SHARE:
        return ""
    return (
        "its normal map lies by its texture coordinates; its TANGENT, which is not read, points "
        f"elsewhere on {100.0 * share:.0f} % of its surface"
    )
