"""Wavefront MTL, with the physically based keys that exporters added, as airlight materials.

Kd, map_Kd        base colour (linear; the image is sRGB and multiplies, but a black Kd)
Ks, Ns            dielectric specular and roughness; a bright Ks over a black Kd is a metal
Pr, Pm, map_*     roughness and metallic; they win over Ks and Ns
d, Tr, map_d      coverage: the rest of the light passes; Tr = 1 alone is opaque. A map_d whose
                  texels are there or not cuts holes
Ke, map_Ke        emitted radiance
norm, map_Bump    normal map (a height map is told apart and left out)
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from ..material import Material, Texture
from .mtl_statements import Block, is_number, read_blocks
from .texture_files import TextureFiles
from .texture_mix import is_soft, packed_roughness_metallic, with_alpha

DIELECTRIC_REFLECTANCE = 0.04
METAL_MAX_KD, METAL_MIN_KS = 0.05, 0.3

_READ = frozenset(
    (
        *("kd", "map_kd", "ks", "ns", "pr", "pm", "map_pr", "map_pm", "ke", "map_ke", "illum"),
        *("d", "tr", "map_d", "map_opacity"),
        *("norm", "map_norm", "map_kn", "map_bump", "bump"),
    )
)
_MEANINGLESS = frozenset(("ka", "map_ka", "ni", "tf", "km", "sharpness", "map_aat"))
"""Ambient light, which is computed, and what exporters write whatever the material is."""


def load_mtl(path: Path, textures: TextureFiles) -> dict[str, Material]:
    """Materials by name. Texture names are looked up by `textures`, which takes the warnings.

    Raises SceneError with file and line for a number that is none.
    """
    return {block.name: _material(block, textures) for block in read_blocks(path)}


def _material(block: Block, textures: TextureFiles) -> Material:
    # Each group of statements gives some fields; the base texture may get the mask as alpha.
    values: dict[str, Any] = {"name": block.name}
    values.update(_reflection(block, textures))
    values.update(_coverage(block, textures, _base_texture(block, textures)))
    values.update(_emission(block, textures))
    values.update(_normal_map(block, textures))
    # What was not read is said once for the material.
    unread = [key for key, (text, _) in block.statements.items() if _is_lost(key, text)]
    if unread:
        listed = ", ".join(f"'{key}'" for key in unread)
        textures.warnings.append(
            f"{block.path}: {listed} of '{block.name}' are not read and left out"
        )
    # Options and spectra of statements that are read otherwise.
    parts = sorted({part for key in _READ for part in block.unread(key)})
    if parts:
        textures.warnings.append(
            f"{block.path}: {', '.join(parts)} of '{block.name}' left out: colours are numbers, "
            "images are scaled and shifted only"
        )
    return Material(**values)


def _is_lost(key: str, text: str) -> bool:
    """Whether a statement says something that is not shown: nothing is said by zeros."""
    if key in _READ or key in _MEANINGLESS:
        return False
    return not all(is_number(word) and float(word) == 0.0 for word in text.split())


def _base_texture(block: Block, textures: TextureFiles) -> Texture | None:
    name = block.image("map_kd")
    return None if name is None else name.placed(textures.color(name.file))


def _reflection(block: Block, textures: TextureFiles) -> dict[str, Any]:
    """Base colour, roughness, metallic and specular."""
    kd = block.color("kd") or (0.8, 0.8, 0.8)
    if max(kd) == 0.0 and block.image("map_kd") is not None:
        # Exporters write a black Kd beside an image, and viewers show the image.
        kd = (1.0, 1.0, 1.0)
    ks = block.color("ks") or (0.0, 0.0, 0.0)
    if max(kd) > 1.0:
        textures.warnings.append(f"{block.path}: Kd of '{block.name}' is above 1 and was cut")
        kd = (min(kd[0], 1.0), min(kd[1], 1.0), min(kd[2], 1.0))
    # A dark Kd beside a bright Ks is how MTL says metal.
    roughness, metallic = block.number("pr"), block.number("pm")
    is_metal = metallic is None and max(kd) < METAL_MAX_KD and max(ks) > METAL_MIN_KS
    values: dict[str, Any] = {"base_color": kd, "metallic": _unit(metallic or 0.0)}
    if is_metal and "map_kd" not in block.statements:
        values |= {"base_color": tuple(min(c, 1.0) for c in ks), "metallic": 1.0}
    # Roughness by its own key, else by Phong's exponent; specular by Ks, where no key of PBR is
    # set.
    has_map = "map_pr" in block.statements or "map_pm" in block.statements
    if roughness is None and has_map:
        roughness = 1.0
    values["roughness"] = _unit(_blinn_roughness(block) if roughness is None else roughness)
    if roughness is None and metallic is None:
        values["specular"] = _unit(sum(ks) / 3.0 / DIELECTRIC_REFLECTANCE)
    if has_map:
        values.update(_roughness_metallic_maps(block, textures, metallic))
    return values


def _blinn_roughness(block: Block) -> float:
    """Perceptual roughness of a Blinn-Phong exponent Ns: alpha^2 = 2/(Ns + 2), alpha = r^2.

    Source: Walter2007, section 5.2 (matching Beckmann to Phong), with glTF's alpha = r^2.
    """
    exponent = block.number("ns")
    # Without highlights the exponent says nothing: illum 0 and 1 are matte.
    if exponent is None or block.number("illum") in (0.0, 1.0):
        return 1.0
    return float((2.0 / (max(exponent, 0.0) + 2.0)) ** 0.25)


def _roughness_metallic_maps(
    block: Block, textures: TextureFiles, metallic: float | None
) -> dict[str, Any]:
    # Two grey images become channels of one.
    names = [block.image(key) for key in ("map_pr", "map_pm")]
    images = [textures.data(name.file) if name else None for name in names]
    packed = packed_roughness_metallic(images[0], images[1])
    if packed is None:
        return {}
    placed = next(name for name in names if name is not None).placed(packed)
    # The factor of a metallic image is 1 unless Pm says it; without an image Pm alone counts.
    has_metal = images[1] is not None
    return {
        "metallic_roughness_texture": placed,
        "metallic": 1.0 if has_metal and metallic is None else _unit(metallic or 0.0),
    }


def _coverage(block: Block, textures: TextureFiles, base: Texture | None) -> dict[str, Any]:
    """Alpha mask and base-colour texture. `d 0` beside a map_d is an exporter's habit: it is 1."""
    opacity, transparency = block.number("d"), block.number("tr")
    if transparency is not None and transparency >= 1.0 and opacity is None:
        # By the book it is invisible, which nobody means: MeshLab writes opacity under this name.
        textures.warnings.append(
            f"{block.path}: 'Tr {transparency:g}' of '{block.name}' is taken for opaque, as "
            "MeshLab means it; for a surface that is not there write d 0"
        )
        transparency = None
    # `d` is opacity, `Tr` is what it lacks to 1; `d` counts where both are there.
    alpha = 1.0 if transparency is None else 1.0 - transparency
    alpha = _unit(alpha if opacity is None else opacity)
    # A mask that is soft blends, one that is sharp cuts holes.
    mask = block.image("map_d", "map_opacity")
    if mask is not None:
        image = textures.data(mask.file)
        if image is not None:
            alpha = alpha if alpha > 0.0 else 1.0
            is_blended = alpha < 1.0 or is_soft(image)
            return {
                "base_color_texture": with_alpha(base, mask.placed(image)),
                "alpha": alpha,
                **({"is_blended": True} if is_blended else {"alpha_cutoff": 0.5}),
            }
    # One opacity for all of the surface.
    if alpha == 1.0:
        return {"base_color_texture": base}
    return {"base_color_texture": base, "alpha": alpha, "is_blended": True}


def _emission(block: Block, textures: TextureFiles) -> dict[str, Any]:
    """Radiance; a map_Ke without a Ke, or with a black one, is taken as it is."""
    emitted = block.color("ke") or (0.0, 0.0, 0.0)
    name = block.image("map_ke")
    if name is None:
        return {"emission": emitted}
    texture = name.placed(textures.color(name.file))
    return {
        "emission": emitted if max(emitted) > 0.0 else (1.0, 1.0, 1.0),
        "emission_texture": texture,
    }


def _normal_map(block: Block, textures: TextureFiles) -> dict[str, Any]:
    name = block.image("norm", "map_norm", "map_kn", "map_bump", "bump")
    texture = textures.data(name.file) if name else None
    if name is None or texture is None:
        return {}
    # Height maps have the same keys: in a normal map the mean pixel points outwards.
    if not _is_normal_map(texture):
        textures.warnings.append(
            f"{block.path}: '{name.file}' of '{block.name}' is a height map, not a normal map; "
            "the surface goes without"
        )
        return {}
    return {"normal_texture": name.placed(texture), "normal_scale": name.number("-bm", 1.0)}


def _is_normal_map(texture: Texture) -> bool:
    """Whether the mean pixel is a unit vector that points out of the surface."""
    mean = texture.pixels[..., :3].reshape(-1, 3).mean(axis=0) / 127.5 - 1.0
    return bool(mean[2] > 0.5 and np.abs(mean[:2]).max() < 0.25)


def _unit(value: float) -> float:
    return min(max(value, 0.0), 1.0)
