"""The shapes a scene file can name: unit sized, centred at the origin.

Texture coordinates put an image upright and unmirrored to who looks at the surface from outside
with +Y up (at the quad and the box's lid from above with -Z up, at its floor with +Z up).
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import cast

import numpy as np
from numpy.typing import NDArray

from .checks import F32, F64
from .mesh import Geometry

_CORNERS_RIGHT_DOWN: F64 = np.array([[-1, 1], [1, 1], [1, -1], [-1, -1]], np.float64) / 2
"""A square's corners, counter-clockwise, as (right, down) of the image on it."""

_TWO_TRIANGLES = np.array([[0, 1, 2], [0, 2, 3]])

_BOX_RIGHT: F64 = np.array(
    [[0, 0, -1], [0, 0, 1], [1, 0, 0], [1, 0, 0], [1, 0, 0], [-1, 0, 0]], np.float64
)
_BOX_DOWN: F64 = np.array(
    [[0, -1, 0], [0, -1, 0], [0, 0, 1], [0, 0, -1], [0, -1, 0], [0, -1, 0]], np.float64
)
"""The image axes of the faces +X, -X, +Y, -Y, +Z, -Z; down x right is the outward normal."""


def box() -> Geometry:
    """A cube of side 1: 24 vertices, 12 triangles, flat normals, the whole image on each face."""
    return _squares(_BOX_RIGHT, _BOX_DOWN, offset=0.5)


def quad() -> Geometry:
    """A square of side 1 in the plane y = 0, facing +Y: 4 vertices, 2 triangles."""
    return _squares(_BOX_RIGHT[2:3], _BOX_DOWN[2:3], offset=0.0)


def sphere(segments: int = 64, rings: int = 32) -> Geometry:
    """A sphere of diameter 1: `segments` around +Y, `rings` from pole to pole.

    u runs around +Y from its seam at -Z, v from the north pole (0) to the south pole (1).
    Vertices lie on the true sphere, with its exact normals. Those of the seam's two sides, which
    differ in u, and those of a pole have the very same position: the sphere is closed.
    """
    # A lattice of angles, with the seam and the poles once more for their texture coordinates.
    u, v = np.meshgrid(np.linspace(0.0, 1.0, segments + 1), np.linspace(0.0, 1.0, rings + 1))
    azimuth, polar = 2.0 * np.pi * (u - 0.5), np.pi * v
    normals = np.stack(
        [np.sin(polar) * np.sin(azimuth), np.cos(polar), np.sin(polar) * np.cos(azimuth)], axis=-1
    )
    # The sine of pi is not quite 0.
    normals[:, -1] = normals[:, 0]
    normals[0], normals[-1] = (0.0, 1.0, 0.0), (0.0, -1.0, 0.0)
    normals = normals.reshape(-1, 3)
    return Geometry(
        positions=_f32(0.5 * normals),
        indices=_lattice_triangles(segments, rings),
        normals=_f32(normals),
        uvs=_f32(np.stack([u, v], axis=-1).reshape(-1, 2)),
    )


def revolved(lines: Sequence[tuple[F64, F64]], segments: int = 64) -> Geometry:
    """A body of revolution about +Y: each line turned around, its edges sharp.

    A line is its points (N, 2), distance from the axis and height, upwards on the outside, and
    their unit normals (N, 2). Texture coordinates are left out.
    """
    azimuth = 2.0 * np.pi * (np.arange(segments + 1) % segments) / segments
    around = np.stack([np.sin(azimuth), np.cos(azimuth)])
    positions, normals, triangles, first = [], [], [], 0
    for points, outwards in lines:
        turned = [
            np.stack([v[:, :1] * around[0], np.repeat(v[:, 1:], segments + 1, 1),
                      v[:, :1] * around[1]], axis=-1).reshape(-1, 3)
            for v in (points, outwards)
        ]  # fmt: skip
        ring, segment = np.meshgrid(np.arange(len(points) - 1), np.arange(segments), indexing="ij")
        low = first + ring * (segments + 1) + segment
        high = low + segments + 1
        # On the axis a ring is a point, and one of the two triangles has no area.
        is_open = [points[:-1, 0] > 0.0, points[1:, 0] > 0.0]
        triangles.append(np.stack([low, low + 1, high + 1], axis=-1)[is_open[0]].reshape(-1, 3))
        triangles.append(np.stack([low, high + 1, high], axis=-1)[is_open[1]].reshape(-1, 3))
        positions.append(turned[0])
        normals.append(turned[1])
        first += len(turned[0])
    return Geometry(
        positions=_f32(np.concatenate(positions)),
        indices=np.concatenate(triangles).astype(np.uint32),
        normals=_f32(np.concatenate(normals)),
    )


def _squares(right: F64, down: F64, *, offset: float) -> Geometry:
    """One unit square per row, `offset` metres from the origin along its normal down x right."""
    # The face's corners from its image axes, moved out along its normal.
    normal = np.cross(down, right)
    corners = np.einsum("ck,kfx->fcx", _CORNERS_RIGHT_DOWN, np.stack([right, down]))
    positions = corners + offset * normal[:, None]
    first = 4 * np.arange(len(right))[:, None, None]
    return Geometry(
        positions=_f32(positions.reshape(-1, 3)),
        indices=(first + _TWO_TRIANGLES).reshape(-1, 3).astype(np.uint32),
        normals=_f32(np.repeat(normal, 4, axis=0)),
        uvs=_f32(np.tile(_CORNERS_RIGHT_DOWN + 0.5, (len(right), 1))),
    )


def _lattice_triangles(segments: int, rings: int) -> NDArray[np.uint32]:
    """Two triangles per cell of a (rings + 1) x (segments + 1) lattice, one beside a pole."""
    ring, segment = np.meshgrid(np.arange(rings), np.arange(segments), indexing="ij")
    north_west = ring * (segments + 1) + segment
    south_west = north_west + segments + 1
    # Cells by their corners; beside a pole one of the two triangles has no area, and is left out.
    lower = np.stack([north_west, south_west, south_west + 1], axis=-1)[:-1]
    upper = np.stack([north_west, south_west + 1, north_west + 1], axis=-1)[1:]
    triangles = np.concatenate([lower.reshape(-1, 3), upper.reshape(-1, 3)])
    return cast(NDArray[np.uint32], triangles.astype(np.uint32))


def _f32(values: F64) -> F32:
    return cast(F32, np.ascontiguousarray(values, dtype=np.float32))
