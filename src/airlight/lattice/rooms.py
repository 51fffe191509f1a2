"""Which closed bodies are rooms: those that hold the eye or a local light.

A solid blocks light with its outside, a room with both sides of its walls. The eye and the lights
move, so that rooms are found again in each frame, mostly without a look at any triangle: what a
point is inside of does not change before it reaches a triangle.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..maths.arrays import F64
from ..maths.chunks import chunks
from ..maths.transforms import box_around
from ..scene.fingerprint import is_same
from ..scene.light_shapes import LightMesh
from ..scene.mesh import Mesh
from .bodies import closed_bodies, is_sealed, winding_number


@dataclass(frozen=True, eq=False)
class _Known:
    """Whether a body of `meshes` holds all points nearer than `reach_m` to `point`."""

    meshes: tuple[Mesh, ...]
    point: F64
    reach_m: float
    holds: bool


class Rooms:
    """The closed bodies of a scene, and which of their sides block.

    `sides`, one per mesh: 1 the front, -1 the back, 0 both that its material has. `walls`: the
    meshes, by index, of rooms that hold some of the points and not all: no light comes from one
    side of those to the other but through their materials.
    """

    def __init__(self, meshes: Sequence[Mesh], points: F64) -> None:
        """`points` (n, 3), metres: bodies around one of them are rooms for good."""
        # Bodies are found once: a mesh that moves or bends closes what it closed.
        self._outer, self._bodies = closed_bodies(meshes)
        self._known: list[list[_Known]] = [[] for _ in self._bodies]
        self._parting: dict[int, tuple[list[Mesh], bool]] = {}
        self._placed: Sequence[Mesh] | None = None
        self._boxes = np.zeros((2, 0, 3))
        self._always = self._around(meshes, points)
        self._rooms = self._always
        self.sides = self._blocking(meshes)
        self.walls = self._walls(self._always, meshes, points)

    def update(self, meshes: Sequence[Mesh], points: F64) -> bool:
        """Take on where meshes and `points` (n, 3), metres, are.

        Returns whether `sides` or `walls` changed.
        """
        before, holding = (self.sides, self.walls), self._around(meshes, points)
        self.walls = self._walls(holding, meshes, points)
        rooms = self._always | holding
        # Which sides block changes only where a body becomes a room, or is none any more.
        if rooms != self._rooms:
            self._rooms = rooms
            self.sides = self._blocking(meshes)
        return (self.sides, self.walls) != before

    def parted(
        self, meshes: Sequence[Mesh], eye: F64, points: F64, reaches_m: F64
    ) -> NDArray[np.bool_]:
        """Which `points` (n, 3), metres, an opaque closed surface parts from the `eye` (3,).

        Exactly: a path between points around which a surface without edges winds differently often
        meets it. `reaches_m` (n + 1,): how far eye and points reach about themselves; what comes so
        near to the surface is not parted.
        """
        self._place(meshes)
        both = np.concatenate([eye[None], points])
        low, high = self._boxes[:, :, None]
        is_near = ((both > low) & (both < high)).all(axis=-1)
        found = np.zeros(len(points), bool)
        for number in np.flatnonzero(is_near.any(axis=1)).tolist():
            # Outside its box a point is outside the body.
            is_held = is_near[number]
            for k in np.flatnonzero(is_held):
                is_held[k] = self._holds(number, meshes, both[k])
            differs = is_held != is_held[0]
            if not differs.any() or not self._parts(number, meshes):
                continue
            # The eye, and each point on its other side, have to be clear of it.
            body = [meshes[index] for index in self._bodies[number]]
            least = np.maximum(reaches_m, _CLEAR * np.ptp(self._boxes[:, number], axis=0).max())
            if _clearance(body, eye) > least[0]:
                for k in np.flatnonzero(differs[1:]):
                    is_far = not np.isfinite(points[k]).all()
                    found[k] |= is_far or _clearance(body, points[k]) > least[k + 1]
        return found

    def _parts(self, number: int, meshes: Sequence[Mesh]) -> bool:
        """Whether no light and no camera sees through a body as it is; a lid may have opened."""
        body = [meshes[index] for index in self._bodies[number]]
        known, parts = self._parting.get(number, ([], False))
        if not is_same(body, known):
            parts = all(map(_is_opaque, body)) and is_sealed(body)
            self._parting[number] = body, parts
        return parts

    def _walls(
        self, holding: frozenset[int], meshes: Sequence[Mesh], points: F64
    ) -> frozenset[int]:
        """The meshes of those bodies, which hold some of the points, that do not hold all."""
        low, high = self._boxes
        found: set[int] = set()
        for number in holding:
            # Outside its box a point is outside the body: that saves most winding numbers.
            is_near = ((points > low[number]) & (points < high[number])).all(axis=-1)
            if not (is_near.all() and all(self._holds(number, meshes, p) for p in points)):
                found.update(self._bodies[number])
        return frozenset(found)

    def _blocking(self, meshes: Sequence[Mesh]) -> list[int]:
        """Rooms, and what of single-sided materials faces in, block as their materials have it."""
        # A room's both sides block; a solid's outer one, unless it faces in and is single-sided.
        found = list(self._outer)
        for number, body in enumerate(self._bodies):
            for index in body:
                faces_in = found[index] < 0 and not meshes[index].material.two_sided
                if number in self._rooms or faces_in:
                    found[index] = 0
        return found

    def _around(self, meshes: Sequence[Mesh], points: F64) -> frozenset[int]:
        """The bodies that hold one of the points."""
        if not self._bodies or not len(points):
            return frozenset()
        # Boxes tell of nearly all that they hold none.
        self._place(meshes)
        low_m, high_m = self._boxes[:, :, None]
        is_near = ((points > low_m) & (points < high_m)).all(axis=-1)

        # Only within a box is the winding number asked.
        return frozenset(
            int(number)
            for number in np.flatnonzero(is_near.any(axis=1))
            if any(self._holds(int(number), meshes, point) for point in points[is_near[number]])
        )

    def _place(self, meshes: Sequence[Mesh]) -> None:
        """Find the bodies' boxes where the `meshes` are others than before."""
        if self._bodies and meshes is not self._placed:
            boxes = [box_around([meshes[i].world_bounds for i in body]) for body in self._bodies]
            self._placed, self._boxes = meshes, np.array(boxes).swapaxes(0, 1)

    def _holds(self, number: int, meshes: Sequence[Mesh], point: F64) -> bool:
        """Whether a body holds a point."""
        body = tuple(meshes[index] for index in self._bodies[number])
        # What was found of these very meshes, at a point with no triangle between.
        kept = [known for known in self._known[number] if is_same(body, known.meshes)]
        for known in kept:
            if float(np.linalg.norm(point - known.point)) < known.reach_m:
                return known.holds

        # Else the winding number tells, for as far as no triangle is near.
        new = _Known(body, point, _clearance(body, point), winding_number(body, point) > 0.5)
        self._known[number] = [*kept[-_MOST_KNOWN:], new]
        return new.holds


_MOST_KNOWN = 31
"""Places of which a body remembers whether it holds them."""
_CLEAR = 1e-4
"""Of a body's longest side: what is nearer to its surface is on neither side for sure."""


def sides(meshes: Sequence[Mesh], points: F64) -> list[int]:
    """The side of each mesh that blocks, with rooms around `points` (n, 3), metres."""
    return Rooms(meshes, points).sides


def _is_opaque(mesh: Mesh) -> bool:
    """Whether nothing is seen through a mesh from either side, nor is light sent from within it."""
    material = mesh.material
    has_gaps = material.is_translucent or material.alpha_cutoff > 0.0 or material.is_culled
    return not (has_gaps or material.is_emissive or isinstance(mesh, LightMesh))


def _clearance(body: Sequence[Mesh], point: F64) -> float:
    """Metres to the nearest triangle at least: to its box, or to its plane."""
    # A lower bound suffices: within it no triangle lies between two points.
    nearest = np.inf
    for mesh in body:
        corners = mesh.world_positions - point
        for part in chunks(len(mesh.geometry.indices)):
            three = corners[mesh.geometry.indices[part]]
            # Per axis, how far the triangle's box is away; 0 where the point is beside it.
            beyond = np.maximum(np.maximum(three.min(axis=1), -three.max(axis=1)), 0.0)
            # A triangle is no nearer than its plane, nor than its box: the larger of both.
            normal = np.cross(three[:, 1] - three[:, 0], three[:, 2] - three[:, 0])
            length = np.maximum(np.linalg.norm(normal, axis=1), 1e-30)
            to_plane = np.abs(np.einsum("nk,nk->n", normal, three[:, 0])) / length
            least = np.maximum(np.linalg.norm(beyond, axis=1), to_plane)
            nearest = min(nearest, float(least.min(initial=np.inf)))
    return nearest
