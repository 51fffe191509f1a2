"""Material textures on the device, with mip chains filtered in linear light."""

from __future__ import annotations

from collections.abc import Hashable, Mapping
from functools import cache, cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..gpu.device import Gpu
from ..gpu.memory import Buffer, Sampler, Texture, buffer_of
from ..gpu.uploads import Lease
from ..maths.colour import srgb_decode, srgb_encode
from ..scene.fingerprint import array_digest
from ..scene.material import Material, Wrap
from ..scene.material import Texture as SceneTexture
from .packed_maps import (
    Location,
    PackedMaps,
    image_of,
    most_texels,
    packed_sets,
    uses_visibility_buffer,
)

_WRAPS: dict[Wrap, str] = {"repeat": "repeat", "mirror": "mirror-repeat", "clamp": "clamp-to-edge"}


class TextureStore:
    """The textures of a scene on the device, each image once, however many textures show it.

    Scenes on one device share images that are the same, and maps packed of the same images. One
    sampler is cached for each kind of wrapping.
    """

    def __init__(self, gpu: Gpu) -> None:
        self.gpu = gpu
        self._textures: dict[tuple[int, bool], tuple[SceneTexture, Lease[Texture]]] = {}
        self._samplers: dict[tuple[Wrap, Wrap], Sampler] = {}
        self._chains: dict[tuple[int, bool], tuple[SceneTexture, list[NDArray[np.uint8]]]] = {}
        self._images: dict[tuple[int, bool], tuple[SceneTexture, Hashable]] = {}
        self._packed: list[Lease[tuple[dict[Hashable, Location | None], Buffer]]] = []
        self.white = _solid(gpu, "white", (255, 255, 255, 255))
        self.flat_normal = _solid(gpu, "flat normal", (128, 128, 255, 255))

    def get(self, texture: SceneTexture | None, default: Texture) -> Texture:
        """The device's copy of `texture`."""
        if texture is None:
            return default

        # Identical images of other scenes on the device are found by their digest.
        found = self._textures.get(image_of(texture))
        if found is None:
            key = ("texture", self._image(texture))
            lease = self.gpu.uploads.lease(
                self.gpu, key, lambda gpu: _uploaded(gpu, texture, self.chain(texture))
            )
            found = self._textures[image_of(texture)] = (texture, lease)
        return found[1].value

    def chain(self, texture: SceneTexture) -> list[NDArray[np.uint8]]:
        """Its mip chain; cached until it is packed, on devices that pack maps."""
        found = self._chains.get(image_of(texture))
        if found is None:
            found = (texture, mip_chain(texture.pixels, is_srgb=texture.is_srgb))
            if uses_visibility_buffer(self.gpu):
                self._chains[image_of(texture)] = found
        return found[1]

    def packed(self, materials: list[Material]) -> tuple[list[Location | None], Buffer]:
        """Where the maps of each of the `materials` are in one buffer, and that buffer.

        Scenes whose materials have the same maps share it.
        """
        # Lookups share a buffer where the sets of maps are the same, whatever the factors beside
        # them.
        keys, sets = packed_sets(materials, self._image)
        most = most_texels(self.gpu)

        def make(gpu: Gpu) -> tuple[dict[Hashable, Location | None], Buffer]:
            maps = PackedMaps(sets, self.chain, most)
            return maps.locations, buffer_of(gpu, "packed maps", maps.texels)

        lease = self.gpu.uploads.lease(self.gpu, ("packed maps", most, *sets), make)
        self._packed.append(lease)
        # Mip chains were held for packing alone.
        self._chains.clear()
        locations, texels = lease.value
        return [None if key is None else locations[key] for key in keys], texels

    def _image(self, texture: SceneTexture) -> Hashable:
        """A key that textures of the same texels share, of whatever scene."""
        # The image's digest is taken once, however many textures show it.
        found = self._images.get(image_of(texture))
        if found is None:
            found = (texture, (array_digest(texture.pixels), texture.is_srgb))
            self._images[image_of(texture)] = found
        return found[1]

    def sampler(self, texture: SceneTexture | None) -> Sampler:
        """Trilinear; shaders see to footprints that are longer than wide (wgsl/footprint.wgsl)."""
        wrap: tuple[Wrap, Wrap] = texture.wrap if texture else ("repeat", "repeat")
        if wrap not in self._samplers:
            self._samplers[wrap] = Sampler(
                self.gpu,
                f"material {wrap}",
                mag_filter="linear",
                min_filter="linear",
                mipmap_filter="linear",
                address_mode_u=_WRAPS[wrap[0]],
                address_mode_v=_WRAPS[wrap[1]],
            )
        return self._samplers[wrap]


class MaterialTextures:
    """The maps of a material on the device, uploaded when they are first drawn.

    CPU adapters shade most materials from packed maps, and never bind these.
    """

    def __init__(self, store: TextureStore, maps: Mapping[str, SceneTexture | None]) -> None:
        """`maps` by name: base_color, normal and so on."""
        self._store, self._maps = store, maps

    @cached_property
    def bound(self) -> dict[str, Texture | Sampler]:
        """Textures and samplers by slot name."""
        # Without a map, white leaves the factors as they are, and a flat normal the surface's.
        store, found = self._store, dict[str, Texture | Sampler]()
        for name, texture in self._maps.items():
            default = store.flat_normal if name == "normal" else store.white
            found[f"{name}_map"] = store.get(texture, default)
            found[f"{name}_sampler"] = store.sampler(texture)
        return found


def _solid(gpu: Gpu, label: str, rgba: tuple[int, int, int, int]) -> Texture:
    made = Texture(gpu, label, (1, 1), "rgba8unorm")
    made.write(np.array([[rgba]], np.uint8))
    return made


def _uploaded(gpu: Gpu, texture: SceneTexture, chain: list[NDArray[np.uint8]]) -> Texture:
    # Codes stay sRGB on the device, whose samplers decode before they filter.
    height, width = texture.pixels.shape[:2]
    format = "rgba8unorm-srgb" if texture.is_srgb else "rgba8unorm"
    made = Texture(gpu, texture.source or "texture", (width, height), format, mips=len(chain))
    for level, pixels in enumerate(chain):
        made.write(pixels, mip=level)
    return made


def mip_chain(pixels: NDArray[np.uint8], *, is_srgb: bool) -> list[NDArray[np.uint8]]:
    """`pixels` (H, W, 4) and its halvings down to 1x1.

    Colour is averaged in linear light, weighted by alpha so that the hidden colour of cut-out
    texels does not bleed in.
    """
    chain = [np.ascontiguousarray(pixels)]
    decoded, encoded = _tables(is_srgb)
    # Halved in linear light, and encoded level by level.
    level = np.empty(pixels.shape, np.float32)
    level[..., :3] = decoded[pixels[..., :3]]
    level[..., 3] = pixels[..., 3] / np.float32(255.0)
    is_opaque = bool((pixels[..., 3] == 255).all())
    while max(level.shape[:2]) > 1:
        level = _halved(level, is_opaque=is_opaque)
        coded = np.empty(level.shape, np.uint8)
        coded[..., :3] = encoded[(level[..., :3] * 65535.0 + 0.5).astype(np.uint16)]
        coded[..., 3] = level[..., 3] * 255.0 + 0.5
        chain.append(coded)
    return chain


@cache
def _tables(is_srgb: bool) -> tuple[NDArray[np.float32], NDArray[np.uint8]]:
    """Linear light of each of 256 codes; the code of each of 65536 steps of linear light."""
    codes, light = np.arange(256) / 255.0, np.arange(65536) / 65535.0
    if is_srgb:
        codes, light = srgb_decode(codes), srgb_encode(light)
    return codes.astype(np.float32), (light * 255.0 + 0.5).astype(np.uint8)


def _halved(level: NDArray[Any], *, is_opaque: bool) -> NDArray[Any]:
    # Even sides; a last odd row or column is left out.
    height, width = level.shape[:2]
    if height > 1 and height % 2:
        level = level[:-1]
    if width > 1 and width % 2:
        level = level[:, :-1]
    # The four texels that become one.
    rows = (level[0::2], level[1::2]) if level.shape[0] > 1 else (level, level)
    quads = [
        q
        for row in rows
        for q in ((row[:, 0::2], row[:, 1::2]) if level.shape[1] > 1 else (row, row))
    ]
    # Colours count by their alpha: what is not there has none.
    if is_opaque:
        return np.asarray((quads[0] + quads[1] + quads[2] + quads[3]) * np.float32(0.25))
    alpha = sum(q[..., 3:] for q in quads)
    weighted = sum(q[..., :3] * q[..., 3:] for q in quads)
    plain = sum(q[..., :3] for q in quads) * 0.25
    colour = np.where(alpha > 0.0, weighted / np.maximum(alpha, 1e-6), plain)
    return np.concatenate([colour, alpha * 0.25], axis=-1)
