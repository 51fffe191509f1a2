"""Where Mitsuba's media are: in cubes, in spheres, and in what meshes enclose."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from ...errors import SceneError
from ...maths.transforms import box_corners, placed_points, triple
from ..checks import F32, F64, Bounds
from ..enclosed import FEWEST, Body
from .mitsuba_nodes import Node
from .mitsuba_shapes import Placed, shape_geometries, shape_matrix
from .mitsuba_textures import Source

UNIT: Bounds = ((-1.0, -1.0, -1.0), (1.0, 1.0, 1.0))
_HAIR = 1e-3  # of a grid: so much of it may lie outside of a cube that holds it


@dataclass(frozen=True, eq=False)
class Region:
    """What a shape bounds: a cube, a sphere, or the inside of `parts`, its triangles.

    `extent` is the box around it in the space of `world_from_shape`.
    """

    node: Node
    kind: str
    world_from_shape: F64
    extent: Bounds
    parts: tuple[Placed, ...]

    @cached_property
    def body(self) -> Body:
        """As triangles."""
        return Body.of(self.parts)

    @property
    def box(self) -> tuple[F64, F64] | None:
        """World corners, where it is an upright box."""
        linear = self.world_from_shape[:3, :3]
        if self.kind != "cube" or np.abs(linear - np.diag(np.diag(linear))).max() > 1e-9:
            return None
        ends = np.array(self.extent) * np.diag(linear) + self.world_from_shape[:3, 3]
        return ends.min(axis=0), ends.max(axis=0)

    @property
    def middle(self) -> F64:
        """Of its extent, in the world."""
        centre = np.mean(self.extent, axis=0)
        return np.asarray(self.world_from_shape[:3, :3] @ centre + self.world_from_shape[:3, 3])

    def filled(self, free_path_m: float, source: Source) -> dict[str, Any] | None:
        """The arguments of a Volume of density 1 in it, of this mean free path.

        None, and a note, where it encloses nothing.
        """
        if self.kind in ("cube", "sphere"):
            shape = "sphere" if self.kind == "sphere" else "box"
            return {
                "shape": shape,
                "bounds": self.extent,
                "world_from_volume": self.world_from_shape,
            }
        found = self.body.density(free_path_m)
        if found is None:
            source.note(f"{self.node} encloses nothing: its medium is left out")
            return None
        return {"density": found[0], "bounds": found[1], "body": self.body}


def region_of(shape: Node, source: Source) -> Region:
    """What a shape bounds. Raises SceneError for a shape that is not read."""
    parts = tuple(shape_geometries(shape, source))
    if not parts:
        raise SceneError(f"{shape} holds a medium, but is not read", where=source.path)
    matrix = shape_matrix(shape)
    # Shapes that volumes of ours have.
    if shape.kind == "cube":
        return Region(shape, "cube", matrix, UNIT, parts)
    if shape.kind == "sphere":
        radius = float(shape.get("radius", 1.0))
        c = np.array(shape.get("center", (0.0, 0.0, 0.0)))
        return Region(shape, "sphere", matrix, (triple(c - radius), triple(c + radius)), parts)
    return _mesh_region(shape, parts)


def _mesh_region(shape: Node, parts: tuple[Placed, ...]) -> Region:
    points = [
        part.geometry.positions @ part.world_from_object[:3, :3].T + part.world_from_object[:3, 3]
        for part in parts
    ]
    low = np.min([at.min(axis=0) for at in points], axis=0)
    high = np.max([at.max(axis=0) for at in points], axis=0)
    return Region(shape, "mesh", np.eye(4), (triple(low), triple(high)), parts)


def joined(regions: Sequence[Region], source: Source) -> list[tuple[int, Region]]:
    """The regions of one medium, each with the index of its first: those of open meshes that close
    a body together are one. A note tells of those that stay open."""
    is_open = [region.kind == "mesh" and region.body.holes > 0 for region in regions]
    members = [index for index, it_is in enumerate(is_open) if it_is]
    # Files often have a body's sides as meshes of their own, which bound a medium together.
    if len(members) > 1:
        parts = tuple(part for index in members for part in regions[index].parts)
        whole = _mesh_region(regions[members[0]].node, parts)
        if whole.body.holes == 0:
            rest = [(index, region) for index, region in enumerate(regions) if not is_open[index]]
            return [*rest, (members[0], whole)]
    # Those that leave a hole even so are closed by lids.
    for index in members:
        source.note(
            f"{regions[index].node}: it is open, and its medium ends at lids across its holes "
            f"({regions[index].body.holes})"
        )
    return list(enumerate(regions))


def shares_of_grid(
    region: Region, size: tuple[int, ...], bounds: Bounds, world_from_grid: F64
) -> tuple[F32 | None, int]:
    """How much of each voxel of a grid lies in the region: (z, y, x), and how many times as many
    voxels along each side that has as `size`. None, and 1, where all of the grid does.
    """
    low, high = (np.array(corner) for corner in bounds)
    # A cube around the grid, as it mostly is, bounds nothing of it.
    if region.kind == "cube":
        corners = box_corners(low, high)
        cube = np.linalg.inv(region.world_from_shape) @ world_from_grid
        if np.abs(placed_points(corners, cube)).max() <= 1.0 + _HAIR:
            return None, 1
    times = max(1, FEWEST // max(size))
    nz, ny, nx = (times * n for n in size)
    at = np.asarray(np.linalg.inv(world_from_grid), np.float64)
    shares = region.body.shares(low, high, (nx, ny, nz), at)
    if shares.min() == 1.0:
        return None, 1
    return np.asarray(shares, np.float32), times


def finer(values: F64 | F32, times: int) -> F32:
    """A grid (z, y, x, ...) with so many voxels for each along each side, linear between them."""
    found = np.asarray(values, np.float32)
    for axis in range(3 if times > 1 else 0):
        count = found.shape[axis]
        at = np.clip((np.arange(count * times) + 0.5) / times - 0.5, 0.0, count - 1.0)
        low = np.minimum(at.astype(np.int64), max(count - 2, 0))
        part = (at - low).astype(np.float32).reshape(-1, *(1,) * (found.ndim - axis - 1))
        below, above = (found.take(np.minimum(low + k, count - 1), axis) for k in (0, 1))
        found = below * (1 - part) + above * part
    return found
