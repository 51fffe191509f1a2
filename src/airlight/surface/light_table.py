"""The light table: all lights of a scene in one storage buffer."""

from __future__ import annotations

import math
from typing import Any, assert_never

import numpy as np
from numpy.typing import NDArray

from ..gpu.layout import Struct, f32, pack_array, u32, vec3f
from ..scene.lights import AreaLight, DirectionalLight, Light, LightSample, PointLight, SpotLight
from .light_views import view_count

DIRECTIONAL, POINT, SPOT, SAMPLE = 0, 1, 2, 3
_MOST_RECENT = 8


class LightData(Struct):
    """One light, as shaders read it."""

    color = vec3f("W m^-2 (directional) or W sr^-1")
    kind = u32("0 directional, 1 point, 2 spot, 3 sample of a light with extent")
    position = vec3f("m")
    cos_inner = f32("of a sample: `front`")
    direction = vec3f("of travel")
    cos_outer = f32("of a sample: `even`")
    first_view = u32()
    view_count = u32()
    nearest = f32("m^2, squares of distances are no smaller")
    pad = f32()


def light_fields(light: Light, first_view: int = 0) -> dict[str, Any]:
    """The values of `LightData`."""
    fields: dict[str, Any] = {
        "color": (0, 0, 0),
        "kind": DIRECTIONAL,
        "position": (0, 0, 0),
        "cos_inner": -1.0,
        "direction": (0, -1, 0),
        "cos_outer": -1.0,
        "first_view": first_view,
        "view_count": view_count(light),
        "nearest": 1e-8,
        "pad": 0.0,
    }
    match light:
        case DirectionalLight():
            fields |= {"color": light.irradiance, "direction": light.direction}
        case PointLight():
            fields |= {"color": light.intensity, "kind": POINT, "position": light.position}
        case SpotLight():
            fields |= {
                "color": light.intensity,
                "kind": SPOT,
                "position": light.position,
                "direction": light.direction,
                "cos_inner": math.cos(math.radians(light.inner_deg)),
                "cos_outer": math.cos(math.radians(light.outer_deg)),
            }
        case LightSample():
            fields |= {
                "color": light.intensity,
                "kind": SAMPLE,
                "position": light.position,
                "direction": light.direction,
                "cos_inner": light.front,
                "cos_outer": light.even,
                "nearest": max(light.extent**2, 1e-8),
            }
        case AreaLight():  # comes as samples
            pass
        case _:
            assert_never(light)
    return fields


def light_rows(lights: tuple[Light, ...]) -> list[dict[str, Any]]:
    """One row per light; views of directional and of local lights are counted separately."""
    rows, used = [], {True: 0, False: 0}
    for light in lights:
        is_parallel = isinstance(light, DirectionalLight)
        rows.append(light_fields(light, used[is_parallel]))
        used[is_parallel] += view_count(light)
    return rows


_recent: tuple[tuple[tuple[Light, ...], NDArray[np.void]], ...] = ()


def packed_lights(lights: tuple[Light, ...]) -> NDArray[np.void]:
    """The table of `LightData`, read-only, cached for the lights asked for last.

    A sky is a hundred lights, and several tables of them are asked for in every frame.
    """
    global _recent
    # Tuples of the very same lights compare without looking into them.
    table = next((found for given, found in _recent if given == lights), None)
    if table is None:
        table = pack_array(LightData, light_rows(lights))
        table.flags.writeable = False
    rest = tuple(entry for entry in _recent if entry[1] is not table)
    _recent = ((lights, table), *rest)[:_MOST_RECENT]
    return table
