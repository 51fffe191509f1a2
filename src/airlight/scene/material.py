"""How a surface reflects and emits."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from ..errors import SceneError
from . import checks
from .checks import Rgb

Wrap = Literal["repeat", "mirror", "clamp"]


@dataclass(frozen=True, eq=False)
class Texture:
    """An 8-bit image. `pixels` is (H, W, 4) uint8, top row first.

    `is_srgb` says that RGB is sRGB-encoded (colour); data (normals, roughness) is linear.
    `scale` and `offset` map mesh uv to image uv: uv * scale + offset. `wrap`: beyond the image,
    along u and along v. `source`: the file that it came from, if any.
    """

    pixels: NDArray[np.uint8]
    is_srgb: bool = True
    wrap: tuple[Wrap, Wrap] = ("repeat", "repeat")
    scale: tuple[float, float] = (1.0, 1.0)
    offset: tuple[float, float] = (0.0, 0.0)
    source: str = ""

    def __post_init__(self) -> None:
        pixels = checks.array(
            self.pixels, f"texture {self.source}", shape=(None, None, 4), dtype=np.uint8
        )
        if pixels.size == 0:
            raise SceneError("texture has no pixels", where=self.source)
        object.__setattr__(self, "pixels", pixels)


_MAPS = ("base_color", "metallic_roughness", "normal", "emission")


@dataclass(frozen=True, eq=False)
class Material:
    """Lambert plus GGX metallic-roughness, as in glTF 2.0. All colours are linear Rec.709.

    `base_color` is the diffuse reflectance of a dielectric and the specular one of a metal;
    textures multiply their factor. `emission` is radiance, W m^-2 sr^-1. A surface reflects and
    emits on both sides where it is `two_sided`, else on its front alone; light does not pass its
    back. Cameras see that back as black where `has_black_back` (Mitsuba's surfaces without
    `twosided`), else they see through it (glTF's culling). A surface with `alpha` (times the
    base-colour texture's alpha) below `alpha_cutoff` is not there; 0 means opaque everywhere. Where
    it `is_blended`, `alpha` is the share of the surface that is there, and the rest of the light
    passes (glTF's BLEND). `transmission`: of the light that a dielectric does not mirror, the share
    that passes unbent, tinted by `base_color`; the rest is reflected diffusely
    (KHR_materials_transmission, as thin glass). `base_color_texture` and `emission_texture` are
    colours; of `metallic_roughness_texture` green is roughness and blue metallic; `normal_texture`
    has tangent-space normals, whose x and y `normal_scale` multiplies. `name` is for messages and
    files. `specular` scales the dielectric reflectance of 0.04 (0: a pure Lambert surface). Where
    it `is_unlit`, cameras see `base_color` itself, as radiance after exposure
    (KHR_materials_unlit); light meets it as a surface like any other.
    """

    name: str = ""
    base_color: Rgb = (0.8, 0.8, 0.8)
    base_color_texture: Texture | None = None
    alpha: float = 1.0
    alpha_cutoff: float = 0.0
    roughness: float = 1.0
    metallic: float = 0.0
    metallic_roughness_texture: Texture | None = None
    specular: float = 1.0
    normal_texture: Texture | None = None
    normal_scale: float = 1.0
    emission: Rgb = (0.0, 0.0, 0.0)
    emission_texture: Texture | None = None
    two_sided: bool = True
    has_black_back: bool = False
    is_blended: bool = False
    transmission: float = 0.0
    is_unlit: bool = False

    def __post_init__(self) -> None:
        # Colours and shares in [0, 1], emission without a bound but that of all numbers.
        put = object.__setattr__
        put(self, "base_color", checks.rgb(self.base_color, "base_color", high=1.0))
        for name in ("alpha", "roughness", "metallic", "specular", "transmission"):
            put(self, name, checks.number(getattr(self, name), name, low=0.0, high=1.0))
        put(self, "alpha_cutoff", checks.number(self.alpha_cutoff, "alpha_cutoff", low=0, high=1))
        put(self, "normal_scale", checks.number(self.normal_scale, "normal_scale"))
        put(self, "emission", checks.rgb(self.emission, "emission"))
        for name in _MAPS:
            texture = getattr(self, f"{name}_texture")
            if texture is not None:
                checks.instance(texture, f"{name}_texture", Texture)
        for name in ("two_sided", "has_black_back", "is_blended", "is_unlit"):
            put(self, name, checks.boolean(getattr(self, name), name))

    @property
    def is_emissive(self) -> bool:
        """Whether the surface gives light of its own."""
        return max(self.emission) > 0.0

    @property
    def is_culled(self) -> bool:
        """Whether cameras see through the surface's back."""
        return not (self.two_sided or self.has_black_back)

    @property
    def lets_light_out(self) -> bool:
        """Whether light passes its back: samples of what emits on its front lie behind it."""
        return self.is_emissive and not self.two_sided

    @cached_property
    def is_translucent(self) -> bool:
        """Whether light passes straight through some of the surface that is there."""
        return self._has_gaps or (self.transmission > 0.0 and self.metallic < 1.0)

    @property
    def _has_gaps(self) -> bool:
        # Coverage below 1 somewhere: by the factor, or by the image's alpha.
        texture = self.base_color_texture
        is_covered = texture is None or bool((texture.pixels[..., 3] == 255).all())
        return self.is_blended and (self.alpha < 1.0 or not is_covered)


SIDES: Mapping[str, dict[str, Any]] = {
    "both": {"two_sided": True, "has_black_back": False},
    "front": {"two_sided": False, "has_black_back": True},
    "culled": {"two_sided": False, "has_black_back": False},
}
"""Which sides of a surface reflect, and what cameras see of its back; the fields that say so."""

DEFAULT_MATERIAL: Material = Material(name="default")


def textures_of(material: Material) -> list[Texture]:
    """All that it has."""
    named = (getattr(material, f"{name}_texture") for name in _MAPS)
    return [texture for texture in named if texture is not None]


def specular_of(ior: float) -> float:
    """Scale of the dielectric reflectance 0.04, by Fresnel's at normal incidence; above 1 beyond
    an index of 1.5. An index of 0 stands for an endless one, as glTF has it."""
    reflectance = ((ior - 1.0) / (ior + 1.0)) ** 2 if ior > 0.0 else 1.0
    return reflectance / 0.04
