"""airlight materials as Mitsuba BSDFs.

Lambert (`specular` 0, `metallic` 0) is `diffuse`, exactly. Everything else is our own model
(mitsuba_brdf.py) where the child process knows it, else `principled`: the same GGX with
alpha = roughness^2, F0 = 0.04 specular through its index of refraction.
differs (principled): its diffuse term is Burley's, not Lambert's (darker at grazing angles when
smooth, retro-reflective when rough) and loses nothing to the reflection above it; its
dielectric Fresnel term is exact where ours is Schlick's; its masking is uncorrelated.
Measured, base colour 0.5: a dielectric reflects 2 to 8% more than ours head on (roughness 0.1
to 1), and at 84 degrees 12% less to 40% more; a metal the same head on, 0 to 27% less at 84.
Whole images of random scenes outdoors, whose materials are dielectrics, were 14 to 18% brighter.
"""

from __future__ import annotations

import re
from dataclasses import replace
from xml.etree.ElementTree import Element

import numpy as np

from ..scene.checks import Rgb
from ..scene.material import Material, Texture
from ..scene.mesh import Geometry
from .mitsuba_files import FileStore, write_exr, write_png
from .mitsuba_textures import (
    add_bitmap,
    add_color_texture,
    add_data_channel,
    note_wrapping,
    opaque,
    scaled_normals,
)
from .mitsuba_xml import add_number, add_rgb, add_text, add_truth, plugin

PRINCIPLED = (
    "glossy materials are Mitsuba's principled, whose diffuse part is Burley's: random scenes "
    "outdoors come out 14 to 18 % brighter. Install libLLVM 19, or name it in DRJIT_LIBLLVM_PATH"
)
"""Told of a reference that could not use airlight's own BRDF."""


def material_reference(
    material: Material, geometry: Geometry, files: FileStore, notes: list[str]
) -> str:
    """The id of the BSDF of `material` on `geometry`, which joins files.bsdfs on first use."""
    colors = None if geometry.colors is None else files.identity(geometry.colors)
    key = (files.identity(material), geometry.uvs is not None, colors)
    if key not in files.bsdfs:
        slug = re.sub(r"[^A-Za-z0-9_-]+", "_", material.name) or "material"
        bsdf = _material_bsdf(material, geometry, files, notes)
        bsdf.set("id", f"{slug}_{len(files.bsdfs)}")
        files.bsdfs[key] = bsdf
    return str(files.bsdfs[key].get("id"))


def _material_bsdf(
    material: Material, geometry: Geometry, files: FileStore, notes: list[str]
) -> Element:
    """The BSDF of `material` on `geometry`; what it cannot say exactly goes to `notes`."""
    # First what Mitsuba has no words for, each with a note.
    material, geometry = _with_constant_colors(material, geometry, notes)
    note_wrapping(material, notes)
    if material.is_unlit:
        notes.append(f"material '{material.name}': unlit, and written as a matt one")
    if material.transmission > 0.0 and material.is_translucent:
        return _covered(_glass(material, geometry, files, notes), material, geometry, files)
    # From the inside out: the reflection, its normals, then which sides have it.
    if material.specular == 0.0 and material.metallic == 0.0:
        inner = plugin("bsdf", "diffuse")
        _add_base_color(inner, "reflectance", material, geometry, files)
    else:
        inner = _glossy(material, geometry, files, notes)
    if material.normal_texture is not None and geometry.uvs is not None:
        inner = _normal_mapped(inner, material.normal_texture, material.normal_scale, files)
        if geometry.tangents is not None:
            notes.append(
                f"material '{material.name}': its normal map lies by tangents, which Mitsuba has "
                "no word for: there it lies by texture coordinates"
            )
    if material.two_sided:
        both = plugin("bsdf", "twosided")
        both.append(inner)
        inner = both
    elif material.is_culled:
        notes.append(
            "one-sided surfaces are black from behind in Mitsuba, where airlight's cameras look "
            "through them"
        )
    return _covered(inner, material, geometry, files)


def _covered(inner: Element, material: Material, geometry: Geometry, files: FileStore) -> Element:
    """`inner` where the surface is there."""
    if is_masked(material, geometry):
        inner = _masked(inner, material, files)
    if not material.is_blended or not material.is_translucent:
        return inner
    node, texture = plugin("bsdf", "mask"), material.base_color_texture

    # Opacity by the texture's alpha where there are coordinates to read it at.
    if texture is None or geometry.uvs is None:
        add_number(node, "opacity", material.alpha)
    else:
        add_data_channel(node, "opacity", texture, 3, material.alpha, files)
    node.append(inner)
    return node


def _glass(material: Material, geometry: Geometry, files: FileStore, notes: list[str]) -> Element:
    """Thin glass: our own where it is known, else Mitsuba's blended with the rest."""
    if material.normal_texture is not None:
        notes.append(f"material '{material.name}': the normal map of its glass is left out")
        material = replace(material, normal_texture=None)
    if files.knows_airlight:
        node = _glossy(material, geometry, files, notes)
        node.set("type", "airlight_glass")
        add_number(node, "transmission", material.transmission)
        add_truth(node, "two_sided", material.two_sided)
        return node
    notes.append(
        "glass is Mitsuba's thindielectric: its Fresnel term is exact where ours is Schlick's"
    )
    # Mitsuba's dielectric is mixed with the opaque rest by the share that passes.
    glass = plugin("bsdf", "thindielectric")
    add_number(glass, "int_ior", _thin_index(0.04 * material.specular))
    add_number(glass, "ext_ior", 1.0)
    _add_base_color(glass, "specular_transmittance", material, geometry, files)
    solid = replace(material, transmission=0.0, is_blended=False, alpha_cutoff=0.0)
    node = plugin("bsdf", "blendbsdf")
    add_number(node, "weight", material.transmission * (1.0 - material.metallic))
    node.append(_material_bsdf(solid, geometry, files, notes))
    node.append(glass)
    return node


def _thin_index(reflectance: float) -> float:
    """The index of a slab whose two faces together reflect so much head on: 2F/(1 + F)."""
    root = float(np.sqrt(reflectance / (2.0 - reflectance)))
    return (1.0 + root) / (1.0 - root)


def is_masked(material: Material, geometry: Geometry) -> bool:
    """Whether parts of the surface are cut away by its base-colour texture's alpha."""
    texture = material.base_color_texture
    if material.alpha_cutoff <= 0.0 or texture is None or geometry.uvs is None:
        return False
    return bool(texture.pixels[..., 3].min() / 255.0 * material.alpha < material.alpha_cutoff)


def is_absent(material: Material) -> bool:
    """Whether nothing of the surface passes its alpha cutoff."""
    return material.alpha < material.alpha_cutoff


def _with_constant_colors(
    material: Material, geometry: Geometry, notes: list[str]
) -> tuple[Material, Geometry]:
    """Vertex colours that are one colour, or stand beside a texture, moved into base_color."""
    if geometry.colors is None:
        return material, geometry
    # Mitsuba reads vertex colours as a texture, so that a mesh cannot have both.
    colors = np.clip(geometry.colors[:, :3], 0.0, 1.0)
    varies = bool(np.ptp(colors, axis=0).max() > 1e-6)
    if varies and (material.base_color_texture is None or geometry.uvs is None):
        return material, geometry
    if varies:
        notes.append(
            f"material '{material.name}': vertex colours beside a base-colour texture are "
            "replaced by their mean"
        )
    mean = colors.mean(axis=0, dtype=np.float64) * material.base_color
    color: Rgb = (float(mean[0]), float(mean[1]), float(mean[2]))
    return replace(material, base_color=color), replace(geometry, colors=None)


def _add_base_color(
    parent: Element, name: str, material: Material, geometry: Geometry, files: FileStore
) -> None:
    # By a texture times its factor, by vertex colours, or one colour.
    texture = material.base_color_texture
    if texture is not None and geometry.uvs is not None:
        add_color_texture(parent, name, texture, material.base_color, files)
    elif geometry.colors is not None:
        node = plugin("texture", "mesh_attribute", name)
        add_text(node, "name", "vertex_color")
        parent.append(node)
    else:
        add_rgb(parent, name, material.base_color)


def _glossy(material: Material, geometry: Geometry, files: FileStore, notes: list[str]) -> Element:
    node = plugin("bsdf", "airlight" if files.knows_airlight else "principled")
    _add_base_color(node, "base_color", material, geometry, files)
    texture = material.metallic_roughness_texture if geometry.uvs is not None else None

    # glTF keeps roughness in the green and metallic in the blue channel.
    for name, channel in (("roughness", 1), ("metallic", 2)):
        factor = getattr(material, name)
        if texture is None or factor == 0.0:
            add_number(node, name, factor)
            continue
        add_data_channel(node, name, texture, channel, factor, files)
    if files.knows_airlight:
        add_number(node, "specular", material.specular)
        return node
    notes.append(PRINCIPLED)
    # Mitsuba's F0 = 0.08 specular; 0 would also switch a metal's reflection off.
    add_number(node, "specular", max(0.5 * material.specular, 1e-5))
    return node


def _normal_mapped(inner: Element, texture: Texture, scale: float, files: FileStore) -> Element:
    key = (files.identity(texture.pixels), "normal", scale, texture.wrap)
    filename = files.once(
        key, "normal", "exr", lambda path: write_exr(path, scaled_normals(texture, scale))
    )
    node = plugin("bsdf", "normalmap")
    add_bitmap(node, "normalmap", texture, filename, raw=True)
    # Mitsuba's own softening of the terminator is no part of glTF's model.
    add_truth(node, "use_shadowing_function", False)
    node.append(inner)
    return node


def _masked(inner: Element, material: Material, files: FileStore) -> Element:
    """`inner` where alpha reaches the cutoff, nothing elsewhere.

    airlight filters alpha, then compares; Mitsuba would filter the comparison. So the filtered
    alpha is compared here, on a finer grid, and read without filtering.
    """
    texture = material.base_color_texture
    assert texture is not None

    # A mask depends on pixels, factor, cutoff and wrapping: equal ones share a file.
    key = (
        files.identity(texture.pixels),
        "opacity",
        material.alpha,
        material.alpha_cutoff,
        texture.wrap,
    )
    filename = files.once(
        key, "opacity", "png", lambda path: write_png(path, opaque(material, texture))
    )
    node = plugin("bsdf", "mask")
    add_bitmap(node, "opacity", texture, filename, raw=True, nearest=True)
    node.append(inner)
    return node
