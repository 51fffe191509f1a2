"""Where a glTF material's images lie on its surfaces: KHR_texture_transform, rotations included.

An image of airlight's is scaled and shifted, never turned. So what turns is turned once, in the
mesh's own coordinates, and each image keeps a scale and an offset of those. That holds for all
images of a material that are turned alike, which is how exporters write them; those of others are
drawn again (gltf_frames).
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from ..checks import F64
from ..material import Texture
from .gltf_json import Item

_SAME = 1e-6


@dataclass(frozen=True, eq=False)
class UvFrame:
    """Which coordinates of a mesh a material's images read: set TEXCOORD_`uv_set` through `matrix`.

    `matrix` (2, 2) gives frame_from_file; None leaves them as the file has them.
    """

    uv_set: int = 0
    matrix: F64 | None = None

    @property
    def key(self) -> tuple[Any, ...]:
        """What tells frames apart."""
        return (self.uv_set, None if self.matrix is None else tuple(self.matrix.ravel()))


@dataclass(frozen=True, eq=False)
class ImageUse:
    """A texture of a material, the coordinates it reads, and image_from_file (2, 2) without the
    offset, which the texture has already."""

    texture: Texture
    uv_set: int
    matrix: F64
    item: Item


def image_use(info: Item, texture: Texture) -> ImageUse:
    """The use of `texture` by a textureInfo, with its offset.

    Source: Khronos, KHR_texture_transform: offset * rotation * scale, the rotation turning
    coordinates counter-clockwise about the image's upper left corner with v downwards, so that
    its example (offset [0, 1], rotation pi / 2, scale .5) shows the lower left quadrant.
    """
    transform = info.at("extensions", "KHR_texture_transform")
    ou, ov = transform.floats("offset", 2, (0.0, 0.0))
    return ImageUse(
        texture=replace(texture, offset=(ou, ov)),
        uv_set=transform.integer("texCoord", info.integer("texCoord", 0)),
        matrix=_turned(transform.number("rotation", 0.0))
        # The offset goes to the texture at once, the turn and the scale wait for a frame.
        @ np.diag(transform.floats("scale", 2, (1.0, 1.0))),
        item=info,
    )


def _turned(angle: float) -> F64:
    """Coordinates (u, v downwards) turned counter-clockwise as one sees them, radians."""
    c, s = math.cos(angle), math.sin(angle)
    return np.array([[c, s], [-s, c]])


def shared_frame(uses: Sequence[ImageUse]) -> tuple[UvFrame, list[Texture]] | None:
    """A frame that all images lie in, each scaled and moved, and their textures there; None where
    there is none."""
    # Any image's own frame may serve the others: their scales follow from it.
    for matrix in _candidates(uses):
        frame = UvFrame(uses[0].uv_set if uses else 0, matrix)
        scales = [scale_in(use, frame) for use in uses]
        if all(scale is not None for scale in scales):
            placed = zip(uses, scales, strict=True)
            return frame, [replace(use.texture, scale=s) for use, s in placed if s is not None]
    return None


def scale_in(use: ImageUse, frame: UvFrame) -> tuple[float, float] | None:
    """The scale by which an image lies in a frame; None where that is not enough."""
    if use.uv_set != frame.uv_set:
        return None
    # What remains of the image's matrix within the frame has to be diagonal, without a turn.
    rest = use.matrix if frame.matrix is None else use.matrix @ np.linalg.pinv(frame.matrix)
    if max(abs(rest[0, 1]), abs(rest[1, 0])) > _SAME * np.abs(rest).max():
        return None
    return float(rest[0, 0]), float(rest[1, 1])


def _candidates(uses: Sequence[ImageUse]) -> Iterator[F64 | None]:
    """Matrices by which a mesh's coordinates may be turned, the plain one first."""
    yield None
    for use in uses:
        # A matrix that flattens coordinates cannot be undone.
        if abs(np.linalg.det(use.matrix)) > _SAME:
            yield use.matrix
