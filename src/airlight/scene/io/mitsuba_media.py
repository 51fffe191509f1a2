"""Mitsuba's media, and the shapes that hold them, as a medium and volumes.

Where media nest, Mitsuba's inner one stands alone and airlight's adds to the outer one: the
outer medium is taken off the inner coefficients.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from ...maths.transforms import triple
from ..checks import F32, F64, Bounds
from ..coefficients import scale_density_tint
from ..medium import Medium
from ..volume import Volume
from .mitsuba_bodies import Region, finer, joined, region_of, shares_of_grid
from .mitsuba_coefficients import (
    GRID,
    extinction,
    mean_cosine_of,
    phase_of,
    scattering_albedo,
)
from .mitsuba_nodes import Node
from .mitsuba_textures import Source


@dataclass(frozen=True, eq=False)
class Held:
    """A medium and where it is.

    `sigma_t` (3,) for a homogeneous one, else (z, y, x, 3) with its box and placement; then
    `albedo` and `g` may be grids of the same shape.
    """

    node: Node
    exterior: Node | None
    region: Region
    sigma_t: F64 | F32
    albedo: F64
    g: float | F32
    grid_bounds: Bounds = GRID
    world_from_grid: F64 | None = None

    @property
    def is_homogeneous(self) -> bool:
        """Whether its extinction is one triple, not a grid."""
        return self.sigma_t.ndim == 1


def held_medium(shape: Node, interior: Node, exterior: Node | None, source: Source) -> Held:
    """What the medium `interior` of a shape is, and where."""
    sigma_t, grid, world_from_grid = extinction(interior, source)
    return Held(
        interior,
        exterior,
        region_of(shape, source),
        sigma_t,
        scattering_albedo(interior, source, sigma_t.shape),
        phase_of(interior.first("phase"), source, sigma_t.shape, is_alone=exterior is None),
        grid,
        world_from_grid,
    )


def medium_and_volumes(
    held: list[Held], around_camera: Node | None, source: Source
) -> tuple[Medium | None, tuple[Volume, ...]]:
    """The scene's one homogeneous medium, and everything else as volumes."""
    held = _joined(held, source)
    air = _largest_box(held)
    medium: Medium | None = None
    if air is not None:
        low, high = (tuple(float(x) for x in corner) for corner in air.region.box or ())
        sigma_t, albedo, g = triple(air.sigma_t), triple(air.albedo), (air.g,) * 3
        medium = Medium(sigma_t, albedo, g, (low, high))  # type: ignore[arg-type]
    elif around_camera is not None and not any(h.node.id == around_camera.id for h in held):
        medium = _endless(around_camera, source)
    volumes = [_volume(h, air, source) for h in held if h is not air]
    return medium, tuple(v for v in volumes if v is not None)


def _largest_box(held: list[Held]) -> Held | None:
    boxes = [(h, h.region.box) for h in held if h.is_homogeneous]
    sizes = [(float(np.prod(box[1] - box[0])), h) for h, box in boxes if box is not None]
    return max(sizes, key=lambda entry: entry[0])[1] if sizes else None


def _endless(node: Node, source: Source) -> Medium | None:
    """The medium around the camera that no shape bounds: it fills the scene."""
    sigma_t, _, _ = extinction(node, source)
    if sigma_t.ndim != 1:
        source.note(f"{node}: a grid around the camera that no shape bounds is left out")
        return None
    g = mean_cosine_of(node.first("phase"), source)
    return Medium(triple(sigma_t), triple(scattering_albedo(node, source)), (g,) * 3)


def _volume(held: Held, air: Held | None, source: Source) -> Volume | None:
    sigma_t, albedo, g = _without_medium(held, air, source)
    if float(sigma_t.max()) <= 0.0:
        return None
    # One density everywhere, in a box, a sphere or what a mesh encloses.
    if held.is_homogeneous:
        assert isinstance(g, float)  # only a grid's phase functions are mixed by voxel
        filled = held.region.filled(1.0 / float(sigma_t.max()), source)
        if filled is None:
            return None
        return Volume(sigma_t=triple(sigma_t), albedo=triple(albedo), g=(g,) * 3, **filled)
    # A grid that its shape cuts: more voxels where those are coarse, with what is inside of each.
    at = np.eye(4) if held.world_from_grid is None else held.world_from_grid
    shares, times = shares_of_grid(held.region, sigma_t.shape[:3], held.grid_bounds, at)
    if shares is not None:
        sigma_t = finer(sigma_t, times) * shares[..., None]
        albedo = albedo if albedo.ndim < 4 else finer(albedo, times).astype(np.float64)
        if not isinstance(g, float):
            g = finer(g, times)
        if float(sigma_t.max()) <= 0.0:
            return None
    # A grid: its densities, and the coefficients of density 1.
    top, density, tint = scale_density_tint(np.asarray(sigma_t, dtype=np.float32))
    is_one_albedo = albedo.ndim < 4
    return Volume(
        sigma_t=top,
        density=density,
        tint=tint,
        albedo=triple(albedo) if is_one_albedo else (1.0, 1.0, 1.0),
        albedo_grid=None if is_one_albedo else np.asarray(albedo, np.float32),
        g=(g,) * 3 if isinstance(g, float) else (0.0, 0.0, 0.0),
        g_grid=None if isinstance(g, float) else g,
        bounds=held.grid_bounds,
        world_from_volume=at,
    )


def _without_medium(
    held: Held, air: Held | None, source: Source
) -> tuple[F64 | F32, F64, float | F32]:
    """Coefficients less those of the medium around, where the shape lies in it."""
    if air is None or held.exterior is None or held.exterior.id != air.node.id:
        if air is not None and _lies_inside(held, air):
            source.note(f"{held.node} lies in the medium of the scene, whose extinction it adds to")
        return held.sigma_t, held.albedo, held.g
    # The medium around is in the file's coefficients; the rest is the volume's own.
    inner, outer = (np.asarray(h.sigma_t, dtype=np.float64) for h in (held, air))
    rest: F64 = inner - outer
    if rest.min() < -1e-4 * float(outer.max()):
        source.note(f"{held.node} is thinner than the medium around it, which cannot be said")
    sigma_t: F64 = np.maximum(rest, 0.0)
    # The albedo follows from the scattering of that rest, per voxel where it varies.
    scattered = inner * held.albedo - outer * air.albedo
    parts = (scattered, sigma_t)
    if held.albedo.ndim < 4:
        parts = tuple(part.reshape(-1, 3).sum(axis=0) for part in parts)
    albedo = np.clip(parts[0] / np.maximum(parts[1], 1e-30), 0.0, 1.0)
    if held.g != air.g:
        source.note(f"{held.node}: its g is taken as its own, the mix with the medium is left out")
    return sigma_t, albedo, held.g


def _lies_inside(held: Held, air: Held) -> bool:
    box, middle = air.region.box, held.region.middle
    return box is not None and bool((middle > box[0]).all() and (middle < box[1]).all())


def _joined(held: list[Held], source: Source) -> list[Held]:
    """The same, where open shapes that hold one medium close a body together as one."""
    groups: dict[int, list[Held]] = {}
    for one in held:
        groups.setdefault(id(one.node.children), []).append(one)
    found = []
    for group in groups.values():
        regions = joined([one.region for one in group], source)
        found += [replace(group[index], region=region) for index, region in regions]
    return found
