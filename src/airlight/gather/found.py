"""The sums of points as an image that neighbours read, without blots of what single rays found."""

from __future__ import annotations

from ..gpu.commands import Commands
from ..gpu.compute import ComputePass
from ..gpu.device import Gpu
from ..gpu.layout import Struct, f32, u32, vec2u
from ..gpu.memory import Buffer, Texture
from ..gpu.slots import image, storage, texture, uniform
from ..lighting.view import View
from .points import Points
from .sums import PointSums, sums_image, written_sums

_TILE = 8
"""Points along a side of what the brightness of rays around is taken from, nine of these."""
_MOST = 24.0
"""Times the mean of the rays around that one ray counts at most where points have sixteen."""


class FoundParams(Struct):
    """The points, and how much a ray may have found."""

    reduced = vec2u("blocks of pixels")
    rows = u32("of points, orphans' below those of the blocks")
    rays = u32("of a point")
    most = f32("times the mean luminance of rays around that a ray counts")


_POINTS = (
    uniform("params", FoundParams),
    storage("sums", PointSums),
)
_TILES = texture("tiles", "2d", "unfilterable-float")


class _TileSums(ComputePass):
    slots = (
        *_POINTS,
        texture("places", "2d", "unfilterable-float"),
        image("tile_sums", "rgba32float"),
    )
    workgroup = (8, 8, 1)
    file = "tile_sums.wgsl"


class _TileExcess(ComputePass):
    slots = (
        *_POINTS,
        texture("places", "2d", "unfilterable-float"),
        storage("orphans", "u32"),
        _TILES,
        image("excess", "rgba32float", "2d-array"),
    )
    workgroup = (8, 8, 1)
    file = "tile_excess.wgsl"


class _Found(ComputePass):
    slots = (
        *_POINTS,
        _TILES,
        texture("excess", "2d-array", "unfilterable-float"),
        storage("orphans", "u32"),
        written_sums(),
    )
    workgroup = (8, 8, 1)
    file = "found_sums.wgsl"


class FoundSums:
    """A `sums_image` of what all rays of a view's points found."""

    def __init__(self, gpu: Gpu, points: Points, rays: int) -> None:
        """`rays`: of a point."""
        self._points, self._rays = points, rays
        self._sums, self._excess, self._found = (
            made(gpu, generated=f"const TILE = {_TILE}u;\n")
            for made in (_TileSums, _TileExcess, _Found)
        )
        width, height = (-(-side // _TILE) for side in points.blocks)
        self._tiles = Texture(gpu, "tiles of sums", (width, height), "rgba32float", written=True)
        # Light and where it comes from, beyond what stays with points.
        self._given = Texture(
            gpu, "excess", (width, height, 2), "rgba32float", dimension="2d-array", written=True
        )
        self._image = sums_image(gpu, "gathered sums", points)

    def encode(self, commands: Commands, view: View, sums: Buffer) -> Texture:
        """The image of `sums`, of a sample of the view."""
        points, tiles = self._points, self._tiles.size[:2]
        params = FoundParams(
            reduced=points.blocks,
            rows=points.reduced[1],
            rays=self._rays,
            # The mean of more rays bears more, and in the limit all.
            most=_MOST * ((view.sample + 1) * self._rays / 16.0) ** 0.5,
        )
        # How bright rays are around, what is too bright for that, and what each point then has.
        seen = {"params": params, "sums": sums, "places": points.places}
        self._sums.dispatch(commands, tiles, **seen, tile_sums=self._tiles)
        bright = {"tiles": self._tiles, "orphans": points.orphans.buffer}
        self._excess.dispatch(commands, tiles, **seen, **bright, excess=self._given)
        self._found.dispatch(
            commands,
            points.reduced,
            params=params,
            sums=sums,
            **bright,
            excess=self._given,
            sums_after=self._image,
        )
        return self._image
