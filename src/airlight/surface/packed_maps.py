"""Material maps of all materials in one buffer, for shaders that filter them themselves.

CPU adapters shade whole blocks of pixels for each triangle. A pass over the image shades each pixel
once, but cannot bind other textures for each pixel. Here a texel is 8 bytes: base colour, normal
and roughness, so that one load serves all three maps.
"""

from __future__ import annotations

from collections.abc import Callable, Hashable, Mapping, Sequence
from functools import cache

import numpy as np
from numpy.typing import NDArray

from ..gpu.demands import largest_binding
from ..gpu.device import Gpu
from ..maths.colour import srgb_decode
from ..scene.material import Material, Texture, Wrap

HAS_NORMAL, HAS_ROUGHNESS, HAS_BASE, ONE_SIDED = 1, 2, 4, 8
WRAP_BITS: dict[Wrap, int] = {"repeat": 0, "mirror": 1, "clamp": 2}
WRAP_U_SHIFT, WRAP_V_SHIFT = 4, 6  # wgsl/packed_maps.wgsl knows these bits
_MOST_SIDE = 65535
_TEXEL_BYTES, _MOST_BYTES = 8, 1 << 29


def uses_visibility_buffer(gpu: Gpu) -> bool:
    """Whether the visibility buffer is the faster way on a device, so that maps are packed."""
    return gpu.paths.visibility_buffer and "shader-int64" in gpu.features


def most_texels(gpu: Gpu) -> int:
    """The most texels of all maps together, in one storage buffer of at most 512 MB.

    Where a driver binds no more than 128 MB, a single map of 4096 x 4096 texels and its mip levels
    do not fit.
    """
    return min(_MOST_BYTES, largest_binding(gpu)) // _TEXEL_BYTES


def is_packable(m: Material) -> bool:
    """Whether the maps share size and transform, and none is of emission or varying metal.

    Translucent materials are not, either: their triangles are drawn one behind the other; nor
    unlit ones, which follow the exposure.
    """
    # One lookup serves all maps only where they are laid out alike.
    maps = _maps(m)
    alike = {(t.pixels.shape, t.wrap, t.scale, t.offset) for t in maps}
    linear = not any(t.is_srgb for t in (m.metallic_roughness_texture, m.normal_texture) if t)
    sides = [side for t in maps for side in t.pixels.shape[:2]]
    return (
        m.emission_texture is None
        and not m.is_translucent
        and not m.is_unlit
        and len(alike) <= 1
        and linear
        and max(sides, default=0) <= _MOST_SIDE
        and metallic_factor(m) is not None
    )


def metallic_factor(m: Material) -> float | None:
    """The factor that the maps apply to the material's metallic; None where it varies."""
    texture = m.metallic_roughness_texture

    # A constant channel is a factor, and needs no texel.
    if texture is None or m.metallic == 0.0:
        return 1.0
    metallic = texture.pixels[..., 2]
    return float(metallic.flat[0]) / 255.0 if (metallic == metallic.flat[0]).all() else None


def _maps(m: Material) -> list[Texture]:
    found = (m.base_color_texture, m.metallic_roughness_texture, m.normal_texture)
    return [t for t in found if t is not None]


def image_of(texture: Texture) -> tuple[int, bool]:
    """A key that is equal for textures of the same image, valid while one of them exists."""
    return (id(texture.pixels), texture.is_srgb)


Location = tuple[int, int, int, int]
"""(first, width | height << 16, flags, levels) of a material's maps among packed ones.

At `first` stands a table of where each level and the one after it begin.
"""
Maps = tuple[Texture | None, Texture | None, Texture | None]
"""Base colour, roughness, normal."""


def packed_sets(
    materials: Sequence[Material], image: Callable[[Texture], Hashable]
) -> tuple[list[Hashable | None], dict[Hashable, Maps]]:
    """The maps of each of the `materials` by a key, None where they are not packable; by key.

    `image` returns what a texture's texels are identified by.
    """
    # Equal sets of images share one key; factors and transforms are the material's own.
    keys: list[Hashable | None] = []
    sets: dict[Hashable, Maps] = {}
    for m in materials:
        if not is_packable(m):
            keys.append(None)
            continue
        maps = (m.base_color_texture, m.metallic_roughness_texture, m.normal_texture)
        keys.append(tuple(None if t is None else (image(t), t.wrap) for t in maps))
        sets.setdefault(keys[-1], maps)
    return keys, sets


class PackedMaps:
    """`texels` (N, 2) uint32; `locations` says where in them maps are, by their key.

    None for those that are too large beside others.
    """

    def __init__(
        self,
        sets: Mapping[Hashable, Maps],
        chain: Callable[[Texture], list[NDArray[np.uint8]]],
        most: int,
    ) -> None:
        """`chain` returns a texture's mip chain; there are at most `most` texels."""
        self._chain, self._most = chain, most
        self._parts: list[NDArray[np.uint32]] = []
        self._length = 0
        self.locations: dict[Hashable, Location | None] = {
            key: self._add(*maps) for key, maps in sets.items()
        }

    @property
    def texels(self) -> NDArray[np.uint32]:
        """All texels, and one that is 0, so that there is always one."""
        return np.concatenate([*self._parts, np.zeros((1, 2), np.uint32)])

    def _add(
        self, base: Texture | None, rough: Texture | None, normal: Texture | None
    ) -> Location | None:
        some = base or rough or normal
        if some is None:
            return (0, 1 | 1 << 16, 0, 1)
        if self._length + _count(*some.pixels.shape[:2]) >= self._most:  # `texels` has one more
            return None
        # All mip levels of the three maps, texel by texel in one word pair.
        chains = [None if t is None else self._chain(t) for t in (base, rough, normal)]
        levels = next(len(chain) for chain in chains if chain is not None)
        is_srgb = bool(base and base.is_srgb)
        packed = [
            _packed(*(chain[level] if chain else None for chain in chains), is_srgb=is_srgb)
            for level in range(levels)
        ]
        # Where each level and the next one begin, then the levels.
        first = self._length
        begins = first + levels + np.cumsum([0, *(len(p) for p in packed)])[:levels]
        table = np.stack([begins, np.append(begins[1:], begins[-1])], axis=1).astype(np.uint32)
        self._parts += [table, *packed]
        self._length += levels + sum(len(p) for p in packed)
        # Which maps there are, and how coordinates wrap.
        flags = HAS_NORMAL * (normal is not None) + HAS_ROUGHNESS * (rough is not None)
        flags += HAS_BASE * (base is not None)
        flags |= WRAP_BITS[some.wrap[0]] << WRAP_U_SHIFT | WRAP_BITS[some.wrap[1]] << WRAP_V_SHIFT
        height, width = some.pixels.shape[:2]
        return (first, width | height << 16, flags, levels)


def _count(height: int, width: int) -> int:
    """The texels of a map, its mip levels and their table."""
    levels = range(max(height, width).bit_length())
    return len(levels) + sum(max(height >> k, 1) * max(width >> k, 1) for k in levels)


def _packed(
    base: NDArray[np.uint8] | None,
    rough: NDArray[np.uint8] | None,
    normal: NDArray[np.uint8] | None,
    *,
    is_srgb: bool,
) -> NDArray[np.uint32]:
    """One mip level (texels, 2): square roots of linear light, 10 bits each; normal, roughness."""
    # Channels without a map are all ones, so that factors hold alone.
    some = next(level for level in (base, rough, normal) if level is not None)
    texels = np.full((some.shape[0] * some.shape[1], 2), 0xFFFFFFFF, np.uint32)
    # The root of light spends its 10 bits where the eye tells colours apart.
    if base is not None:
        codes = _roots(is_srgb)[base.reshape(-1, 4)[:, :3]]
        texels[:, 0] = codes[:, 0] | codes[:, 1] << 10 | codes[:, 2] << 20

    # The second word: three bytes of the normal, one of roughness (green in glTF).
    surface = texels.view(np.uint8)[:, 4:8]
    if normal is not None:
        surface[:, :3] = normal.reshape(-1, 4)[:, :3]
    if rough is not None:
        surface[:, 3] = rough.reshape(-1, 4)[:, 1]
    return texels


@cache
def _roots(is_srgb: bool) -> NDArray[np.uint32]:
    """Square roots of the linear light of 256 codes, scaled to 1023: a shader squares them."""
    codes = np.arange(256) / 255.0
    light = srgb_decode(codes) if is_srgb else codes
    return np.round(np.sqrt(light) * 1023.0).astype(np.uint32)
