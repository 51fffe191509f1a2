"""Texels of textures on the host: the nearest to a place, and values interpolated between them.

Passes read textures through samplers; surfels, glowing pieces and images that are drawn again ask
here. Both wrap alike.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..maths.arrays import F64, I64
from .material import Texture, Wrap


def in_image(texture: Texture, uv: F64) -> F64:
    """Image coordinates (n, 2), whose 1 is the image's side, of a mesh's coordinates `uv`."""
    return uv * texture.scale + texture.offset


def wrapped(texel: I64, count: int, wrap: Wrap) -> I64:
    """Indices 0 to `count` - 1 of texels of any index along an axis of `count`."""
    if wrap == "clamp":
        return np.clip(texel, 0, count - 1)
    # A mirrored image has a period of two, of which the second half runs backwards.
    if wrap == "mirror":
        return np.minimum(texel % (2 * count), 2 * count - 1 - texel % (2 * count))
    return texel % count


def nearest(texture: Texture, uv: F64) -> NDArray[np.uint8]:
    """(n, 4): the texel that each of a mesh's coordinates `uv` (n, 2) lies in."""
    height, width = texture.pixels.shape[:2]
    texel = np.floor(in_image(texture, uv) * (width, height)).astype(np.int64)
    x = wrapped(texel[:, 0], width, texture.wrap[0])
    y = wrapped(texel[:, 1], height, texture.wrap[1])
    return np.asarray(texture.pixels[y, x])


def interpolated(image: NDArray[Any], at: F64, wrap: tuple[Wrap, Wrap]) -> F64:
    """Bilinear values (n, C) of an image (H, W, C) at image coordinates `at` (n, 2).

    An image of bytes gives bytes' range, 0 to 255.
    """
    # Texel centres lie at half numbers; the four around each place, wrapped.
    size = np.array(image.shape[1::-1])
    place = at * size - 0.5
    corner = np.floor(place).astype(np.int64)
    x, y = (place - corner).T[..., None]
    (x0, x1), (y0, y1) = (
        [wrapped(corner[:, k] + step, int(size[k]), wrap[k]) for step in (0, 1)] for k in (0, 1)
    )
    above = image[y0, x0] * (1.0 - x) + image[y0, x1] * x
    below = image[y1, x0] * (1.0 - x) + image[y1, x1] * x
    return np.asarray(above * (1.0 - y) + below * y)
