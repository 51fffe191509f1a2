"""A studio to show a thing in: a seamless backdrop, soft light from above, and the lights' glows.

The map belongs to the scene's directional lights. Its lower half is as bright as a matte ground
of GROUND_ALBEDO under them and under the upper half, and the upper half begins with that radiance:
where such a ground ends, or meets the horizon, nothing is seen.
"""

from __future__ import annotations

import functools
from collections.abc import Sequence

import numpy as np

from ..maths.colour import luminance
from ..maths.latlong import latlong_row_solid_angles, latlong_texel_directions
from ..maths.transforms import smoothstep
from .checks import F32, F64, Rgb
from .environment import Environment
from .lights import DirectionalLight, Light
from .sun_sky import MAP_HEIGHT

NAME = "builtin:studio"
"""What an [environment] names as its file, and the `source` of the environment."""
GROUND_ALBEDO = 0.24
KEY_IRRADIANCE: Rgb = (26.0, 25.0, 23.5)
"""W m^-2 at normal incidence, of the light that the other radiances are made for."""

PRINTED = 1.6
"""Display-referred: a white sheet of albedo .8 is shown as 1.2, a stop and a half above which
highlights still have room in the film curve."""

_DOME = np.array((0.75, 0.86, 1.02))
_TOP = np.array((3.0, 3.2, 3.5))
_COVE_TOP = 0.25
"""The sine of the elevation up to which the backdrop passes over into the dome."""
_SOFTBOX = (0.7, 0.95)
"""The sines of the elevations between which the light overhead sets in."""
_GLOW, _GLOW_POWER = 0.3, 32
"""Radiance of a light's glow over its irradiance, sr^-1, and the power of its cosine."""
_RIM, _RIM_POWER, _RIM_ELEVATION_DEG = 0.22, 48, 35.0
"""The same of the glow across from it."""


def studio(lights: Sequence[Light]) -> Environment:
    """The environment that belongs to the directional lights among `lights`."""
    shine = tuple(light for light in lights if isinstance(light, DirectionalLight))
    return Environment(map=_map(shine), source=NAME)


@functools.lru_cache(maxsize=4)
def _map(lights: tuple[DirectionalLight, ...]) -> F32:
    # One map serves all scenes with the same lights.
    made = studio_map(lights)
    made.flags.writeable = False
    return made


def studio_light(towards_light: F64) -> tuple[DirectionalLight, Environment]:
    """The key light from a unit vector, and the environment that belongs to it."""
    x, y, z = (-float(v) for v in towards_light)
    key = DirectionalLight(direction=(x, y, z), irradiance=KEY_IRRADIANCE)
    return key, studio((key,))


def incident_stops(key: DirectionalLight, environment: Environment, towards_eye: F64) -> float:
    """The exposure, stops, by the light that falls on a thing seen from `towards_eye`, (3,).

    As photographers hold a meter: it faces halfway from the eye to the key light. There a matte
    surface of albedo a is shown as one of radiance a PRINTED, whatever else the image holds: dark
    things stay dark and white ones white.
    """
    towards_key = -np.array(key.direction) / np.linalg.norm(key.direction)
    normal = towards_key + towards_eye / np.linalg.norm(towards_eye)
    length = float(np.linalg.norm(normal))
    # A key light from straight behind the thing leaves no way between.
    normal = normal / length if length > 1e-6 else towards_key
    received = np.array(key.irradiance) * max(float(normal @ towards_key), 0.0)
    radiance = np.asarray(environment.map, np.float64)
    height, width = radiance.shape[:2]
    facing = np.maximum(latlong_texel_directions(height, width) @ normal, 0.0)
    weights = facing * latlong_row_solid_angles(height, width)[:, None]
    received += np.einsum("hw,hwc->c", weights, radiance)
    return round(float(np.log2(PRINTED * np.pi / luminance(received))), 2)


def studio_map(lights: Sequence[Light], height: int = MAP_HEIGHT) -> F32:
    """Radiance (height, 2 height, 3), W m^-2 sr^-1; `height` is even."""
    directions = latlong_texel_directions(height, 2 * height)
    up = directions[: height // 2, :, 1]
    # What hangs in the room, and the share of the backdrop that shows between it.
    dome = _DOME + (_TOP - _DOME) * smoothstep(*_SOFTBOX, up)[..., None]
    hidden = smoothstep(0.0, _COVE_TOP, up)[..., None]
    hung = hidden * (dome + _glows(lights, directions[: height // 2]))
    # The backdrop is lit by what hangs, by the lights, and by itself: c = a / pi (E + c F).
    weights = (up * latlong_row_solid_angles(height, 2 * height)[: height // 2, None])[..., None]
    received = (hung * weights).sum(axis=(0, 1)) + _level_irradiance(lights)
    of_itself = float(((1.0 - hidden) * weights).sum())
    share = GROUND_ALBEDO / np.pi
    backdrop = share * received / (1.0 - share * of_itself)
    # Nothing but the backdrop below the horizon.
    below = np.broadcast_to(backdrop, (height - height // 2, 2 * height, 3))
    radiance = np.concatenate([hung + (1.0 - hidden) * backdrop, below])
    return np.asarray(radiance, np.float32)


def _directional(lights: Sequence[Light]) -> list[tuple[F64, F64]]:
    """(unit vector towards it, irradiance) of each directional light above the horizon."""
    return [
        (-np.array(light.direction) / np.linalg.norm(light.direction), np.array(light.irradiance))
        for light in lights
        if isinstance(light, DirectionalLight) and light.direction[1] < 0.0
    ]


def _level_irradiance(lights: Sequence[Light]) -> F64:
    """W m^-2 (3,) that level ground receives from the directional lights."""
    parts = [irradiance * towards[1] for towards, irradiance in _directional(lights)]
    return np.asarray(np.sum([np.zeros(3), *parts], axis=0))


def _glows(lights: Sequence[Light], directions: F64) -> F64:
    """Radiance (..., 3) of a soft box around each light, and of a smaller one across from it.

    Metals and coats mirror them: without, they would show an empty room.
    """
    glows = np.zeros(directions.shape)
    rise = np.radians(_RIM_ELEVATION_DEG)
    for towards, irradiance in _directional(lights):
        cosine = np.maximum(directions @ towards, 0.0)[..., None]
        glows += _GLOW * irradiance * cosine**_GLOW_POWER
        # Across: the light's azimuth turned by half, at an elevation of its own.
        flat = np.array((towards[0], 0.0, towards[2]))
        length = float(np.linalg.norm(flat))
        across = -np.cos(rise) * flat / max(length, 1e-9) + (0.0, np.sin(rise), 0.0)
        cosine = np.maximum(directions @ across, 0.0)[..., None]
        glows += _RIM * irradiance * cosine**_RIM_POWER * min(1.0, length)
    return glows
