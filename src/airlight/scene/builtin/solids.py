"""Flat pieces and boxes, with texture coordinates in metres."""

from __future__ import annotations

import numpy as np

from ..checks import F64, Vec3
from ..mesh import Geometry
from .patch import patch, patches

ALL_FACES = ("-x", "+x", "-y", "+y", "-z", "+z")

_UV_AXES = {0: (2, 1), 1: (0, 2), 2: (0, 1)}
"""For a face across the given axis: the world axes of u and of v."""


def rectangle(corner: Vec3, right: Vec3, down: Vec3, cells: tuple[int, int] = (1, 1)) -> Geometry:
    """A flat piece facing down x right, from its upper left `corner`; `cells` (right, down).

    uv are the metres from world zero along both edges, so that neighbours continue each other.
    """
    s, t = np.meshgrid(np.linspace(0, 1, cells[0] + 1), np.linspace(0, 1, cells[1] + 1))
    # Both edges span the piece; the metres along them are its texture coordinates.
    edge_u, edge_v = np.array(right, np.float64), np.array(down, np.float64)
    positions = np.array(corner) + s[..., None] * edge_u + t[..., None] * edge_v
    unit_u, unit_v = edge_u / np.linalg.norm(edge_u), edge_v / np.linalg.norm(edge_v)
    normals = np.broadcast_to(np.cross(unit_v, unit_u), positions.shape)
    uvs = np.stack([positions @ unit_u, positions @ unit_v], axis=-1)
    return patch(positions, normals, uvs)


def box(low: Vec3, high: Vec3, faces: tuple[str, ...] = ALL_FACES) -> Geometry:
    """The named faces of a box, facing outwards, 2 triangles each."""
    return patches([_face(np.array(low), np.array(high), face, 0.0) for face in faces])


def shell(low: Vec3, high: Vec3, thick: float) -> list[Geometry]:
    """Floor, ceiling and walls `thick` metres thick around a box of air, a slab each."""
    (x0, y0, z0), (x1, y1, z1), t = low, high, thick
    return [
        box((x0 - t, y0 - t, z0 - t), (x1 + t, y0, z1 + t)),
        box((x0 - t, y1, z0 - t), (x1 + t, y1 + t, z1 + t)),
        box((x0 - t, y0, z0 - t), (x0, y1, z1 + t)),
        box((x1, y0, z0 - t), (x1 + t, y1, z1 + t)),
        box((x0, y0, z0 - t), (x1, y1, z0)),
        box((x0, y0, z1), (x1, y1, z1 + t)),
    ]


def rounded_box(low: Vec3, high: Vec3, radius: float) -> Geometry:
    """A box whose edges are rounded (two facets an edge, smooth normals), 108 triangles.

    `radius` in metres, at most half the shortest side.
    """
    low_m, high_m = np.array(low, np.float64), np.array(high, np.float64)
    # Rounding ends before the two edges of a side meet.
    radius = min(radius, 0.499 * float((high_m - low_m).min()))
    return patches([_face(low_m, high_m, face, radius) for face in ALL_FACES])


def _face(low: F64, high: F64, face: str, radius: float) -> tuple[F64, F64, F64]:
    """Positions, normals and uvs, rows by columns, of one face."""
    axis, outward = "xyz".index(face[1]), 1.0 if face[0] == "+" else -1.0
    u_axis, v_axis = _UV_AXES[axis]
    # Points along both edges of the face, set on its plane.
    along_u, along_v = (_stations(low[k], high[k], radius) for k in (u_axis, v_axis))
    on_box = np.zeros((len(along_v), len(along_u), 3))
    on_box[..., axis] = high[axis] if outward > 0 else low[axis]
    on_box[..., u_axis], on_box[..., v_axis] = np.meshgrid(along_u, along_v)
    # Rounded: points at the radius from the box that is smaller by it.
    if radius > 0.0:
        core = np.clip(on_box, low + radius, high - radius)
        normals = on_box - core
        normals /= np.linalg.norm(normals, axis=-1, keepdims=True)
        positions = core + radius * normals
    else:
        # Sharp: the face as it is, with its own normal.
        normals = np.zeros_like(on_box)
        normals[..., axis] = outward
        positions = on_box
    # Texture coordinates upright on all sides, in metres.
    mirror = outward if axis != 0 else -outward
    v_sign = -1.0 if v_axis == 1 else outward
    u_sign = 1.0 if axis == 1 else mirror
    uvs = np.stack([u_sign * on_box[..., u_axis], v_sign * on_box[..., v_axis]], axis=-1)
    return positions, normals, uvs


def _stations(low: float, high: float, radius: float) -> F64:
    # A rounded edge has one more line of points on each face.
    inner = [low + radius, high - radius] if radius > 0.0 else []
    return np.array([low, *inner, high])
