"""airlight textures as Mitsuba bitmaps: wrapping, channels, normal maps and alpha cutoffs."""

from __future__ import annotations

from xml.etree.ElementTree import Element

import numpy as np
from numpy.typing import NDArray

from ..scene.checks import F32, Rgb
from ..scene.material import Material, Texture
from ..scene.texels import wrapped
from .mitsuba_files import FileStore, write_exr, write_png
from .mitsuba_xml import add_matrix, add_text, add_truth, plugin

OPACITY_UPSAMPLING = 4
MAX_OPACITY_PX = 8192


def linear_pixels(texture: Texture) -> F32:
    """(H, W, 3) float32, linear, of a texture's 8-bit pixels."""
    # The sRGB decoding, in single precision.
    x = texture.pixels[..., :3].astype(np.float32) / np.float32(255.0)
    if not texture.is_srgb:
        return x
    return np.where(x <= 0.04045, x / 12.92, ((x + 0.055) / 1.055) ** 2.4).astype(np.float32)


def add_bitmap(
    parent: Element, name: str, texture: Texture, filename: str, *, raw: bool, nearest: bool = False
) -> None:
    """A bitmap child with the texture's wrapping and uv transform."""
    node = plugin("texture", "bitmap", name)
    add_text(node, "filename", filename)
    add_text(node, "wrap_mode", _wrap(texture))
    if raw:
        add_truth(node, "raw", True)
    if nearest:
        add_text(node, "filter_type", "nearest")
    # Mitsuba wraps both axes alike: beside another mode a mirrored axis is unfolded into an image
    # twice as long, over which uv go half as fast.
    scale, offset = np.array(texture.scale), np.array(texture.offset)
    if "mirror" in texture.wrap and texture.wrap[0] != texture.wrap[1]:
        doubled = np.array([2.0 if mode == "mirror" else 1.0 for mode in texture.wrap])
        scale, offset = scale / doubled, offset / doubled
    if tuple(scale) != (1.0, 1.0) or tuple(offset) != (0.0, 0.0):
        matrix = np.diag([scale[0], scale[1], 1.0, 1.0])
        matrix[:2, 3] = offset  # Mitsuba drops the offset of a 3x3 matrix
        add_matrix(node, "to_uv", matrix)
    parent.append(node)


def _wrap(texture: Texture) -> str:
    """One mode for both axes; a mirrored axis beside another mode is unfolded into pixels."""
    u, v = texture.wrap
    if u == v:
        return u
    return "clamp" if "clamp" in (u, v) else "repeat"


def note_wrapping(material: Material, notes: list[str]) -> None:
    """Tells `notes` of each texture whose wrapping Mitsuba cannot say."""
    textures = (material.base_color_texture, material.normal_texture)
    for texture in (*textures, material.metallic_roughness_texture):
        if texture is not None and texture.wrap[0] != texture.wrap[1] and "clamp" in texture.wrap:
            notes.append(
                f"texture {texture.source or 'of ' + material.name}: clamped along one axis only, "
                "written as clamped along both"
            )


def unfolded(texture: Texture, pixels: F32) -> F32:
    """`pixels` as add_bitmap expects them: mirrored copies where the two axes wrap unlike."""
    u, v = texture.wrap
    if u != v and u == "mirror":
        pixels = np.concatenate([pixels, pixels[:, ::-1]], axis=1)
    if u != v and v == "mirror":
        pixels = np.concatenate([pixels, pixels[::-1]], axis=0)
    return pixels


def add_color_texture(
    parent: Element, name: str, texture: Texture, factor: Rgb, files: FileStore
) -> None:
    """The texture itself where its factor is 1, else linear float pixels times the factor."""
    # 8-bit pixels are stored as they are where nothing multiplies or unfolds them.
    key = (files.identity(texture.pixels), "color", texture.is_srgb, texture.wrap, factor)
    if factor == (1.0, 1.0, 1.0) and texture.is_srgb and texture.wrap[0] == texture.wrap[1]:
        pixels = texture.pixels[..., :3]
        filename = files.once(key, "color", "png", lambda path: write_png(path, pixels))
    else:
        filename = files.once(
            key,
            "color",
            "exr",
            lambda path: write_exr(
                path, unfolded(texture, linear_pixels(texture) * np.array(factor, np.float32))
            ),
        )
    add_bitmap(parent, name, texture, filename, raw=False)


def add_data_channel(
    parent: Element, name: str, texture: Texture, channel: int, factor: float, files: FileStore
) -> None:
    """One channel of a texture times `factor`, as raw float pixels."""
    key = (files.identity(texture.pixels), "data", channel, factor, texture.wrap)
    filename = files.once(
        key,
        name,
        "exr",
        lambda path: write_exr(
            path,
            unfolded(texture, texture.pixels[..., channel] * np.float32(factor / 255.0)),
        ),
    )
    add_bitmap(parent, name, texture, filename, raw=True)


def scaled_normals(texture: Texture, scale: float) -> F32:
    """Unit normals from -1..1 to 0..1, their tilt times `scale`."""
    # Bytes to vectors; only the tilt is scaled, and lengths become 1 again.
    n = texture.pixels[..., :3].astype(np.float32) / np.float32(127.5) - np.float32(1.0)
    n[..., :2] *= np.float32(scale)
    length = np.sqrt(np.einsum("ijk,ijk->ij", n, n))
    n /= np.maximum(length, np.float32(1e-6))[..., None]
    return unfolded(texture, np.float32(0.5) * n + np.float32(0.5))


def opaque(material: Material, texture: Texture) -> NDArray[np.uint8]:
    """255 where the filtered alpha reaches the cutoff, else 0."""
    # Alpha is compared on the finer grid, as if filtered first.
    alpha = texture.pixels[..., 3].astype(np.float32) * np.float32(material.alpha / 255.0)
    fine = _upsampled(unfolded(texture, alpha), texture)
    return np.where(fine >= material.alpha_cutoff, 255, 0).astype(np.uint8)


def _upsampled(alpha: F32, texture: Texture) -> F32:
    """Bilinear, `OPACITY_UPSAMPLING` times finer per axis where that stays within bounds."""
    for axis, mode in ((0, texture.wrap[1]), (1, texture.wrap[0])):
        # Texel centres of the fine grid, between which two coarse ones they lie, and how far along.
        count = alpha.shape[axis]
        factor = max(1, min(OPACITY_UPSAMPLING, MAX_OPACITY_PX // count))
        at = (np.arange(count * factor) + 0.5) / factor - 0.5
        low = np.floor(at).astype(np.int64)
        weight = (at - low).astype(np.float32)
        weight = weight[:, None] if axis == 0 else weight
        first, second = (np.take(alpha, wrapped(low + k, count, mode), axis=axis) for k in (0, 1))
        alpha = first * (1 - weight) + second * weight
    return alpha
