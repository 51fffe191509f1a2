"""Float fields as 8-bit textures: colours, normals of a height field, roughness; and finishes."""

from __future__ import annotations

from functools import cache
from typing import Any, cast

import numpy as np
from numpy.typing import NDArray

from ...maths.arrays import U8
from ...maths.colour import srgb_encode
from ..checks import Rgb
from ..material import Material, Texture
from .patch import Finish

Field = NDArray[np.floating[Any]]
"""Values of any float type; the results are 8 bit anyway."""

_STEPS = 8191
"""Steps of the table of the sRGB curve: finer than half a code value down to 0.1 %."""


def color_texture(
    grey: Field, tints: Field | Rgb, source: str, alpha: Field | None = None
) -> Texture:
    """sRGB texture of `grey` (H, W) times `tints`, one linear colour or (H, W, 3)."""
    # A table of the sRGB curve instead of a power for each texel.
    scaled = np.multiply(grey, np.float32(_STEPS), dtype=np.float32)
    pixels = np.full((*grey.shape, 4), 255, np.uint8)
    for channel in range(3):
        factor = tints[channel] if isinstance(tints, tuple) else tints[..., channel]
        index = np.clip(scaled * factor, 0, _STEPS).astype(np.uint16)
        pixels[..., channel] = _srgb_table()[index]
    if alpha is not None:
        pixels[..., 3] = np.clip(255.0 * alpha + 0.5, 0, 255)
    return Texture(pixels, source=source)


def normal_texture(height_m: Field, width_m: float, source: str) -> Texture:
    """Tangent-space normals of a tileable height field (H, W) that spans `width_m` metres.

    As in glTF: x to the image's right, y to its top, z outwards; linear.
    """
    # Central differences across two texels; the field wraps around.
    texel_m = np.float32(2.0 * width_m / height_m.shape[1])
    slope_x = (np.roll(height_m, -1, 1) - np.roll(height_m, 1, 1)) / texel_m
    slope_down = (np.roll(height_m, -1, 0) - np.roll(height_m, 1, 0)) / texel_m
    z = 1.0 / np.sqrt(1.0 + slope_x * slope_x + slope_down * slope_down)
    pixels = np.full((*height_m.shape, 4), 255, np.uint8)
    # Rows run downwards and green upwards, hence the sign of its slope.
    for channel, value in enumerate((-slope_x * z, slope_down * z, z)):
        pixels[..., channel] = value * np.float32(127.5) + np.float32(128.0)
    return Texture(pixels, is_srgb=False, source=source)


def roughness_texture(roughness: Field, source: str) -> Texture:
    """Roughness (H, W) in green, as glTF has it; blue (metallic) full, for the factor to scale."""
    pixels = np.full((*roughness.shape, 4), 255, np.uint8)
    pixels[..., 1] = np.clip(255.0 * roughness + 0.5, 0, 255)
    return Texture(pixels, is_srgb=False, source=source)


def patterned(
    name: str,
    tile_m: float,
    grey: Field,
    tints: Field | Rgb,
    height_m: Field,
    roughness: Field | float,
) -> Finish:
    """An opaque finish of images that repeat every `tile_m` metres, with relief `height_m`."""
    rough = (
        None if isinstance(roughness, float) else roughness_texture(roughness, f"{name} roughness")
    )
    material = Material(
        name=name,
        base_color=(1.0, 1.0, 1.0),
        base_color_texture=color_texture(grey, tints, name),
        metallic_roughness_texture=rough,
        normal_texture=normal_texture(height_m, tile_m, f"{name} normals"),
        roughness=roughness if isinstance(roughness, float) else 1.0,
        two_sided=False,
    )
    return Finish(material, tile_m)


@cache
def _srgb_table() -> U8:
    linear = np.arange(_STEPS + 1) / _STEPS
    return cast(U8, (255.0 * srgb_encode(linear) + 0.5).astype(np.uint8))
