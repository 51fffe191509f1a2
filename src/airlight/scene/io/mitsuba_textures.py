"""Mitsuba's textures: bitmaps, checkerboards and constants, as colours and airlight textures."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any, cast

import numpy as np
from numpy.typing import NDArray

from ...errors import SceneError
from ...maths.colour import srgb_decode, srgb_encode
from ..checks import F32, Rgb
from ..material import Texture, Wrap
from .images import read_radiance, read_texture
from .mitsuba_nodes import Folders, Node
from .mitsuba_values import Spectrum
from .texture_files import missing_texture

CHECKER_PX = 128
FLOAT_SUFFIXES = (".exr", ".hdr", ".pic", ".rgbe", ".pfm")


COLOURED = ("vertex_color", "face_color")
"""Attributes of meshes that are colours, by how their names begin."""


@dataclass
class Source:
    """Where a scene's files lie, and what there is to tell about it."""

    path: Path
    folders: Folders
    notes: list[str] = field(default_factory=list)
    textures: dict[Any, tuple[Texture, float] | None] = field(default_factory=dict)

    def note(self, text: str) -> None:
        """Tell it once."""
        if text not in self.notes:
            self.notes.append(text)

    def file(self, node: Node) -> Path:
        """The file that `node` names. Raises SceneError."""
        name = str(node.get("filename", ""))
        if not name:
            raise SceneError(f"{node} names no file", where=self.path)
        return self.folders.find(name, self.path)


def color_input(
    node: Node, name: str, default: float, source: Source, *, is_color: bool = True
) -> tuple[Rgb, Texture | None]:
    """A colour parameter: (factor, texture). One is neutral where the other says all.

    `is_color`: the texture is a colour, stored sRGB-encoded; else data, stored as it is.
    """
    # A plain value: a number, a triple or a spectrum.
    child = node.child(name)
    if child is None:
        value = node.get(name, default)
        if isinstance(value, Spectrum):
            if value.is_reduced:
                source.note("spectra are reduced to red, green and blue")
            value = value.emitted if node.tag == "emitter" else value
        return rgb_of(value), None
    # A texture, by its kind; any other plugin cannot be a colour.
    node.read.add(name)
    if child.tag == "texture":
        return texture_input(child, source, is_color=is_color)
    source.note(f"{node}: a {child.tag} as '{name}' is left out")
    return (default,) * 3, None


def rgb_of(value: Any) -> Rgb:
    """One number as grey; three as they are."""
    if isinstance(value, (int, float)):
        return (float(value),) * 3
    r, g, b = value
    return (float(r), float(g), float(b))


def scalar_input(
    node: Node, name: str, default: float, source: Source
) -> tuple[float, Texture | None]:
    """A parameter of one number, or a data texture with the factor of its channels."""
    factor, texture = color_input(node, name, default, source, is_color=False)
    r, g, b = factor
    return (r if r == g == b else (r + g + b) / 3.0), texture


def color_attribute(shape: Node) -> str:
    """What the material of a shape calls the colours of its mesh; "" where it asks for none."""
    todo = shape.all("bsdf")
    while todo:
        node = todo.pop()
        for child in node.children:
            if child.kind == "mesh_attribute":
                name = str(child.values.get("name", ""))
                if name.startswith(COLOURED):
                    return name
        todo += node.all("bsdf")
    return ""


def mean_input(node: Node, name: str, source: Source) -> float:
    """A parameter that is one number here, 0 by default; of an image the mean, with a note."""
    factor, texture = scalar_input(node, name, 0.0, source)
    if texture is None:
        return factor
    source.note(f"{node}: of its image '{name}' the mean is taken")
    return factor * float(texture.pixels[..., 0].mean()) / 255.0


def texture_input(node: Node, source: Source, *, is_color: bool) -> tuple[Rgb, Texture | None]:
    """A texture as factor and image, as `color_input`."""
    # A bitmap that cannot be read leaves a mid grey where it is data.
    if node.kind == "bitmap":
        found = bitmap(node, source, is_color=is_color)
        return ((found[1],) * 3, found[0]) if found else ((0.5,) * 3, None)
    if node.kind == "checkerboard":
        return (1.0, 1.0, 1.0), _checkerboard(node, source, is_color)
    # Colours of a mesh multiply every material here already.
    if node.kind == "mesh_attribute":
        if is_color and str(node.get("name", "")).startswith(COLOURED):
            return (float(node.get("scale", 1.0)),) * 3, None
        source.note(f"{node}: only colours of vertices and faces are read, a mid grey stands in")
        return (0.5, 0.5, 0.5), None
    source.note(f"{node} is unknown, a mid grey stands in")
    return (0.5, 0.5, 0.5), None


def bitmap(
    node: Node, source: Source, *, is_color: bool, is_cut: bool = False, is_raw: bool = False
) -> tuple[Texture, float] | None:
    """An airlight texture and the factor that its 8 bits are to be multiplied with.

    `is_cut`: only whether a value is above one half counts, so filtering hardly does. `is_raw`: it
    is not decoded from sRGB, whatever the file says.
    """
    path = source.file(node)
    raw = bool(node.get("raw", False)) or is_raw
    # The same file may be a colour here and data there, which decode differently.
    key = (path, raw, is_color)
    if key not in source.textures:
        # An image that cannot be read costs the texture, not the scene.
        try:
            source.textures[key] = _read(path, raw, is_color)
        except SceneError as error:
            stands = "a magenta checker stands in" if is_color else "the surface goes without"
            source.note(f"{str(error).rstrip('.')}; {stands}")
            source.textures[key] = (missing_texture(path.name), 1.0) if is_color else None
    found = source.textures[key]
    if found is None:
        return None
    # Sharp texels are not kept: all textures are filtered.
    if node.get("filter_type", "bilinear") != "bilinear" and not is_cut:
        source.note(f"{node}: {path.name} is filtered, though the scene says it should not be")
    return _placed(found[0], node, source), found[1]


def _read(path: Path, raw: bool, is_color: bool) -> tuple[Texture, float]:
    """8 bits as they are; float pixels scaled to their largest value, then rounded to 8 bits."""
    if path.suffix.lower() not in FLOAT_SUFFIXES:
        found = read_texture(path, is_srgb=is_color and not raw)
        # An alpha channel says nothing to Mitsuba.
        pixels = found.pixels.copy()
        pixels[..., 3] = 255
        # It decodes sRGB unless `raw`, of weights and roughness, too; here data are linear.
        if not is_color and not raw:
            linear = np.round(255.0 * np.asarray(srgb_decode(np.arange(256) / 255.0)))
            pixels[..., :3] = linear.astype(np.uint8)[pixels[..., :3]]
        return replace(found, pixels=pixels), 1.0
    # Values above 1 need a factor, as 8 bits end at 1.
    values = read_radiance(path)
    top = max(1.0, float(values.max()))
    return to_texture(values / np.float32(top), is_color=is_color, source=str(path)), top


def to_texture(values: F32, *, is_color: bool, source: str) -> Texture:
    """(H, W, 3) in [0, 1] as 8 bits: sRGB-encoded for colours."""
    encoded = srgb_encode(values) if is_color else np.clip(values, 0.0, 1.0)
    rgb = np.round(encoded * 255.0).astype(np.uint8)
    opaque = np.full((*rgb.shape[:2], 1), 255, np.uint8)
    pixels: NDArray[np.uint8] = np.concatenate([rgb, opaque], axis=2)
    return Texture(pixels, is_srgb=is_color, source=source)


def _placed(texture: Texture, node: Node, source: Source) -> Texture:
    """With the node's wrapping and uv transform."""
    # One mode for both axes.
    mode = node.get("wrap_mode", "repeat")
    if mode not in ("repeat", "mirror", "clamp"):
        raise SceneError(f"{node}: wrap_mode '{mode}' is unknown", where=source.path)
    wrap = cast(Wrap, mode)
    # A scale and a shift for each axis; a turn does not fit into them.
    to_uv = node.get("to_uv")
    scale, offset = (1.0, 1.0), (0.0, 0.0)
    if to_uv is not None:
        scale = (float(to_uv[0, 0]), float(to_uv[1, 1]))
        offset = (float(to_uv[0, 3]), float(to_uv[1, 3]))
        if to_uv[0, 1] != 0.0 or to_uv[1, 0] != 0.0:
            source.note(f"{node}: the turn in its to_uv is left out")
    return replace(texture, wrap=(wrap, wrap), scale=scale, offset=offset)


def _checkerboard(node: Node, source: Source, is_color: bool) -> Texture:
    """Two by two fields, baked: color0 where both halves agree."""
    colors = [
        color_input(node, name, d, source)[0] for name, d in (("color0", 0.4), ("color1", 0.2))
    ]
    # Each field is half of the image wide and high.
    half = np.arange(CHECKER_PX) >= CHECKER_PX // 2
    alike = half[:, None] == half[None, :]
    values = np.where(alike[..., None], colors[0], colors[1]).astype(np.float32)
    return _placed(to_texture(values, is_color=is_color, source="checkerboard"), node, source)
