"""UsdPreviewSurface as a Material: numbers, images, and how they are read."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from ...errors import SceneError
from ..checks import Rgb
from ..material import Material, Texture, Wrap, specular_of
from .images import read_texture
from .texture_files import missing_texture
from .texture_mix import is_soft, packed_roughness_metallic, with_alpha
from .usd_losses import surface_losses
from .usd_stage import resolved_asset

_WRAPS: dict[str, Wrap] = {"repeat": "repeat", "mirror": "mirror", "clamp": "clamp"}
_CHANNELS = {"r": 0, "g": 1, "b": 2, "a": 3}
USUAL = Material(name="usd", base_color=(0.8, 0.8, 0.8), roughness=0.5)
_PREVIEW = "UsdPreviewSurface"


class UsdMaterials:
    """The materials of a stage, each read once; trouble goes to `warnings`."""

    def __init__(self, folder: Path, time: Any) -> None:
        self._folder, self._time = folder, time
        self.warnings: list[str] = []
        self._made: dict[tuple[str, bool, bool], Material] = {}
        self._images: dict[tuple[str, bool], Texture] = {}

    def of(self, prim: Any, *, has_colors: bool) -> Material:
        """The material of a prim; where it has none, white under its displayColor, or grey."""
        from pxr import UsdGeom

        # A subset has a material of its own, and the sides of its mesh.
        bound = _bound(prim)
        mesh = prim if prim.IsA(UsdGeom.Gprim) else prim.GetParent()
        sided = UsdGeom.Gprim(mesh).GetDoubleSidedAttr().Get(self._time) or False
        key = (str(bound.GetPath()) if bound else "", bool(sided), has_colors)
        if key not in self._made:
            self._made[key] = self._read(bound, two_sided=key[1], has_colors=has_colors)
        return self._made[key]

    def uv_name(self, prim: Any) -> str:
        """The primvar of texture coordinates that a prim's material reads."""
        # The base colour's image says which coordinates; all others are read by the same.
        surface = self._surface(prim)
        shader = self._producer(surface, "diffuseColor")[0] if surface else None
        name = None
        if shader is not None and shader.GetInput("st"):
            reader = self._reader(shader)
            name = self._value(reader, "varname") if reader is not None else None
        return str(name) if name else "st"

    def _surface(self, prim: Any) -> Any:
        bound = _bound(prim)
        shader = bound.ComputeSurfaceSource()[0] if bound else None
        return shader if shader and shader.GetIdAttr().Get() == _PREVIEW else None

    def _read(self, bound: Any, *, two_sided: bool, has_colors: bool) -> Material:
        white = (1.0, 1.0, 1.0) if has_colors else USUAL.base_color
        usual = replace(USUAL, base_color=white, two_sided=two_sided)
        # Without a material, or with one of another kind, the colour of the mesh alone.
        if not bound:
            return usual
        name = str(bound.GetPath())
        shader = bound.ComputeSurfaceSource()[0]
        if not shader or shader.GetIdAttr().Get() != _PREVIEW:
            self.warnings.append(f"{name}: has no {_PREVIEW}: it is shown grey")
            return replace(usual, name=name)
        self.warnings += [f"{name}: {text}" for text in surface_losses(shader, self._time)]
        # Images and numbers of UsdPreviewSurface; where there is an image, it alone counts.
        base = self._texture(shader, "diffuseColor", is_color=True)
        emission = self._texture(shader, "emissiveColor", is_color=True)
        images = {n: self._texture(shader, n, is_color=False) for n in ("roughness", "metallic")}
        opacity = self._texture(shader, "opacity", is_color=False)
        threshold = float(self._value(shader, "opacityThreshold") or 0.0)
        # Without a threshold opacity blends, else it cuts holes.
        alpha = 1.0 if opacity else float(np.clip(self._number(shader, "opacity", 1.0), 0.0, 1.0))
        is_blended = threshold <= 0.0 and (
            alpha < 1.0 or (opacity is not None and is_soft(opacity))
        )
        if opacity is not None:
            base = with_alpha(base, opacity)
            threshold = threshold or (0.0 if is_blended else 0.5)
        # One image holds roughness and metal; a number beside an image is 1.
        numbers = {
            n: 1.0 if images[n] else float(np.clip(self._number(shader, n, usual_value), 0, 1))
            for n, usual_value in (("roughness", 0.5), ("metallic", 0.0))
        }
        if images["roughness"] and not images["metallic"]:
            packed = packed_roughness_metallic(images["roughness"], None)
        else:
            packed = packed_roughness_metallic(images["roughness"], images["metallic"])
        return Material(
            name=name,
            base_color=(1.0,) * 3 if base else self._color(shader, "diffuseColor", 0.18, high=1.0),
            base_color_texture=base,
            alpha=alpha,
            alpha_cutoff=float(np.clip(threshold, 0.0, 1.0)),
            is_blended=is_blended,
            metallic_roughness_texture=packed,
            normal_texture=self._texture(shader, "normal", is_color=False),
            emission=(1.0,) * 3 if emission else self._color(shader, "emissiveColor", 0.0),
            emission_texture=emission,
            two_sided=two_sided,
            roughness=numbers["roughness"],
            metallic=numbers["metallic"],
            specular=min(specular_of(self._number(shader, "ior", 1.5)), 1.0),
        )

    def _producer(self, shader: Any, name: str) -> tuple[Any, str]:
        """The UsdUVTexture that an input is connected to, and which output; (None, "") without."""
        from pxr import UsdShade

        given = shader.GetInput(name)
        for attribute in UsdShade.Utils.GetValueProducingAttributes(given) if given else ():
            source = UsdShade.Shader(attribute.GetPrim())
            if source and source.GetIdAttr().Get() == "UsdUVTexture":
                return source, attribute.GetBaseName()
        return None, ""

    def _reader(self, texture: Any, name: str = "st") -> Any:
        """The primvar reader behind a texture's coordinates, past a transform."""
        from pxr import UsdShade

        for attribute in UsdShade.Utils.GetValueProducingAttributes(texture.GetInput(name)):
            source = UsdShade.Shader(attribute.GetPrim())
            kind = str(source.GetIdAttr().Get()) if source else ""
            if kind.startswith("UsdPrimvarReader"):
                return source
            if kind == "UsdTransform2d" and name == "st":
                return self._reader(source, "in")
        return None

    def _value(self, shader: Any, name: str) -> Any:
        """What an input is, through connections to interfaces; None where nothing says it."""
        from pxr import UsdShade

        given = shader.GetInput(name)
        for attribute in UsdShade.Utils.GetValueProducingAttributes(given) if given else ():
            if not UsdShade.Output.IsOutput(attribute):
                return attribute.Get(self._time)
        return None

    def _number(self, shader: Any, name: str, usual: float) -> float:
        value = self._value(shader, name)
        return usual if value is None else float(value)

    def _color(self, shader: Any, name: str, usual: float, high: float = 1e6) -> Rgb:
        value = self._value(shader, name)
        r, g, b = (usual,) * 3 if value is None else np.clip(np.array(value, float), 0.0, high)
        return (float(r), float(g), float(b))

    def _texture(self, shader: Any, name: str, *, is_color: bool) -> Texture | None:
        """The image of an input. Of one channel, in data, that channel is in all of them."""
        source, channel = self._producer(shader, name)
        if source is None:
            return None
        place = f"{shader.GetPath()}: the image of {name}"
        image = self._image(source, place, is_color=is_color)
        # The texel is scale times the image plus bias.
        scale = np.array(self._value(source, "scale") or (1.0,) * 4, float)
        bias = np.array(self._value(source, "bias") or (0.0,) * 4, float)
        # Data in one channel, with scale and bias worked in, as images have no such keys here.
        if not is_color and name != "normal" and channel in _CHANNELS:
            plane = image.pixels[..., _CHANNELS[channel]] / 255.0
            k = _CHANNELS[channel]
            plane = np.clip(plane * scale[k] + bias[k], 0.0, 1.0)
            pixels = np.full((*plane.shape, 4), 255, np.uint8)
            pixels[..., :3] = np.round(plane * 255.0).astype(np.uint8)[..., None]
            image = replace(image, pixels=pixels)
        elif name != "normal" and (not np.allclose(scale, 1.0) or bias.any()):
            self.warnings.append(f"{place}: its scale and bias are left out")
        # Wrapping by axis; the format's other modes repeat.
        wraps = [str(self._value(source, f"wrap{axis}") or "repeat") for axis in "ST"]
        for axis, wrap in zip("ST", wraps, strict=True):
            if wrap not in (*_WRAPS, "useMetadata"):
                self.warnings.append(f"{place}: its wrap{axis} '{wrap}' is left out: it repeats")
        wrap_s, wrap_t = (_WRAPS.get(name, "repeat") for name in wraps)
        return self._placed(replace(image, wrap=(wrap_s, wrap_t)), source, place)

    def _placed(self, image: Texture, source: Any, place: str) -> Texture:
        """With the scale and translation of a UsdTransform2d before its coordinates."""
        from pxr import UsdShade

        given = source.GetInput("st")
        for attribute in UsdShade.Utils.GetValueProducingAttributes(given) if given else ():
            moved = UsdShade.Shader(attribute.GetPrim())
            if moved and moved.GetIdAttr().Get() == "UsdTransform2d":
                if self._number(moved, "rotation", 0.0):
                    self.warnings.append(f"{place}: its rotation is left out")
                su, sv = (float(x) for x in self._value(moved, "scale") or (1.0, 1.0))
                tu, tv = (float(x) for x in self._value(moved, "translation") or (0.0, 0.0))
                # v runs downwards here: 1 - (sv (1 - v) + tv).
                return replace(image, scale=(su, sv), offset=(tu, 1.0 - sv - tv))
        return image

    def _image(self, source: Any, place: str, *, is_color: bool) -> Texture:
        # Each image is read once for each coding.
        value = self._value(source, "file")
        asset = str(value.path) if value is not None else ""
        # "auto" leaves the coding to what the image is used for.
        space = str(self._value(source, "sourceColorSpace") or "auto")
        is_srgb = space == "sRGB" or (space == "auto" and is_color)
        key = (f"{source.GetPath()} {asset}", is_srgb)
        if key not in self._images and not asset:
            self.warnings.append(f"{place}: it names no file: its fallback stands in")
            self._images[key] = self._fallback(source)
        if key not in self._images:
            try:
                self._images[key] = self._opened(source, asset, is_srgb)
            except SceneError as error:
                self.warnings.append(f"{place}: {error.problem}; a magenta checker stands in")
                self._images[key] = missing_texture(asset)
        return self._images[key]

    def _fallback(self, source: Any) -> Texture:
        """One texel of a UsdUVTexture's fallback, where there is no image; black without one."""
        value = np.array(self._value(source, "fallback") or (0.0, 0.0, 0.0, 1.0), float)
        texel = np.round(np.clip(value, 0.0, 1.0) * 255.0).astype(np.uint8)
        return Texture(texel.reshape(1, 1, 4), is_srgb=False)

    def _opened(self, source: Any, asset: str, is_srgb: bool) -> Texture:
        from pxr import Ar

        # A tiled image is many files, of which no single one is the texture.
        if "<UDIM>" in asset:
            raise SceneError(f"'{asset}' is tiled, which is not read")
        # A path is relative to the layer that wrote it, which need not be the stage's own.
        stack = source.GetInput("file").GetAttr().GetPropertyStack(self._time)
        producers = source.GetInput("file").GetValueProducingAttributes()
        stack = producers[0].GetPropertyStack(self._time) if producers else stack
        resolved = resolved_asset(stack[0].layer, asset, self._folder) if stack else ""
        opened = Ar.GetResolver().OpenAsset(Ar.ResolvedPath(resolved)) if resolved else None
        if not opened:
            raise SceneError(f"'{asset}' is missing")
        return read_texture(bytes(opened.GetBuffer()), is_srgb=is_srgb, source=asset)


def _bound(prim: Any) -> Any:
    """The material of a prim: for previews, for all purposes, or else the one for final images."""
    from pxr import UsdShade

    api, tokens = UsdShade.MaterialBindingAPI(prim), UsdShade.Tokens
    found = (api.ComputeBoundMaterial(purpose)[0] for purpose in (tokens.preview, tokens.full))
    return next((material for material in found if material), None)
