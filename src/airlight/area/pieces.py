"""Glowing surfaces in small triangles: where they lie, where they face, what they give."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from ..maths.weld import connected, edges_of, welded
from ..scene.checks import F64, I64
from ..scene.mesh import Geometry, is_mirrored
from .sources import Source, snapped, texture_light
from .threads import threads_joined

LEAST_PIECES, LEAST_TEXTURED = 512, 2048
"""Small triangles of a source, at least: samples are groups of them."""
MOST_SPLIT = 5
_FOLD_COSINE = 0.9  # of normals of neighbours that belong to one smooth part
_TAPS = np.array([(4, 1, 1), (1, 4, 1), (1, 1, 4), (2, 2, 2)], np.float64) / 6.0


@dataclass(frozen=True, eq=False)
class Pieces:
    """`positions` (n, 3), m; `normals` (n, 3), of the side that glows; `areas` (n,), m^2;
    `radiance` (n, 3), W m^-2 sr^-1; `corners` (n, 3, 3), m.
    """

    positions: F64
    normals: F64
    areas: F64
    radiance: F64
    corners: F64

    @property
    def power(self) -> F64:
        """W (n,), the mean of the channels."""
        return np.asarray(np.pi * self.areas * self.radiance.mean(axis=1))

    def taken(self, rows: I64) -> Pieces:
        """Some of them."""
        columns = (self.positions, self.normals, self.areas, self.radiance, self.corners)
        return Pieces(*(values[rows] for values in columns))


@dataclass(frozen=True, eq=False)
class Layout:
    """How sources are cut, for as long as their triangles stay the same: of each piece its source,
    its triangle and the weights (n, 3, 3) of the triangle's corners in its own; what its texture
    makes of the source's emission (n, 3); the smooth part, and the connected body, that it is of.
    """

    source: I64
    triangle: I64
    weights: F64
    share: F64
    part: I64
    body: I64


def layout(found: Sequence[Source]) -> Layout:
    """Cut all triangles so that sources have many pieces, and number smooth parts and bodies."""
    columns: list[tuple[I64, I64, F64, F64, I64, I64]] = []
    firsts: dict[tuple[int, int], tuple[int, int]] = {}
    parts = bodies = 0
    for row, source in enumerate(found):
        geometry, material = source.surface.geometry, source.surface.material
        count = len(geometry.indices)
        # Triangles of few-sided surfaces, and of textured ones, are split into equal parts.
        texture = material.emission_texture if geometry.uvs is not None else None
        wanted = LEAST_TEXTURED if texture else LEAST_PIECES
        depth = min(MOST_SPLIT, max(0, int(np.ceil(0.5 * np.log2(wanted / count)))))
        split = _split(depth)
        triangle = np.repeat(np.arange(count), len(split))
        weights = np.tile(split, (count, 1, 1))
        # The share of the emission that the texture leaves each piece.
        share = np.ones((len(triangle), 3))
        if texture is not None and geometry.uvs is not None:
            uv = geometry.uvs[geometry.indices[triangle]].astype(np.float64)
            taps = np.einsum("tk,nkc,ncx->tnx", _TAPS, weights, uv)
            share = np.mean([texture_light(texture, tap) for tap in taps], axis=0)
        # Smooth parts and bodies are numbered over all sources; what several meshes make, once.
        whole, offset = source.part or (geometry, 0)
        part, body = _parts_of(whole)
        key = (id(whole), source.side) if source.part else (row, 0)
        if key not in firsts:
            firsts[key] = parts, bodies
            parts += int(part.max()) + 1
            bodies += int(body.max()) + 1
        own = offset + triangle
        part, body = part[own] + firsts[key][0], body[own] + firsts[key][1]
        columns.append((np.full(len(triangle), row), triangle, weights, share, part, body))
    if not columns:
        none = np.zeros(0, np.int64)
        return Layout(none, none, np.zeros((0, 3, 3)), np.zeros((0, 3)), none, none)
    return Layout(*(np.concatenate(column) for column in zip(*columns, strict=True)))


def _split(depth: int) -> F64:
    """Weights (4^depth, 3 corners, 3) of the corners of a triangle's equal parts."""
    parts = np.eye(3)[None]
    for _ in range(depth):
        # The middles of its edges cut a triangle into four of equal area and of its own shape.
        a, b, c = parts[:, 0], parts[:, 1], parts[:, 2]
        ab, bc, ca = (a + b) / 2.0, (b + c) / 2.0, (c + a) / 2.0
        quarters = [(a, ab, ca), (ab, b, bc), (ca, bc, c), (bc, ca, ab)]
        parts = np.concatenate([np.stack(quarter, axis=1) for quarter in quarters])
    return parts


def pieces(found: Sequence[Source], cut: Layout) -> Pieces:
    """The pieces of sources as they stand now."""
    corners = np.zeros((len(cut.source), 3, 3))
    radiance = np.zeros((len(cut.source), 3))
    sign = np.ones(len(cut.source))
    # Pieces lie in the order of their sources.
    first = np.searchsorted(cut.source, np.arange(len(found) + 1))
    for row, source in enumerate(found):
        own = slice(int(first[row]), int(first[row + 1]))
        surface = source.surface
        triangles = surface.world_positions[surface.geometry.indices[cut.triangle[own]]]
        corners[own] = np.einsum("nkc,ncx->nkx", cut.weights[own], triangles)
        radiance[own] = cut.share[own] * np.array(surface.material.emission)
        # A mirroring placement keeps the front.
        sign[own] = -source.side if is_mirrored(surface) else source.side
    # The cross product is twice the area along the normal, turned to the side that glows.
    cross = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    double = np.linalg.norm(cross, axis=1)
    normals = sign[:, None] * cross / np.maximum(double, 1e-30)[:, None]
    return Pieces(corners.mean(axis=1), normals, 0.5 * double, radiance, corners)


@lru_cache(maxsize=256)
def _parts_of(geometry: Geometry) -> tuple[I64, I64]:
    """`parts_and_bodies`, once for all meshes that share a geometry."""
    found = parts_and_bodies(geometry)
    for numbers in found:
        numbers.flags.writeable = False
    return found


def parts_and_bodies(geometry: Geometry) -> tuple[I64, I64]:
    """(T,) each: numbers of the parts of a mesh that join without a fold, threads whole; and of the
    bodies whose triangles are connected."""
    # Corners in one place are one: seams of texture coordinates cut no surface.
    corners = welded(snapped(geometry).positions)[geometry.indices]
    points = geometry.positions.astype(np.float64)[geometry.indices]
    normals = np.cross(points[:, 1] - points[:, 0], points[:, 2] - points[:, 0])
    normals /= np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-30)
    # Edges that two triangles share, sorted side by side.
    edges = edges_of(corners)
    owner = np.repeat(np.arange(len(corners)), 3)
    order = np.lexsort((edges[:, 1], edges[:, 0]))
    edges, owner = edges[order], owner[order]
    is_same = (edges[1:] == edges[:-1]).all(axis=1)
    a, b = owner[:-1][is_same], owner[1:][is_same]
    # Across a fold the body goes on, the smooth part does not.
    joins = (normals[a] * normals[b]).sum(axis=1) > _FOLD_COSINE
    part = connected(len(corners), a[joins], b[joins])
    body = connected(len(corners), a, b)
    return threads_joined(points, part, body), body
