"""Surfaces that rays found, in textures that lighting reads as it reads a G-buffer's.

A texel is a ray. Lighting a hit and lighting a pixel differ in one thing: a pixel's place follows
from its depth, a hit's is stored.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from ..gpu.counted import CountedRows
from ..gpu.device import Gpu
from ..gpu.memory import Texture
from ..gpu.slots import Slot, texture


@dataclass(frozen=True)
class Points:
    """What tells lighting where surfaces lie: the texture that it binds, and how it is read."""

    slot: Slot
    wgsl: str


PIXELS = Points(texture("depth", "2d", "depth"), "//! use surface_of_pixel\n")
"""The surfaces of an image's pixels, from its depth."""
HITS = Points(texture("positions", "2d", "unfilterable-float"), "//! use surface_of_hit\n")
"""The surfaces that rays found."""


class Hits:
    """What rays of a batch found, a texel each.

    positions  xyz world, m, w the material met and its side, as `hit_code.wgsl` writes them; where
               a ray left the scene its direction, w 0
    normal     xyz world, facing where the ray came from; w what light from all around adds to the
               albedo (to lighting a roughness, of which a surface without a coat knows nothing)
    albedo     rgb, a metallic
    emission   rgb W m^-2 sr^-1, a specular; black: what glows is lit as an emitter

    `rows`: how many rows of them there are, where the device counts them; else all.
    """

    def __init__(self, gpu: Gpu, size: tuple[int, int], rows: CountedRows | None = None) -> None:
        self.size, self.rows = size, rows
        self.positions = Texture(gpu, "hit positions", size, "rgba32float", written=True)
        self.normal = Texture(gpu, "hit normals", size, "rgba16float", written=True)
        self.albedo = Texture(gpu, "hit albedo", size, "rgba16float", written=True)
        self.emission = Texture(gpu, "hit emission", size, "rgba16float")

    @property
    def bound(self) -> dict[str, Any]:
        """By slot name, for lighting passes."""
        return {
            "positions": self.positions,
            "normal": self.normal,
            "albedo": self.albedo,
            "emission": self.emission,
        }
