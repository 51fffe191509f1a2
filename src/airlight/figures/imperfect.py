"""Indirect light by imperfect shadow maps (Ritschel2008), which Kaplanyan2010 Fig. 6 stands beside.

A view from the light, a reflective shadow map, is sampled for virtual lights; each sees a few
points of all surfaces in a small map of its hemisphere, whose holes are filled; pixels add up the
lights whose maps see them. In NumPy, to be looked at: its time says nothing.
"""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass
from typing import cast

import numpy as np
from numpy.typing import NDArray

from ..lattice.surfels import surfels, triangle_areas
from ..maths.colour import luminance
from ..scene.camera import Camera
from ..scene.checks import F32, F64, Vec3
from ..scene.image import Image
from ..scene.lights import DirectionalLight, Light
from ..scene.scene import Scene
from .cascades import surface_points
from .panels import Request, renderer

LIGHTS = 256
"""Virtual lights, as many as the paper's."""
POINTS = 8192
"""Points of all surfaces that each of them sees."""
MAP_PX = 128
_VIEW_PX = 256
_POOL = 1 << 17  # points, from which each light takes others
_SUN_FOV_DEG = 1.0  # of a directional light's view, from far away


@dataclass(frozen=True)
class VirtualLights:
    """Positions and normals (N, 3), power (N, 3) in W, and area (N,), m^2, each stands for."""

    position: F64
    normal: F64
    power: F64
    area: F64


def indirect_of(request: Request, scene: Scene) -> F32:
    """One bounce (H, W, 3), W m^-2 sr^-1, of a scene with directional and spot lights alone.

    Raises SettingsError, DeviceError.
    """
    # Virtual lights where the lights' views see surfaces, and the pixels that they light.
    rng = np.random.default_rng(1)
    lights = virtual_lights(request, scene, rng)
    image = _seen(request, scene)
    points = surface_points(scene.camera, image.layers["depth"]).reshape(-1, 3)  # 1e6 m: nothing
    normals = image.layers["normal"].reshape(-1, 3)

    # Points of all surfaces, of which each light takes its own.
    pool, apart_m = _surface_samples(scene)
    irradiance = np.zeros((len(points), 3))
    for k in range(len(lights.power)):
        # What the light sees in its hemisphere, by a few points.
        frame = _frame(lights.normal[k])
        some = pool[rng.integers(0, len(pool), POINTS)]
        seen = depth_map((some - lights.position[k]) @ frame.T)

        # Pixels relative to the light, and both cosines.
        from_light = points - lights.position[k]
        away = from_light @ frame.T
        square = np.maximum(np.sum(away**2, axis=1), 1e-12)
        facing = np.maximum(-np.sum(from_light * normals, axis=1), 0.0)
        cosines = facing * np.maximum(away[:, 2], 0.0) / square
        # The disc that a virtual light stands for: no singularity where a pixel is near it.
        share = cosines / (np.pi * square + lights.area[k])
        share[~is_lit(seen, away, 0.5 * apart_m)] = 0.0
        irradiance += share[:, None] * lights.power[k]
    albedo = image.layers["albedo"]
    return np.asarray(albedo * irradiance.reshape(albedo.shape) / np.pi, np.float32)


def virtual_lights(request: Request, scene: Scene, rng: np.random.Generator) -> VirtualLights:
    """LIGHTS texels of the lights' views, chosen by the power that they reflect."""
    found: list[tuple[F64, ...]] = []
    for light in scene.lights:
        # A view from the light, without all other light.
        camera = _view_of(light, scene)
        alone = dataclasses.replace(scene, lights=(light,), environment=None, camera=camera)
        image = _seen(dataclasses.replace(request, size=(_VIEW_PX, _VIEW_PX)), alone)
        depth, normal = (image.layers[name] for name in ("depth", "normal"))

        # Where its texels see surfaces, and along which rays.
        where = surface_points(camera, np.where(np.isfinite(depth), depth, 1.0).astype(np.float32))
        rays = where - np.array(camera.position)
        rays /= np.linalg.norm(rays, axis=-1, keepdims=True)
        # A texel's solid angle and the slope of what it sees are the area that it stands for.
        ahead = rays @ rays[_VIEW_PX // 2, _VIEW_PX // 2]
        angle = (2.0 * np.tan(0.5 * np.radians(camera.fov_y_deg)) / _VIEW_PX) ** 2 * ahead**3
        slope = np.maximum(-np.sum(rays * normal, axis=-1), 0.02)
        area = np.where(np.isfinite(depth), depth, 0.0) ** 2 * angle / slope

        # What the texel's surface reflects, its power in W.
        power = np.pi * image.layers["direct"] * area[..., None]
        parts = (where, normal, power, area)
        found.append(tuple(np.asarray(a, np.float64).reshape(area.size, -1) for a in parts))
    where, normal, power, area = (np.concatenate(each) for each in zip(*found, strict=True))
    flux = luminance(power.astype(np.float32)).astype(np.float64)
    # As many as there are lights, evenly along the sum of all power.
    at = (np.arange(LIGHTS) + rng.random(LIGHTS)) / LIGHTS * flux.sum()
    chosen = np.minimum(np.searchsorted(np.cumsum(flux), at), len(flux) - 1)

    # Each carries an equal part of all power, in its texel's colour.
    each = flux.sum() / LIGHTS / np.maximum(flux[chosen], 1e-30)
    scaled = (power[chosen] * each[:, None], area[chosen, 0] * each)
    return VirtualLights(where[chosen], normal[chosen], *scaled)


def depth_map(points: F64) -> F64:
    """(MAP_PX, MAP_PX): how far the nearest of `points` (N, 3) is in each direction with z > 0.

    A paraboloid's projection; where no point lies, what coarser levels of the map say.
    """
    # The nearest point in each texel that has one.
    points = points[points[:, 2] > 0.0]
    column, row = _texels(points)
    nearest = np.full((MAP_PX, MAP_PX), np.inf)
    np.minimum.at(nearest, (row, column), np.linalg.norm(points, axis=1))
    # Pull: each level has the mean of what its four texels know; push: holes take it.
    levels = [nearest]
    while len(levels[-1]) > 1:
        side = len(levels[-1]) // 2
        four = levels[-1].reshape(side, 2, side, 2)
        known = np.isfinite(four)
        count = known.sum(axis=(1, 3))
        total = np.where(known, four, 0.0).sum(axis=(1, 3))
        levels.append(np.where(count > 0, total / np.maximum(count, 1), np.inf))
    filled = levels.pop()
    for level in reversed(levels):
        filled = np.where(np.isfinite(level), level, filled.repeat(2, axis=0).repeat(2, axis=1))
    return filled


def is_lit(seen: F64, away: F64, bias_m: float) -> NDArray[np.bool_]:
    """(N,) bool: whether points `away` (N, 3) of a light lie no farther than its map has seen."""
    # Nearer than the map's depth, but for how far apart its points are.
    column, row = _texels(away)
    return np.asarray(
        (away[:, 2] > 0.0) & (np.linalg.norm(away, axis=1) <= seen[row, column] + bias_m)
    )


def _texels(away: F64) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
    """Columns and rows of directions in a paraboloid's map."""
    # A paraboloid maps a hemisphere to the unit disc.
    length = np.linalg.norm(away, axis=1)
    on_disc = away[:, :2] / np.maximum(length + np.abs(away[:, 2]), 1e-30)[:, None]
    texel = ((0.5 * on_disc + 0.5) * MAP_PX).astype(np.intp).clip(0, MAP_PX - 1)
    return texel[:, 0], texel[:, 1]


def _seen(request: Request, scene: Scene) -> Image:
    """One sample a pixel: depths of two surfaces make no third between them."""
    with renderer(request, scene, {}, technique="direct") as made:
        image = made.frame()
    assert image is not None
    return image


def _view_of(light: Light, scene: Scene) -> Camera:
    """What a light lights: a spot's cone, or all of the scene from far against its direction."""
    if not isinstance(light, DirectionalLight):
        assert light.cone is not None
        target = np.add(light.position, light.cone[0])
        return Camera(light.position, cast(Vec3, tuple(target)), fov_y_deg=2.0 * light.cone[1])

    # From so far that rays are nearly parallel, over the whole scene's sphere.
    low, high = (np.asarray(corner, np.float64) for corner in scene.bounds)
    middle, radius = 0.5 * (low + high), 0.5 * float(np.linalg.norm(high - low))
    far = radius / np.tan(np.radians(0.5 * _SUN_FOV_DEG))
    eye = middle - far * np.array(light.direction)
    return Camera(cast(Vec3, tuple(eye)), cast(Vec3, tuple(middle)), fov_y_deg=_SUN_FOV_DEG)


def _surface_samples(scene: Scene) -> tuple[F64, float]:
    """World points (N, 3) over all surfaces, and how far apart, m, POINTS of them would be."""
    # Surfels are in objects' space: to the world by their instances.
    made = surfels(scene.meshes, list(range(len(scene.meshes))), _POOL)
    matrices = np.stack([np.asarray(mesh.world_from_object) for mesh in scene.meshes])
    own = matrices[made["instance"]]
    world = np.einsum("nij,nj->ni", own[:, :3, :3], made["position"]) + own[:, :3, 3]
    area = sum(float(triangle_areas(mesh).sum()) for mesh in scene.meshes)
    return np.asarray(world, np.float64), float(np.sqrt(area / POINTS))


def _frame(normal: F64) -> F64:
    """(3, 3): rows are two tangents and the normal."""
    # Any axis that is not nearly along the normal.
    other = np.array([1.0, 0.0, 0.0]) if abs(normal[0]) < 0.5 else np.array([0.0, 1.0, 0.0])
    tangent = np.cross(normal, other)
    tangent /= np.linalg.norm(tangent)
    return np.stack([tangent, np.cross(normal, tangent), normal])
