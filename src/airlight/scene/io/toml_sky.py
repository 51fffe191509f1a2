"""[sky] of a scene file: read and written."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import fields, replace
from datetime import datetime, timedelta, timezone
from typing import Any

from ...errors import SceneError
from ..environment import Environment
from ..scene import Scene
from ..sun_sky import Sky, sky_at, zone_of
from .toml_schema import check_table, inside
from .toml_tables import SKY

_ANGLES = ("elevation_deg", "azimuth_deg")
_PLACE = ("latitude_deg", "longitude_deg", "date", "time")
_OF_PLACE = (*_PLACE, "utc_offset_h")


def read_sky(raw: Mapping[str, Any]) -> Sky | None:
    """The sky of a scene file, None where it has none. Raises SceneError."""
    if "sky" not in raw:
        return None
    label = SKY.header
    values = check_table(SKY, raw["sky"], label)
    # One of them says what is all around.
    if "environment" in raw:
        raise SceneError(f"{label} stands beside [environment]", remedy="Use one of them.")
    # Keys of the place are apart from those of the sky.
    placed = {name: values.pop(name) for name in _OF_PLACE if name in values}
    north_deg = values.pop("north_deg", 0.0)
    with inside(label):
        sky = _placed(placed, values) if placed else Sky(**values)
        # Azimuths of skies are those of the scene's axes.
        return replace(sky, azimuth_deg=sky.azimuth_deg + north_deg)


def _placed(placed: dict[str, Any], values: dict[str, Any]) -> Sky:
    # The sun's direction is said once, by angles or by place and time.
    angles = [name for name in _ANGLES if name in values]
    if angles:
        raise SceneError(
            f"{angles[0]} stands beside a place", remedy="Use angles or place and time."
        )
    missing = [name for name in _PLACE if name not in placed]
    if missing:
        raise SceneError(
            f"a place and time lack {missing[0]}", remedy=f"Write {', '.join(_PLACE)}."
        )
    # The hour is that of the place, unless its offset is said.
    offset = placed.get("utc_offset_h")
    zone = zone_of(placed["longitude_deg"])
    if offset is not None:
        zone = timezone(timedelta(hours=offset))
    when = datetime.combine(placed["date"], placed["time"], zone)
    turbidity = values.pop("turbidity", Sky.turbidity)
    made = sky_at(placed["latitude_deg"], placed["longitude_deg"], when, turbidity=turbidity)
    return replace(made, **values)


def under(scene: Scene, sky: Sky | None) -> Scene:
    """The scene as read, with the sky of its file; its own lights stay as they are.

    The sun comes last, so that keyframes of lights keep their numbers.
    """
    if sky is None:
        return scene
    return replace(scene, lights=(*scene.lights, sky.sun()), environment=Environment.of_sky(sky))


def sky_table(scene: Scene, original: Scene, raw: Mapping[str, Any]) -> dict[str, Any]:
    """[sky] of a scene that was read as `original` from a file with the table `raw`."""
    sky = scene.environment.sky if scene.environment is not None else None
    if sky is None:
        return {}
    # A sky that nobody changed is written as the file has it, by place and time if it was so.
    before = original.environment.sky if original.environment is not None else None
    if sky == before and raw:
        return dict(raw)
    # Only what differs from the defaults, and the angles, which say where the sun is.
    usual = Sky()
    return {
        field.name: getattr(sky, field.name)
        for field in fields(Sky)
        if field.name in _ANGLES or getattr(sky, field.name) != getattr(usual, field.name)
    }
