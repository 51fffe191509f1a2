"""What each material reflects over all directions, in small maps: what a gather ray needs of it.

A ray of a gather stands for a thousandth of all directions, in which texels of a map blur.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from ..gpu.device import Gpu
from ..gpu.layout import Struct, pack_array, u32, vec4f
from ..gpu.memory import buffer_of
from ..maths.arrays import F64
from ..maths.colour import srgb_decode
from ..maths.reflection import bihemispherical_albedo, grazing_albedo
from ..scene.material import Material, Texture
from ..surface.materials import reflecting_share, uv_transform
from ..surface.packed_maps import WRAP_BITS

_SIDE = 64  # texels of a map at most
_READ = 8  # pixels along a side that a texel is the mean of, at most
MOST_GRAZING = 0.0625
# Bits of a row: how its coordinates repeat, and whether its back is black.
_BLACK_BACK = 16


class AlbedoData(Struct):
    """Where a material's map is, and how mesh coordinates lie in it."""

    uv_transform = vec4f("scale, offset")
    first = u32("texel")
    width = u32("texels")
    height = u32("texels")
    wrap = u32("of u | of v << 2 | 16 where its back is black")


class Albedos:
    """The maps of `materials`, in their order."""

    def __init__(self, gpu: Gpu, materials: Sequence[Material]) -> None:
        rows, texels, first = [], [], 0
        # Maps one after the other, each at its own small size.
        for material in materials:
            found = albedo_map(material)
            # Coordinates go by the map that the texels are made of.
            map = material.base_color_texture or material.metallic_roughness_texture
            wrap = map.wrap if map else ("repeat", "repeat")
            rows.append(
                {
                    "uv_transform": uv_transform(map),
                    "first": first,
                    "width": found.shape[1],
                    "height": found.shape[0],
                    "wrap": WRAP_BITS[wrap[0]]
                    | WRAP_BITS[wrap[1]] << 2
                    | _BLACK_BACK * (not material.two_sided),
                }
            )
            # The texels of all materials lie in one buffer, where the rows find them.
            texels.append(packed(found).ravel())
            first += found.shape[0] * found.shape[1]
        self.rows = buffer_of(gpu, "albedo maps", pack_array(AlbedoData, rows))
        self.texels = buffer_of(gpu, "albedo texels", np.concatenate(texels))

    @property
    def bound(self) -> dict[str, object]:
        """By slot name, for `wgsl/hit_albedo.wgsl`."""
        return {"albedo_rows": self.rows, "albedo_texels": self.texels}


def albedo_map(material: Material) -> F64:
    """(H, W, 4): albedo over the material's base-colour map, and what grazing light adds to it.

    Their sum is the bihemispherical albedo, which light from all around meets; local and
    directional lights, which seldom graze, meet the first alone. One texel where there is no map.
    Metallic and roughness vary with it where their map lies as it does, and are means else.
    """
    colour_map, gloss_map = material.base_color_texture, material.metallic_roughness_texture
    size = _size(colour_map or gloss_map)
    colour = np.tile(np.asarray(material.base_color, np.float64), (*size, 1))
    # Parameters at each texel of the colour; the gloss is its mean where both maps lie apart.
    metallic, roughness = np.full(size, material.metallic), np.full(size, material.roughness)
    if colour_map is not None:
        colour = colour * reduced(colour_map, size)
    colour *= reflecting_share(material)
    if gloss_map is not None:
        is_alike = colour_map is None or uv_transform(colour_map) == uv_transform(gloss_map)
        gloss = reduced(gloss_map, size if is_alike else (1, 1))
        metallic, roughness = metallic * gloss[..., 2], roughness * gloss[..., 1]
    # Reflected of light from all around: what the coat adds by grazing it is apart, in a.
    flat = [x.reshape(-1) for x in (metallic, roughness, np.full(size, material.specular))]
    whole = bihemispherical_albedo(colour.reshape(-1, 3), *flat)
    grazing = grazing_albedo(colour.reshape(-1, 3), *flat)
    return np.concatenate([whole - grazing[:, None], grazing[:, None]], axis=1).reshape(*size, 4)


def packed(albedo: F64) -> NDArray[np.uint32]:
    """(H, W): square roots of the first three of (H, W, 4), and the last over MOST_GRAZING.

    A byte each.
    """
    # Square roots leave dark colours more of a byte's steps.
    values = np.concatenate(
        [np.sqrt(np.clip(albedo[..., :3], 0.0, 1.0)), albedo[..., 3:] / MOST_GRAZING], axis=-1
    )
    byte = np.round(255.0 * np.clip(values, 0.0, 1.0)).astype(np.uint32)
    return np.asarray((byte << np.array([0, 8, 16, 24], np.uint32)).sum(axis=-1, dtype=np.uint32))


def _size(map: Texture | None) -> tuple[int, int]:
    if map is None:
        return (1, 1)
    # No more texels than a ray of a gather can tell apart.
    height, width = map.pixels.shape[:2]
    return (min(height, _SIDE), min(width, _SIDE))


def reduced(map: Texture, size: tuple[int, int]) -> F64:
    """(H, W, 3): the linear means of a map over blocks of its pixels."""
    pixels = map.pixels[..., :3]
    # Values of 8 bits become linear by a table.
    table = np.arange(256) / 255.0
    table = srgb_decode(table) if map.is_srgb else table
    for axis, count in enumerate(size):
        # Of wide blocks some rows stand for all.
        step = max(1, pixels.shape[axis] // (count * _READ))
        pixels = pixels[(slice(None),) * axis + (slice(step // 2, None, step),)]
    # Means of linear colours, along one axis after the other; blocks differ by one row at most.
    values = table[pixels]
    for axis, count in enumerate(size):
        starts = np.arange(count) * values.shape[axis] // count
        lengths = np.diff(np.append(starts, values.shape[axis]))
        shape = [1, 1, 1]
        shape[axis] = count
        values = np.add.reduceat(values, starts, axis=axis) / lengths.reshape(shape)
    return np.asarray(values)
