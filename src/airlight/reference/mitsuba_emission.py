"""What media emit, for Mitsuba: its media (3.9) emit nothing, so small glowing balls stand in them.

Every ball has the power of its part of the medium, and all of them the same: so many that emitter
sampling finds them evenly, so small that they hide 1 % of one another.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from xml.etree.ElementTree import Element

import numpy as np
from numpy.typing import NDArray

from ..scene.checks import F64
from ..scene.scene import Scene
from ..scene.volume import Volume
from .mitsuba_xml import add_number, add_rgb, add_xyz, plugin

BALLS = 400
"""Balls for all media together."""
MARK = "airlight_emission"
"""Begins the ids of balls."""
_COVERED = 0.02  # of the area that light comes from, by the balls' discs
_SAMPLES = 64  # points along each axis of a shape's box


@dataclass(frozen=True, eq=False)
class _Lights:
    """Points (n, 3), m; their power divided by 4 pi (n, 3), W sr^-1; sides (n, 3, 3) of voxels."""

    points: F64
    intensity: F64
    sides: F64


def is_lit(volume: Volume) -> bool:
    """Whether a volume emits anything at this time, so that balls stand for it."""
    if not volume.is_emissive or volume.emission is None:
        return False
    values = volume.density if volume.emission.values is None else volume.emission.values
    return values is None or float(values.max()) > 0.0


def emission_balls(scene: Scene, notes: list[str]) -> list[Element]:
    """The balls as shapes, and a note that there are some."""
    # Volumes that emit become points of light; the emission of [medium] gets a note.
    emissive = [v for v in scene.volumes if is_lit(v)]
    if scene.medium is not None and max(scene.medium.emission) > 0.0:
        notes.append("the emission of [medium] is left out: Mitsuba's media emit nothing")
    found = [_voxels(volume) for volume in emissive]
    if not found:
        return []
    notes.append(f"what volumes emit is written as {BALLS} glowing balls: Mitsuba's media emit not")
    points = np.concatenate([one.points for one in found])
    intensity = np.concatenate([one.intensity for one in found])
    # Equal powers, each at a random point of its share: systematic resampling.
    rng = np.random.default_rng(0)
    weight = intensity.mean(axis=1)
    order = np.lexsort(np.round(points, 1).T)
    running = np.cumsum(weight[order])
    at = (np.arange(BALLS) + rng.random(BALLS)) / BALLS * running[-1]
    edges = np.minimum(np.searchsorted(running, at), len(order) - 1)
    chosen = order[edges]
    sides = np.concatenate([one.sides for one in found])[chosen]
    places = points[chosen] + np.einsum("nij,nj->ni", sides, 0.8 * rng.random((BALLS, 3)) - 0.4)
    # A ball has its voxel's colour, and all have the whole's power; large enough not to be
    # missed, small enough not to hide one another.
    share = intensity[chosen] / weight[chosen, None] * (float(weight.sum()) / BALLS)
    radius = math.sqrt(_COVERED * _cross_section(points, weight) / (BALLS * math.pi))
    return [
        _ball(k, point, power, radius)
        for k, (point, power) in enumerate(zip(places, share, strict=True))
    ]


def _cross_section(points: F64, weight: F64) -> float:
    """m^2: the mean over three axes of what is seen of most of the light."""
    # Half axes of sqrt(3) standard deviations: half the width, were it a uniform box.
    mean = np.average(points, axis=0, weights=weight)
    spread = np.sqrt(np.average((points - mean) ** 2, axis=0, weights=weight))
    x, y, z = (max(float(s), 1e-4) for s in spread)
    return math.pi * (x * y + y * z + z * x)


def _ball(number: int, point: F64, intensity: F64, radius: float) -> Element:
    # A ball is black, or it would scatter the light of others.
    shape = plugin("shape", "sphere", id=f"{MARK}_{number}")
    add_xyz(shape, "point", "center", (float(point[0]), float(point[1]), float(point[2])))
    add_number(shape, "radius", radius)
    black = plugin("bsdf", "diffuse")
    add_rgb(black, "reflectance", (0.0, 0.0, 0.0))
    shape.append(black)
    emitter = plugin("emitter", "area")
    # A ball of radiance L has the intensity pi r^2 L.
    r, g, b = (float(c) / (math.pi * radius**2) for c in intensity)
    add_rgb(emitter, "radiance", (r, g, b))
    shape.append(emitter)
    return shape


def _voxels(volume: Volume) -> _Lights:
    """Every voxel as a point; shapes are sampled on a grid of their own."""
    # Density's own voxels, those of the emission, or samples of a shape without either.
    emission = volume.emission
    assert emission is not None
    values: NDArray[np.floating]
    if volume.density is None:
        shape: tuple[int, ...] = (_SAMPLES,) * 3
        values = np.ones((*shape, 1))
    else:
        values = volume.density[..., None] if emission.values is None else emission.values
        shape = values.shape[:3]
    # The middles of voxels in the unit box, and their colours; a ball's corners are dark.
    axes = [(np.arange(n) + 0.5) / n for n in shape]
    z, y, x = np.meshgrid(*axes, indexing="ij")
    unit = np.stack([x, y, z], axis=-1).reshape(-1, 3)
    colours = values.reshape(-1, values.shape[3]).astype(np.float64)
    if volume.shape == "sphere":
        colours = np.where(((unit - 0.5) ** 2).sum(axis=1, keepdims=True) <= 0.25, colours, 0.0)
    # Each voxel's intensity by its size in the world, and where it stands there.
    low, high = np.array(volume.bounds)
    matrix = volume.world_from_volume
    size = float(np.prod(high - low)) * abs(float(np.linalg.det(matrix[:3, :3])))
    intensity = np.asarray(colours * np.array(emission.radiance) * (size / len(unit)))
    lit = intensity.max(axis=1) > 0.0
    points = (low + unit[lit] * (high - low)) @ matrix[:3, :3].T + matrix[:3, 3]
    sides = matrix[:3, :3] * ((high - low) / np.array(shape[::-1]))
    return _Lights(points, intensity[lit], np.broadcast_to(sides, (len(points), 3, 3)))
