"""All lights in one storage buffer."""

from __future__ import annotations

import math
from typing import Any

from ..gpu.layout import Struct, f32, u32, vec2f, vec3f
from ..scene.lights import DirectionalLight, Light, PointLight, SpotLight
from .light_views import view_count

DIRECTIONAL, POINT, SPOT = 0, 1, 2


class LightData(Struct):
    """A light, as shaders see it."""

    color = vec3f("W m^-2 (directional) or W sr^-1")
    kind = u32("0 directional, 1 point, 2 spot")
    position = vec3f("m")
    cos_inner = f32()
    direction = vec3f("of travel")
    cos_outer = f32()
    first_view = u32()
    view_count = u32()
    pad = vec2f()


def light_fields(light: Light, first_view: int = 0) -> dict[str, Any]:
    """The values of `LightData`."""
    fields: dict[str, Any] = {
        "color": (0, 0, 0), "kind": DIRECTIONAL, "position": (0, 0, 0), "cos_inner": -1.0,
        "direction": (0, -1, 0), "cos_outer": -1.0, "first_view": first_view,
        "view_count": view_count(light), "pad": (0, 0),
    }  # fmt: skip
    match light:
        case DirectionalLight():
            fields |= {"color": light.irradiance, "direction": light.direction}
        case PointLight():
            fields |= {"color": light.intensity, "kind": POINT, "position": light.position}
        case SpotLight():
            fields |= {
                "color": light.intensity, "kind": SPOT, "position": light.position,
                "direction": light.direction,
                "cos_inner": math.cos(math.radians(light.inner_deg)),
                "cos_outer": math.cos(math.radians(light.outer_deg)),
            }  # fmt: skip
    return fields


def light_rows(lights: tuple[Light, ...]) -> list[dict[str, Any]]:
    """One row per light; directional lights count their views apart from local ones."""
    rows, used = [], {True: 0, False: 0}
    for light in lights:
        is_parallel = isinstance(light, DirectionalLight)
        rows.append(light_fields(light, used[is_parallel]))
        used[is_parallel] += view_count(light)
    return rows
