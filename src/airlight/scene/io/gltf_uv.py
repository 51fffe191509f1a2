"""Where a glTF material's images lie on its surfaces: KHR_texture_transform, rotations included.

An image of airlight's is scaled and shifted, never turned. So what turns is turned once, in the
mesh's own coordinates, and each image keeps a scale and an offset of those. That holds for all
images of a material that are turned alike, which is how exporters write them.
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
        @ np.diag(transform.floats("scale", 2, (1.0, 1.0))),
        item=info,
    )


def _turned(angle: float) -> F64:
    """Coordinates (u, v downwards) turned counter-clockwise as one sees them, radians."""
    c, s = math.cos(angle), math.sin(angle)
    return np.array([[c, s], [-s, c]])


def shared_frame(uses: Sequence[ImageUse]) -> tuple[UvFrame, list[Texture], list[ImageUse]]:
    """The frame of most images; every texture, scaled for that; and what is placed wrongly."""
    if not uses:
        return UvFrame(), [], []
    uv_set = uses[0].uv_set
    matrix = max(_candidates(uses), key=lambda m: sum(_is_scale(use.matrix, m) for use in uses))
    textures, lost = [], []
    for use in uses:
        # The diagonal is all that an image keeps; where there is more, it is placed wrongly.
        scale = np.diag(use.matrix @ np.linalg.inv(matrix))
        textures.append(replace(use.texture, scale=(float(scale[0]), float(scale[1]))))
        if use.uv_set != uv_set or not _is_scale(use.matrix, matrix):
            lost.append(use)
    plain = np.array_equal(matrix, np.eye(2))
    return UvFrame(uv_set, None if plain else matrix), textures, lost


def _candidates(uses: Sequence[ImageUse]) -> Iterator[F64]:
    """Matrices by which a mesh's coordinates may be turned; of equally good ones the first."""
    yield np.eye(2)
    for use in uses:
        if abs(np.linalg.det(use.matrix)) > _SAME:
            yield use.matrix


def _is_scale(matrix: F64, frame: F64) -> bool:
    """Whether `matrix` is a scaling of what `frame` gives."""
    rest = matrix @ np.linalg.inv(frame)
    return bool(max(abs(rest[0, 1]), abs(rest[1, 0])) <= _SAME * np.abs(rest).max())
