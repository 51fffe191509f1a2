"""What prims of a USD stage ask for and do not get: a warning for each kind, which names the first.

A property that airlight does not read is told where it is set to another value than its schema's
fallback; a number that makes no sense, an unknown input of a light, a prim of a type that
OpenUSD does not know, and what moves are told as well.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from ...errors import Kinds, left_out

_LOST = {
    **dict.fromkeys(("cornerIndices", "creaseIndices"), "edges of subdivided meshes are smooth"),
    "subdivisionScheme": "the cage of a subdivided mesh is shown, with smooth normals",
    "primvars:displayOpacity": "left out",
    **dict.fromkeys(("inputs:diffuse", "inputs:specular"), "lights light all of a surface"),
    **dict.fromkeys(("light:filters", "portals", "treatAsLine"), "left out"),
    "inputs:texture:file": "the light has one colour",
    "inputs:texture:format": "an image is taken by latitude and longitude",
    "inputs:angle": "shadows of distant lights are sharp",
    **dict.fromkeys(("horizontalApertureOffset", "verticalApertureOffset"), "left out"),
    **dict.fromkeys(("clippingPlanes", "shutter:open", "shutter:close"), "left out"),
    "exposure": "cameras are exposed by the image",
}
_LOST_FAMILIES = (
    "inputs:shaping:",
    "inputs:shadow:",
    "exposure:",
    "collection:lightLink:",
    "collection:shadowLink:",
)
_READ_OF = {
    "DomeLight": ("inputs:texture:file",),
    "SphereLight": ("inputs:shaping:cone:angle", "inputs:shaping:cone:softness"),
}
"""What others lack, by the kind of prim that has it."""
_BESIDE = ("expansionRule", "includeRoot", "mode")
"""Of a collection, what says nothing without its members."""
_NOT_NEGATIVE = (
    *("inputs:intensity", "inputs:radius", "inputs:width", "inputs:height", "inputs:length"),
    *("inputs:angle", "inputs:color", "inputs:colorTemperature"),
    *("size", "radius", "height", "width", "length"),
    *("focalLength", "horizontalAperture", "verticalAperture", "fStop", "focusDistance"),
)


class UsdLosses:
    """What was found, prim by prim; `texts` tells it, `time` being what is shown."""

    def __init__(self, time: Any) -> None:
        self._time = time
        self._seen: set[str] = set()
        self._kinds, self._moving = Kinds(), Kinds()

    def look(self, prim: Any, *, moves: bool) -> None:
        """Take note of a prim; of one in a prototype only once. `moves`: its place may."""
        from pxr import Usd

        owner = prim.GetPrimInPrototype() if prim.IsInstanceProxy() else prim
        if str(owner.GetPath()) in self._seen:
            return
        self._seen.add(str(owner.GetPath()))
        # A type that the library does not know is nothing that is shown.
        kind = str(prim.GetTypeName())
        if kind and not prim.GetPrimTypeInfo().GetSchemaType():
            self._note(f"type {kind}", prim, f"a {kind} is left out")
        known = prim.GetPrimDefinition().GetPropertyNames()
        read = _READ_OF.get(kind.partition("_")[0], ())
        for prop in prim.GetAuthoredProperties():
            name = str(prop.GetName())
            is_place = moves and name.startswith("xformOp:")
            if isinstance(prop, Usd.Attribute) and prop.GetNumTimeSamples() > 1 and not is_place:
                at = f"what moves stands as at {self._at()}: "
                self._moving.note("", f"{at}'{prim.GetPath()}' {name}")
            if name in known:
                self._check(prim, prop, name, read=read)
            elif name.startswith("inputs:") and "inputs:intensity" in known:
                self._note(name, prim, left_out("input", name, known))

    def look_hidden(self, prim: Any) -> None:
        """Take note of a prim that is not shown now, and may appear later; of none below it."""
        from pxr import UsdGeom

        visibility = UsdGeom.Imageable(prim).GetVisibilityAttr()
        values = [visibility.Get(code) for code in visibility.GetTimeSamples()]
        is_now = visibility.Get(self._time) == UsdGeom.Tokens.invisible
        if is_now and any(value != UsdGeom.Tokens.invisible for value in values):
            text = f"it is invisible at {self._at()} and appears later, which is left out"
            self._note("appears", prim, text)

    def texts(self) -> list[str]:
        """The warnings: each kind once, with how many more there are."""
        return [*self._moving.texts(), *self._kinds.texts()]

    def _at(self) -> str:
        return (
            "the first time" if self._time.IsEarliestTime() else f"time {self._time.GetValue():g}"
        )

    def _check(self, prim: Any, prop: Any, name: str, *, read: tuple[str, ...]) -> None:
        from pxr import Usd

        if not isinstance(prop, Usd.Attribute):
            # Links of lights, and filters: relationships that lead somewhere.
            if self._words(name) and prop.HasAuthoredTargets() and prop.GetTargets():
                self._note(name, prim, f"{name} is set: {self._words(name)}")
            return
        words = "" if name in read else self._words(name)
        # Values of other properties, long arrays among them, are not read.
        value = prop.Get(self._time) if words or name in _NOT_NEGATIVE else None
        if value is None:
            return
        if name in _NOT_NEGATIVE:
            self._check_numbers(prim, name, value)
        if words and _is_set(prim, name, value):
            self._note(name, prim, f"{name} is set: {words}")

    def _check_numbers(self, prim: Any, name: str, value: Any) -> None:
        try:
            numbers = np.array(value, np.float64)
        except (TypeError, ValueError):  # of another type than its schema says
            return
        for number in numbers.ravel()[:4]:
            if not np.isfinite(number) or number < 0.0:
                wrong = "below 0" if number < 0.0 else "no finite number"
                self._note(f"{name} {wrong}", prim, f"{name} is {number:g}, {wrong}")

    @staticmethod
    def _words(name: str) -> str:
        if name.rpartition(":")[2] in _BESIDE:
            return ""
        is_of_family = any(name.startswith(family) for family in _LOST_FAMILIES)
        return _LOST.get(name, "left out" if is_of_family else "")

    def _note(self, key: str, prim: Any, text: str) -> None:
        self._kinds.note(key, f"'{prim.GetPath()}': {text}")


def _is_set(prim: Any, name: str, value: Any) -> bool:
    """Whether a value asks for something: another one than the schema's fallback."""
    if name == "subdivisionScheme":
        return bool(value != "none")
    if name == "inputs:texture:format" and str(value) in ("automatic", "latlong"):
        return False
    fallback = prim.GetPrimDefinition().GetAttributeFallbackValue(name)
    if hasattr(value, "__len__") and not isinstance(value, str) and len(value) == 0:
        return False
    try:
        return bool(value != fallback)
    except (TypeError, ValueError):
        return True


_INPUTS = {
    **dict.fromkeys(("diffuseColor", "roughness", "metallic", "opacity"), (0.0, 1.0)),
    "emissiveColor": (0.0, np.inf),
    "opacityThreshold": (0.0, 1.0),
    "ior": (0.0, np.inf),
    "normal": (-np.inf, np.inf),
}
"""Inputs of UsdPreviewSurface that are read, and the least and the most of their numbers."""
_USUAL_INPUTS = {
    **dict.fromkeys(("useSpecularWorkflow", "clearcoat", "displacement"), (0,)),
    "opacityMode": ("transparent", "presence"),
}
"""Others, and values by which they ask for nothing."""
_ASIDE = ("specularColor", "clearcoatRoughness", "occlusion")
"""What goes with those, and occlusion, which is part of the light that is computed."""


def surface_losses(shader: Any, time: Any) -> list[str]:
    """What a UsdPreviewSurface asks for that is not read, or is out of its range."""
    from pxr import UsdShade

    told = []
    for given in shader.GetInputs():
        name = str(given.GetBaseName())
        sources = UsdShade.Utils.GetValueProducingAttributes(given)
        ends = [a for a in sources if not UsdShade.Output.IsOutput(a)]
        value = ends[0].Get(time) if ends else None
        # Inputs that are no part of the surface, those that are read only as usual, and those read.
        if name not in (*_INPUTS, *_USUAL_INPUTS, *_ASIDE):
            told.append(left_out("input", name, _INPUTS))
        elif name in _USUAL_INPUTS:
            is_connected = any(UsdShade.Output.IsOutput(a) for a in sources)
            if is_connected or (value is not None and value not in _USUAL_INPUTS[name]):
                told.append(f"its {name} is left out")
        elif name in _INPUTS:
            kinds = [_kind(a) for a in sources if UsdShade.Output.IsOutput(a)]
            others = [kind for kind in kinds if kind != "UsdUVTexture"]
            told += [f"its {name} comes from a {kind}, which is not read" for kind in others]
            told += _beyond(name, value)
    return told


def _kind(output: Any) -> str:
    from pxr import UsdShade

    shader = UsdShade.Shader(output.GetPrim())
    return str(shader.GetIdAttr().Get()) if shader else "shader of no kind"


def _beyond(name: str, value: Any) -> list[str]:
    low, high = _INPUTS[name]
    try:
        numbers = np.array([] if value is None else value, np.float64).ravel()
    except (TypeError, ValueError):
        return []
    wrong = [n for n in numbers if not low <= n <= high]
    bounds = f"{low:g} to {high:g}" if np.isfinite(high) else f"{low:g} upwards"
    return [f"its {name} is {n:g}, outside of {bounds}: the nearest is taken" for n in wrong[:1]]
