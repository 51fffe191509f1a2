"""Simplified scenes for maps of few texels, by vertex clustering (Rossignac1993).

The sky's maps see the whole scene a hundred times, each in less than ten thousand texels, so that a
hundred thousand triangles are ten to a texel. The vertices in each cell of a grid, which is finer
than texels and than the lattice's cells, collapse to the one nearest to their mean. Where
clustering loses area (gravel smaller than cells) and in leaves, triangles stay as they are.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..gpu.device import Gpu
from ..maths.chunks import chunks
from ..maths.weld import open_vertices, welded
from ..scene.checks import F64, I64
from ..scene.mesh import Geometry, Mesh
from ..scene.scene import Scene
from .geometry import GpuScene

MOST_TRIANGLES = 100_000
"""Instances counted each: scenes of no more are drawn as they are."""
FEWEST_OF_A_GEOMETRY = 2048
"""Of all its instances: fewer are drawn in less time than they take to be made coarse."""
_CELLS_A_TEXEL = 2.0
_MOST_CELLS = 1 << 25
_BLOCK = 4  # cells along a side of the blocks whose area is compared
_LEAST_AREA, _MOST_AREA = 0.5, 1.5  # of what a block had


class CoarseScene:
    """A scene as maps of `resolution` texels a side need it: simplified, or itself."""

    def __init__(self, gpu: Gpu, scene: GpuScene, resolution: int) -> None:
        self._fine = scene
        self._coarse: GpuScene | None = None
        self._version = -1
        self._sources: dict[int, NDArray[np.uint32]] = {}
        self._made: dict[int, tuple[Geometry, Geometry]] = {}

        # Only large scenes are simplified.
        if sum(len(m.geometry.indices) for m in scene.original) <= MOST_TRIANGLES:
            return
        # Vertices within a part of a texel become one, where that leaves half of the triangles.
        low, high = scene.bounds
        cell = float(np.linalg.norm(high - low)) / (_CELLS_A_TEXEL * resolution)
        for first, (geometry, stretch, instances) in _geometries(scene).items():
            drawn = instances * len(geometry.indices)

            # Geometries that lose less than half of their triangles stay as they are.
            if drawn >= FEWEST_OF_A_GEOMETRY and stretch > 0.0:
                triangles = coarse_triangles(geometry, cell / stretch)
                if 2 * len(triangles) <= len(geometry.indices):
                    sources, indices = np.unique(triangles, return_inverse=True)
                    self._sources[first] = sources.astype(np.uint32)
                    coarse = _at(geometry, sources, indices.reshape(-1, 3).astype(np.uint32))
                    self._made[first] = (geometry, coarse)
        # The simplified scene shares the materials' textures with the original.
        if self._made:
            self._coarse = GpuScene(gpu, Scene(self._meshes(scene.original)), scene.store)

    def current(self) -> GpuScene:
        """The scene to draw, moved as the original has moved."""
        if self._coarse is None:
            return self._fine
        if self._version != self._fine.version:
            self._version = self._fine.version
            self._coarse.move(self._meshes(self._fine.current))
        return self._coarse

    def _meshes(self, meshes: tuple[Mesh, ...]) -> tuple[Mesh, ...]:
        """The scene's `meshes`, with simplified geometries where there are any."""
        # Draws number vertices of the scene, so meshes of one geometry share its first vertex.
        return tuple(
            replace(m, geometry=self._geometry(k, m.geometry)) if k in self._made else m
            for m, k in zip(meshes, self._fine.first_vertices, strict=True)
        )

    def _geometry(self, first: int, now: Geometry) -> Geometry:
        """The simplified geometry, with the vertices that the original has now."""
        before, coarse = self._made[first]
        if before is not now:
            coarse = _at(now, self._sources[first], coarse.indices)
            self._made[first] = (now, coarse)
        return coarse


def _geometries(scene: GpuScene) -> dict[int, tuple[Geometry, float, int]]:
    """By first vertex: the geometry, how much its largest instance stretches it, its instances."""
    found: dict[int, tuple[Geometry, float, int]] = {}

    # The spectral norm: no edge of an instance is longer than that times the geometry's own.
    for mesh, first in zip(scene.original, scene.first_vertices, strict=True):
        stretch = float(np.linalg.norm(mesh.world_from_object[:3, :3], 2))
        _, known, instances = found.get(first, (mesh.geometry, 0.0, 0))
        found[first] = (mesh.geometry, max(stretch, known), instances + 1)
    return found


def _at(g: Geometry, vertices: NDArray[np.integer[Any]], indices: NDArray[np.uint32]) -> Geometry:
    """The triangles `indices` between some of a geometry's `vertices`."""
    normals, uvs, colors = (
        None if values is None else values[vertices] for values in (g.normals, g.uvs, g.colors)
    )
    return Geometry(g.positions[vertices], indices, normals=normals, uvs=uvs, colors=colors)


def coarse_triangles(geometry: Geometry, cell: float) -> NDArray[np.uint32]:
    """Triangles (n, 3) between the geometry's own vertices, without details below `cell`.

    `cell` is in metres of object space. Where the grid would have too many cells, all triangles of
    the geometry are returned.
    """
    # A grid over the geometry's box.
    positions, indices = geometry.positions, geometry.indices
    low = positions.min(axis=0).astype(np.float64)
    count = np.floor((positions.max(axis=0) - low) / cell).astype(np.int64) + 1
    if np.prod(count.astype(float)) > _MOST_CELLS:
        return indices
    cluster, middle = _clusters(positions, low, cell, count)
    # Triangles whose corners lie in three cells, each of them once. Those that are all rim, leaves
    # and blades, stay as they are.
    vertex = welded(positions)
    is_open = open_vertices(vertex[indices])
    is_leaf = np.empty(len(indices), dtype=bool)
    remaining = []
    for part in chunks(len(indices)):
        is_leaf[part] = is_open[vertex[indices[part]]].all(axis=1)
        a, b, c = cluster[indices[part]].T
        is_left = (a != b) & (b != c) & (c != a) & ~is_leaf[part]
        remaining.append(np.stack([a[is_left], b[is_left], c[is_left]], axis=1))

    # The smallest cluster leads, by a turn: equal triangles become equal rows and keep their side.
    corners = np.concatenate(remaining)
    turn = corners.argmin(axis=1)[:, None]
    corners = np.take_along_axis(corners, (turn + np.arange(3)) % 3, axis=1)

    # Keys of three numbers below 2^21 fit into 64 bits; with more, repeated triangles stay.
    key = (corners[:, 0] * len(middle) + corners[:, 1]) * len(middle) + corners[:, 2]
    if len(middle) < 1 << 21:
        corners = corners[np.sort(np.unique(key, return_index=True)[1])]

    # Each cluster is drawn at its middle vertex.
    triangles = middle[corners].astype(np.uint32)
    sheets, leaves = indices[~is_leaf], indices[is_leaf]
    return np.concatenate([_with_lost(positions, sheets, triangles, low, cell, count), leaves])


def _clusters(positions: NDArray[np.float32], low: F64, cell: float, count: I64) -> tuple[I64, I64]:
    """The cluster (V,) of each vertex, and of each cluster the vertex nearest to its middle."""
    # The cluster of each vertex, by cell; only cells with vertices count.
    at = np.empty(len(positions), np.int64)
    for part in chunks(len(positions)):
        at[part] = _cell_number(positions[part], low, cell, count)
    is_used = np.zeros(int(np.prod(count)), dtype=bool)
    is_used[at] = True
    cluster = (np.cumsum(is_used) - 1)[at]
    # How far each vertex is from its cluster's middle.
    sizes = np.bincount(cluster)
    distance = np.zeros(len(positions))
    for column in positions.T:
        offset = column - (np.bincount(cluster, column) / sizes)[cluster]
        distance += offset * offset
    # The nearest of each.
    least = np.full(len(sizes), np.inf)
    np.minimum.at(least, cluster, distance)
    nearest = np.flatnonzero(distance == least[cluster])
    middle = np.zeros(len(sizes), np.int64)
    middle[cluster[nearest]] = nearest
    return cluster, middle


def _cell_number(points: NDArray[np.floating[Any]], low: F64, cell: float, count: I64) -> I64:
    x, y, z = np.minimum(((points - low) / cell).astype(np.int64), count - 1).T
    return np.asarray((x * count[1] + y) * count[2] + z)


def _with_lost(
    positions: NDArray[np.float32],
    indices: NDArray[np.uint32],
    coarse: NDArray[np.uint32],
    low: F64,
    cell: float,
    count: I64,
) -> NDArray[np.uint32]:
    """The `coarse` triangles, replaced by those of `indices` where much area was lost."""
    # Area before and after, by blocks of cells.
    side, blocks = cell * _BLOCK, -(-count // _BLOCK)
    old, old_area = _blocks_and_areas(positions, indices, low, side, blocks)
    new, new_area = _blocks_and_areas(positions, coarse, low, side, blocks)
    had = np.bincount(old, old_area, int(np.prod(blocks)))
    has = np.bincount(new, new_area, len(had))

    # Blocks that lost or gained too much keep their triangles.
    is_lost = (has < _LEAST_AREA * had) | (has > _MOST_AREA * had)
    return np.concatenate([coarse[~is_lost[new]], indices[is_lost[old]]])


def _blocks_and_areas(
    positions: NDArray[np.float32],
    triangles: NDArray[np.uint32],
    low: F64,
    side: float,
    blocks: I64,
) -> tuple[I64, F64]:
    """Of each triangle the block (n,) that its first corner lies in, and its area (n,)."""
    block, area = np.empty(len(triangles), np.int64), np.empty(len(triangles))
    for part in chunks(len(triangles)):
        a, b, c = (positions[triangles[part, k]].astype(np.float64) for k in range(3))
        block[part] = _cell_number(a, low, side, blocks)
        area[part] = 0.5 * np.linalg.norm(np.cross(b - a, c - a), axis=1)
    return block, area
