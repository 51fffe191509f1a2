"""Images of one surface put together: packed into channels, multiplied."""

from __future__ import annotations

import dataclasses
from collections.abc import Sequence

import numpy as np
import PIL.Image

from ...maths.arrays import U8
from ..material import Texture

SOFT_SHARE = 0.2
"""Of a mask's texels: edges of cut-outs have fewer."""


def with_alpha(base: Texture | None, mask: Texture) -> Texture:
    """`base` (white where None) with its alpha taken from `mask`, at the larger one's size.

    A mask image with an alpha channel of its own gives that, any other its mean brightness.
    """
    alpha = _alpha(mask)
    # A mask alone is the alpha of white.
    if base is None:
        white = np.full((*alpha.shape, 4), 255, dtype=np.uint8)
        base = dataclasses.replace(mask, pixels=white, is_srgb=True)
    shape = _larger(base.pixels.shape[:2], alpha.shape[:2])
    planes = [resized(base.pixels[..., k], shape) for k in range(3)]
    pixels = np.stack([*planes, resized(alpha, shape)], axis=-1)
    return dataclasses.replace(base, pixels=pixels, source=f"{base.source} + {mask.source}")


def _alpha(mask: Texture) -> U8:
    """(H, W) coverage of a mask: its alpha, or where that says nothing its brightness."""
    alpha = mask.pixels[..., 3]
    if alpha.min() == 255:
        alpha = mask.pixels[..., :3].mean(axis=2).round().astype(np.uint8)
    return alpha


def is_soft(mask: Texture) -> bool:
    """Whether a mask is coverage, not a cut-out: much of it is far from both 0 and 1."""
    alpha = _alpha(mask)
    return bool(((alpha > 25) & (alpha < 230)).mean() > SOFT_SHARE)


def packed_roughness_metallic(
    roughness: Texture | None, metallic: Texture | None
) -> Texture | None:
    """Roughness into green and metallic into blue, as in glTF; an absent one is 1."""
    given = roughness or metallic
    if given is None:
        return None
    # The larger of both sizes, so that neither image loses detail.
    shape = given.pixels.shape[:2]
    if roughness is not None and metallic is not None:
        shape = _larger(shape, metallic.pixels.shape[:2])
    pixels = np.full((*shape, 4), 255, dtype=np.uint8)
    for channel, image in ((1, roughness), (2, metallic)):
        if image is not None:
            pixels[..., channel] = resized(image.pixels[..., 0], shape)
    return dataclasses.replace(given, pixels=pixels)


def raised(images: Sequence[Texture], power: float) -> Texture:
    """The product of data images, raised to `power`, of the largest size; placed as the first."""
    shape = (0, 0)
    for image in images:
        shape = _larger(shape, image.pixels.shape[:2])
    product = np.ones((*shape, 1))
    for image in images:
        product = product * resized(image.pixels[..., 0], shape)[..., None] / 255.0
    grey = np.round(255.0 * product**power).astype(np.uint8)
    pixels = np.concatenate([grey, grey, grey, np.full_like(grey, 255)], axis=-1)
    return dataclasses.replace(images[0], pixels=pixels)


def _larger(a: tuple[int, ...], b: tuple[int, ...]) -> tuple[int, int]:
    return max(a[0], b[0]), max(a[1], b[1])


def resized(plane: U8, shape: tuple[int, ...]) -> U8:
    """The plane (H, W) at another size, bilinear."""
    if plane.shape == shape:
        return plane
    image = PIL.Image.fromarray(np.ascontiguousarray(plane))
    return np.asarray(image.resize((shape[1], shape[0]), PIL.Image.Resampling.BILINEAR))
