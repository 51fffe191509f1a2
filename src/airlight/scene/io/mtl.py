"""Wavefront MTL, with the physically based keys that exporters added, as airlight materials.

Kd, map_Kd        base colour (linear; the image is sRGB and multiplies, but a black Kd)
Ks, Ns            dielectric specular and roughness; a bright Ks over a black Kd is a metal
Pr, Pm, map_*     roughness and metallic; they win over Ks and Ns
d, Tr, map_d      coverage: below one half the surface is not there; Tr = 1 alone is opaque
Ke, map_Ke        emitted radiance
norm, map_Bump    normal map (a height map is told apart and left out)
"""

from __future__ import annotations

import dataclasses
import math
from pathlib import Path
from typing import Any

import numpy as np

from ...errors import SceneError
from ..material import Material, Texture
from .files import read_bytes
from .texture_files import TextureFiles
from .texture_mix import packed_roughness_metallic, with_alpha

DIELECTRIC_REFLECTANCE = 0.04
METAL_MAX_KD, METAL_MIN_KS = 0.05, 0.3

_OPTION_ARGUMENTS = {
    "-bm": 1,
    "-boost": 1,
    "-texres": 1,
    "-blendu": 1,
    "-blendv": 1,
    "-cc": 1,
    "-clamp": 1,
    "-imfchan": 1,
    "-type": 1,
    "-mm": 2,
}
_READ = frozenset(
    (
        *("kd", "map_kd", "ks", "ns", "pr", "pm", "map_pr", "map_pm", "ke", "map_ke", "illum"),
        *("d", "tr", "map_d", "map_opacity"),
        *("norm", "map_norm", "map_kn", "map_bump", "bump"),
    )
)
_MEANINGLESS = frozenset(("ka", "map_ka", "ni", "tf", "km", "sharpness", "map_aat"))
"""Ambient light, which is computed, and what exporters write whatever the material is."""
_VECTOR_OPTIONS = ("-s", "-o", "-t")


def load_mtl(path: Path, textures: TextureFiles) -> dict[str, Material]:
    """Materials by name. Texture names are looked up by `textures`, which takes the warnings.

    Raises SceneError with file and line for a number that is none.
    """
    blocks: dict[str, _Block] = {}
    block: _Block | None = None
    text = read_bytes(path).decode("utf-8", "replace").replace("\\\n", " ")
    for number, line in enumerate(text.splitlines(), start=1):
        keyword, _, rest = line.split("#", 1)[0].strip().replace("\t", " ").partition(" ")
        if keyword.lower() == "newmtl":
            block = _Block(rest.strip(), path)
            blocks.setdefault(block.name, block)
        elif keyword and block is not None:
            block.statements[keyword.lower()] = (rest.strip(), number)
    return {name: _material(block, textures) for name, block in blocks.items()}


class _Block:
    """The statements of one newmtl: lower-case key -> text and line."""

    def __init__(self, name: str, path: Path) -> None:
        self.name = name
        self.path = path
        self.statements: dict[str, tuple[str, int]] = {}

    def numbers(self, key: str) -> list[float] | None:
        """The numbers of a statement, None where it is absent or spectral."""
        if key not in self.statements:
            return None
        text, line = self.statements[key]
        words = text.split()
        if words and words[0] in ("spectral", "xyz", "-halo"):
            words = words[1:] if words[0] == "-halo" else []
        try:
            values = [float(word) for word in words]
        except ValueError:
            raise SceneError(
                f"'{key} {text}' is not a list of numbers", where=f"{self.path}, line {line}"
            ) from None
        if not all(math.isfinite(v) for v in values):
            raise SceneError(f"'{key} {text}' is not finite", where=f"{self.path}, line {line}")
        return values or None

    def number(self, key: str) -> float | None:
        values = self.numbers(key)
        return None if values is None else values[0]

    def color(self, key: str) -> tuple[float, float, float] | None:
        """A colour, not negative; one number is grey."""
        values = self.numbers(key)
        if values is None:
            return None
        values = [max(v, 0.0) for v in values]
        return (values[0], values[1], values[2]) if len(values) >= 3 else (values[0],) * 3

    def image(self, *keys: str) -> _ImageName | None:
        """The image that the first present of `keys` names."""
        for key in keys:
            name = _ImageName(self.statements[key][0]) if key in self.statements else None
            if name and name.file:
                return name
        return None


class _ImageName:
    """A texture statement: its options, then a file name that may hold spaces."""

    def __init__(self, text: str) -> None:
        self.options: dict[str, list[str]] = {}
        words = text.split(" ")
        while words and (words[0] in _OPTION_ARGUMENTS or words[0] in _VECTOR_OPTIONS):
            option = words.pop(0)
            limit = _OPTION_ARGUMENTS.get(option, 3)
            taken: list[str] = []
            # -s, -o and -t take one to three numbers, and the file's name comes last.
            while len(taken) < limit and len(words) > 1:
                if option in _VECTOR_OPTIONS and not _is_number(words[0]):
                    break
                taken.append(words.pop(0))
            self.options[option] = taken
        self.file = " ".join(words).strip()

    def vector(self, option: str, default: float) -> tuple[float, float]:
        values = [float(v) for v in self.options.get(option, []) if _is_number(v)]
        u = values[0] if values else default
        return u, values[1] if len(values) > 1 else default

    def number(self, option: str, default: float) -> float:
        words = self.options.get(option, [])
        return float(words[0]) if words and _is_number(words[0]) else default

    def placed(self, texture: Texture) -> Texture:
        """The texture with this statement's scale, offset and clamp.

        u' = u s + o holds with v upwards; ours runs downwards, so v' = v s + 1 - s - o.
        """
        (su, sv), (ou, ov) = self.vector("-s", 1.0), self.vector("-o", 0.0)
        clamped = self.options.get("-clamp") == ["on"]
        if (su, sv, ou, ov) == (1.0, 1.0, 0.0, 0.0) and not clamped:
            return texture
        wrap: Any = ("clamp", "clamp") if clamped else ("repeat", "repeat")
        return dataclasses.replace(texture, scale=(su, sv), offset=(ou, 1.0 - sv - ov), wrap=wrap)


def _is_number(word: str) -> bool:
    try:
        return math.isfinite(float(word))
    except ValueError:
        return False


def _material(block: _Block, textures: TextureFiles) -> Material:
    values: dict[str, Any] = {"name": block.name}
    values.update(_reflection(block, textures))
    values.update(_coverage(block, textures, _base_texture(block, textures)))
    values.update(_emission(block, textures))
    values.update(_normal_map(block, textures))
    unread = [key for key, (text, _) in block.statements.items() if _is_lost(key, text)]
    if unread:
        listed = ", ".join(f"'{key}'" for key in unread)
        textures.warnings.append(
            f"{block.path}: {listed} of '{block.name}' are not read and left out"
        )
    return Material(**values)


def _is_lost(key: str, text: str) -> bool:
    """Whether a statement says something that is not shown: nothing is said by zeros."""
    if key in _READ or key in _MEANINGLESS:
        return False
    return not all(_is_number(word) and float(word) == 0.0 for word in text.split())


def _base_texture(block: _Block, textures: TextureFiles) -> Texture | None:
    name = block.image("map_kd")
    return None if name is None else name.placed(textures.color(name.file))


def _reflection(block: _Block, textures: TextureFiles) -> dict[str, Any]:
    """Base colour, roughness, metallic and specular."""
    kd = block.color("kd") or (0.8, 0.8, 0.8)
    if max(kd) == 0.0 and block.image("map_kd") is not None:
        # Exporters write a black Kd beside an image, and viewers show the image.
        kd = (1.0, 1.0, 1.0)
    ks = block.color("ks") or (0.0, 0.0, 0.0)
    if max(kd) > 1.0:
        textures.warnings.append(f"{block.path}: Kd of '{block.name}' is above 1 and was cut")
        kd = (min(kd[0], 1.0), min(kd[1], 1.0), min(kd[2], 1.0))
    roughness, metallic = block.number("pr"), block.number("pm")
    is_metal = metallic is None and max(kd) < METAL_MAX_KD and max(ks) > METAL_MIN_KS
    values: dict[str, Any] = {"base_color": kd, "metallic": _unit(metallic or 0.0)}
    if is_metal and "map_kd" not in block.statements:
        values |= {"base_color": tuple(min(c, 1.0) for c in ks), "metallic": 1.0}
    has_map = "map_pr" in block.statements or "map_pm" in block.statements
    if roughness is None and has_map:
        roughness = 1.0
    values["roughness"] = _unit(_blinn_roughness(block) if roughness is None else roughness)
    if roughness is None and metallic is None:
        values["specular"] = _unit(sum(ks) / 3.0 / DIELECTRIC_REFLECTANCE)
    if has_map:
        values.update(_roughness_metallic_maps(block, textures, metallic))
    return values


def _blinn_roughness(block: _Block) -> float:
    """Perceptual roughness of a Blinn-Phong exponent Ns: alpha^2 = 2/(Ns + 2), alpha = r^2.

    Source: Walter2007, section 5.2 (matching Beckmann to Phong), with glTF's alpha = r^2.
    """
    exponent = block.number("ns")
    if exponent is None or block.number("illum") in (0.0, 1.0):
        return 1.0
    return float((2.0 / (max(exponent, 0.0) + 2.0)) ** 0.25)


def _roughness_metallic_maps(
    block: _Block, textures: TextureFiles, metallic: float | None
) -> dict[str, Any]:
    names = [block.image(key) for key in ("map_pr", "map_pm")]
    images = [textures.data(name.file) if name else None for name in names]
    packed = packed_roughness_metallic(images[0], images[1])
    if packed is None:
        return {}
    placed = next(name for name in names if name is not None).placed(packed)
    has_metal = images[1] is not None
    return {
        "metallic_roughness_texture": placed,
        "metallic": 1.0 if has_metal and metallic is None else _unit(metallic or 0.0),
    }


def _coverage(block: _Block, textures: TextureFiles, base: Texture | None) -> dict[str, Any]:
    """Alpha mask and base-colour texture. `d 0` beside a map_d is an exporter's habit: it is 1."""
    opacity, transparency = block.number("d"), block.number("tr")
    if transparency is not None and transparency >= 1.0 and opacity is None:
        # By the book it is invisible, which nobody means: MeshLab writes opacity under this name.
        textures.warnings.append(
            f"{block.path}: 'Tr {transparency:g}' of '{block.name}' is taken for opaque, as "
            "MeshLab means it; for a surface that is not there write d 0"
        )
        transparency = None
    alpha = 1.0 if transparency is None else 1.0 - transparency
    alpha = _unit(alpha if opacity is None else opacity)
    mask = block.image("map_d", "map_opacity")
    if mask is not None:
        image = textures.data(mask.file)
        if image is not None:
            return {
                "base_color_texture": with_alpha(base, mask.placed(image)),
                "alpha": alpha if alpha > 0.0 else 1.0,
                "alpha_cutoff": 0.5,
            }
    if alpha == 1.0:
        return {"base_color_texture": base}
    if alpha > 0.0:
        shown = "opaque" if alpha >= 0.5 else "left out"
        textures.warnings.append(
            f"{block.path}: '{block.name}' is {alpha:g} opaque; "
            f"see-through surfaces are not rendered, it is {shown}"
        )
    return {"base_color_texture": base, "alpha": alpha, "alpha_cutoff": 0.5}


def _emission(block: _Block, textures: TextureFiles) -> dict[str, Any]:
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


def _normal_map(block: _Block, textures: TextureFiles) -> dict[str, Any]:
    name = block.image("norm", "map_norm", "map_kn", "map_bump", "bump")
    texture = textures.data(name.file) if name else None
    if name is None or texture is None:
        return {}
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
