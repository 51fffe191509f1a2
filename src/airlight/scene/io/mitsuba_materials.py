"""Mitsuba's BSDFs as Lambert plus GGX, as far as they go."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

from ..material import SIDES, Material
from .mitsuba_blend import blended, can_blend
from .mitsuba_bumps import normals_of_heights
from .mitsuba_lobes import (
    DEFAULT_INDEX,
    DIELECTRIC_REFLECTANCE,
    INDICES,
    at_most_one,
    index_of,
    limited,
    roughness_of,
    specular_of,
)
from .mitsuba_metals import metal, mirrored
from .mitsuba_nodes import Node
from .mitsuba_plastic import coated, mean_alpha
from .mitsuba_textures import Source, bitmap, color_input, mean_input, rgb_of, scalar_input
from .texture_mix import is_soft, packed_roughness_metallic, with_alpha

GREY = Material(name="grey", base_color=(0.5, 0.5, 0.5), specular=0.0, **SIDES["front"])


class NoSurface(Exception):
    """The BSDF lets everything pass: there is nothing to see but what lies behind."""


def material(node: Node | None, source: Source) -> Material:
    """The material of a BSDF; GREY, which is Mitsuba's default, for none.

    Raises NoSurface for null.
    """
    if node is None:
        return GREY
    reader = _READERS.get(node.kind)
    if reader is None:
        source.note(f"{node} is unknown, a mid grey stands in")
        return replace(GREY, **SIDES["both"])
    return replace(reader(node, source), name=node.id or node.kind)


def _nested(node: Node, source: Source) -> Material:
    inner = node.first("bsdf")
    if inner is None:
        source.note(f"{node} has no BSDF inside, a mid grey stands in")
    return material(inner, source)


def _diffuse(node: Node, source: Source) -> Material:
    color, texture = color_input(node, "reflectance", 0.5, source)
    return replace(GREY, base_color=at_most_one(color), base_color_texture=texture)


def _twosided(node: Node, source: Source) -> Material:
    if len(node.all("bsdf")) > 1:
        source.note(f"{node}: the BSDF of its back is left out, both sides look alike")
    return replace(_nested(node, source), **SIDES["both"])


def _mask(node: Node, source: Source) -> Material:
    """Opacity is coverage; a texture whose texels are there or not cuts holes."""
    inner = _nested(node, source)
    # One opacity for the whole surface: it covers a share of what is behind.
    child = node.child("opacity")
    if child is None:
        opacity = sum(rgb_of(node.get("opacity", 0.5))) / 3.0
        if opacity == 0.0:
            raise NoSurface
        return replace(inner, alpha=min(opacity, 1.0), is_blended=True)
    # A texture, in the alpha of the colour's.
    found = None
    if child.kind == "bitmap":
        found = bitmap(child, source, is_color=False, is_cut=True)
    if found is None:
        source.note(f"{node}: its opacity texture is left out")
        return inner
    cut = with_alpha(inner.base_color_texture, found[0])
    # One texture has one uv transform, the colour's.
    if inner.base_color_texture is not None and (found[0].scale, found[0].offset) != (
        inner.base_color_texture.scale,
        inner.base_color_texture.offset,
    ):
        source.note(f"{node}: its opacity takes the uv transform of the colour texture")
    # Where texels are there or not it cuts, else it blends.
    if is_soft(found[0]):
        return replace(inner, base_color_texture=cut, is_blended=True)
    return replace(inner, base_color_texture=cut, alpha_cutoff=0.5)


def _normalmap(node: Node, source: Source) -> Material:
    inner = _nested(node, source)
    # Flags of the BSDF that say how to shade; reading them keeps them from being reported.
    for flag in ("use_shadowing_function", "flip_invalid_normals"):
        node.get(flag)
    child = node.child("normalmap") or node.first("texture")
    is_bitmap = child is not None and child.kind == "bitmap"
    # Directions are no brightness: they are never decoded here.
    found = bitmap(child, source, is_color=False, is_raw=True) if child and is_bitmap else None
    return replace(inner, normal_texture=found[0]) if found else inner


def _bumpmap(node: Node, source: Source) -> Material:
    """Its heights as normals where a unit of the coordinates is a metre; `on_mesh` mends that."""
    inner, child = _nested(node, source), node.first("texture")
    scale = float(node.get("scale", 1.0))
    is_bitmap = child is not None and child.kind == "bitmap"
    found = bitmap(child, source, is_color=False) if child and is_bitmap else None
    if found is None or scale == 0.0:
        source.note(f"{node}: its bump map is left out, the surface is smooth")
        return inner
    normals, steepest = normals_of_heights(found[0])
    return replace(inner, normal_texture=normals, normal_scale=scale * found[1] * steepest)


def _blend(node: Node, source: Source) -> Material:
    options = node.all("bsdf")
    weight, image = scalar_input(node, "weight", 0.5, source)
    if len(options) < 2:
        return _nested(node, source)
    first, second = (material(option, source) for option in options[:2])
    if can_blend(first, second):
        return blended(first, second, min(max(weight, 0.0), 1.0), image)
    source.note(f"{node}: the BSDF of more weight stands for both, as one lets light pass")
    return second if weight > 0.5 else first


def _principled(node: Node, source: Source) -> Material:
    source.note("principled: read as Lambert plus GGX; its diffuse part is Burley's in Mitsuba")
    # Each parameter is a number or a texture.
    color, texture = color_input(node, "base_color", 0.5, source)
    roughness, rough_texture = scalar_input(node, "roughness", 0.5, source)
    passed = min(max(mean_input(node, "spec_trans", source), 0.0), 1.0)
    metallic, metal_texture = scalar_input(node, "metallic", 0.0, source)
    # Specular from an index of refraction, or as its own parameter.
    if "eta" in node.values:
        specular = specular_of(float(node.get("eta")), node, source)
    else:
        # Mitsuba's F0 is 0.08 times its specular, ours 0.04 times.
        specular = limited(2.0 * float(node.get("specular", 0.5)), node, source)
    return Material(
        base_color=at_most_one(color),
        base_color_texture=texture,
        roughness=min(roughness, 1.0),
        metallic=min(metallic, 1.0),
        metallic_roughness_texture=packed_roughness_metallic(rough_texture, metal_texture),
        specular=specular if specular > 4e-5 else 0.0,
        transmission=passed,
        **SIDES["both" if passed > 0.0 else "front"],
    )


def _principled_thin(node: Node, source: Source) -> Material:
    """A sheet: what it scatters to its other side is left out of what it reflects."""
    made = _principled(node, source)
    through = min(max(mean_input(node, "diff_trans", source) / 2.0, 0.0), 1.0)
    if through > 0.0:
        source.note(f"{node}: light that it scatters to its other side is left out")
    r, g, b = ((1.0 - through) * c for c in made.base_color)
    # Base colours tint what passes, too, where light passes straight on.
    return replace(made, base_color=(r, g, b), **SIDES["both"])


def _conductor(node: Node, source: Source) -> Material:
    tint, texture = color_input(node, "specular_reflectance", 1.0, source)
    # What the metal mirrors straight on, by Fresnel's formula or by its name.
    if "eta" in node.values or "k" in node.values:
        base = mirrored(rgb_of(node.get("eta", 0.0)), rgb_of(node.get("k", 1.0)))
    else:
        name = str(node.get("material", "Cu"))
        known = metal(name)
        if known is None:
            source.note(f"{node}: the metal '{name}' is not known, a light grey one stands in")
        base = known or (0.8, 0.8, 0.8)
    r, g, b = (x * t for x, t in zip(base, tint, strict=True))
    return Material(
        base_color=at_most_one((r, g, b)),
        base_color_texture=texture,
        **roughness_of(node, source),
        metallic=1.0,
        **SIDES["front"],
    )


def _plastic(node: Node, source: Source) -> Material:
    source.note(f"{node.kind}: read as Lambert plus GGX")
    color, texture = color_input(node, "diffuse_reflectance", 0.5, source)
    index = index_of(node, "int_ior", 1.49) / index_of(node, "ext_ior", INDICES["air"])
    # What passes the coat, as rough as it is on the average.
    rough = roughness_of(node, source)
    if node.kind != "pplastic":
        color, texture = coated(
            color,
            texture,
            index=index,
            alpha=mean_alpha(rough),
            distribution=str(node.get("distribution", "beckmann")),
            is_nonlinear=bool(node.get("nonlinear", False)),
        )
    # At normal incidence a dielectric reflects ((n - 1) / (n + 1))^2, all of specular that our
    # material knows.
    tint = sum(color_input(node, "specular_reflectance", 1.0, source)[0]) / 3.0
    return Material(
        base_color=at_most_one(color),
        base_color_texture=texture,
        **rough,
        specular=min(1.0, tint * specular_of(index, node, source)),
        **SIDES["front"],
    )


def _glass(node: Node, source: Source) -> Material:
    """Glass without thickness; of a body each of its sides is one."""
    is_thin = node.kind == "thindielectric"
    if not is_thin:
        source.note(f"{node}: its glass does not bend light, one sees straight through it")
    # Fresnel's reflectance at normal incidence, over the one that a specular of 1 stands for.
    index = index_of(node, "int_ior", DEFAULT_INDEX) / index_of(node, "ext_ior", INDICES["air"])
    mirrored = ((index - 1.0) / (index + 1.0)) ** 2
    if is_thin:  # what goes to and fro between its two sides included
        mirrored = 2.0 * mirrored / (1.0 + mirrored)
    # Light that passes is tinted by the base colour.
    tint, texture = color_input(node, "specular_transmittance", 1.0, source)
    return Material(
        base_color=at_most_one(tint),
        base_color_texture=texture,
        **roughness_of(node, source),
        specular=limited(mirrored / DIELECTRIC_REFLECTANCE, node, source),
        transmission=1.0,
    )


def _polarizer(node: Node, source: Source) -> Material:
    """As unpolarised light meets it: half of its transmittance is left, the rest is absorbed."""
    source.note(f"{node}: light has no polarisation here, and half of it passes")
    node.get("theta")
    share = 0.5 * sum(color_input(node, "transmittance", 1.0, source)[0]) / 3.0
    black = replace(GREY, base_color=(0.0, 0.0, 0.0), **SIDES["both"])
    return replace(black, alpha=min(max(1.0 - share, 0.0), 1.0), is_blended=True)


def _null(node: Node, source: Source) -> Material:
    raise NoSurface


_READERS: dict[str, Callable[[Node, Source], Material]] = {
    "diffuse": _diffuse,
    "twosided": _twosided,
    "mask": _mask,
    "normalmap": _normalmap,
    "bumpmap": _bumpmap,
    "blendbsdf": _blend,
    "principled": _principled,
    "principledthin": _principled_thin,
    "conductor": _conductor,
    "roughconductor": _conductor,
    "plastic": _plastic,
    "roughplastic": _plastic,
    "pplastic": _plastic,
    "dielectric": _glass,
    "roughdielectric": _glass,
    "thindielectric": _glass,
    "polarizer": _polarizer,
    "circular": _polarizer,
    "null": _null,
}
