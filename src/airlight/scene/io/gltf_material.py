"""glTF materials and textures as airlight's, with a word on everything that is approximated.

airlight has no see-through surfaces: alphaMode BLEND and transmission become a cut at one half.
"""

from __future__ import annotations

import dataclasses
from typing import Any

import numpy as np

from ...errors import SceneError
from ..material import DEFAULT_MATERIAL, Material, Texture, Wrap
from .gltf_buffers import Buffers, uri_bytes, uri_file
from .gltf_json import Item
from .images import read_texture
from .texture_files import missing_texture

_WRAPS: dict[int, Wrap] = {10497: "repeat", 33648: "mirror", 33071: "clamp"}
_UNDERSTOOD = {
    "KHR_materials_emissive_strength": {"emissiveStrength"},
    "KHR_materials_ior": {"ior"},
    "KHR_materials_pbrSpecularGlossiness": {
        "diffuseFactor",
        "diffuseTexture",
        "glossinessFactor",
        "specularFactor",
        "specularGlossinessTexture",  # said as a whole: a dielectric
    },
    "KHR_materials_specular": {"specularFactor"},
    "KHR_materials_transmission": {"transmissionFactor"},
    "KHR_materials_unlit": set(),
}
"""By extension, what of it is read."""


@dataclasses.dataclass(frozen=True, eq=False)
class PlacedMaterial:
    """A material and the texture coordinate set (TEXCOORD_n) that its images use."""

    material: Material
    uv_set: int


class Materials:
    """The materials of a document, each made once; trouble goes to `warnings`."""

    def __init__(self, document: Item, buffers: Buffers) -> None:
        self.warnings: list[str] = []
        self.items = document.items("materials")
        self._buffers = buffers
        self._textures = document.items("textures")
        self._images = document.items("images")
        self._samplers = document.items("samplers")
        self._made: dict[int, PlacedMaterial] = {}
        self._pixels: dict[tuple[int, bool], Texture] = {}

    def of(self, primitive: Item) -> PlacedMaterial:
        """The material of a primitive, or the default one."""
        if not primitive.has("material"):
            return PlacedMaterial(DEFAULT_MATERIAL, 0)
        k = primitive.index("material", self.items, "materials")
        if k not in self._made:
            self._made[k] = self._material(self.items[k])
        return self._made[k]

    def _material(self, item: Item) -> PlacedMaterial:
        values: dict[str, Any] = {
            "name": item.text("name") or item.place,
            "two_sided": item.flag("doubleSided"),
        }
        sets: list[int] = []
        self._reflection(item, values, sets)
        normal = item.child("normalTexture")
        values["normal_texture"] = self._texture(item, "normalTexture", sets, is_srgb=False)
        values["normal_scale"] = normal.number("scale", 1.0)
        self._emission(item, values, sets)
        self._coverage(item, values)
        if len(set(sets)) > 1:
            self._warn(item, f"its images use texture coordinates {sorted(set(sets))}; one is used")
        return PlacedMaterial(Material(**values), sets[0] if sets else 0)

    def _reflection(self, item: Item, values: dict[str, Any], sets: list[int]) -> None:
        """Base colour, alpha, roughness, metallic and specular."""
        extensions = item.child("extensions")
        if extensions.has("KHR_materials_pbrSpecularGlossiness"):
            old = extensions.child("KHR_materials_pbrSpecularGlossiness")
            factor = old.floats("diffuseFactor", 4, (1.0,) * 4)
            values["base_color_texture"] = self._texture(old, "diffuseTexture", sets)
            values["roughness"] = _unit(1.0 - old.number("glossinessFactor", 1.0))
            self._warn(item, "specular-glossiness is approximated as a dielectric")
        else:
            pbr = item.child("pbrMetallicRoughness")
            factor = pbr.floats("baseColorFactor", 4, (1.0,) * 4)
            values["base_color_texture"] = self._texture(pbr, "baseColorTexture", sets)
            values["metallic"] = _unit(pbr.number("metallicFactor", 1.0))
            values["roughness"] = _unit(pbr.number("roughnessFactor", 1.0))
            values["metallic_roughness_texture"] = self._texture(
                pbr, "metallicRoughnessTexture", sets, is_srgb=False
            )
        values["base_color"] = tuple(_unit(c) for c in factor[:3])
        values["alpha"] = _unit(factor[3])
        values["specular"] = _specular(extensions)
        if extensions.has("KHR_materials_unlit"):
            values |= {"metallic": 0.0, "roughness": 1.0, "specular": 0.0}
            self._warn(item, "unlit is not supported, the surface is lit as a matte one")
        for name in extensions.keys():  # noqa: SIM118
            if not name.startswith("KHR_materials_"):
                continue
            if name not in _UNDERSTOOD:
                self._warn(item, f"{name} is not supported and left out")
            elif unread := set(extensions.child(name).keys()) - _UNDERSTOOD[name]:
                self._warn(item, f"{', '.join(sorted(unread))} of {name} left out")

    def _emission(self, item: Item, values: dict[str, Any], sets: list[int]) -> None:
        factor = item.floats("emissiveFactor", 3, (0.0, 0.0, 0.0))
        strength = item.at("extensions", "KHR_materials_emissive_strength").number(
            "emissiveStrength", 1.0
        )
        values["emission"] = tuple(max(c * strength, 0.0) for c in factor)
        if max(values["emission"]) > 0.0:
            values["emission_texture"] = self._texture(item, "emissiveTexture", sets)

    def _coverage(self, item: Item, values: dict[str, Any]) -> None:
        """alpha and alpha_cutoff of alphaMode and transmission."""
        mode = item.text("alphaMode", "OPAQUE")
        transmission = item.at("extensions", "KHR_materials_transmission").number(
            "transmissionFactor", 0.0
        )
        if mode == "MASK":
            values["alpha_cutoff"] = _unit(item.number("alphaCutoff", 0.5))
        elif mode == "BLEND" or transmission > 0.0:
            values["alpha"] = _unit((values["alpha"] if mode == "BLEND" else 1.0) - transmission)
            values["alpha_cutoff"] = 0.5
            self._warn(
                item, "see-through surfaces are not rendered: it is opaque where alpha is above 0.5"
            )
        elif mode == "OPAQUE":
            values["alpha"] = 1.0
        else:
            raise item.child("alphaMode").error(f"'{mode}' is unknown")

    def _texture(
        self, parent: Item, key: str, sets: list[int], *, is_srgb: bool = True
    ) -> Texture | None:
        """The texture that parent[key] names, placed by KHR_texture_transform."""
        if not parent.has(key):
            return None
        info = parent.child(key)
        texture = self._textures[info.index("index", self._textures, "textures")]
        pixels = self._image(texture, is_srgb=is_srgb)
        transform = info.at("extensions", "KHR_texture_transform")
        sets.append(transform.integer("texCoord", info.integer("texCoord", 0)))
        if transform.number("rotation", 0.0) != 0.0:
            self._warn(info, "the rotation of its image is left out")
        if pixels is None:
            return None
        su, sv = transform.floats("scale", 2, (1.0, 1.0))
        ou, ov = transform.floats("offset", 2, (0.0, 0.0))
        return dataclasses.replace(
            pixels, wrap=self._wrap(texture), scale=(su, sv), offset=(ou, ov)
        )

    def _wrap(self, texture: Item) -> tuple[Wrap, Wrap]:
        if not texture.has("sampler"):
            return ("repeat", "repeat")
        sampler = self._samplers[texture.index("sampler", self._samplers, "samplers")]
        u, v = (_WRAPS.get(sampler.integer(key, 10497), "repeat") for key in ("wrapS", "wrapT"))
        return (u, v)

    def _image(self, texture: Item, *, is_srgb: bool) -> Texture | None:
        """The pixels of a texture; where they cannot be had, a stand-in for colours."""
        webp = texture.at("extensions", "EXT_texture_webp")
        source = webp if webp.has("source") else texture
        if not source.has("source"):
            names = ", ".join(texture.child("extensions").keys()) or "nothing"
            self._warn(
                texture,
                f"has no image that airlight can read, but {names}; a magenta checker stands in",
            )
            return missing_texture(texture.place) if is_srgb else None
        k = source.index("source", self._images, "images")
        if (k, is_srgb) not in self._pixels:
            image = self._images[k]
            name = image.text("uri")[:200] if not image.text("uri").startswith("data:") else ""
            where = f"{image.file}: {image.place}{f' ({name})' if name else ''}"
            if image.has("uri") and not image.text("uri").startswith("data:"):
                uri_file(image, self._buffers.folder)  # one of another place is no mere loss
            try:
                raw = self._image_bytes(image)
                self._pixels[k, is_srgb] = read_texture(raw, is_srgb=is_srgb, source=where)
            except SceneError as error:
                if not is_srgb:
                    self.warnings.append(f"{where}: {error.problem}; the surface goes without")
                    return None
                self.warnings.append(f"{where}: {error.problem}; a magenta checker stands in")
                self._pixels[k, is_srgb] = missing_texture(where)
        return self._pixels[k, is_srgb]

    def _image_bytes(self, image: Item) -> bytes:
        if image.has("bufferView"):
            return bytes(self._buffers.view(image)[0])
        if not image.has("uri"):
            raise image.error("has neither 'uri' nor 'bufferView'")
        return uri_bytes(image, self._buffers.folder)

    def _warn(self, item: Item, problem: str) -> None:
        name = item.text("name")
        self.warnings.append(f"{item.file}: {item.place}{f' ({name})' if name else ''}: {problem}")


def _specular(extensions: Item) -> float:
    """Scale of the dielectric reflectance 0.04, from KHR_materials_ior and _specular."""
    ior = extensions.child("KHR_materials_ior").number("ior", 1.5)
    reflectance = ((ior - 1.0) / (ior + 1.0)) ** 2 if ior > 0.0 else 1.0
    factor = extensions.child("KHR_materials_specular").number("specularFactor", 1.0)
    return _unit(factor * reflectance / 0.04)


def _unit(value: float) -> float:
    return float(np.clip(value, 0.0, 1.0))
