"""Materials as shaders see them."""

from __future__ import annotations

from dataclasses import fields
from typing import Any

import numpy as np

from ..gpu.layout import Struct, f32, u32, vec3f, vec4f
from ..maths.colour import srgb_decode
from ..maths.translucency import passed_share
from ..scene.material import Material, Texture

IDENTITY_UV = (1.0, 1.0, 0.0, 0.0)
"""Scale and offset of a map that lies as its mesh says."""


class MaterialData(Struct):
    """The factors of a material; textures multiply them."""

    base_color = vec3f()
    alpha = f32()
    emission = vec3f("W m^-2 sr^-1")
    alpha_cutoff = f32()
    roughness = f32()
    metallic = f32()
    specular = f32()
    normal_scale = f32()
    transmission = f32()
    is_blended = u32("1: alpha is coverage")
    is_translucent = u32()
    is_unlit = u32()
    is_one_sided = u32("1: its back is black")
    uv_base_color = vec4f("scale, offset")
    uv_metallic_roughness = vec4f("scale, offset")
    uv_normal = vec4f("scale, offset")
    uv_emission = vec4f("scale, offset")


def material_fields(m: Material) -> dict[str, Any]:
    """The values of `MaterialData`."""
    return {
        "base_color": m.base_color,
        "alpha": m.alpha,
        "emission": m.emission,
        "alpha_cutoff": m.alpha_cutoff,
        "roughness": m.roughness,
        "metallic": m.metallic,
        "specular": m.specular,
        "normal_scale": m.normal_scale,
        "transmission": m.transmission,
        "is_blended": int(m.is_blended),
        "is_translucent": int(m.is_translucent),
        "is_unlit": int(m.is_unlit),
        "is_one_sided": int(not m.two_sided),
        "uv_base_color": uv_transform(m.base_color_texture),
        "uv_metallic_roughness": uv_transform(m.metallic_roughness_texture),
        "uv_normal": uv_transform(m.normal_texture),
        "uv_emission": uv_transform(m.emission_texture),
    }


def uv_transform(texture: Texture | None) -> tuple[float, ...]:
    """Scale and offset of a map's coordinates."""
    return (*texture.scale, *texture.offset) if texture else IDENTITY_UV


def differ_in_emission_alone(a: Material, b: Material) -> bool:
    """Whether two materials are the same but for their emission (and their names)."""
    names = [field.name for field in fields(Material) if field.name not in ("emission", "name")]
    return all(
        getattr(a, name) is getattr(b, name) or getattr(a, name) == getattr(b, name)
        for name in names
    )


def chance_to_meet(m: Material) -> float:
    """The share of light head on that does not pass a surface, where its map's alpha is 1."""
    # The mean colour of the map, in linear light.
    base, texture = np.array(m.base_color), m.base_color_texture
    if texture is not None:
        mean = texture.pixels[..., :3].reshape(-1, 3).mean(axis=0) / 255.0
        base = base * (srgb_decode(mean) if texture.is_srgb else mean)

    # Head on, Fresnel's term is the surface's F0.
    coverage = m.alpha if m.is_blended else 1.0
    passed = passed_share(base[None], [coverage], [transmission(m)], [0.04 * m.specular])
    return max(1.0 - float(passed.mean()), 1e-6)


def reflecting_share(m: Material) -> float:
    """What a surface that is met reflects diffusely, over what it would if no light passed it."""
    if not m.is_translucent:
        return 1.0
    coverage = m.alpha if m.is_blended else 1.0
    return min(coverage * (1.0 - transmission(m)) / chance_to_meet(m), 1.0)


def transmission(m: Material) -> float:
    """The share that passes of what the surface does not mirror: metal lets nothing pass."""
    return m.transmission * (1.0 - m.metallic)
