"""What part of each pixel of a still glows: exact for polygons, whatever the samples hit.

An area light of a few pixels is tens of times as bright as what it lights, so that the few samples
of a still know its edges badly. Its polygon's part of a pixel is a sum over its edges in closed
form; a sample says whether something stands before it, and has that part of the glow, on the light
or beside it. Source: ours; the sum is that of font rasterizers.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from ..gpu.commands import Commands
from ..gpu.device import Gpu
from ..gpu.fullscreen import FullscreenPass
from ..gpu.layout import Struct, f32, mat4x4f, pack_array, u32, vec2f, vec3f
from ..gpu.memory import Buffer, Texture
from ..gpu.slots import storage, texture, uniform
from ..scene.checks import F64
from ..surface.gbuffer import GBuffer
from .emitter import Emitter
from .shapes import MOST_CORNERS, Shape

_CLOSE = 0.01  # m before the eye, closer than which a corner may be beside or behind it


class CoverageParams(Struct):
    """The camera, and how many outlines there are."""

    world_from_clip = mat4x4f()
    size = vec2f("px")
    jitter = vec2f("px, that the image is moved by")
    count = u32()


class OutlineData(Struct):
    """A glowing polygon that faces the eye; its corners in the image lie in another table."""

    radiance = vec3f("W m^-2 sr^-1")
    radius = f32("m")
    centre = vec3f("m")
    corner_count = u32()
    normal = vec3f()


class _CoveragePass(FullscreenPass):
    """G-buffer -> its emission, with polygons by the part of each pixel that they cover."""

    targets = ("rgba32float",)
    file = "coverage.wgsl"
    slots = (
        uniform("params", CoverageParams),
        texture("depth", "2d", "depth"),
        texture("emission", "2d", "unfilterable-float"),
        storage("outlines", OutlineData),
        storage("corners", "vec4f"),
    )


class Coverage:
    """Redraws the emission of a still's samples, where whole polygons glow."""

    def __init__(self, gpu: Gpu, most: int) -> None:
        """`most`: how many emitters there are."""
        self.gpu = gpu
        self._pass = _CoveragePass(gpu)
        self._outlines = Buffer(gpu, "outlines", OutlineData.dtype.itemsize * most)
        self._corners = Buffer(gpu, "outline corners", 16 * MOST_CORNERS * most)
        self._drawn: Texture | None = None

    def encode(
        self,
        commands: Commands,
        gbuffer: GBuffer,
        emitters: Sequence[Emitter],
        camera: tuple[F64, F64, F64],
        jitter_px: tuple[float, float],
    ) -> Texture:
        """The texture that stands for the G-buffer's emission, or that one where nothing is exact.

        `camera`: clip_from_world, its inverse, and the eye, metres; its image is moved by
        `jitter_px`.
        """
        clip_from_world, world_from_clip, eye = camera
        # The outline of each emitter in the image, as far as it is before the eye.
        found = []
        for emitter in emitters:
            corners = seen_corners(emitter, clip_from_world, eye, gbuffer.size)
            if corners is not None:
                found.append((emitter.shape, corners - (*jitter_px, 0.0)))

        # Without an outline the G-buffer's own emission is as good.
        if not found:
            return gbuffer.emission
        if self._drawn is None or self._drawn.size[:2] != gbuffer.size:
            self._drawn = Texture(
                self.gpu, "coverage", gbuffer.size, "rgba32float", target=True, written=True
            )
        # As tables of outlines and of their corners.
        self._outlines.write(pack_array(OutlineData, [_row(shape, len(c)) for shape, c in found]))
        packed = np.zeros((len(found), MOST_CORNERS, 4), np.float32)
        for row, (_, corners) in enumerate(found):
            packed[row, : len(corners), :3] = corners
        self._corners.write(packed)
        # Each pixel takes of an emitter as much as it covers of it.
        bound = gbuffer.bound
        self._pass.draw(
            commands,
            (self._drawn,),
            params=CoverageParams(
                world_from_clip=world_from_clip,
                size=gbuffer.size,
                jitter=jitter_px,
                count=len(found),
            ),
            depth=bound["depth"],
            emission=bound["emission"],
            outlines=self._outlines,
            corners=self._corners,
        )
        return self._drawn


def _row(shape: Shape, count: int) -> dict[str, Any]:
    return {
        "radiance": shape.radiance,
        "radius": shape.radius,
        "centre": shape.centre,
        "corner_count": count,
        "normal": shape.normal,
    }


def seen_corners(
    emitter: Emitter, clip_from_world: F64, eye: F64, size: tuple[int, int]
) -> F64 | None:
    """(n, 3) pixels and depth: a polygon's corners in the image, if all of its front is ahead.

    None where a polygon is not exactly what is seen of the emitter.
    """
    shape = emitter.shape

    # Only what is seen as one whole polygon has an outline.
    if not emitter.is_outlined or shape.corners is None:
        return None
    # From behind or nearly edge on, no front is seen whose area could be computed.
    if float((eye - shape.centre) @ shape.normal) <= 1e-3 * shape.radius:
        return None
    # A corner beside or behind the eye has no place in the image: the projection turns over.
    clip = np.concatenate([shape.corners, np.ones((len(shape.corners), 1))], 1) @ clip_from_world.T
    if float(clip[:, 3].min()) < _CLOSE:
        return None

    # From clip space to pixels, y downwards.
    ndc = clip[:, :3] / clip[:, 3:]
    return np.asarray((ndc * (0.5, -0.5, 1.0) + (0.5, 0.5, 0.0)) * (*size, 1.0))
