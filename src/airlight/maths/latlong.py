"""Latitude-longitude maps: u = atan2(x, -z)/2pi (mod 1), v = acos(y)/pi from the top row."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from .arrays import F64


def latlong_from_direction(direction: ArrayLike) -> F64:
    """(u, v) (..., 2) in [0, 1] of unit directions (..., 3) towards the environment."""
    d = np.asarray(direction, dtype=np.float64)
    u = np.mod(np.arctan2(d[..., 0], -d[..., 2]) / (2.0 * np.pi), 1.0)
    # atan2 keeps the digits that acos(y) loses at the poles
    v = np.arctan2(np.hypot(d[..., 0], d[..., 2]), d[..., 1]) / np.pi
    return np.stack([u, v], axis=-1)


def direction_from_latlong(uv: ArrayLike) -> F64:
    """Unit directions (..., 3) of (u, v) (..., 2)."""
    p = np.asarray(uv, dtype=np.float64)
    phi, theta = 2.0 * np.pi * p[..., 0], np.pi * p[..., 1]
    s = np.sin(theta)
    return np.stack([s * np.sin(phi), np.cos(theta), -s * np.cos(phi)], axis=-1)


def latlong_texel_directions(height: int, width: int) -> F64:
    """Unit directions (height, width, 3) of texel centres."""
    u, v = np.meshgrid((np.arange(width) + 0.5) / width, (np.arange(height) + 0.5) / height)
    return direction_from_latlong(np.stack([u, v], axis=-1))


def latlong_row_solid_angles(height: int, width: int) -> F64:
    """Solid angle (height,), sr, of one texel in each row; times width they sum to 4 pi."""
    # Bands between two latitudes, cut into texels of one width.
    edges = np.cos(np.linspace(0.0, np.pi, height + 1))
    return np.asarray(-np.diff(edges) * (2.0 * np.pi / width))


def turned_about_y(directions: F64, rotation_deg: float) -> F64:
    """Directions (..., 3) turned about +Y, as `rotation_deg` of an environment turns its map."""
    # A turn about +y moves +z towards +x.
    angle = np.radians(rotation_deg)
    c, s = np.cos(angle), np.sin(angle)
    about_y = np.array([[c, 0.0, s], [0.0, 1.0, 0.0], [-s, 0.0, c]])
    return np.asarray(directions @ about_y.T)
