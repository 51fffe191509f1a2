"""A sun and a sky for a scene without light, the sun placed so that it gets in.

Radiometry: the sun gives 30, 27, 22 W m^-2 at normal incidence; the sky 1 to 4 W m^-2 sr^-1,
about 8 W m^-2 on open ground: the ratio of a clear mid-morning.
"""

from __future__ import annotations

import numpy as np

from ...maths.latlong import latlong_texel_directions
from ..camera import Camera, view_directions
from ..checks import F32, F64, Rgb
from ..environment import Environment
from ..lights import DirectionalLight
from ..sun_sky import MAP_HEIGHT
from .probe import Probe

SUN_IRRADIANCE: Rgb = (30.0, 27.0, 22.0)
_ZENITH = np.array((0.85, 1.5, 2.9))
_HORIZON = np.array((2.7, 3.1, 3.6))
_GROUND = np.array((0.42, 0.38, 0.33))
_SUN_GLOW = np.array((1.6, 1.3, 0.8))

_ELEVATIONS_DEG = (25.0, 40.0, 55.0)
_AZIMUTHS = 16
OPEN_SHARE = 0.35
_ENOUGH_SHARE = 0.15


def sun_and_sky(towards_sun: F64) -> tuple[DirectionalLight, Environment]:
    """The light and the map that belongs to it; `towards_sun` is a unit vector."""
    x, y, z = (-float(v) for v in towards_sun)
    sun = DirectionalLight(direction=(x, y, z), irradiance=SUN_IRRADIANCE)
    return sun, Environment(map=clear_sky(towards_sun), source="default sky", horizon=True)


def clear_sky(towards_sun: F64, height: int = MAP_HEIGHT) -> F32:
    """Radiance (height, 2 height, 3) float32 of a clear sky over dull ground.

    Blue above, pale at the horizon, a warm glow around (but not of) the sun, which is a
    light of its own. The colours are chosen by eye, not measured.
    """
    direction = latlong_texel_directions(height, 2 * height)
    y = direction[..., 1]
    # Paler towards the horizon, with a glow about the sun.
    paleness = np.exp(-np.maximum(y, 0.0) * 3.5)[..., None]
    sky = _ZENITH + (_HORIZON - _ZENITH) * paleness
    cosine = np.clip(direction @ towards_sun, 0.0, 1.0)[..., None]
    sky = sky + _SUN_GLOW * cosine**16
    # Below the horizon lies ground of one colour.
    is_sky = (y > 0.0)[..., None]
    blended: F32 = (_GROUND + (sky - _GROUND) * is_sky).astype(np.float32)
    return blended


def sun_for(probe: Probe, camera: Camera) -> tuple[F64, float]:
    """Unit vector towards the sun, and the share of what the camera sees that it lights.

    In the open the sun stands high behind the camera's shoulder. Where little of the view
    would be lit, the directions that light some of it through openings are searched; among
    those, light that falls towards the camera draws better shadows than light from behind it.
    """
    forward = np.subtract(camera.target, camera.position)
    # Azimuths are counted from +Z, and `facing` is the one behind the camera's back.
    facing = float(np.arctan2(-forward[0], -forward[2]))
    shoulder = _direction(45.0, facing - 0.75)
    # In the open, the shoulder's sun will do.
    points = _seen_points(probe, camera)
    if len(points) == 0:
        return shoulder, 1.0
    share = float(probe.sees_sky(points, shoulder).mean())
    if share >= OPEN_SHARE:
        return shoulder, share
    # Else try a grid of directions by how much of the view they light, and from which side.
    azimuths = facing + 2.0 * np.pi * np.arange(_AZIMUTHS) / _AZIMUTHS
    tried = [_direction(e, a) for e in _ELEVATIONS_DEG for a in azimuths]
    shares = np.array([probe.sees_sky(points, d).mean() for d in tried])
    from_behind = -np.array(tried) @ (forward / np.linalg.norm(forward))
    score = np.minimum(shares, _ENOUGH_SHARE) * (1.0 - 0.35 * np.maximum(from_behind, 0.0))
    # The best of them, unless no daylight gets in at all.
    best = int(np.argmax(score))
    if shares[best] == 0.0:
        return shoulder, share
    return tried[best], float(shares[best])


def _direction(elevation_deg: float, azimuth: float) -> F64:
    e = np.radians(elevation_deg)
    return np.array([np.cos(e) * np.sin(azimuth), np.sin(e), np.cos(e) * np.cos(azimuth)])


def _seen_points(probe: Probe, camera: Camera) -> F64:
    """Surface points (P, 3) in the camera's view, a hair in front of their surfaces."""
    # A coarse bundle of rays through the image; those that miss everything see no surface.
    eye = np.array(camera.position)
    directions = view_directions(camera, 20, 12)
    hits = probe.cast(np.repeat(eye[None], len(directions), axis=0), directions)
    seen = hits.triangle >= 0
    points = eye + directions[seen] * hits.distance[seen, None]
    # In front, on the side that was hit, so that a ray towards the sun does not hit the start.
    size = float(np.ptp(probe.corners.reshape(-1, 3), axis=0).max()) if seen.any() else 1.0
    normals = probe.normals[hits.triangle[seen]]
    side = np.where(hits.is_front[seen], 1.0, -1.0)[:, None]
    lifted: F64 = points + normals * side * 1e-4 * size
    return lifted
