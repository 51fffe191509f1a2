"""Two of Mitsuba's BSDFs mixed by a weight, as one material."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from ...maths.colour import srgb_decode
from ...maths.transforms import triple
from ..checks import F64
from ..material import Material, Texture
from .mitsuba_textures import to_texture
from .texture_mix import resized


def can_blend(*materials: Material) -> bool:
    """Whether surfaces are there everywhere and let no light pass: only such ones are mixed."""
    return not any(m.is_translucent or m.alpha_cutoff > 0.0 for m in materials)


def blended(first: Material, second: Material, weight: float, map: Texture | None) -> Material:
    """The material that has `weight`, times the image `map`, of `second` and the rest of `first`.

    What it reflects diffusely, and what it mirrors straight on, is the mean of both; the lobe is as
    rough as both are on the average of what they mirror. Normals are those of the heavier one.
    """
    images = [map, *(t for m in (first, second) for t in _images(m))]
    place = next((image for image in images if image is not None), None)
    shape = _largest(images, place)
    w = np.full(shape, weight)
    if map is not None:
        w = w * _values(map, shape, place)[..., 0]
    one, two = (_Texels.of(m, s, place) for m, s in ((first, 1.0 - w), (second, w)))
    # Colours add; what is metal is the share of the colour that metals mirror.
    base = one.color + two.color
    metallic = np.minimum((one.metal + two.metal) / np.maximum(base.mean(-1), 1e-6), 1.0)
    rough = one.mirrored * one.roughness + two.mirrored * two.roughness
    rough = rough / np.maximum(one.mirrored + two.mirrored, 1e-9)
    coat = float((one.coat + two.coat).mean() / max(float((1.0 - metallic).mean()), 1e-6))
    heavier = second if float(w.mean()) > 0.5 else first
    # Without images numbers say it all.
    if place is None:
        return replace(
            heavier,
            base_color=triple(base[0, 0]),
            roughness=float(rough[0, 0]),
            metallic=float(metallic[0, 0]),
            specular=min(coat, 1.0),
        )
    lobe = np.stack([np.zeros(shape), rough, metallic], axis=-1)
    return replace(
        heavier,
        base_color=(1.0, 1.0, 1.0),
        roughness=1.0,
        metallic=1.0,
        specular=min(coat, 1.0),
        base_color_texture=_as_image(base, place, is_color=True),
        metallic_roughness_texture=_as_image(lobe, place, is_color=False),
    )


@dataclass(frozen=True, eq=False)
class _Texels:
    """A material's share of a blend at each texel: its colour (H, W, 3), and (H, W) how rough it
    is, what of the colour is metal, and how much of a dielectric's reflectance it has."""

    color: F64
    roughness: F64
    metal: F64
    coat: F64

    @classmethod
    def of(cls, material: Material, share: F64, place: Texture | None) -> _Texels:
        """As much as `share` (H, W) says."""
        plain = np.ones((*share.shape, 3))
        color, lobe = (
            plain if image is None else _values(image, share.shape, place)
            for image in _images(material)
        )
        base = share[..., None] * color * np.array(material.base_color)
        metallic = lobe[..., 2] * material.metallic
        coat = share * (1.0 - metallic) * material.specular
        return cls(base, lobe[..., 1] * material.roughness, metallic * base.mean(-1), coat)

    @property
    def mirrored(self) -> F64:
        """What it mirrors straight on."""
        return self.metal + 0.04 * self.coat


def _images(material: Material) -> tuple[Texture | None, Texture | None]:
    return material.base_color_texture, material.metallic_roughness_texture


def _largest(images: list[Texture | None], place: Texture | None) -> tuple[int, int]:
    shapes = [image.pixels.shape for image in images if image and _lies_as(image, place)]
    return max((s[0] for s in shapes), default=1), max((s[1] for s in shapes), default=1)


def _lies_as(image: Texture, place: Texture | None) -> bool:
    return place is not None and (image.scale, image.offset) == (place.scale, place.offset)


def _values(image: Texture, shape: tuple[int, ...], place: Texture | None) -> F64:
    """(H, W, 3) linear values; one that lies otherwise on the surface is its mean."""
    planes = np.stack([resized(image.pixels[..., k], shape) for k in range(3)], axis=-1)
    values = np.asarray(srgb_decode(planes / 255.0) if image.is_srgb else planes / 255.0)
    if _lies_as(image, place):
        return values
    return np.broadcast_to(values.mean(axis=(0, 1)), values.shape)


def _as_image(values: F64, place: Texture, *, is_color: bool) -> Texture:
    made = to_texture(values.astype(np.float32), is_color=is_color, source=place.source)
    return replace(made, wrap=place.wrap, scale=place.scale, offset=place.offset)
