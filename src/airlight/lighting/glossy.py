"""Which surfaces mirror enough of the light around them to follow mirrored rays.

`wgsl/glossy.wgsl` follows them into lattices, `gather.mirrors` among triangles; scenes without such
surfaces are lit without either.
"""

from __future__ import annotations

from collections.abc import Iterable

from ..scene.material import Material

# Above these `glossy_share` in wgsl/surface_reflection.wgsl is 0 at every angle.
_DIELECTRIC_ROUGHNESS, _METAL_ROUGHNESS = 0.65, 0.97


def is_any_glossy(materials: Iterable[Material]) -> bool:
    """Whether any material is smooth enough, somewhere on its textures."""
    return any(_is_glossy(material) for material in materials)


def _is_glossy(material: Material) -> bool:
    # The smoothest texel of the map decides; metals mirror at a higher roughness than others.
    roughness = material.roughness
    if material.metallic_roughness_texture is not None:
        roughness *= float(material.metallic_roughness_texture.pixels[..., 1].min()) / 255.0
    if material.metallic > 0.0:
        return roughness < _METAL_ROUGHNESS
    return material.specular > 0.0 and roughness < _DIELECTRIC_ROUGHNESS
