"""Which of the nested lattices lights what: an image in their colours, mixed where they fade."""

from __future__ import annotations

from typing import Any

import numpy as np

from ..app.compare.images import shown
from ..lattice.nested import shares
from ..maths.arrays import U8
from ..scene.builtin import atrium
from ..scene.camera import Camera, view_directions
from ..scene.checks import F32, F64
from ..scene.image import Image
from ..scene.scene import Scene
from .panels import Request, exposure_of, renderer

COLOURS: F64 = np.array(
    [
        [0.95, 0.35, 0.25],
        [0.3, 0.8, 0.35],
        [0.3, 0.5, 1.0],
        [0.95, 0.8, 0.25],
        [0.8, 0.4, 0.9],
        [0.4, 0.9, 0.9],
    ]
)
"""Of cascades from the finest on."""
COUNT = 3


def cascades_coloured(
    request: Request, scene: Scene | None = None, count: int = COUNT
) -> tuple[list[tuple[str, U8 | None]], list[dict[str, Any]]]:
    """Panels (the image, its indirect light, the cascades in colours), and what each lights."""
    # One sample: depth averaged over several would belong to no surface.
    seen = scene or atrium()
    with renderer(request, seen, {"cascades": count}) as made:
        image = made.frame(samples=1)
        levels, origin = made.technique.kit.lattices.placements, made.origin
    assert image is not None

    # Each lattice's share of the light at every pixel's surface.
    given = shares(levels, surface_points(seen.camera, image.layers["depth"]) - origin)
    stops = exposure_of(seen, image.radiance)

    # The image, its indirect light, and the lattices' colours, exposed alike.
    bounced = image.layers["indirect"]
    panels: list[tuple[str, U8 | None]] = [
        ("the image", shown(image.radiance, stops)),
        ("indirect light", shown(bounced, stops)),
        ("cascades: red, green, blue from the finest", shown(coloured(image, given), stops)),
    ]

    # What each lattice is, and how much of the image it lights.
    numbers = [
        {"cell_m": level.cell, "cells": list(level.count), "share_of_pixels": float(part.mean())}
        for level, part in zip(levels, given, strict=True)
    ]
    return panels, numbers


def coloured(image: Image, given: F64) -> F32:
    """The image's light in the colours of the cascades; `given` (L, H, W) their shares."""
    # Grey light, so that hue says nothing but the lattice.
    grey = image.radiance.mean(axis=-1, keepdims=True)
    tint = np.tensordot(given, COLOURS[: len(given)], axes=(0, 0))
    return np.asarray(1.5 * grey * tint, np.float32)


def surface_points(camera: Camera, depth: F32) -> F64:
    """World points (H, W, 3) of pixels, `depth` in metres along their rays; far where it is not."""
    height, width = depth.shape
    rays = view_directions(camera, width, height, width / height).reshape(height, width, 3)
    points = np.array(camera.position) + rays * np.minimum(depth, 1e6)[..., None]
    return np.asarray(points, np.float64)
