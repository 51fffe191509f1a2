"""Cameras around what stands free: from its front, as near as shows all of it."""

from __future__ import annotations

import math

import numpy as np

from ..camera import Camera
from ..checks import F64

OBJECT_FOV_DEG = 30.0
"""As a lens of 45 mm on film of 36 x 24 mm: parallel edges nearly stay so."""
MARGIN = 1.18
"""What the image has room for, over what is in it."""
_ELEVATION_DEG, _STEEPEST_DEG = 14.0, 38.0
"""Of the eye above what stands, and above what lies flat."""
AZIMUTH_DEG, _SIDEMOST_DEG = 32.0, 58.0
"""Of the eye from +Z, the front of models, for what is as wide as deep, and for what is long."""
_LONG = 4.0
BELOW_DEG = -OBJECT_FOV_DEG / 2.0 - 2.0
"""So that smoke and clouds are seen before the sky alone, all of the view above the horizon."""
_STEPS = 30


def from_front(points: F64) -> Camera:
    """Three quarters from the front and a little from above; the points (N, 3) say how far.

    What lies flat is seen from higher up, and what is longer than wide more from its side.
    """
    width, height, depth = np.ptp(points, axis=0)
    # 0 for what is as high as it is wide or higher, 1 for a sheet on the ground.
    flatness = 1.0 - min(1.0, height / max(width, depth, 1e-30))
    elevation = _ELEVATION_DEG + (_STEEPEST_DEG - _ELEVATION_DEG) * flatness**2
    # 0 for what is as wide as deep or wider, 1 for _LONG times as deep.
    length = np.clip(np.log(max(depth, 1e-30) / max(width, 1e-30)) / np.log(_LONG), 0.0, 1.0)
    azimuth = AZIMUTH_DEG + (_SIDEMOST_DEG - AZIMUTH_DEG) * length
    return around(towards_eye(elevation, azimuth), points)


def towards_eye(elevation_deg: float, azimuth_deg: float) -> F64:
    """Unit vector (3,); azimuths go from +Z to +X."""
    e, a = np.radians(elevation_deg), np.radians(azimuth_deg)
    return np.array((np.cos(e) * np.sin(a), np.sin(e), np.cos(e) * np.cos(a)))


def around(direction: F64, points: F64) -> Camera:
    """From outside along -direction, as near as keeps all points (N, 3) in a 4:3 image.

    The points' outline lies in its middle, with a MARGIN on the sides that bound it.
    """
    towards = direction / np.linalg.norm(direction)
    center = (points.min(axis=0) + points.max(axis=0)) / 2.0
    right = np.cross((0.0, 1.0, 0.0), towards)
    right /= np.linalg.norm(right)
    offset = points - center
    half = math.tan(math.radians(OBJECT_FOV_DEG) / 2.0) / MARGIN
    # Across the image and up it: |x - a| <= reach (s - z) says how far back, s, the eye has to be.
    axes = ((right, half * 4.0 / 3.0), (np.cross(towards, right), half))
    z = offset @ towards
    needed = [
        (np.max(reach * z + offset @ axis) + np.max(reach * z - offset @ axis)) / (2.0 * reach)
        for axis, reach in axes
    ]
    # Points on the way to the eye stay before it.
    before = 1e-3 * (float(np.ptp(points, axis=0).max()) or 1.0)
    back = max(float(max(needed)), float(z.max()) + before)
    # From there, where the outermost angles on both sides are alike.
    eye = center.copy()
    for axis, _ in axes:
        eye += axis * _middle(offset @ axis, back - z)
    return rounded_camera(eye + towards * back, eye, OBJECT_FOV_DEG)


def _middle(x: F64, depth: F64) -> float:
    """The a at which (x - a) / depth, (N,) both, reaches as far below 0 as above."""
    a = 0.0
    for _ in range(_STEPS):
        slopes = (x - a) / depth
        # Between the depths of the two outermost points no step goes too far.
        a += (float(slopes.max()) + float(slopes.min())) / 2.0 * float(depth.min())
    return a


def rounded_camera(eye: F64, target: F64, fov_y_deg: float) -> Camera:
    """A camera whose numbers have as many digits as its distance needs, so that files read well."""
    # Tenths of millimetres, and more digits where all is nearer than that is fine.
    apart = max(float(np.linalg.norm(eye - target)), 1e-30)
    digits = max(4, 3 - math.floor(math.log10(apart)))
    ex, ey, ez = (round(float(v), digits) for v in eye)
    tx, ty, tz = (round(float(v), digits) for v in target)
    return Camera(position=(ex, ey, ez), target=(tx, ty, tz), fov_y_deg=fov_y_deg)
