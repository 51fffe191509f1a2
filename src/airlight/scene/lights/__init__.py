"""Lights, a module for each type. Directions are travel directions: away from the light.

    files, Python, viewer -> keys, checked -> a light -> row (shaders), emitters (Mitsuba),
    punctual (glTF)

light_type   what a type of light says of itself, which is all that others ask
light_key    its fields: check, unit, meaning, whether keyframes and the viewer change them
emitters     what a type gives for Mitsuba, written by `reference.mitsuba_lights`
directional, point, spot, area   the types that a scene may have
sample       a part of a light with extent, made on the way to the device
lights.wgsl, light_kinds.wgsl    the same types as shaders know them

A new type is a module here, its row in `Light` and `TYPES`, and its branch in the two shaders.
"""

from __future__ import annotations

from .area import AREA_SHAPES, AreaLight, AreaShape
from .directional import DirectionalLight
from .light_type import LightRow, LightType
from .point import PointLight
from .sample import LightSample
from .spot import SpotLight

LightFromPoint = PointLight | SpotLight | LightSample
"""Lights that shadow maps see from one point."""
Light = DirectionalLight | AreaLight | LightFromPoint

TYPES: dict[str, type[Light]] = {
    cls.type_name: cls for cls in (DirectionalLight, PointLight, SpotLight, AreaLight)
}
"""What a scene may have, by the names of scene files."""

__all__ = [
    "AREA_SHAPES",
    "TYPES",
    "AreaLight",
    "AreaShape",
    "DirectionalLight",
    "Light",
    "LightFromPoint",
    "LightRow",
    "LightSample",
    "LightType",
    "PointLight",
    "SpotLight",
]
