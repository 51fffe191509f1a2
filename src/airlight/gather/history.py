"""The light of gather points from the frames before: temporal reprojection, where it is wanted.

Off unless `gather_history` asks for it: a frame then depends on the frames before it.
"""

from __future__ import annotations

import numpy as np

from ..gpu.commands import Commands
from ..gpu.compute import ComputePass
from ..gpu.device import Gpu
from ..gpu.layout import Struct, f32, mat4x4f, u32, vec2f, vec2u, vec3f
from ..gpu.memory import Buffer, Texture
from ..gpu.slots import storage, texture, uniform
from ..lighting.view import View
from ..maths.transforms import F64
from ..scene.fingerprint import is_same
from ..scene.scene import Scene
from .points import Points
from .sums import read_sums, sums_image, written_sums

MOST_NUMBERS = 1 << 16
"""Frames after which rays take the numbers of the first once more."""


class PlaceBefore(Struct):
    """Where a point of the frame before was, and how long its mean is."""

    place = vec3f("m")
    frames = f32("that are in its mean, 0 where there is no surface")
    normal = vec3f("of its plane")
    orphans = u32("of its block, as `Orphans` says")


class HistoryParams(Struct):
    """The cameras of this frame and of the one before, and how the image is reduced."""

    clip_from_world = mat4x4f()
    before_from_world = mat4x4f("clip space of the frame before")
    size = vec2f("px")
    reduced = vec2u("texels, one for each block of pixels")
    rows = u32("of points, orphans' below those of the blocks")
    scale = u32("pixels along a side of a texel")
    texel = f32("m, how wide a texel is one metre away")
    most = f32("frames before that count; 0 in the first")
    is_changing = u32("whether light may have changed since")
    pad = u32()


class _Reproject(ComputePass):
    slots = (
        uniform("params", HistoryParams),
        texture("places", "2d", "unfilterable-float"),
        texture("planes", "2d", "unfilterable-float"),
        storage("orphans", "u32"),
        read_sums("sums"),
        read_sums("sums_before"),
        storage("places_before", PlaceBefore),
        written_sums(),
        storage("places_after", PlaceBefore, "read_write"),
    )
    workgroup = (8, 8, 1)
    file = "history.wgsl"


class History:
    """Sums of a view's points -> their mean over frames.

    Of each point it keeps `PointSums`, whose `frames` says for how many what was found before
    counts, and `PlaceBefore`.
    """

    def __init__(self, gpu: Gpu, points: Points, most: int) -> None:
        """`most`: frames before one that count for it."""
        self._points, self._most, self._pass = points, most, _Reproject(gpu)
        # Two sets of sums and places: of the frame before, and of this one.
        self._kept = [
            (
                sums_image(gpu, f"sums of frames {i}", points),
                Buffer(gpu, f"places of frames {i}", PlaceBefore.dtype.itemsize * points.count),
            )
            for i in range(2)
        ]
        self._before: F64 | None = None
        self.number = 0
        """Of the frame: its rays take the numbers of that sample of a still."""

    def encode(
        self, commands: Commands, view: View, sums: Texture, *, is_changing: bool
    ) -> Texture:
        """The image of `sums` of a view's points with those of the frames before it.

        `is_changing`: anything but the camera may have changed since the last of them.
        """
        points = self._points
        # Two sets: one is read, the other written, and then they change places.
        before, after = self._kept[self.number % 2], self._kept[1 - self.number % 2]
        # The first frame finds nothing before it.
        is_first = self._before is None
        self._pass.dispatch(
            commands,
            points.reduced,
            params=HistoryParams(
                clip_from_world=view.clip_from_world,
                before_from_world=view.clip_from_world if self._before is None else self._before,
                size=points.size,
                reduced=points.blocks,
                rows=points.reduced[1],
                scale=points.scale,
                texel=points.texel_m(view),
                most=0.0 if is_first else self._most,
                is_changing=int(is_changing),
                pad=0,
            ),
            places=points.places,
            planes=points.planes,
            orphans=points.orphans.buffer,
            sums=sums,
            sums_before=before[0],
            places_before=before[1],
            sums_after=after[0],
            places_after=after[1],
        )
        # The next frame looks points up in this camera, and its rays take the next numbers.
        self._before = np.array(view.clip_from_world)
        self.number = (self.number + 1) % MOST_NUMBERS
        return after[0]


def lit_alike(one: Scene, other: Scene) -> bool:
    """Whether what lights two scenes' surfaces is the same; parts of frames that rest are."""
    # All that lights surfaces; the camera does not.
    parts = ("lights", "light_groups", "meshes", "volumes")
    # Parts of a frame that rest are the very same objects as before.
    return (
        one.environment is other.environment
        and one.medium is other.medium
        and all(is_same(getattr(one, name), getattr(other, name)) for name in parts)
    )
