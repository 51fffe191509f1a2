"""Palm-like plants: fronds cut out of an alpha mask, arching from a pot."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ..checks import F32, F64
from ..material import Material
from ..mesh import Geometry
from .images import Field, color_texture, normal_texture
from .noise import fractal_noise
from .patch import Finish, lattice_normals, merged, patch
from .profile import Points, arc, profile, revolved

FROND_CELLS = (2, 9)
"""Quads of one frond: across, along."""
_SIDE_PX = 512


def frond_finish(rng: np.random.Generator) -> Finish:
    """A pinnate frond, stalk at the image's bottom: leaflets beside a rib, alpha masked.

    uv of a frond are image coordinates, so its tile is 1.
    """
    at = (np.arange(_SIDE_PX, dtype=np.float32) + 0.5) / _SIDE_PX
    x = 2.0 * at[None, :] - 1.0
    along = 1.0 - at[:, None]
    side = np.abs(x)
    # Which leaflet a texel is in, how far that reaches, and how wide it is there.
    leaflet = (along - 0.16 * side) * 22.0 + 0.5 * (x > 0.0)
    number = np.floor(leaflet).astype(np.intp)
    jitter = rng.uniform(-0.06, 0.06, 64).astype(np.float32)
    reach = np.sin(np.pi * np.clip(0.06 + 0.94 * along, 0, 1)) ** 0.45 * 0.91 + jitter[number % 64]
    taper = np.clip(1.0 - (side / np.maximum(reach, 1e-3)) ** 2, 0.0, 1.0)
    half_width = 0.40 * np.sqrt(taper) * np.clip(0.55 + 2.0 * side, 0.0, 1.0)
    across = np.abs(leaflet % 1.0 - 0.5)
    # Coverage: signed distances to the edges in texels, so that they are smooth.
    blade = np.where(taper > 0.0, (half_width - across) * _SIDE_PX / 22.0, -1.0)
    rib = (0.030 * (1.1 - along) - side) * _SIDE_PX * 0.5
    stalk = along < 0.05
    alpha = np.clip(np.where(stalk, rib, np.maximum(blade, rib)) + 0.5, 0.0, 1.0)
    # The blade is lighter at its tip, the rib paler than the leaflets.
    grey, tint = _leaf_color(across, side, along, rib > 0.0, rng)
    height = 0.004 * np.clip(1.0 - 2.4 * across, 0, 1)
    material = Material(
        name="fronds",
        base_color=(1.0, 1.0, 1.0),
        base_color_texture=color_texture(grey, tint, "frond", alpha.astype(np.float32)),
        normal_texture=normal_texture(height.astype(np.float32), 0.35, "frond normals"),
        alpha_cutoff=0.5,
        roughness=0.5,
        two_sided=True,
    )
    return Finish(material, 1.0)


def _leaf_color(
    across: Field, side: Field, along: Field, is_rib: NDArray[np.bool_], rng: np.random.Generator
) -> tuple[F32, F32]:
    mottle = fractal_noise(across.shape, (8, 8), rng, octaves=4)
    grey = (1.0 + 0.08 * mottle) * (1.12 - 0.5 * across) * (0.82 + 0.25 * along)
    # Young parts, at the tips, are lighter; mottled between.
    young, old = np.array([0.16, 0.30, 0.055]), np.array([0.075, 0.19, 0.035])
    mix = np.clip(side + 0.15 * mottle, 0.0, 1.0)[..., None]
    tint = np.where(is_rib[..., None], (0.26, 0.34, 0.10), old + mix * (young - old))
    return grey.astype(np.float32), tint.astype(np.float32)


def fronds(rng: np.random.Generator, count: int = 34, length_m: float = 1.15) -> Geometry:
    """`count` fronds growing from the origin upwards and outwards, uv over the whole image."""
    across, along = FROND_CELLS
    s = np.linspace(-1.0, 1.0, across + 1)
    t = np.linspace(0.0, 1.0, along + 1)
    # Old fronds stand outside, longer and lower, turned by the golden angle.
    age = np.linspace(0.0, 1.0, count)
    azimuth = 2.399963 * np.arange(count) + rng.normal(0.0, 0.25, count)
    length = length_m * (0.75 + 0.45 * age * (1.3 - age)) * rng.uniform(0.85, 1.15, count)
    rise = np.radians(86.0 - 52.0 * age + rng.normal(0.0, 6.0, count))
    droop = np.radians(40.0 + 75.0 * age + rng.normal(0.0, 12.0, count))
    # Each spine bends down along its length; its blade is folded along the rib.
    elevation = rise[:, None] - droop[:, None] * t**1.5
    step = np.diff(t, prepend=0.0) * length[:, None]
    out = np.cumsum(step * np.cos(elevation), axis=1)
    up = np.cumsum(step * np.sin(elevation), axis=1)
    # Each frond lies in a plane through the axis, with its leaflets across.
    radial = np.stack([np.cos(azimuth), np.zeros(count), np.sin(azimuth)], axis=1)
    sideways = np.stack([-np.sin(azimuth), np.zeros(count), np.cos(azimuth)], axis=1)
    width = 0.17 * length
    spread = width[:, None, None] * np.broadcast_to(s, (count, along + 1, across + 1))
    spine = out[..., None] * radial[:, None] + up[..., None] * np.array([0.0, 1.0, 0.0])
    fold = -0.35 * np.abs(spread)[..., None] * _upwards(elevation, radial)[:, :, None]
    points = spine[:, :, None] + spread[..., None] * sideways[:, None, None] + fold
    # The whole image on every frond, its stalk at the bottom.
    image_u, image_v = np.meshgrid(0.5 + 0.5 * s, 1.0 - t)
    uvs = np.stack([image_u, image_v], axis=-1)
    return merged([patch(p, -lattice_normals(p), uvs) for p in points])


def _upwards(elevation: F64, radial: F64) -> F64:
    """The upper side of a spine rising at `elevation` (count, steps) along `radial` (count, 3)."""
    vertical = np.array([0.0, 1.0, 0.0])
    tilt = elevation[..., None]
    upper: F64 = np.cos(tilt) * vertical - np.sin(tilt) * radial[:, None]
    return upper


def pot() -> Geometry:
    """A terracotta pot, 0.8 m wide and 0.75 m high, with a rolled rim; the soil is `soil`."""
    # From the axis out along the bottom, up the belly, and over the rolled rim inside.
    shape: Points = [(0.0, 0.0), (0.24, 0.0), (0.26, 0.03)]
    shape += [(0.30, 0.16), (0.345, 0.32), (0.37, 0.46), (0.372, 0.55), (0.35, 0.63)]
    shape += arc((0.36, 0.69), 0.04, -70.0, 160.0, 8)
    shape += [(0.315, 0.66), (0.32, 0.60)]
    return revolved(profile(shape), 28)


def soil() -> Geometry:
    """The earth in a `pot`, slightly heaped."""
    return revolved(profile([(0.325, 0.61), (0.2, 0.635), (0.0, 0.645)]), 24)


SOIL = Finish(Material(name="soil", base_color=(0.07, 0.05, 0.035), roughness=1.0), 1.0)
