"""Closed bodies: which side of a mesh faces out, and what is inside.

A closed body stops light with its outside alone. It need not be one mesh: files are cut by
material, so that meshes whose edges meet close a body together.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence

import numpy as np
from numpy.typing import NDArray

from ..maths.arrays import F64, I64
from ..maths.chunks import chunks
from ..maths.solid_angle import signed_solid_angle
from ..maths.transforms import placed_points
from ..maths.weld import open_vertices, welded
from ..scene.mesh import Geometry, Mesh, is_mirrored

_OPEN_EDGES = 0.01  # share of edges without a partner up to which a body counts as closed
_SAME = 2.0**-20  # of the scene's extent: edges so near to each other meet
_MOST_EDGES = 1 << 20
"""Of open meshes, the smallest first: what are more are leaves and the like."""


def closed_bodies(meshes: Sequence[Mesh]) -> tuple[list[int], list[list[int]]]:
    """The outer side of each mesh, and the bodies that they close, by the meshes' indices.

    1: the front faces out, -1: the back, 0: the mesh is part of no closed body.
    """
    # Each geometry is looked at once; a body of a single mesh closes by itself.
    closed = {key: outer_side(g) for key, g in {id(m.geometry): m.geometry for m in meshes}.items()}
    found = [closed[id(mesh.geometry)] for mesh in meshes]
    bodies = [[index] for index, side in enumerate(found) if side != 0]
    # Open meshes may close a body together; the sign of its volume says which side is out.
    for body in _joined([index for index, side in enumerate(found) if side == 0], meshes):
        outside = 1 if sum(_volume(meshes[index]) for index in body) > 0.0 else -1
        for index in body:
            found[index] = outside
        bodies.append(body)
    return found, bodies


def winding_number(meshes: Mesh | Iterable[Mesh], point: F64) -> float:
    """How often meshes wind around a point: 1 inside a closed body, 0 outside.

    The sum of the triangles' solid angles over 4 pi, without its sign.
    """
    angle = 0.0
    for mesh in [meshes] if isinstance(meshes, Mesh) else meshes:
        # Triangles as seen from the point: the solid angle of each.
        corners = mesh.world_positions - point
        indices, own = mesh.geometry.indices, 0.0
        for part in chunks(len(indices)):
            own += float(signed_solid_angle(corners[indices[part]]).sum())
        angle += own * _handedness(mesh)
    return abs(angle) / (4.0 * np.pi)


def outer_side(geometry: Geometry) -> int:
    """1 or -1 where the triangles close a body and face out or in; 0 for open sheets."""
    # Every edge of a closed body is shared by two triangles, which run it in opposite directions.
    corners = welded(geometry.positions)[geometry.indices]
    edges = int((corners != np.roll(corners, -1, axis=1)).sum())
    if edges == 0 or _unmatched_edges(corners) > _OPEN_EDGES * edges:
        return 0
    # A closed body's signed volume says which side faces out.
    positions = geometry.positions
    return 1 if _signed_volume(positions - positions.mean(axis=0), geometry.indices) > 0.0 else -1


def is_sealed(meshes: Sequence[Mesh]) -> bool:
    """Whether as many edges of all triangles run each way between any two points of the world.

    Then what they wind around is parted from what they do not: there is no way round an edge.
    """
    return bool(_met(_edges(meshes)[0])[1].all())


def _edges(meshes: Sequence[Mesh]) -> tuple[I64, I64]:
    """All edges (E, 2) in the world, between numbers of points that several meshes may share, and
    the place in `meshes` of the one that each is of."""
    points, pairs = zip(*map(_placed, meshes), strict=True)
    owner = np.repeat(np.arange(len(pairs)), [len(p) for p in pairs])
    first = np.cumsum([0, *(len(p) for p in points[:-1])])
    ends = np.concatenate([p + start for p, start in zip(pairs, first, strict=True)])
    placed = np.concatenate(points)

    # Points that are the same but for rounding become one; edges of no length go.
    step = max(_SAME * float(np.ptp(placed, axis=0).max(initial=0.0)), 1e-30)
    edges = welded(np.round(placed / step))[ends]
    is_edge = edges[:, 0] != edges[:, 1]
    return np.asarray(edges[is_edge], np.int64), owner[is_edge]


def _signed_volume(positions: NDArray[np.floating], indices: NDArray[np.uint32]) -> float:
    """Six times the volume that triangles enclose, negative where they face in."""
    volume = 0.0

    # Six times the signed volume of the tetrahedra between triangles and the origin.
    for part in chunks(len(indices)):
        a, b, c = (positions[indices[part, k]].astype(np.float64) for k in range(3))
        volume += float(np.einsum("nk,nk->", a, np.cross(b, c)))
    return volume


def _volume(mesh: Mesh) -> float:
    """A mesh's part, m^3, in six times the volume of the body that it closes with others."""
    return _signed_volume(mesh.world_positions, mesh.geometry.indices) * _handedness(mesh)


def _handedness(mesh: Mesh) -> float:
    """-1 for a mesh under a mirroring transform, whose triangles face as if it did not mirror."""
    return -1.0 if is_mirrored(mesh) else 1.0


def _unmatched_edges(corners: I64) -> int:
    """How many edges of triangles `corners` (T, 3) have no partner in the opposite direction."""
    # Both ends of an edge without a partner are open.
    is_open = open_vertices(corners)
    ahead = np.roll(corners, -1, axis=1)
    doubtful = is_open[corners] & is_open[ahead] & (corners != ahead)
    a, b, n = corners[doubtful], ahead[doubtful], np.int64(len(is_open))
    return len(a) - int(np.isin(a * n + b, b * n + a, kind="sort").sum())


def _joined(open_ones: list[int], meshes: Sequence[Mesh]) -> list[list[int]]:
    """Groups of meshes, by index, of which each closes a body together."""
    # The smallest first, as many as are quickly looked through.
    by_size = sorted(open_ones, key=lambda index: len(meshes[index].geometry.indices))
    sizes = np.cumsum([3 * len(meshes[index].geometry.indices) for index in by_size])
    left = by_size[: int(np.searchsorted(sizes, _MOST_EDGES, side="right"))]
    if len(left) < 2:
        return []
    edges, places = _edges([meshes[index] for index in left])
    owner = np.asarray(left, np.int64)[places]
    # A mesh with edges that no other's meet is a sheet; without it, others may be, too.
    while len(left):
        which, is_met = _met(edges)
        most = _OPEN_EDGES * np.bincount(owner, minlength=len(meshes))
        missing = np.bincount(owner[~is_met], minlength=len(meshes))
        kept = [index for index in left if missing[index] <= most[index]]
        if len(kept) == len(left):
            return _connected(left, owner, which)
        stays = np.isin(owner, kept)
        left, owner, edges = kept, owner[stays], edges[stays]
    return []


def _placed(mesh: Mesh) -> tuple[F64, I64]:
    """The points (V, 3), m, of a mesh's triangles, and the edges (E, 2) between them; what mirrors
    swaps the ends."""
    # Only vertices that triangles use, renumbered; edges in the order of the triangle.
    used, rows = np.unique(mesh.geometry.indices, return_inverse=True)
    placed = placed_points(mesh.geometry.positions[used].astype(np.float64), mesh.world_from_object)
    rows = rows.reshape(-1, 3)
    ends = np.stack([rows, np.roll(rows, -1, axis=1)], axis=2).reshape(-1, 2)
    return placed, ends[:, ::-1] if is_mirrored(mesh) else ends


def _met(edges: I64) -> tuple[I64, NDArray[np.bool_]]:
    """The place of each of the `edges` (E, 2), and whether as many run there either way."""
    # An edge and its reverse are at one place; they balance where each has the other.
    low, high = edges.min(axis=1), edges.max(axis=1)
    _, which = np.unique(low * (edges.max() + 1) + high, return_inverse=True)
    balance = np.bincount(which, weights=np.where(edges[:, 0] < edges[:, 1], 1.0, -1.0))
    return which, balance[which] == 0.0


def _connected(left: list[int], owner: I64, which: I64) -> list[list[int]]:
    """Groups of those `left` that have edges at the same places."""
    # Meshes that share an edge, as pairs; groups are what the pairs join.
    order = np.argsort(which, kind="stable")
    is_same = which[order][1:] == which[order][:-1]
    one, two = owner[order][:-1][is_same], owner[order][1:][is_same]
    group = {index: index for index in left}

    def root(index: int) -> int:
        while group[index] != index:
            index = group[index]
        return index

    # Union-find: groups that share one become one.
    for a, b in np.unique(np.stack([one, two], axis=1), axis=0).tolist():
        group[root(a)] = root(b)
    return [[i for i in left if root(i) == head] for head in left if root(head) == head]
