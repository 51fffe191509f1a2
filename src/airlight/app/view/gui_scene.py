"""The panel's controls of the scene: lights, sky, fog and volumes."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any, assert_never

import numpy as np
from imgui_bundle import imgui

from ...scene.checks import Vec3
from ...scene.lights import Light
from ...scene.lights.light_key import Control
from ...scene.medium import Medium
from ...scene.scene import Scene
from ...scene.sun_sky import (
    LEAST_TURBIDITY,
    LOWEST_DEG,
    MOST_TURBIDITY,
    Sky,
)
from ...scene.volume import Volume
from .state import ViewState, fog_for, source_angles_deg, travel_from

_PAD_PX = 110.0
_LEAST_SIGMA, _MOST_SIGMA = 1e-4, 1e3
_LOGARITHMIC = imgui.SliderFlags_.logarithmic
_GOLD = 0xFF40C8FF  # imgui's order: alpha, blue, green, red


def light_controls(state: ViewState) -> None:
    """Choose a light, turn or move it, and what it gives; and the sky."""
    lights = state.scene.lights
    if lights:
        names = [f"{i + 1}  {light.noun}" for i, light in enumerate(lights)]
        state.light = min(state.light, len(lights) - 1)
        _, state.light = imgui.combo("light", state.light, names)
        changed = _edited(lights[state.light], state.scene)
        if changed is not None:
            state.set_light(state.light, changed)
    environment = state.scene.environment
    if (environment is None or environment.sky is None) and imgui.button("sun and sky"):
        state.put_sky(Sky())
    if environment is None:
        return
    if environment.sky is not None:
        _sky_controls(state, environment.sky)
        return
    scaled, scale = imgui.slider_float(
        "sky", environment.scale, 0.0, 10.0, "%.3g", imgui.SliderFlags_.logarithmic
    )
    turned, degrees = imgui.slider_float("sky turned", environment.rotation_deg, -180.0, 180.0)
    seen, visible = imgui.checkbox("sky is seen", environment.visible)
    if scaled or turned or seen:
        changes: dict[str, Any] = {"scale": scale, "rotation_deg": degrees, "visible": visible}
        state.scene = replace(state.scene, environment=replace(environment, **changes))


def _sky_controls(state: ViewState, sky: Sky) -> None:
    """Where the sun of a computed sky stands, and its haze; a drag turns it, too."""
    bar = imgui.slider_float
    up, elevation = bar("sun's elevation", sky.elevation_deg, LOWEST_DEG, 90.0, "%.1f")
    round_, azimuth = bar("sun's azimuth", sky.azimuth_deg % 360.0, 0.0, 360.0, "%.0f")
    hazed, turbidity = bar(
        "haze (turbidity)", sky.turbidity, LEAST_TURBIDITY, MOST_TURBIDITY, "%.1f"
    )
    if up or round_ or hazed:
        new = replace(sky, elevation_deg=elevation, azimuth_deg=azimuth, turbidity=turbidity)
        state.put_sky(new)


def media_controls(state: ViewState) -> None:
    """Fog and volumes: how much, how white, how far forwards."""
    scene = state.scene
    if scene.medium is None:
        if imgui.button("add fog"):
            state.scene = replace(scene, medium=fog_for(scene))
    else:
        fog = _scattering(scene.medium, "fog")
        if fog is not None:
            state.scene = replace(scene, medium=fog)
        if imgui.button("no fog"):
            state.scene = replace(state.scene, medium=None)
    for index, volume in enumerate(scene.volumes):
        imgui.separator_text(f"volume {index + 1}")
        changed = _scattering(volume, f"volume {index + 1}")
        if changed is not None:
            state.set_volume(index, changed)


def _edited(light: Light, scene: Scene) -> Light | None:
    """The light as the widgets leave it, or None where they left it alone."""
    low, high = scene.bounds
    step = float(np.linalg.norm(high - low)) / 500.0
    edited = light
    for key in light.controls():
        assert key.control is not None
        shown = getattr(light, key.name)
        changed, value = _shown(key.control, shown, step)
        if changed:
            edited = edited.changed(key.name, value)
    return None if edited is light else edited


def _shown(control: Control, value: Any, step: float) -> tuple[bool, Any]:
    """A field's widget: whether a hand changed it, and its value now. `step`: m for each pixel."""
    label = control.label
    match control.widget:
        case "point":
            changed, place = imgui.drag_float3(label, list(value), step)
            return changed, _triple(place)
        case "sky":
            return _sky_pad(label, value)
        case "angle":
            changed, angle = imgui.slider_float(label, value, 1.0, 89.0)
            return changed, float(angle)
        case "length":
            changed, length = imgui.drag_float(label, value, step, step, 1e4)
            return changed, float(length)
        case "lengths":
            changed, pair = imgui.drag_float2(label, list(value), step, step, 1e4)
            return changed, (float(pair[0]), float(pair[1]))
        case "strength":
            return _strength(label, value)
        case _:
            assert_never(control.widget)


def _sky_pad(label: str, direction: Vec3) -> tuple[bool, Vec3]:
    """A pad that is the sky seen from below the ground, north up; and the angles."""
    azimuth, elevation = source_angles_deg(direction)
    corner = imgui.get_cursor_screen_pos()
    imgui.invisible_button(f"{label} pad", (_PAD_PX, _PAD_PX))
    radius = _PAD_PX / 2.0
    centre = (corner.x + radius, corner.y + radius)
    # A quick hand lets go in the frame in which it arrives.
    is_dragged = imgui.is_item_active() or imgui.is_item_deactivated()
    if is_dragged:
        mouse = imgui.get_io().mouse_pos
        x, y = (mouse.x - centre[0]) / radius, (mouse.y - centre[1]) / radius
        azimuth = float(np.degrees(np.arctan2(x, y)))
        elevation = float(np.clip(90.0 * (1.0 - np.hypot(x, y)), -5.0, 90.0))
    _pad(centre, radius, azimuth, elevation)
    imgui.same_line()
    imgui.begin_group()
    imgui.push_item_width(80.0)
    turned, azimuth = imgui.drag_float("azimuth", azimuth, 0.5, -180.0, 180.0, "%.1f")
    raised, elevation = imgui.drag_float("elevation", elevation, 0.5, -90.0, 90.0, "%.1f")
    imgui.pop_item_width()
    imgui.end_group()
    return is_dragged or turned or raised, travel_from(azimuth, elevation)


def _pad(centre: tuple[float, float], radius: float, azimuth: float, elevation: float) -> None:
    draw = imgui.get_window_draw_list()
    draw.add_circle_filled(centre, radius, 0xFF4A3A30, 48)
    for share in (1.0, 2.0 / 3.0, 1.0 / 3.0):
        draw.add_circle(centre, radius * share, 0xFF807870, 48)
    away = min((90.0 - elevation) / 90.0, 1.05) * radius
    a = np.radians(azimuth)
    sun = (centre[0] + float(np.sin(a)) * away, centre[1] + float(np.cos(a)) * away)
    draw.add_circle_filled(sun, 7.0, _GOLD, 24)


def _strength(label: str, rgb: Sequence[float]) -> tuple[bool, tuple[float, float, float]]:
    """A logarithmic slider of the largest channel, and a colour with that at 1."""
    largest = max(*rgb, 1e-6)
    tinted, colour = imgui.color_edit3(
        f"##{label}",
        [c / largest for c in rgb],
        imgui.ColorEditFlags_.no_inputs | imgui.ColorEditFlags_.float,
    )
    imgui.same_line()
    scaled, strength = imgui.slider_float(label, largest, 1e-3, 1e4, "%.3g", _LOGARITHMIC)
    return tinted or scaled, _triple([c * strength for c in colour])


def _scattering(of: Any, label: str) -> Any:
    """The medium or volume as the widgets leave it, or None where they left it alone."""
    assert isinstance(of, (Medium, Volume))
    changes: dict[str, Any] = {}
    largest = max(*of.sigma_t, _LEAST_SIGMA)
    changed, sigma = imgui.slider_float(
        f"extinction (1/m)##{label}", largest, _LEAST_SIGMA, _MOST_SIGMA, "%.4g", _LOGARITHMIC
    )
    if changed:
        even = max(of.sigma_t) <= 0.0
        changes["sigma_t"] = _triple([sigma if even else c * sigma / largest for c in of.sigma_t])
    changed, albedo = imgui.color_edit3(
        f"albedo##{label}", list(of.albedo), imgui.ColorEditFlags_.float
    )
    if changed:
        changes["albedo"] = _triple([float(np.clip(c, 0.0, 1.0)) for c in albedo])
    changed, g = imgui.slider_float(f"g: back / forth##{label}", of.g[1], -0.98, 0.98, "%.2f")
    if changed:
        changes["g"] = (g, g, g)
    return replace(of, **changes) if changes else None


def _triple(values: Sequence[float]) -> tuple[float, float, float]:
    return (float(values[0]), float(values[1]), float(values[2]))
