"""A clear sky with its sun, by angles or by place and time, as an environment and a light."""

from __future__ import annotations

import functools
import math
import re
from dataclasses import dataclass, replace
from datetime import UTC, datetime, timedelta, timezone
from typing import TYPE_CHECKING

import numpy as np

from ..errors import SceneError
from ..maths.atmosphere import Air
from ..maths.sun_position import sun_angles_deg
from ..maths.sunlight import SUN_RADIUS_DEG, sky_map, sun_irradiance
from . import checks
from .checks import F32, F64, Rgb
from .lights import DirectionalLight

if TYPE_CHECKING:
    from .scene import Scene

MAP_HEIGHT = 256
"""Rows of a sky's map: between two of them a clear sky bends by at most .13 % of its radiance."""
LEAST_TURBIDITY, MOST_TURBIDITY = 1.0, 10.0
LOWEST_DEG = -18.0
"""Astronomical twilight ends there: below, the model is night, which has no sunlight."""
MOST_DISK_RADIANCE = 60_000.0
"""W m^-2 sr^-1: images are stored as half floats. The sun's own is up to 140 times that."""


@dataclass(frozen=True)
class Sky:
    """A clear sky, of light scattered by air, haze and ozone, and its sun.

    `elevation_deg` above the horizon, -18 to 90; `azimuth_deg` from north (-Z) by east (+X).
    `turbidity` 1 to 10: 2 is very clear, 3 clear, 6 hazy. `ground`: albedo of what lies below the
    horizon. `scale` multiplies sun and sky. `disk`: the sun is seen. Raises SceneError.
    """

    elevation_deg: float = 40.0
    azimuth_deg: float = 135.0
    turbidity: float = 2.5
    ground: float = 0.2
    scale: float = 1.0
    disk: bool = True

    def __post_init__(self) -> None:
        def put(name: str, low: float, high: float) -> None:
            value = checks.number(getattr(self, name), f"sky {name}", low=low, high=high)
            object.__setattr__(self, name, value)

        put("elevation_deg", LOWEST_DEG, 90.0)
        put("azimuth_deg", -720.0, 720.0)
        put("turbidity", LEAST_TURBIDITY, MOST_TURBIDITY)
        put("ground", 0.0, 1.0)
        put("scale", 0.0, checks.MOST)
        object.__setattr__(self, "disk", checks.boolean(self.disk, "sky disk"))

    @property
    def towards_sun(self) -> F64:
        """Unit vector (3,)."""
        e, a = math.radians(self.elevation_deg), math.radians(self.azimuth_deg)
        return np.array([math.cos(e) * math.sin(a), math.sin(e), -math.cos(e) * math.cos(a)])

    @property
    def irradiance(self) -> Rgb:
        """W m^-2 that the sun gives a surface which faces it."""
        r, g, b = sun_irradiance(self._air, self.elevation_deg) * self.scale
        return float(r), float(g), float(b)

    def sun(self) -> DirectionalLight:
        """The sun as a light; black where it has set."""
        x, y, z = (-float(v) for v in self.towards_sun)
        return DirectionalLight(direction=(x, y, z), irradiance=self.irradiance)

    def map(self) -> F32:
        """Radiance (256, 512, 3) of sky and ground, without the sun."""
        air = (self.turbidity, self.ground)
        radiance = _map(*air, self.elevation_deg, self.azimuth_deg)
        return np.asarray(radiance * np.float32(self.scale))

    def turned_to(self, direction: tuple[float, float, float]) -> Sky:
        """The sky whose sun's light travels along `direction`; no lower than it can be."""
        x, y, z = np.negative(direction) / np.linalg.norm(direction)
        elevation = max(math.degrees(math.asin(float(np.clip(y, -1.0, 1.0)))), LOWEST_DEG)
        azimuth = math.degrees(math.atan2(x, -z)) % 360.0
        return replace(self, elevation_deg=elevation, azimuth_deg=azimuth)

    @property
    def disk_radiance(self) -> Rgb:
        """W m^-2 sr^-1 of the sun as it is seen; black where it is not."""
        # The solid angle of the disk spreads its irradiance; what half floats cannot hold is cut.
        solid_angle = 2.0 * math.pi * (1.0 - math.cos(math.radians(SUN_RADIUS_DEG)))
        radiance = np.array(self.irradiance) / solid_angle * self.disk
        most = float(radiance.max())
        r, g, b = radiance * min(1.0, MOST_DISK_RADIANCE / max(most, 1e-9))
        return float(r), float(g), float(b)

    @property
    def _air(self) -> Air:
        return Air(self.turbidity, self.ground)


def sky_at(latitude_deg: float, longitude_deg: float, when: datetime, *, turbidity: float) -> Sky:
    """The sky of a place, degrees, at a time with its zone.

    Raises SceneError at night, and for what is no place or no time.
    """
    # The sun's position goes by universal time, so a zone is needed.
    latitude = checks.number(latitude_deg, "latitude", low=-90.0, high=90.0)
    longitude = checks.number(longitude_deg, "longitude", low=-180.0, high=180.0)
    try:
        utc = when.astimezone(UTC).replace(tzinfo=None)
    except OverflowError:
        raise SceneError(
            f"{when.isoformat()} is no time at UTC", remedy="Write years from 2 to 9998."
        ) from None
    elevation, azimuth = sun_angles_deg(utc, latitude, longitude)
    # The model goes a little below the horizon, and no further.
    if elevation < LOWEST_DEG:
        raise SceneError(
            f"it is night: the sun stands {-elevation:.0f} degrees below the horizon",
            remedy=f"The sky model ends at {-LOWEST_DEG:.0f}: choose another time.",
        )
    return Sky(elevation, azimuth, turbidity)


def zone_of(longitude_deg: float) -> timezone:
    """The zone in whole hours that the longitude alone would have. Raises SceneError."""
    longitude = checks.number(longitude_deg, "longitude", low=-180.0, high=180.0)
    return timezone(timedelta(hours=round(longitude / 15.0)))


_WRITTEN = "ELEVATION,AZIMUTH or DATE-T-TIME@LATITUDE,LONGITUDE, such as 35,135 or "
_EXAMPLE = "2026-06-21T17:30+02:00@48.1,11.6; a third number is the turbidity"


def chosen_sky(sun: Sky | str | None) -> Sky | None:
    """A sky, that of text, or none. Raises SceneError for anything else."""
    if sun is None or isinstance(sun, Sky):
        return sun
    if isinstance(sun, str):
        return sky_of_text(sun)
    raise _not_a_sun(repr(sun))


def sky_of_text(text: str) -> Sky:
    """What `--sun` says. Raises SceneError for text that is neither angles nor a time and place."""
    # A time and a place, or angles alone; perhaps the turbidity behind them.
    when, at, rest = text.rpartition("@")
    numbers = re.split(r"\s*,\s*", rest.strip())
    try:
        first, second, *more = (float(part) for part in numbers)
        (turbidity,) = more or (Sky.turbidity,)
    except ValueError:
        raise _not_a_sun(text) from None
    # Angles alone, or a time, in the zone of the place where it says none.
    if not at:
        return Sky(first, second, turbidity)
    try:
        moment = datetime.fromisoformat(when.strip())
    except ValueError:
        raise _not_a_sun(text) from None
    if moment.tzinfo is None:
        moment = moment.replace(tzinfo=zone_of(second))
    return sky_at(first, second, moment, turbidity=turbidity)


def _not_a_sun(text: str) -> SceneError:
    return SceneError(f"'{text}' says no sun", remedy=f"Write {_WRITTEN}{_EXAMPLE}.")


def with_sky(scene: Scene, sky: Sky) -> Scene:
    """The scene under `sky`: instead of its environment and its directional lights.

    Where no exposure was chosen it comes from the image. The sun is the last light.
    """
    from .environment import Environment

    seen = scene.camera
    # An exposure of 0 was chosen by nobody, and the real sun needs another.
    if seen.exposure_stops == 0.0:
        seen = replace(seen, exposure_stops=None)
    # Local lights stay; the sky brings its own sun.
    kept = tuple(light for light in scene.lights if not isinstance(light, DirectionalLight))
    return replace(
        scene, lights=(*kept, sky.sun()), environment=Environment.of_sky(sky), camera=seen
    )


def without_sun(scene: Scene) -> Scene:
    """The scene without the sun of its computed sky, its last light."""
    has_sun = bool(scene.lights) and isinstance(scene.lights[-1], DirectionalLight)
    return replace(scene, lights=scene.lights[:-1]) if has_sun else scene


def followed(scene: Scene) -> Scene:
    """The scene with its sky turned to its sun, the last light, where a hand has turned that.

    A studio becomes the one of the lights that the scene has now.
    """
    from .environment import Environment
    from .studio import NAME, studio

    if scene.environment is not None and scene.environment.source == NAME:
        made = studio(scene.lights)
        if made.map is scene.environment.map:
            return scene
        return replace(scene, environment=replace(scene.environment, map=made.map))
    sky = scene.environment.sky if scene.environment is not None else None
    if sky is None or not scene.lights or not isinstance(scene.lights[-1], DirectionalLight):
        return scene
    light = scene.lights[-1]
    if np.allclose(light.direction, -sky.towards_sun, atol=1e-9):
        return scene
    # The sky goes by the angle of its sun, so it is another sky now.
    turned = sky.turned_to(light.direction)
    return replace(
        scene,
        lights=(*scene.lights[:-1], turned.sun()),
        environment=Environment.of_sky(turned),
    )


@functools.lru_cache(maxsize=4)
def _map(turbidity: float, ground: float, elevation_deg: float, azimuth_deg: float) -> F32:
    # One map serves all skies of the same haze, ground and sun; scales multiply it later.
    sky = Sky(elevation_deg, azimuth_deg, turbidity, ground)
    made: F32 = sky_map(Air(turbidity, ground), sky.towards_sun, MAP_HEIGHT).astype(np.float32)
    made.flags.writeable = False
    return made
