"""What Mitsuba's BSDFs share: indices of refraction and roughness as numbers of ours."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from ..checks import Rgb
from ..material import Texture
from .mitsuba_nodes import Node
from .mitsuba_textures import Source, scalar_input
from .texture_mix import packed_roughness_metallic, raised

INDICES = {"air": 1.000277, "vacuum": 1.0, "water": 1.333, "bk7": 1.5046, "acrylic glass": 1.49}
DEFAULT_INDEX = 1.5046
DIELECTRIC_REFLECTANCE = 0.04


def roughness_of(node: Node, source: Source) -> dict[str, Any]:
    """The fields of a Material: the square root of Mitsuba's alpha; 0 for the smooth kinds."""
    if not node.kind.startswith("rough") and node.kind != "pplastic":
        return {"roughness": 0.0}
    if node.get("distribution", "beckmann") != "ggx":
        source.note(f"{node}: its Beckmann lobe is read as GGX of the same alpha")
    # The geometric mean of both widths keeps the area of the lobe.
    widths = [name for name in ("alpha_u", "alpha_v") if name in node.values or node.child(name)]
    given = [scalar_input(node, name, 0.1, source) for name in widths or ("alpha",)]
    if len(given) == 1 and widths:  # the other one is Mitsuba's default
        given.append((0.1, None))
    if len(given) == 2 and not _is_one(given[0], given[1]):
        source.note(f"{node}: its anisotropic roughness is read as its geometric mean")
    # Mitsuba's alpha is the square of our roughness.
    power = 0.5 / len(given)
    textures = [texture for _, texture in given if texture is not None]
    factor = math.prod(max(value, 0.0) for value, _ in given) ** power
    packed = packed_roughness_metallic(raised(textures, power), None) if textures else None
    return {"roughness": min(1.0, factor), "metallic_roughness_texture": packed}


def _is_one(a: tuple[float, Texture | None], b: tuple[float, Texture | None]) -> bool:
    """Whether two widths are the same number, or the same image."""
    if (a[1] is None) != (b[1] is None) or a[0] != b[0]:
        return False
    return a[1] is None or b[1] is None or np.array_equal(a[1].pixels, b[1].pixels)


def index_of(node: Node, name: str, default: float) -> float:
    """The index of refraction of a parameter: a number, or a material's name."""
    value = node.get(name, default)
    return float(INDICES.get(value, DEFAULT_INDEX)) if isinstance(value, str) else float(value)


def specular_of(index: float, node: Node, source: Source) -> float:
    """Ours, from a relative index of refraction."""
    f0 = ((index - 1.0) / (index + 1.0)) ** 2
    return limited(f0 / DIELECTRIC_REFLECTANCE, node, source)


def limited(specular: float, node: Node, source: Source) -> float:
    """A scale of our dielectric reflectance as a Material can have it."""
    # Up to 5 % the cut hardly shows; only more gets a note.
    if specular > 1.25:
        source.note(f"{node}: it reflects more than 4% head on, which is cut to 4%")
    return min(1.0, max(0.0, specular))


def at_most_one(color: Rgb) -> Rgb:
    """The colour, each channel from 0 to 1."""
    r, g, b = (min(1.0, max(0.0, c)) for c in color)
    return (r, g, b)
