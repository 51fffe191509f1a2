"""Where light is gathered: a surface point for each block of pixels."""

from __future__ import annotations

import numpy as np

from ..gpu.commands import Commands
from ..gpu.compute import ComputePass
from ..gpu.device import Gpu
from ..gpu.memory import Texture
from ..lighting.view import View
from ..maths.gather_orphans import orphan_step
from ..maths.transforms import F64
from .orphans import BLOCK_BITS, Orphans
from .point_params import CHOOSING_SLOTS, PointParams

MOST_POINTS = 1 << BLOCK_BITS
"""Of an image's blocks of pixels, which grow as large as that asks."""


class _Points(ComputePass):
    slots = CHOOSING_SLOTS
    workgroup = (8, 8, 1)
    file = "points.wgsl"


class Points:
    """The gather points of an image: of its blocks of pixels, and below those of orphan pixels.

    places   xyz world, m; w distance to the eye, m, 0 where there is no surface
    starts   where their rays start, with w as of the places
    normals  of the shaded surface, about which rays are sent; w: the share of the hemisphere that
             near occluders leave
    planes   normals of the surface without relief, by which neighbours share light
    """

    def __init__(self, gpu: Gpu, size: tuple[int, int], *, is_occluded: bool) -> None:
        """For an image of `size`, pixels. `is_occluded`: near surfaces shade it."""
        self.size = size
        # A point for each block of pixels, and blocks as small as MOST_POINTS allows.
        self.scale = reduction(size, MOST_POINTS)
        width, height = (-(-side // self.scale) for side in size)
        self.blocks = (width, height)
        self.orphans = Orphans(gpu, self.blocks, self.scale, is_occluded=is_occluded)
        self.reduced = (width, height + self.orphans.rows)
        self.places, self.starts = (
            Texture(gpu, f"gather {name}", self.reduced, "rgba32float", written=True)
            for name in ("places", "starts")
        )
        self.normals = Texture(gpu, "gather normals", self.reduced, "rgba16float", written=True)
        self.planes = Texture(gpu, "gather planes", self.reduced, "rgba16float", written=True)
        self._pass = _Points(gpu, constants={"HAS_OCCLUSION": float(is_occluded)})

    @property
    def count(self) -> int:
        """How many there are."""
        return self.reduced[0] * self.reduced[1]

    def texel_m(self, view: View) -> float:
        """How wide a texel is one metre from the eye, m."""
        return self.scale * pixel_m(view.world_from_clip, self.size[1])

    def params(self, view: View, rays: int = 0) -> PointParams:
        """What passes over points or pixels must know of the camera; `rays` of a point."""
        return PointParams(
            world_from_clip=view.world_from_clip,
            eye=view.eye,
            scale=self.scale,
            size=self.size,
            reduced=self.blocks,
            sample=view.sample,
            texel=self.texel_m(view),
            rays=rays,
            step=orphan_step(self.scale),
            most=self.orphans.most,
            pad=0,
        )

    def encode(self, commands: Commands, view: View) -> None:
        """Choose a pixel of each block; the view's G-buffer and its occlusion are drawn."""
        params = self.params(view)
        # With its normal goes how much of the hemisphere the near field leaves open.
        bound = {
            "depth": view.gbuffer.depth,
            "normal": view.gbuffer.normal,
            "near_field": view.occlusion.near,
            "places": self.places,
            "starts": self.starts,
            "normals": self.normals,
            "planes": self.planes,
        }
        self._pass.dispatch(commands, self.blocks, params=params, **bound)
        self.orphans.encode(commands, params, bound)


def pixel_m(world_from_clip: F64, height: int) -> float:
    """How wide a pixel of an image of `height` pixels is one metre from the eye, m.

    Depth is reversed and infinite, so that the inverse's columns are homogeneous points one metre
    away, wherever the near plane is.
    """
    return float(np.linalg.norm(world_from_clip[:3, 1])) * 2.0 / height


def reduction(size: tuple[int, int], most: int) -> int:
    """Pixels along a side of the smallest blocks of which an image of `size` has at most `most`."""
    # Blocks grow until the image has few enough of them.
    scale = 1
    while (-(-size[0] // scale)) * (-(-size[1] // scale)) > most:
        scale += 1
    return scale
