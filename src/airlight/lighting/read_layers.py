"""A drawn view read back: its layers, their sum, and where its surfaces are."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from ..gpu.memory import Texture
from ..scene.checks import F32
from .accumulate import Accumulator
from .view import View

NOT_ADDED = ("transmittance",)
"""Layers that are averaged over samples, but are no radiance."""


def read_layers(
    view: View, textures: Mapping[str, Texture], means: Accumulator | None
) -> tuple[dict[str, F32], F32]:
    """Each layer, float32 (H, W, 3), and the sum of those that are radiance, W m^-2 sr^-1.

    `textures`: the technique's layers of the view, or those of its last sample where `means` has
    the means of all. Added to them: albedo, normal, and depth, m, of the last sample's surfaces.
    """
    layers: dict[str, F32] = {
        name: (means.read(name) if means else texture.read())[..., :3].astype(np.float32)
        for name, texture in textures.items()
    }
    # Layers add up to the image, but for those that are no radiance.
    radiance: F32 = np.sum([layers[n] for n in textures if n not in NOT_ADDED], axis=0)
    g = view.gbuffer
    layers |= {
        "albedo": g.albedo.read()[..., :3].astype(np.float32),
        "normal": g.normal.read()[..., :3].astype(np.float32),
        "depth": distance(view),
    }
    return layers, radiance


def distance(view: View) -> F32:
    """The distance along each pixel's ray, m; infinite where there is no surface."""
    depth = view.gbuffer.depth.read().astype(np.float64)
    # Centres of pixels in clip space, with the depth of their surfaces.
    height, width = depth.shape
    x = (np.arange(width) + 0.5) / width * 2.0 - 1.0
    y = 1.0 - (np.arange(height) + 0.5) / height * 2.0
    safe = np.maximum(depth, 1e-9)
    clip = np.stack(
        [*np.broadcast_arrays(x[None, :], y[:, None]), safe, np.ones_like(safe)], axis=-1
    )
    # Back into the world; depth 0 is infinitely far.
    world = clip @ view.world_from_clip.T
    distance = np.linalg.norm(world[..., :3] / world[..., 3:] - view.eye, axis=-1)
    return np.where(depth > 0.0, distance, np.inf).astype(np.float32)
