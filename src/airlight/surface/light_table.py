"""The light table: all lights of a scene in one storage buffer."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..gpu.layout import Struct, f32, pack_array, u32, vec3f
from ..gpu.rows import table
from ..gpu.slots import sampler, texture
from ..scene.lights import DirectionalLight, Light, LightRow
from .light_views import LightViewData, view_count

_MOST_RECENT = 8


class LightData(Struct):
    """One light, as shaders read it."""

    color = vec3f("W m^-2 (directional) or W sr^-1")
    kind = u32("`LightType.kind`")
    position = vec3f("m")
    shape_x = f32("of what it sends by direction: `LightRow.shape`")
    direction = vec3f("of travel")
    shape_y = f32()
    first_view = u32()
    view_count = u32()
    nearest = f32("m^2, squares of distances are no smaller")
    size_y = f32("m, across the tangent: `LightRow.size`")
    tangent = vec3f()
    size_x = f32("m, along it")
    inner_depth = vec3f("`LightRow.inner_depth`")
    spread = f32("m, of a light that fills a volume")


LIGHT_VIEW_SLOTS = (
    table("lights", LightData),
    table("parallel_views", LightViewData),
    table("local_views", LightViewData),
)
"""Of passes that look up lights and the views of their shadow maps."""
SHADOWED_LIGHT_SLOTS = (
    *LIGHT_VIEW_SLOTS,
    texture("parallel_shadows", "2d-array", "depth"),
    texture("local_shadows", "2d-array", "depth"),
    sampler("shadow_compare", "comparison"),
)
"""Of passes that look up their shadow maps, too; `lighting.lights.Lights.bound` binds them."""


def shared_fields(row: LightRow) -> dict[str, Any]:
    """The values that every struct with a light in it has."""
    return {
        "color": row.color,
        "kind": row.kind,
        "position": row.position,
        "shape_x": row.shape[0],
        "direction": row.direction,
        "shape_y": row.shape[1],
    }


def light_rows(lights: tuple[Light, ...]) -> list[dict[str, Any]]:
    """`LightData` of each light; views of directional and of local lights are counted apart."""
    # Parallel and local views lie in two arrays, each counted from 0.
    rows, used = [], {True: 0, False: 0}
    for light in lights:
        is_parallel = isinstance(light, DirectionalLight)
        row = light.row()
        rows.append(
            {
                **shared_fields(row),
                "first_view": used[is_parallel],
                "view_count": view_count(light),
                "nearest": row.nearest,
                "tangent": row.tangent,
                "size_x": row.size[0],
                "size_y": row.size[1],
                "inner_depth": row.inner_depth,
                "spread": row.spread,
            }
        )
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

    # The one just found leads; the one asked for longest ago makes room.
    rest = tuple(entry for entry in _recent if entry[1] is not table)
    _recent = ((lights, table), *rest)[:_MOST_RECENT]
    return table
