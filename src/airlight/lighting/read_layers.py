"""A drawn view read back: its layers, their sum, and where its surfaces are."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..gpu.memory import Texture
from ..scene.checks import F32
from .accumulate import Accumulator
from .view import View

NOT_ADDED = ("transmittance",)
"""Layers that are averaged over samples, but are no radiance."""


class Layers(Mapping[str, F32]):
    """Layers as arrays; one that is computed is so when it is first asked for."""

    def __init__(self, made: Mapping[str, Callable[[], F32]]) -> None:
        self._made, self._known = dict(made), dict[str, F32]()

    def __getitem__(self, name: str) -> F32:
        if name not in self._known:
            self._known[name] = self._made[name]()
        return self._known[name]

    def __iter__(self) -> Iterator[str]:
        return iter(self._made)

    def __len__(self) -> int:
        return len(self._made)


def read_layers(
    view: View, textures: Mapping[str, Texture], means: Accumulator | None
) -> tuple[Layers, F32]:
    """Each layer, float32 (H, W, 3), and the sum of those that are radiance, W m^-2 sr^-1.

    `textures`: the technique's layers of the view, or those of its last sample where `means` has
    the means of all. Added to them: albedo, normal, and depth, m, of the last sample's surfaces.
    All are read at once, since the next frame takes their textures; files that do not hold them
    do without their arrays.
    """
    # The means of all samples, or the textures of the only one.
    read = {n: means.read(n) if means else t.read() for n, t in textures.items()}
    g = view.gbuffer
    surfaces = {"albedo": g.albedo.read(), "normal": g.normal.read()}
    seen = partial(distance, g.depth.read(), view.world_from_clip, view.eye)
    layers = Layers(
        {n: partial(_colours, t) for n, t in {**read, **surfaces}.items()} | {"depth": seen}
    )
    # Radiance is their sum; a layer that nothing else asks for is added as it was read.
    radiance: F32 = np.zeros((*view.size[::-1], 3), np.float32)
    for name, texels in read.items():
        if name not in NOT_ADDED:
            radiance += texels[..., :3]
    return layers, radiance


def _colours(texels: NDArray[Any]) -> F32:
    """Float32 (H, W, 3) of a texture's texels."""
    return texels[..., :3].astype(np.float32)


def distance(
    depth: NDArray[np.float32], world_from_clip: NDArray[Any], eye: tuple[float, float, float]
) -> F32:
    """The distance along each pixel's ray, m; infinite where there is no surface.

    `depth`, (H, W), is the depth buffer, 0 infinitely far; `eye`, m, is where rays start.
    """
    # Centres of pixels in clip space, with the depth of their surfaces.
    height, width = depth.shape
    x = (np.arange(width) + 0.5) / width * 2.0 - 1.0
    y = 1.0 - (np.arange(height) + 0.5) / height * 2.0
    safe = np.maximum(depth.astype(np.float64), 1e-9)
    clip = np.stack(
        [*np.broadcast_arrays(x[None, :], y[:, None]), safe, np.ones_like(safe)], axis=-1
    )
    # Back into the world.
    world = clip @ world_from_clip.T
    distance = np.linalg.norm(world[..., :3] / world[..., 3:] - eye, axis=-1)
    return np.where(depth > 0.0, distance, np.inf).astype(np.float32)
