"""A plume of smoke rising from a bowl, animated."""

from __future__ import annotations

from dataclasses import replace
from functools import partial

import numpy as np
from numpy.typing import NDArray

from ..animation import Animation
from ..animation.density import MadeDensity, VolumeTrack
from ..camera import Camera
from ..checks import F32, Bounds, Rgb, Vec3, number
from ..lights import DirectionalLight
from ..material import Material
from ..mesh import Mesh
from ..scene import Scene
from ..volume import Volume
from . import stone
from .eddies import Eddies, cell_centres
from .noise import smoothstep
from .patch import Finish
from .profile import arc, profile, revolved
from .sky import clear_sky
from .solids import box

SHAPE = (64, 128, 64)
"""Cells of the density grid, (z, y, x)."""
_TRACED = (48, 96, 48)
"""Cells that are followed back through the eddies; the paths of those of the grid lie between."""

BOUNDS: Bounds = ((-1.2, 0.40, -1.2), (1.2, 5.2, 1.2))

RISE_M_S = 0.9
SOURCE_RADIUS_M = 0.16
SPREAD = 0.13
"""Growth of the plume's mean radius per metre of height: entrainment."""

SUN_TRAVEL: Vec3 = (-0.62, -0.60, 0.35)

_EDDIES = Eddies(box_m=(2.4, 4.8, 2.4), cells=(96, 192, 96), largest=(4, 8, 4))
_TRACE_STEPS = 14


def smoke(*, time: float = 0.0, seed: int = 11) -> Scene:
    """Smoke from a bowl before a shaded wall, sun behind it; it rises with time, seconds.

    `time` is when it is shown; `scene.at` moves it on from there or anywhere.
    One grid of 64 x 128 x 64 over 2.4 x 4.8 x 2.4 m; extinction 8 per metre at density 1,
    albedo 0.95, g 0.6. Raises SceneError for a time that is not a number.
    """
    density = plume_density(number(time, "time"), seed)
    volume = Volume(
        sigma_t=(8.0, 8.0, 8.0),
        density=density,
        bounds=BOUNDS,
        albedo=(0.95, 0.95, 0.95),
        g=(0.6, 0.6, 0.6),
        source="builtin smoke",
    )
    return Scene(
        name="smoke",
        meshes=(*court(seed), *_bowl()),
        lights=(DirectionalLight(SUN_TRAVEL, (30.0, 27.0, 22.0)),),
        environment=clear_sky(SUN_TRAVEL),
        camera=Camera((0.6, 2.0, 7.2), (0.0, 2.45, 0.0), fov_y_deg=45.0, exposure_stops=-1.6),
        volumes=(volume,),
        animation=Animation((VolumeTrack(0, MadeDensity(partial(plume_density, seed=seed))),)),
    )


def plume_density(time: float, seed: int) -> F32:
    """Density (z, y, x) in [0, 1] of the plume at `time` in seconds.

    Eddies ride upwards with the mean flow, frozen in its frame (Taylor's hypothesis), and grow
    stronger with the plume's width. Each cell's air is followed back through them over its age,
    height / rise, to where it left the bowl; only what left through the bowl carries smoke,
    thinned by the clear air that the widening plume has taken in.
    """
    eddies, texture = _EDDIES.fields(seed)
    # In the frame that rises with the plume, sideways drift keeps the eddies from recurring.
    ride = np.array([0.11, RISE_M_S, -0.07], np.float32) * np.float32(time)
    moved = _finer(_carried(eddies, ride))
    # Cells near the plume, and where their air had left the bowl.
    points = cell_centres(BOUNDS, SHAPE)
    height, radius, smoky = _plume(points, 2.9)
    points, height, radius = points[smoky], height[smoky], radius[smoky]
    start = points - moved.reshape(-1, 3)[smoky]
    rho = (np.hypot(start[:, 0], start[:, 2]) / radius).astype(np.float32)
    # The noise is looked up only where there may be smoke.
    inside = rho < 1.10 - 0.14 * texture.min()
    points, height, radius, rho = points[inside], height[inside], radius[inside], rho[inside]
    puff = _EDDIES.between(texture, start[inside] - ride)
    # Smoke from within the bowl, thinned by the air that was taken in, ragged by the noise.
    density = smoothstep(1.10, 0.40, rho + 0.14 * puff)
    density *= (SOURCE_RADIUS_M / radius) ** 0.9 * (1.0 + 0.35 * puff)
    # It begins at the bowl and fades out before the grid's top and sides.
    density *= smoothstep(0.0, 0.10, height) * smoothstep(4.8, 3.9, height)
    density *= smoothstep(0.05, 0.30, np.float32(BOUNDS[1][0]) - np.abs(points[:, ::2]).max(axis=1))
    grid = np.zeros(int(np.prod(SHAPE)), np.float32)
    grid[np.flatnonzero(smoky)[inside]] = np.clip(density, 0.0, 1.0)
    return _diffused(grid.reshape(SHAPE))


def _plume(points: F32, radii: float) -> tuple[F32, F32, NDArray[np.bool_]]:
    """Heights above the bowl and the mean plume's radii there, m; who is within so many of them."""
    height = np.maximum(points[:, 1] - np.float32(BOUNDS[0][1]), 0.0)
    radius = np.float32(SOURCE_RADIUS_M) + np.float32(SPREAD) * height
    return height, radius, np.hypot(points[:, 0], points[:, 2]) < radii * radius


def _carried(eddies: F32, ride: F32) -> F32:
    """How far (z, y, x, 3), m, eddies have carried the air of each traced cell."""
    points = cell_centres(BOUNDS, _TRACED)
    height, _, smoky = _plume(points, 3.2)
    begin, height = points[smoky] - ride, height[smoky]
    # Eddies grow stronger with height, up to 1.5 m.
    here, step_s = begin, (height / (RISE_M_S * _TRACE_STEPS)).astype(np.float32)
    speed = 0.10 + 0.13 * np.minimum(height / 1.5, 1.0)
    # Steps of equal time, back along the eddies; the mean rise is in the frame already.
    for _ in range(_TRACE_STEPS):
        here = here - _EDDIES.look_up(eddies, here) * (speed * step_s)[:, None]
    # What the cells have moved, 0 away from the plume.
    carried = np.zeros_like(points)
    carried[smoky] = begin - here
    return carried.reshape(*_TRACED, 3)


def _finer(carried: F32) -> F32:
    """The same at the cells of the grid, by cubics without kinks (Catmull1974)."""
    for fine, coarse in zip(SHAPE, _TRACED, strict=True):
        # Where each fine cell lies among the coarse ones, and the four of them that it mixes.
        at = (np.arange(fine) + 0.5) * coarse / fine - 0.5
        cell = np.floor(at).astype(np.intp)
        t = at - cell
        # Catmull-Rom's weights, twice as large.
        basis = (
            t * (t * (2.0 - t) - 1.0),
            t * t * (3.0 * t - 5.0) + 2.0,
            t * (t * (4.0 - 3.0 * t) + 1.0),
            t * t * (t - 1.0),
        )
        # At the border the last cell stands for those beyond it.
        weights = np.zeros((fine, coarse), np.float32)
        for k, weight in enumerate(basis):
            near = np.clip(cell + k - 1, 0, coarse - 1)
            np.add.at(weights, (np.arange(fine), near), 0.5 * weight)
        carried = np.moveaxis(np.tensordot(weights, carried, (1, 0)), 0, 2)
    return np.ascontiguousarray(carried)


def _diffused(density: F32) -> F32:
    """Mixed with its neighbours by (1 2 1)/4 on each axis: what eddies below a cell do."""
    for axis in range(3):
        wide = np.pad(density, [(1, 1) if k == axis else (0, 0) for k in range(3)])
        before, after = (np.take(wide, range(s, s + SHAPE[axis]), axis) for s in (0, 2))
        density = (before + 2.0 * density + after) / np.float32(4.0)
    return density


def court(seed: int) -> tuple[Mesh, ...]:
    """A floor, and a wall whose shaded side is the dark ground one sees lit smoke against."""
    rng = np.random.default_rng(seed)
    slab = box((-7.0, -0.2, -4.0), (7.0, 0.0, 8.0))
    wall = box((-7.0, 0.0, -3.6), (7.0, 5.2, -3.2))
    blocks = stone.limestone_blocks(rng, size_px=512)
    # The wall is darkened by a factor, with the stone's own image.
    sooty = replace(blocks, material=replace(blocks.material, base_color=(0.3, 0.3, 0.3)))
    return (
        *stone.paving(rng, size_px=512).meshes(slab, "floor"),
        *sooty.meshes(wall, "wall"),
    )


def _bowl() -> tuple[Mesh, ...]:
    # Outside from the foot upwards, over the rim, and the inside of the bowl.
    shape = [(0.0, 0.0), (0.20, 0.0), (0.18, 0.05), (0.07, 0.10), (0.06, 0.22), (0.16, 0.28)]
    shape += [(0.24, 0.38), *arc((0.225, 0.405), 0.02, -20.0, 180.0, 6), (0.14, 0.32), (0.0, 0.30)]
    color: Rgb = (0.35, 0.20, 0.10)
    bronze = Material(name="bronze", base_color=color, roughness=0.45, metallic=1.0)
    geometry = revolved(profile(shape), 40)
    return Finish(bronze).meshes(geometry, "bowl")
