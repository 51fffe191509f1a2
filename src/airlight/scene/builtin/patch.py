"""Surfaces as lattices of points, and what one does with them: join, place, paint.

Texture coordinates are metres here; a `Finish` turns them into image repeats.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from typing import cast

import numpy as np
from numpy.typing import NDArray

from ..checks import F32, F64, Rgb
from ..material import Material
from ..mesh import Geometry, Mesh


def placed_at(x: float, y: float, z: float, turn_deg: float = 0.0, scale: float = 1.0) -> F64:
    """world_from_object (4, 4): scaled, turned about +Y (counter-clockwise from above), moved."""
    c, s = np.cos(np.radians(turn_deg)), np.sin(np.radians(turn_deg))
    matrix = np.eye(4)
    matrix[:3, :3] = scale * np.array([[c, 0.0, s], [0.0, 1.0, 0.0], [-s, 0.0, c]])
    matrix[:3, 3] = x, y, z
    return matrix


_HERE = placed_at(0.0, 0.0, 0.0)


@dataclass(frozen=True, eq=False)
class Finish:
    """A material, and the length in metres that one repeat of its images covers."""

    material: Material
    tile_m: float = 1.0

    def meshes(
        self, geometry: Geometry, name: str, places: Iterable[F64] = (_HERE,)
    ) -> tuple[Mesh, ...]:
        """One mesh per place (world_from_object), all sharing `geometry` with uv in repeats."""
        assert geometry.uvs is not None
        painted = replace(geometry, uvs=geometry.uvs / np.float32(self.tile_m))
        return tuple(Mesh(painted, self.material, place, name) for place in places)


def lambert(name: str, color: Rgb) -> Finish:
    """Perfectly matt, seen from its front."""
    return Finish(Material(name=name, base_color=color, specular=0.0, two_sided=False))


def moved(geometry: Geometry, world_from_object: F64) -> Geometry:
    """The geometry in another frame; the matrix is a rotation, a uniform scale and a shift."""
    # Rotations turn normals as they are; a scale changes their length alone.
    linear = world_from_object[:3, :3]
    turned = np.asarray(geometry.normals) @ linear.T
    return replace(
        geometry,
        positions=f32(geometry.positions @ linear.T + world_from_object[:3, 3]),
        normals=f32(turned / np.linalg.norm(turned, axis=1, keepdims=True)),
    )


def merged(parts: Sequence[Geometry]) -> Geometry:
    """All parts (each with normals and uvs) as one geometry."""
    # Indices count on behind the vertices of the parts before.
    starts = np.cumsum([0] + [len(part.positions) for part in parts])
    return Geometry(
        positions=np.concatenate([part.positions for part in parts]),
        indices=np.concatenate(
            [part.indices + np.uint32(start) for part, start in zip(parts, starts, strict=False)]
        ),
        normals=np.concatenate([cast(F32, part.normals) for part in parts]),
        uvs=np.concatenate([cast(F32, part.uvs) for part in parts]),
    )


def patch(
    positions: F64, normals: F64, uvs: F64, row_pairs: NDArray[np.intp] | None = None
) -> Geometry:
    """A lattice of points as triangles that face along its normals.

    `positions`, `normals` (rows, columns, 3), `uvs` (rows, columns, 2) in metres. `row_pairs`
    (n, 2) says which rows to connect; by default each to the next. Triangles without area
    (poles) are left out.
    """
    rows, columns = positions.shape[:2]
    triangles = _triangles(rows, columns, row_pairs)
    return facing(positions.reshape(-1, 3), triangles, normals.reshape(-1, 3), uvs.reshape(-1, 2))


def patches(parts: Sequence[tuple[F64, F64, F64]]) -> Geometry:
    """Several lattices, each the positions, normals and uvs of a `patch`, as one geometry."""
    starts = np.cumsum([0] + [positions[..., 0].size for positions, _, _ in parts])
    triangles = [
        start + _triangles(*positions.shape[:2])
        for start, (positions, _, _) in zip(starts[:-1], parts, strict=True)
    ]
    positions, normals, uvs = (
        np.concatenate([values.reshape(-1, values.shape[-1]) for values in kind])
        for kind in zip(*parts, strict=True)
    )
    return facing(positions, np.concatenate(triangles), normals, uvs)


def _triangles(
    rows: int, columns: int, row_pairs: NDArray[np.intp] | None = None
) -> NDArray[np.intp]:
    """Triangles (T, 3) between the points of a lattice; `row_pairs` as of `patch`."""
    if row_pairs is None:
        row_pairs = np.stack([np.arange(rows - 1), np.arange(1, rows)], axis=1)
    # Quads between neighbouring points of the connected rows, halved along one diagonal.
    first = row_pairs[:, :1] * columns + np.arange(columns - 1)
    second = row_pairs[:, 1:] * columns + np.arange(columns - 1)
    quads = np.stack([first, second, second + 1, first + 1], axis=-1).reshape(-1, 4)
    return quads[:, [0, 1, 2, 0, 2, 3]].reshape(-1, 3)


def facing(positions: F64, triangles: NDArray[np.intp], normals: F64, uvs: F64) -> Geometry:
    """Triangles (T, 3), wound so that they face along their vertex normals; slivers dropped."""
    unit = normals / np.linalg.norm(normals, axis=1, keepdims=True)
    positions = f32(positions).astype(np.float64)
    a, b, c = (positions[triangles[:, k]] for k in range(3))
    face = np.cross(b - a, c - a)
    # A triangle faces as its vertices' normals do, or else is turned round.
    agrees = np.einsum("ij,ij->i", face, unit[triangles].sum(axis=1)) >= 0.0
    wound = np.where(agrees[:, None], triangles, triangles[:, ::-1])
    # What remains is numbered again without unused points.
    kept = wound[np.linalg.norm(face, axis=1) > 1e-10]
    used, compact = np.unique(kept, return_inverse=True)
    return Geometry(
        positions=f32(positions[used]),
        indices=compact.reshape(-1, 3).astype(np.uint32),
        normals=f32(unit[used]),
        uvs=f32(uvs[used]),
    )


def lattice_normals(positions: F64, *, closed_columns: bool = False) -> F64:
    """Normals (rows, columns, 3) of a smooth lattice: d/drow x d/dcolumn, not normalised.

    `closed_columns`: the last column repeats the first, as around a column's shaft.
    """
    along_rows = np.gradient(positions, axis=0)
    # A closed ring goes on beyond its seam, so that normals agree on both sides of it.
    if closed_columns:
        ring = np.concatenate([positions[:, -2:-1], positions, positions[:, 1:2]], axis=1)
        along_columns = (ring[:, 2:] - ring[:, :-2]) / 2.0
    else:
        along_columns = np.gradient(positions, axis=1)
    return cast(F64, np.cross(along_rows, along_columns))


def f32(values: F64 | F32) -> F32:
    """Contiguous float32."""
    return cast(F32, np.ascontiguousarray(values, dtype=np.float32))
