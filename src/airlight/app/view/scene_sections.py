"""The panel's sections of the scene's lights and sky."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import replace
from typing import Any, assert_never

import numpy as np

from ...scene.environment import Environment
from ...scene.lights.light_key import Control, LightKey
from ...scene.sun_sky import LEAST_TURBIDITY, LOWEST_DEG, MOST_TURBIDITY, Sky
from .state import ViewState, line_angles_deg, source_angles_deg, travel_from
from .widgets import Widget

NO_SKY, UNIFORM, SUN_AND_SKY, MAP = "none", "uniform", "sun and sky", "map"


def lights(state: ViewState) -> Iterator[Widget]:
    """Choose a light, turn or move it, and what it gives."""
    all_lights = state.scene.lights
    if not all_lights:
        return
    # Lights by their number and type.
    names = tuple(f"{i + 1}  {light.noun}" for i, light in enumerate(all_lights))
    index = min(state.light, len(names) - 1)

    def choose(name: str) -> None:
        state.light = state.picked = names.index(name)

    yield Widget("light", "choice", "light", names[index], choose, choices=names)
    light = all_lights[index]
    for key, control in light.controls():
        yield from _of_light(state, index, key, control)


def _of_light(state: ViewState, index: int, key: LightKey, control: Control) -> Iterator[Widget]:
    """The widgets of one field of a light; what needs another renderer counts at rest."""
    name, label, step = f"light.{index}.{key.name}", control.label, _step(state)
    value, waits, tip = getattr(state.scene.lights[index], key.name), not key.moves, _told(key)

    def put(new: Any) -> None:
        state.set_light(index, state.scene.lights[index].changed(key.name, new))

    # Each kind of field has its widget; types that are new fail the type check here.
    match control.widget:
        case "point":
            yield Widget(name, "vector", label, tuple(value), put, step=step, tip=tip)
        case "choice":
            yield Widget(name, "choice", label, value, put, choices=control.choices, tip=tip)
        case "sky":
            angles = source_angles_deg(value)
            yield Widget(name, "sky", label, angles, lambda a: put(travel_from(*a)), tip=tip)
        case "line":
            yield Widget(name, "sky", label, line_angles_deg(value), _along(put), tip=tip)
        case "angle":
            yield Widget(name, "number", label, value, put, 1.0, 89.0, tip=tip)
        case "length":
            ends = (step if key.moves else 0.0, 500.0 * step)
            yield Widget(name, "number", label, value, put, *ends, key.moves, tip=tip, waits=waits)
        case "lengths":
            sizes = _positive(put, step)
            yield Widget(name, "vector", label, tuple(value), sizes, step=step, tip=tip)
        case "strength":
            yield from _strength(name, label, value, put)
        case "colour":
            yield Widget(name, "colour", label, value, put, tip=tip, waits=waits)
        case "flag":
            yield Widget(name, "flag", label, value, put, tip=tip)
        case _:
            assert_never(control.widget)


def _told(key: LightKey) -> str:
    """What the scene file's reference says of a field."""
    return f"{key.name}: {key.doc}"


def _along(put: Callable[[Any], None]) -> Callable[[Any], None]:
    return lambda angles: put(tuple(-v for v in travel_from(*angles)))


def _step(state: ViewState) -> float:
    low, high = state.scene.bounds
    return float(np.linalg.norm(high - low)) / 500.0 or 1e-3


def _positive(put: Callable[[Any], None], least: float) -> Callable[[Any], None]:
    return lambda lengths: put(tuple(max(float(v), least) for v in lengths))


def _strength(
    name: str, label: str, rgb: tuple[float, ...], put: Callable[[Any], None]
) -> Iterator[Widget]:
    """The largest channel, and a colour in which that is 1."""
    largest = max(*rgb, 1e-6)
    colour = tuple(c / largest for c in rgb)
    yield Widget(name, "number", label, largest, lambda v: put(scaled(colour, v)), 1e-3, 1e4, True)
    yield Widget(f"{name}.colour", "colour", "colour", colour, lambda c: put(scaled(c, largest)))


def scaled(colour: tuple[float, ...], strength: float) -> tuple[float, float, float]:
    """A colour times a strength."""
    r, g, b = (float(c) * strength for c in colour)
    return r, g, b


def sky(state: ViewState) -> Iterator[Widget]:
    """What surrounds the scene: nothing, one radiance, the file's map, or a sky with its sun."""
    environment, own = state.scene.environment, state.own_environment
    # The file's own map stays a choice while another environment is shown.
    names = (NO_SKY, UNIFORM, SUN_AND_SKY, *([MAP] if own is not None else []))

    def choose(name: str) -> None:
        if name == SUN_AND_SKY:
            state.put_sky(Sky())
        else:
            chosen = {NO_SKY: None, UNIFORM: Environment((0.5, 0.5, 0.5)), MAP: own}[name]
            state.put_environment(chosen)

    # The kind first; what else can be changed follows from it.
    yield Widget("sky.kind", "choice", "environment", _kind(environment), choose, choices=names)
    if environment is None:
        return
    if environment.sky is not None:
        yield from _of_sky(state, environment.sky)
        return
    put = _putter(state, environment)
    yield Widget("sky.scale", "number", "scale", environment.scale, put("scale"), 0.0, 10.0, True)
    if environment.map is None:
        yield from _strength("sky.radiance", "radiance", environment.radiance, put("radiance"))
    else:
        # Turning shows on a map only.
        turned = environment.rotation_deg
        yield Widget(
            "sky.turned", "number", "turned (degrees)", turned, put("rotation_deg"), -180.0, 180.0
        )
    yield Widget("sky.seen", "flag", "it is seen", environment.visible, put("visible"))


def _kind(environment: Environment | None) -> str:
    if environment is None:
        return NO_SKY
    if environment.sky is not None:
        return SUN_AND_SKY
    return UNIFORM if environment.map is None else MAP


def _putter(state: ViewState, environment: Environment) -> Callable[[str], Callable[[Any], None]]:
    def put(name: str) -> Callable[[Any], None]:
        return lambda value: state.put_environment(replace(environment, **{name: value}))

    return put


def _of_sky(state: ViewState, sky: Sky) -> Iterator[Widget]:
    """Where the sun of a computed sky stands, and its haze; a drag turns it, too."""

    def put(name: str) -> Callable[[Any], None]:
        return lambda value: state.put_sky(replace(sky, **{name: value}))

    up, round_, hazy = put("elevation_deg"), put("azimuth_deg"), put("turbidity")
    yield Widget("sun.up", "number", "sun's elevation", sky.elevation_deg, up, LOWEST_DEG, 90.0)
    yield Widget(
        "sun.round", "number", "sun's azimuth", sky.azimuth_deg % 360.0, round_, 0.0, 360.0
    )
    ends = (LEAST_TURBIDITY, MOST_TURBIDITY)
    yield Widget("sun.haze", "number", "haze (turbidity)", sky.turbidity, hazy, *ends)
