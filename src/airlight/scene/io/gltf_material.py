"""glTF materials and textures as airlight's, with a word on everything that is approximated.

alphaMode BLEND is coverage, transmission thin glass: light passes both unbent.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping
from typing import Any

import numpy as np

from ...errors import SceneError
from ..material import DEFAULT_MATERIAL, Material, Texture, Wrap, specular_of
from .gltf_buffers import Buffers, uri_bytes, uri_file
from .gltf_json import Item
from .gltf_uv import ImageUse, UvFrame, image_use, shared_frame
from .gltf_variants import variant_number, worn
from .images import read_texture
from .texture_files import missing_texture

_WRAPS: dict[int, Wrap] = {10497: "repeat", 33648: "mirror", 33071: "clamp"}
CLEAR_ROUGHNESS = 0.25
"""Up to which glass shows what is behind it all but sharp."""
BLACK_BACK = "airlight_black_back"
"""In a material's extras: its back is black, and not culled."""
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
    """A material, and the texture coordinates that its images read; where no frame serves all,
    `apart` has each image's own by the material's field. `uv_sets` are those that images read."""

    material: Material
    frame: UvFrame
    apart: Mapping[str, ImageUse] = dataclasses.field(default_factory=dict)
    uv_sets: tuple[int, ...] = ()


class Materials:
    """The materials of a document, each made once; trouble goes to `warnings`."""

    def __init__(self, document: Item, buffers: Buffers) -> None:
        self.warnings: list[str] = []
        self.items = document.items("materials")
        self._document = document
        self._variant: int | None = None
        self._buffers = buffers
        self._textures = document.items("textures")
        self._images = document.items("images")
        self._samplers = document.items("samplers")
        self._made: dict[int, PlacedMaterial] = {}
        self._pixels: dict[tuple[int, bool], Texture] = {}

    def choose(self, variant: str | None) -> None:
        """Show the material variant of this name; None: none. Raises SceneError if unknown."""
        self._variant = None if variant is None else variant_number(self._document, variant)

    def of(self, primitive: Item) -> PlacedMaterial:
        """The material of a primitive, or the default one."""
        wearer = worn(primitive, self._variant)
        if not wearer.has("material"):
            return PlacedMaterial(DEFAULT_MATERIAL, UvFrame())
        k = wearer.index("material", self.items, "materials")
        if k not in self._made:
            self._made[k] = self._material(self.items[k])
        return self._made[k]

    def _material(self, item: Item) -> PlacedMaterial:
        values: dict[str, Any] = {
            "name": item.text("name") or item.place,
            "two_sided": item.flag("doubleSided"),
            "has_black_back": item.child("extras").flag(BLACK_BACK),
        }
        uses: list[ImageUse] = []
        # Fields are collected as they are read; images also as uses, each with its frame.
        self._reflection(item, values, uses)
        normal = item.child("normalTexture")
        values["normal_texture"] = self._texture(item, "normalTexture", uses, is_srgb=False)
        values["normal_scale"] = normal.number("scale", 1.0)
        self._emission(item, values, uses)
        self._coverage(item, values)
        # The images in one frame, or as they are, each with its own.
        slots = {id(value): name for name, value in values.items()}
        named = {slots[id(use.texture)]: use for use in uses}
        shared, sets = shared_frame(uses), tuple(sorted({use.uv_set for use in uses}))
        if shared is None:
            return PlacedMaterial(Material(**values), UvFrame(), named, sets)
        frame, textures = shared
        values |= dict(zip(named, textures, strict=True))
        return PlacedMaterial(Material(**values), frame, uv_sets=sets)

    def _reflection(self, item: Item, values: dict[str, Any], uses: list[ImageUse]) -> None:
        """Base colour, alpha, roughness, metallic and specular."""
        # The reflection, in either of the two models that glTF had.
        extensions = item.child("extensions")
        if extensions.has("KHR_materials_pbrSpecularGlossiness"):
            old = extensions.child("KHR_materials_pbrSpecularGlossiness")
            factor = old.floats("diffuseFactor", 4, (1.0,) * 4)
            values["base_color_texture"] = self._texture(old, "diffuseTexture", uses)
            values["roughness"] = _unit(1.0 - old.number("glossinessFactor", 1.0))
            self._warn(item, "specular-glossiness is approximated as a dielectric")
        else:
            pbr = item.child("pbrMetallicRoughness")
            factor = pbr.floats("baseColorFactor", 4, (1.0,) * 4)
            values["base_color_texture"] = self._texture(pbr, "baseColorTexture", uses)
            values["metallic"] = _unit(pbr.number("metallicFactor", 1.0))
            values["roughness"] = _unit(pbr.number("roughnessFactor", 1.0))
            values["metallic_roughness_texture"] = self._texture(
                pbr, "metallicRoughnessTexture", uses, is_srgb=False
            )
        # What both have.
        values["base_color"] = tuple(_unit(c) for c in factor[:3])
        values["alpha"] = _unit(factor[3])
        values["specular"] = _specular(extensions)
        if extensions.has("KHR_materials_unlit"):
            values |= {"is_unlit": True, "metallic": 0.0, "roughness": 1.0, "specular": 0.0}
        # Extensions that are not read, and parts of those that are.
        for name in extensions.keys():  # noqa: SIM118
            if not name.startswith("KHR_materials_"):
                continue
            if name not in _UNDERSTOOD:
                self._warn(item, f"{name} is not supported and left out")
            elif unread := set(extensions.child(name).keys()) - _UNDERSTOOD[name]:
                self._warn(item, f"{', '.join(sorted(unread))} of {name} left out")

    def _emission(self, item: Item, values: dict[str, Any], uses: list[ImageUse]) -> None:
        factor = item.floats("emissiveFactor", 3, (0.0, 0.0, 0.0))
        strength = item.at("extensions", "KHR_materials_emissive_strength").number(
            "emissiveStrength", 1.0
        )
        # What passes through glass, and how clear.
        if values.get("is_unlit"):  # it shows its base colour alone
            factor = (0.0, 0.0, 0.0)
        values["emission"] = tuple(max(c * strength, 0.0) for c in factor)
        if max(values["emission"]) > 0.0:
            values["emission_texture"] = self._texture(item, "emissiveTexture", uses)

    def _coverage(self, item: Item, values: dict[str, Any]) -> None:
        """What is there, and what light passes: alphaMode and transmission."""
        mode = item.text("alphaMode", "OPAQUE")
        glass = item.at("extensions", "KHR_materials_transmission")
        values["transmission"] = _unit(glass.number("transmissionFactor", 0.0))
        if values["transmission"] > 0.0 and values.get("roughness", 1.0) > CLEAR_ROUGHNESS:
            self._warn(item, "its glass is rough, light passes it as if it were clear")
        # A surface is there everywhere, where alpha is above a threshold, or by a share.
        if mode == "MASK":
            cutoff = item.number("alphaCutoff", 0.5)
            values["alpha_cutoff"] = _unit(cutoff)
            if cutoff > 1.0:  # which no alpha reaches: nothing of it is there
                values["alpha"] = 0.0
        elif mode == "BLEND":
            values["is_blended"] = True
        elif mode == "OPAQUE":
            values["alpha"] = 1.0
        else:
            raise item.child("alphaMode").error(f"'{mode}' is unknown")

    def _texture(
        self, parent: Item, key: str, uses: list[ImageUse], *, is_srgb: bool = True
    ) -> Texture | None:
        """The texture that parent[key] names, placed by KHR_texture_transform."""
        if not parent.has(key):
            return None
        info = parent.child(key)
        texture = self._textures[info.index("index", self._textures, "textures")]
        pixels = self._image(texture, is_srgb=is_srgb)
        if pixels is None:
            return None
        use = image_use(info, dataclasses.replace(pixels, wrap=self._wrap(texture)))
        uses.append(use)
        return use.texture

    def _wrap(self, texture: Item) -> tuple[Wrap, Wrap]:
        # A texture without a sampler repeats, as the specification's default says.
        if not texture.has("sampler"):
            return ("repeat", "repeat")
        sampler = self._samplers[texture.index("sampler", self._samplers, "samplers")]
        u, v = (_WRAPS.get(sampler.integer(key, 10497), "repeat") for key in ("wrapS", "wrapT"))
        return (u, v)

    def _image(self, texture: Item, *, is_srgb: bool) -> Texture | None:
        """The pixels of a texture; where they cannot be had, a stand-in for colours."""
        packed = [
            texture.at("extensions", name) for name in ("EXT_texture_webp", "KHR_texture_basisu")
        ]
        # Of a WebP or a KTX 2 and a plain image of the same, the plain one needs no package.
        source = next((s for s in (texture, *packed) if s.has("source")), texture)
        if not source.has("source"):
            names = ", ".join(texture.child("extensions").keys()) or "nothing"
            self._warn(
                texture,
                f"has no image that airlight can read, but {names}; a magenta checker stands in",
            )
            return missing_texture(texture.place) if is_srgb else None
        # Each image is decoded once for each coding that its slots ask for.
        k = source.index("source", self._images, "images")
        if (k, is_srgb) not in self._pixels:
            image = self._images[k]
            name = image.text("uri")[:200] if not image.text("uri").startswith("data:") else ""
            where = f"{image.file}: {image.place}{f' ({name})' if name else ''}"
            if image.has("uri") and not image.text("uri").startswith("data:"):
                uri_file(image, self._buffers.folder)  # one of another place is no mere loss
            # An image that cannot be read costs the texture, not the scene.
            try:
                raw = self._image_bytes(image)
                self._pixels[k, is_srgb] = read_texture(raw, is_srgb=is_srgb, source=where)
            except SceneError as error:
                # A colour that is missing is to be seen; other data are left out.
                if not is_srgb:
                    self.warnings.append(f"{where}: {error.problem}; the surface goes without")
                    return None
                # What can be installed is said where its lack is seen.
                remedy = f". {error.remedy.rstrip('.')}" if "pip install" in error.remedy else ""
                text = f"{where}: {error.problem}; a magenta checker stands in{remedy}"
                self.warnings.append(text)
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
    factor = extensions.child("KHR_materials_specular").number("specularFactor", 1.0)
    return _unit(factor * specular_of(ior))


def _unit(value: float) -> float:
    return float(np.clip(value, 0.0, 1.0))
