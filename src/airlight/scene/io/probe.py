"""Rays against triangles in NumPy: enough to find rooms, views and windows, no renderer.

Only the largest triangles are kept, so that a probe costs the same for every scene.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ...maths.chunks import chunks
from ...maths.solid_angle import signed_solid_angle
from ...maths.transforms import placed_points
from ..checks import F32, F64
from ..mesh import Mesh
from ..scene import Scene

MAX_TRIANGLES = 8_000
_TESTS_AT_ONCE = 60_000
_LARGEST = 500
_HARDLY_LARGER = 1.0001
_PANE_PASSES = 0.25
"""Of the light that meets a pane: with so much it is no wall."""


@dataclass(frozen=True, eq=False)
class Hits:
    """Where rays end: `distance` (R,), inf for a miss; `triangle` (R,), -1; seen from the front."""

    distance: F64
    triangle: NDArray[np.int64]
    is_front: NDArray[np.bool_]


class Probe:
    """The triangles of a scene in world space, largest first.

    `corners` (T, 3, 3) metres, `mesh` (T,) the mesh each belongs to, `normals` (T, 3) unit. Rays
    pass the meshes that `panes` numbers, glass and other surfaces that let much light through.
    """

    def __init__(
        self, corners: F64, normals: F64, mesh: NDArray[np.int64], panes: Sequence[int] = ()
    ) -> None:
        self.corners = corners
        self.normals = normals
        self.mesh = mesh
        self.panes = tuple(panes)
        self._walls = np.flatnonzero(~np.isin(mesh, self.panes))

    @classmethod
    def of(
        cls, scene: Scene, max_triangles: int = MAX_TRIANGLES, *, through_panes: bool = True
    ) -> Probe:
        """The largest triangles of a scene; those without area are left out.

        `through_panes`: rays are light's, which passes panes; else they are somebody's who walks.
        """
        largest = _largest_areas(scene.meshes)
        panes = [
            k
            for k, mesh in enumerate(scene.meshes)
            if through_panes and _passes(mesh) >= _PANE_PASSES
        ]
        held = cls(np.zeros((0, 3, 3)), np.zeros((0, 3)), np.zeros(0, np.int64), panes)
        least = 0.0
        for k, mesh in enumerate(scene.meshes):
            # Of a shape that stands in many places, most add nothing.
            stretch = float(np.linalg.norm(mesh.world_from_object[:3, :3], 2))
            known = largest.get(id(mesh.geometry), np.inf)
            if len(held.corners) == max_triangles and known * stretch**2 <= _HARDLY_LARGER * least:
                continue
            held, least = held._with(_largest_triangles(mesh, max_triangles), k, max_triangles)
        return held

    def _with(self, added: F64, mesh: int, max_triangles: int) -> tuple[Probe, float]:
        """The probe with triangles (T, 3, 3) of a mesh, cut to the largest; least area, twice."""
        corners = np.concatenate([self.corners, added])
        owner = np.append(self.mesh, np.full(len(added), mesh))
        # New triangles compete with those held before; the smallest make room.
        cross, area = _areas(corners)
        keep = np.argsort(-area, kind="stable")[:max_triangles]
        least = float(area[keep[-1]]) if len(keep) else 0.0
        made = Probe(corners[keep], cross[keep] / area[keep, None], owner[keep], self.panes)
        return made, least

    def largest(self, count: int) -> Probe:
        """A quicker and blinder probe."""
        return Probe(self.corners[:count], self.normals[:count], self.mesh[:count], self.panes)

    def cast(self, origins: F64, directions: F64) -> Hits:
        """First hits of rays (R, 3), unit directions (R, 3).

        Source: Moeller1997, the ray-triangle test in barycentric coordinates.
        """
        # Rays in batches: the table of rays times triangles stays within memory.
        count = max(1, _TESTS_AT_ONCE // max(1, len(self._walls)))
        parts = [
            self._cast(origins[k : k + count], directions[k : k + count])
            for k in range(0, len(origins), count)
        ]
        distance = np.concatenate([np.zeros(0), *(part[0] for part in parts)])
        nearest = np.concatenate([np.zeros(0, int), *(part[1] for part in parts)])
        # A ray meets a front where it goes against the surface's normal.
        hit = np.isfinite(distance)
        facing = np.zeros(len(distance))
        facing[hit] = np.einsum("rk,rk->r", self.normals[nearest[hit]], directions[hit])
        return Hits(distance, np.where(hit, nearest, -1), facing < 0.0)

    def _cast(self, origins: F64, directions: F64) -> tuple[F64, NDArray[np.int64]]:
        if len(self._walls) == 0:
            return np.full(len(origins), np.inf), np.zeros(len(origins), dtype=np.int64)
        corners = self.corners[self._walls]
        middle = corners[0].mean(axis=0)  # single precision wants small coordinates
        origins = origins - middle
        a = corners[:, 0] - middle
        edge1, edge2 = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
        normal = np.cross(edge1, edge2)
        # All four triple products are sums over a ray's and a triangle's vectors, so each is a
        # matrix product: (o - a) . (d x e) = e . (o x d) - d . (e x a).
        ray = _single(np.hstack([np.cross(origins, directions), directions]))
        with np.errstate(divide="ignore", invalid="ignore"):
            # Rays along a triangle's plane divide by zero; the comparisons below fail for them.
            inverse = 1.0 / -(ray[:, 3:] @ _single(normal).T)
            u = ray @ _single(np.hstack([edge2, -np.cross(edge2, a)])).T
            u *= inverse
            v = ray @ _single(np.hstack([-edge1, np.cross(edge1, a)])).T
            v *= inverse
            # The distance along the ray, from the plane's equation.
            t = _single(origins) @ _single(normal).T
            t -= _single(np.einsum("tk,tk->t", a, normal))
            t *= inverse
            inside = (u >= 0.0) & (v >= 0.0) & (u + v <= 1.0) & (t > 1e-5)
        t[~inside] = np.inf
        nearest = t.argmin(axis=1)
        return t[np.arange(len(t)), nearest].astype(np.float64), self._walls[nearest]

    def winding(self, points: F64) -> F64:
        """How often the surfaces go round each point (P, 3): about 1 in a solid, 0 in the open or
        in a solid's cavity, -1 in a sheet whose front is inside."""
        angles = [signed_solid_angle(self.corners - point).sum() for point in points]
        return np.array(angles, np.float64) / (4.0 * np.pi)

    def sees_sky(self, points: F64, towards: F64) -> NDArray[np.bool_]:
        """Whether parallel rays from points (P, 3) towards a unit direction leave the scene."""
        clear = np.ones(len(points), dtype=bool)
        # Most rays end at a wall: the few largest triangles go first, the rest see survivors.
        for part in (slice(0, _LARGEST), slice(_LARGEST, None)):
            left = np.flatnonzero(clear)
            clear[left] = ~self._any_hit(points[left], towards, part)
        return clear

    def _any_hit(self, points: F64, towards: F64, part: slice) -> NDArray[np.bool_]:
        """In the plane across the direction a ray is a point: only triangles whose flat box
        holds it are tested."""
        # Parallel rays: in the plane across them only boxes that hold the point can be hit.
        corners = self.corners[self._walls[part]]
        across = _plane(towards)
        near = np.ones((len(points), len(corners)), dtype=bool)
        for axis in across:
            flat: F32 = (corners @ axis).astype(np.float32)
            at: F32 = (points @ axis).astype(np.float32)[:, None]
            near &= (at >= flat.min(axis=1)) & (at <= flat.max(axis=1))
        point, triangle = np.nonzero(near)
        blocked = _pairs_hit(points[point], towards, corners[triangle])
        hits: NDArray[np.bool_] = np.bincount(point[blocked], minlength=len(points)) > 0
        return hits


def _pairs_hit(origins: F64, towards: F64, corners: F64) -> NDArray[np.bool_]:
    """Whether each origin's ray hits the triangle of the same row, (N, 3) and (N, 3, 3)."""
    # Moeller1997; parallel rays divide by zero and fail the comparisons.
    a, b, c = corners.transpose(1, 0, 2)
    edge1, edge2, to_origin = b - a, c - a, origins - a
    p = np.cross(towards, edge2)
    q = np.cross(to_origin, edge1)
    with np.errstate(divide="ignore", invalid="ignore"):
        inverse = 1.0 / np.einsum("nk,nk->n", edge1, p)
        u = np.einsum("nk,nk->n", to_origin, p) * inverse
        v = (q @ towards) * inverse
        t = np.einsum("nk,nk->n", edge2, q) * inverse
    hit: NDArray[np.bool_] = (u >= 0.0) & (v >= 0.0) & (u + v <= 1.0) & (t > 1e-6)
    return hit


def _passes(mesh: Mesh) -> float:
    """The share of light that passes a mesh straight, its textures left aside."""
    material = mesh.material
    covered = material.alpha if material.is_blended else 1.0
    return 1.0 - covered * (1.0 - material.transmission * (1.0 - material.metallic))


def _single(values: F64) -> F32:
    return np.ascontiguousarray(values, dtype=np.float32)


def _plane(direction: F64) -> F64:
    """Two unit vectors (2, 3) across a unit direction."""
    # From the axis that the direction is least along, so that the cross product is long.
    other = np.eye(3)[int(np.abs(direction).argmin())]
    u = np.cross(direction, other)
    u /= np.linalg.norm(u)
    return np.stack([u, np.cross(direction, u)])


def _largest_triangles(mesh: Mesh, count: int) -> F64:
    """Corners (T, 3, 3) in world space of the `count` largest triangles that have an area, in
    their order; none of a mesh that is cut out whole, its alpha below its cutoff."""
    material = mesh.material
    if material.alpha < material.alpha_cutoff:
        return np.zeros((0, 3, 3))
    matrix, indices = mesh.world_from_object, mesh.geometry.indices
    # Areas in the world, as placements scale meshes.
    placed = placed_points(mesh.geometry.positions, matrix)
    area = np.empty(len(indices))
    for part in chunks(len(indices)):
        area[part] = _areas(placed[indices[part]])[1]
    kept = np.flatnonzero(area > 0.0)
    if len(kept) > count:
        # Of those as large as the smallest kept one, the first.
        least = np.partition(area, len(area) - count)[len(area) - count]
        larger, equal = np.flatnonzero(area > least), np.flatnonzero(area == least)
        kept = np.sort(np.append(larger, equal[: count - len(larger)]))
    corners = np.asarray(placed[indices[kept]])
    # Mirrored, a triangle's corners go round the other way; its front stays what it was.
    return corners[:, ::-1] if np.linalg.det(matrix[:3, :3]) < 0.0 else corners


def _largest_areas(meshes: Sequence[Mesh]) -> dict[int, float]:
    """Twice the area of the largest triangle in its own space, by the id of geometries that
    several meshes share."""
    count = Counter(id(mesh.geometry) for mesh in meshes)
    found: dict[int, float] = {}
    for geometry in (mesh.geometry for mesh in meshes):
        if count[id(geometry)] > 1 and id(geometry) not in found:
            areas = [
                _areas(geometry.positions[geometry.indices[part]].astype(np.float64))[1].max()
                for part in chunks(len(geometry.indices))
            ]
            found[id(geometry)] = float(max(areas))
    return found


def _areas(corners: F64) -> tuple[F64, F64]:
    """Cross products (T, 3) of the edges of `corners` (T, 3, 3), and twice the areas (T,)."""
    a, b, c = corners.transpose(1, 0, 2)
    cross = np.cross(b - a, c - a)
    return cross, np.linalg.norm(cross, axis=1)


def sphere_directions(count: int) -> F64:
    """`count` unit vectors spread evenly over the sphere (a Fibonacci spiral), (count, 3)."""
    k = np.arange(count) + 0.5
    # Rings of equal area along y, each turned by the golden angle.
    y = 1.0 - 2.0 * k / count
    angle = k * np.pi * (3.0 - 5.0**0.5)
    across = np.sqrt(1.0 - y * y)
    return np.stack([across * np.cos(angle), y, across * np.sin(angle)], axis=1)
