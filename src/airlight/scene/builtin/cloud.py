"""A cumulus cloud."""

from __future__ import annotations

from typing import cast

import numpy as np

from ..camera import Camera
from ..checks import F32, F64, Bounds, Vec3
from ..lights import DirectionalLight
from ..scene import Scene
from ..volume import Volume
from .noise import fractal_noise, smoothstep
from .sky import clear_sky

PER_M = 2
"""Cells of the density grid along a metre."""

SHAPE = (64 * PER_M, 40 * PER_M, 64 * PER_M)
"""Cells of the density grid, (z, y, x)."""

BOUNDS: Bounds = ((-32.0, 30.0, -32.0), (32.0, 70.0, 32.0))

SUN_TRAVEL: Vec3 = (-0.45, -0.55, -0.75)


def cloud(*, seed: int = 5) -> Scene:
    """A small cumulus, 50 m wide with a flat base, alone in sun and sky.

    Seen from the ground, the sun to the right and a little behind it.
    One grid of 128 x 80 x 128 over 64 x 40 x 64 m; extinction 1 per metre at density 1,
    albedo 0.999, g 0.85.
    """
    volume = Volume(
        sigma_t=(1.0, 1.0, 1.0),
        density=cumulus_density(seed),
        bounds=BOUNDS,
        albedo=(0.999, 0.999, 0.999),
        g=(0.85, 0.85, 0.85),
        source="builtin cloud",
    )
    return Scene(
        name="cloud",
        lights=(DirectionalLight(SUN_TRAVEL, (30.0, 27.0, 22.0)),),
        environment=clear_sky(SUN_TRAVEL),
        camera=Camera((-82.0, 2.0, -9.0), (0.0, 48.0, 0.0), fov_y_deg=36.0, exposure_stops=-2.5),
        volumes=(volume,),
    )


def cumulus_density(seed: int) -> F32:
    """Density (z, y, x) in [0, 1]: a heap of balls with a flat base, billows on its rim."""
    # How deep each cell lies in the heap, metres; balls are a little flat.
    rng = np.random.default_rng(seed)
    z, y, x = np.meshgrid(*((np.arange(n) + 0.5) / PER_M for n in SHAPE), indexing="ij")
    centred = np.stack([x - 32.0, y - 7.0, z - 32.0])
    depth = np.full(SHAPE, -np.inf)
    for cx, cy, cz, radius in _heap(rng):
        away = np.sqrt(
            (centred[0] - cx) ** 2 + (1.15 * (centred[1] - cy)) ** 2 + (centred[2] - cz) ** 2
        )
        depth = np.maximum(depth, radius - away)
    # Billows, round outwards with creases between them, and smaller ones on these. The rim is as
    # sharp as voxels allow; below a height the heap ends, as clouds do.
    billow = np.abs(fractal_noise(SHAPE, (8, 5, 8), rng, octaves=4, gain=0.6))
    small = np.abs(fractal_noise(SHAPE, (16, 10, 16), rng, octaves=3, gain=0.7))
    rim = depth.astype(np.float32) + 1.6 - 5.2 * np.clip(0.8 - billow, 0.0, 1.0)
    rim += 1.2 * small - 0.7
    density = smoothstep(0.0, 0.7, rim) * smoothstep(2.5, 5.0, (y + 0.8 * small).astype(np.float32))
    # Nothing reaches the grid's border, where it would end in a plane.
    edge = np.minimum.reduce([_inside(i, n / PER_M) for i, n in zip((z, y, x), SHAPE, strict=True)])
    return cast(F32, np.clip(density * smoothstep(0.5, 3.0, edge), 0.0, 1.0))


def _heap(rng: np.random.Generator) -> F64:
    """Balls (n, 4): centre and radius, metres from the base's middle; a dome of smaller ones."""
    count = 26
    # Balls by area over a disk, lower and smaller towards its rim, as the dome falls off.
    away = 21.0 * np.sqrt(rng.random(count))
    angle = rng.uniform(0.0, 2.0 * np.pi, count)
    dome = 1.0 - (away / 24.0) ** 2
    height = rng.uniform(0.0, 1.0, count) * 20.0 * dome
    radius = rng.uniform(4.5, 8.0, count) * (0.6 + 0.6 * dome) * (1.0 - 0.02 * height)
    balls = np.stack([away * np.cos(angle), height, 0.8 * away * np.sin(angle), radius], axis=1)
    # Three large ones hold them together.
    core = np.array([[0.0, 4.0, 0.0, 14.0], [-9.0, 2.0, 2.0, 9.0], [10.0, 2.0, -2.0, 9.5]])
    return np.concatenate([core, balls])


def _inside(at: F64, extent: float) -> F32:
    """Metres between here and the grid's nearer border."""
    return cast(F32, np.minimum(at, extent - at).astype(np.float32))
