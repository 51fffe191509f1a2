"""The grid of a medium: where it lies in the world, and its parameters in shaders."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from ...gpu.layout import Struct, f32, mat4x4f, u32, vec3f, vec3u
from ...maths.diffusion import largest_diffusivity
from ...maths.transforms import F64
from ...scene.volume import Volume

FINE = 2  # fine cells per cell and axis; paths sample the density of fine cells
SPHERE_SIDE = 64  # voxels across a sphere
THICKEST_CELL = 4.0  # optical depth of a cell; a thicker one is opaque, and its middle dark
PARTIAL_SUM_GROUP = 256  # cells of a workgroup that leaves one partial sum of a dot product
_STRETCH = 4  # a side has at most this many times the cells of a cube's
_PROBED = 32  # density samples per axis that estimate the width of the medium


class MediumParams(Struct):
    """One medium and its grid; lengths in m, coefficients at density 1."""

    world_from_medium = mat4x4f("its frame to the world's, rigid")
    unit_from_medium = mat4x4f("its frame to the volume's 0..1")
    extent = vec3f("m")
    ordinate_count = u32()
    cell = vec3f("m")
    groups = u32("workgroups that leave a partial sum each, see PARTIAL_SUM_GROUP")
    count = vec3u("cells")
    cells = u32()
    sigma_t = vec3f("m^-1")
    largest_diffusivity = f32("m")
    albedo = vec3f()
    g = vec3f("mean cosine")
    mean_density = f32("over the medium's mass")
    samples = vec3u("density samples per fine cell along each axis")
    surrounding_from_medium = mat4x4f("to 0..1 in a box of another medium around it")
    surrounding_sigma_t = vec3f("m^-1, of that; 0: there is none")


@dataclass(frozen=True, eq=False)
class MediumPlacement:
    """A box of cells around a volume. Its frame has the corner at 0 and axes of unit length, m.

    `world_from_medium` (4, 4) is rigid (it may mirror); `unit_from_medium` (4, 4) leads to the
    voxels of the volume, 0..1. `extent` (3,), m; `count`: cells along x, y, z.
    """

    world_from_medium: F64
    unit_from_medium: F64
    extent: F64
    count: tuple[int, int, int]

    @property
    def cell(self) -> F64:
        """Size of a cell (3,), m; nearly a cube."""
        return np.asarray(self.extent / np.array(self.count))

    @property
    def cells(self) -> int:
        """How many cells there are."""
        return self.count[0] * self.count[1] * self.count[2]

    @property
    def fine_count(self) -> tuple[int, int, int]:
        """Fine cells along x, y, z, whose density paths sample."""
        x, y, z = self.count
        return FINE * x, FINE * y, FINE * z

    @property
    def uvw_from_world(self) -> F64:
        """(4, 4): the world to 0..1 in the box."""
        scale = np.diag([*(1.0 / self.extent), 1.0])
        return np.asarray(scale @ np.linalg.inv(self.world_from_medium))

    def direction(self, world: F64) -> F64:
        """Directions (..., 3) of the world in the medium's frame."""
        return np.asarray(world @ self.world_from_medium[:3, :3])

    def point(self, world: F64) -> F64:
        """Points (..., 3), m, of the world in the medium's frame."""
        return np.asarray((world - self.world_from_medium[:3, 3]) @ self.world_from_medium[:3, :3])


def placed(volume: Volume, resolution: int) -> MediumPlacement:
    """A grid of about `resolution`^3 cells over the box of a volume, whatever its sides."""
    low, high = np.asarray(volume.bounds, dtype=np.float64)
    world_from_unit = np.asarray(volume.world_from_volume) @ _scaled(high - low, low)
    # Axes along its sides, in metres: shear is left to the lookup of its density.
    rotation, low_corner, extent = _frame(world_from_unit)
    world_from_medium = np.eye(4)
    world_from_medium[:3, :3] = rotation
    world_from_medium[:3, 3] = rotation @ low_corner
    # Cells are about cubes, as many as a cube of `resolution` cells has; long sides have more.
    cell = float(np.cbrt(np.prod(extent))) / resolution
    count = np.clip(np.round(extent / cell), 2, _STRETCH * resolution).astype(int)
    return MediumPlacement(
        world_from_medium,
        np.linalg.inv(world_from_unit) @ world_from_medium,
        extent,
        (int(count[0]), int(count[1]), int(count[2])),
    )


def _frame(world_from_unit: F64) -> tuple[F64, F64, F64]:
    """(rotation, lower corner in it, extent) of a box around the image of the unit cube.

    The axes follow its edges where those are at right angles, else the nearest rotation.
    """
    edges = world_from_unit[:3, :3]
    length = np.maximum(np.linalg.norm(edges, axis=0), 1e-12)
    unit = edges / length
    # Sheared edges: the nearest rotation (polar decomposition).
    if np.abs(unit.T @ unit - np.eye(3)).max() > 1e-6:
        left, _, right = np.linalg.svd(edges)
        unit = left @ right
    # The box in that frame around all eight corners.
    corners = np.stack(np.meshgrid(*[[0.0, 1.0]] * 3), axis=-1).reshape(8, 3)
    local = (corners @ edges.T + world_from_unit[:3, 3]) @ unit
    low, high = local.min(axis=0), local.max(axis=0)
    return unit, low, np.maximum(high - low, 1e-9)


def _scaled(size: F64, low: F64) -> F64:
    matrix = np.diag([*np.maximum(size, 1e-12), 1.0])
    matrix[:3, 3] = low
    return matrix


@dataclass(frozen=True)
class Width:
    """How wide the medium of a volume is, estimated from a few samples of its density.

    `diffusivity`, m: the largest possible, a third of the radius; see `maths.diffusion`.
    `density`: the mean density, weighted by mass. `mass`: the plain mean density.
    """

    diffusivity: float
    density: float
    mass: float = 1.0


def medium_width(volume: Volume, placement: MediumPlacement) -> Width:
    """The width of the medium in the box of a volume."""
    probed = probed_density(volume)
    cell = placement.extent / np.array(probed.shape[::-1])
    # Weighted by itself: empty voxels say nothing of the medium.
    mean = float((probed**2).sum() / max(float(probed.sum()), 1e-30))
    return Width(largest_diffusivity(probed, cell), mean, float(probed.mean()))


def probed_density(volume: Volume) -> F64:
    """A few samples (z, y, x) of its density, as far apart along each axis of its box."""
    density = shape_density(volume, _PROBED)
    steps = tuple(slice(None, None, -(-n // _PROBED)) for n in density.shape)
    return np.asarray(density[steps], np.float64)


def shape_density(volume: Volume, side: int) -> Any:
    """The density grid (z, y, x) of any volume; 1 inside a shape, with an anti-aliased rim."""
    if volume.density is not None:
        return volume.density
    if volume.shape == "box":
        return np.ones((2, 2, 2), np.float32)
    # A sphere: each voxel is the mean of eight samples.
    at = (np.arange(2 * side) + 0.5) / side - 1.0
    radius2 = at[:, None, None] ** 2 + at[None, :, None] ** 2 + at[None, None, :] ** 2
    inside = (radius2 <= 1.0).astype(np.float32)
    return inside.reshape(side, 2, side, 2, side, 2).mean(axis=(1, 3, 5))


def placed_parts(parts: Sequence[Volume], resolution: int) -> list[PlacedVolume]:
    """The parts of one volume on its grid; they are as wide as all of them together."""
    made = [PlacedVolume.of(part, resolution) for part in parts]
    if len(made) == 1:
        return made
    # Light leaves all parts together, so their extinctions add up to one density.
    sums = np.zeros(shape_density(parts[0], SPHERE_SIDE).shape, np.float32)
    for part in parts:
        sums += np.float32(np.mean(part.sigma_t)) * shape_density(part, SPHERE_SIDE)
    whole = medium_width(replace(parts[0], density=sums), made[0].placement)
    return [replace(p, width=replace(p.width, diffusivity=whole.diffusivity)) for p in made]


@dataclass(frozen=True, eq=False)
class PlacedVolume:
    """A volume, the grid that it is solved on, and the width of its medium."""

    volume: Volume
    placement: MediumPlacement
    width: Width

    @classmethod
    def of(cls, volume: Volume, resolution: int) -> PlacedVolume:
        """Place `volume` on a grid of about `resolution`^3 cells."""
        placement = placed(volume, resolution)
        return cls(volume, placement, medium_width(volume, placement))

    @property
    def extinction(self) -> tuple[float, ...]:
        """Extinction, m^-1 at density 1, limited so that a cell has an optical depth of at most 4.

        Hardly any light passes such a cell, but the middle of a thicker one receives none: a white
        block under a uniform sky of radiance 1 scatters 1.00 at a depth of 4 per cell, 1.3 at 8,
        2.3 at 20, nothing at 100. Eye rays are marched through the true extinction.
        """
        depth = self.width.density * float(self.placement.cell.mean())
        most = THICKEST_CELL / max(depth, 1e-30)
        return tuple(min(sigma, most) for sigma in self.volume.sigma_t)

    def fields(self, ordinates: int) -> dict[str, Any]:
        """The values of `MediumParams` by name, for passes over so many `ordinates`."""
        volume, placement, width = self.volume, self.placement, self.width
        voxels = np.array(shape_density(volume, SPHERE_SIDE).shape[::-1])
        # So many samples of the density along each side of a cell as it has voxels.
        per_cell = -(-voxels // np.array(placement.fine_count))
        return {
            "world_from_medium": placement.world_from_medium,
            "unit_from_medium": placement.unit_from_medium,
            "extent": placement.extent,
            "ordinate_count": ordinates,
            "cell": placement.cell,
            "count": placement.count,
            "cells": placement.cells,
            "sigma_t": self.extinction,
            "largest_diffusivity": width.diffusivity,
            "albedo": volume.albedo,
            "mean_density": width.density,
            "samples": np.clip(per_cell, 1, 16),
            "g": volume.g,
            "groups": -(-placement.cells // PARTIAL_SUM_GROUP),
            "surrounding_from_medium": np.eye(4),
            "surrounding_sigma_t": (0.0, 0.0, 0.0),
        }
