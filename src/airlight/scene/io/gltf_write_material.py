"""Materials and textures in glTF's terms, for `gltf_write`."""

from __future__ import annotations

from collections.abc import Callable
from typing import IO, Any

import numpy as np
from PIL import Image

from ...maths.arrays import U8
from ...maths.colour import srgb_decode, srgb_encode
from ..material import Material, Texture
from .gltf_material import BLACK_BACK

Json = dict[str, Any]
TextureRow = Callable[[U8, Json], int]
"""Gives the row of a texture of pixels and a sampler."""
_WRAPS = {"repeat": 10497, "mirror": 33648, "clamp": 33071}


def material_json(
    material: Material, row: TextureRow, extensions: set[str], notes: list[str]
) -> Json:
    """A material; `extensions` gets the names of those that it uses."""
    # What every material has: the metallic-roughness model.
    made = _Textures(material, row, extensions, notes)
    reflection: Json = {
        "baseColorFactor": [*material.base_color, material.alpha],
        "metallicFactor": material.metallic,
        "roughnessFactor": material.roughness,
    }
    made.put(reflection, "baseColorTexture", material.base_color_texture, is_colour=True)
    made.put(reflection, "metallicRoughnessTexture", material.metallic_roughness_texture)
    item: Json = {"pbrMetallicRoughness": reflection, "doubleSided": material.two_sided}
    # glTF knows no black back: it goes with the extras, for our own reader.
    if material.has_black_back and not material.two_sided:
        item["extras"] = {BLACK_BACK: True}
    if material.name:
        item["name"] = material.name
    # Relief and holes.
    if made.put(item, "normalTexture", material.normal_texture):
        item["normalTexture"]["scale"] = material.normal_scale
    if material.alpha_cutoff > 0.0:
        item |= {"alphaMode": "MASK", "alphaCutoff": material.alpha_cutoff}
    elif material.is_blended:
        item["alphaMode"] = "BLEND"
    # What extensions say.
    held: Json = {}
    if material.transmission > 0.0:
        held["KHR_materials_transmission"] = {"transmissionFactor": material.transmission}
    if material.is_unlit:
        held["KHR_materials_unlit"] = {}
    if material.specular < 1.0:
        held["KHR_materials_specular"] = {"specularFactor": material.specular}
    # Emission; what is beyond 1 is a factor of its own.
    strength = max(material.emission)
    if strength > 0.0:
        item["emissiveFactor"] = [c / max(strength, 1.0) for c in material.emission]
        made.put(item, "emissiveTexture", material.emission_texture, is_colour=True)
    if strength > 1.0:
        held["KHR_materials_emissive_strength"] = {"emissiveStrength": strength}
    extensions |= held.keys()
    return item | ({"extensions": held} if held else {})


class _Textures:
    """Puts the textures of one material into what refers to them."""

    def __init__(
        self, material: Material, row: TextureRow, extensions: set[str], notes: list[str]
    ) -> None:
        self._material, self._row = material, row
        self._extensions, self._notes = extensions, notes

    def put(
        self, item: Json, key: str, texture: Texture | None, *, is_colour: bool = False
    ) -> bool:
        """`item[key]` for a texture; False without one. Colours are sRGB, everything else not."""
        if texture is None:
            return False
        # glTF fixes the coding by the slot, so an image of the other coding is converted.
        pixels = texture.pixels
        if texture.is_srgb != is_colour:
            pixels = _recoded(pixels, is_srgb=is_colour)
            self._notes.append(
                f"material '{self._material.name}': an image is coded again, as glTF wants it"
            )
        # Wrapping is a sampler's, scale and offset are an extension's.
        u, v = texture.wrap
        found: Json = {"index": self._row(pixels, {"wrapS": _WRAPS[u], "wrapT": _WRAPS[v]})}
        if (texture.scale, texture.offset) != ((1.0, 1.0), (0.0, 0.0)):
            placed = {"scale": list(texture.scale), "offset": list(texture.offset)}
            found["extensions"] = {"KHR_texture_transform": placed}
            self._extensions.add("KHR_texture_transform")
        item[key] = found
        return True


def _recoded(pixels: U8, *, is_srgb: bool) -> U8:
    """Linear pixels as sRGB, or the reverse; alpha stays."""
    values = pixels[..., :3] / 255.0
    coded = srgb_encode(values) if is_srgb else srgb_decode(values)
    rgb = np.clip(np.round(255.0 * coded), 0, 255).astype(np.uint8)
    return np.concatenate([rgb, pixels[..., 3:]], axis=-1)


def texture_png(pixels: U8, file: IO[bytes]) -> None:
    """Write pixels (H, W, 4) as PNG, without alpha where all of it is 255."""
    # An alpha channel of nothing but 255 would only make the file larger.
    is_opaque = bool((pixels[..., 3] == 255).all())
    Image.fromarray(np.ascontiguousarray(pixels[..., :3] if is_opaque else pixels)).save(
        file, "PNG"
    )
