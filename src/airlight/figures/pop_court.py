"""The map of Elek2014's figures: an arcaded court at the end of a day, as the eye sees it."""

from __future__ import annotations

from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from ..maths.latlong import latlong_texel_directions
from ..scene.builtin.noise import fractal_noise, smoothstep
from ..scene.builtin.sky import clear_sky
from ..scene.checks import F64, Vec3
from ..scene.environment import Environment

SUN_TRAVEL: Vec3 = (0.22, -0.33, 0.92)  # low, to the left behind what is looked at towards -z
BRIGHTEST = 150.0  # W m^-2 sr^-1, in the middle of the sun's glow
_GLOW_RAD = 0.06
_HALF_M, _EYE_M, _EAVES_M = 12.0, 1.6, 5.2
_BAY_M, _ARCH_M, _SPRING_M = 4.0, 1.35, 1.6  # an arch to each bay: half its width, where it bends
_STONE = np.array([0.62, 0.5, 0.38])
_SKY = 1.0  # times the built-in sky


@lru_cache(maxsize=2)
def courtyard(height_px: int = 512) -> Environment:
    """A sky with clouds and the sun's glow over four dark arcades: high frequencies.

    Radiance 0.02 to BRIGHTEST, W m^-2 sr^-1.
    """
    # At twice the size; `up` is the height at which a direction meets the walls.
    towards = latlong_texel_directions(2 * height_px, 4 * height_px)
    horizontal = np.maximum(np.abs(towards[..., 0]), np.abs(towards[..., 2]))
    up = _EYE_M + _HALF_M * towards[..., 1] / np.maximum(horizontal, 1e-9)

    # Sky above the eaves, ground below the horizon, walls between.
    light = np.where((up > _EAVES_M)[..., None], _sky(towards), _walls(towards, up))
    light = np.where((up < 0.0)[..., None], _ground(towards), light)

    # Averaged and softened, and the sun's glow held below its brightest.
    smooth = _softened(light.reshape(height_px, 2, 2 * height_px, 2, 3).mean(axis=(1, 3)))
    return Environment(map=np.minimum(smooth, BRIGHTEST).astype(np.float32), source="courtyard")


def _softened(light: F64) -> F64:
    """Edges two texels wide: enlarged by linear filtering they are straight, not stairs."""
    # A tent along rows, which join, then along columns, which end.
    beside = 0.25 * (np.roll(light, 1, 1) + 2.0 * light + np.roll(light, -1, 1))
    above, below = np.vstack([beside[:1], beside[:-1]]), np.vstack([beside[1:], beside[-1:]])
    return np.asarray(0.25 * (above + 2.0 * beside + below))


def _sky(towards: F64) -> F64:
    # The clear sky, clouds of noise before it, and the sun's glow over both.
    height_px, width_px = towards.shape[:2]
    clear = clear_sky(SUN_TRAVEL, height_px=height_px, scale=_SKY).map
    assert clear is not None
    shape = (height_px, width_px)
    cover = fractal_noise(shape, (6, 8), np.random.default_rng(4), octaves=5, gain=0.55)
    cloud = 0.75 * smoothstep(-0.2, 1.8, cover)[..., None]
    angle = np.arccos(np.clip(-towards @ _unit(SUN_TRAVEL), -1.0, 1.0))[..., None]
    glow = np.array([1.0, 0.86, 0.66]) * (
        1.5 * BRIGHTEST * np.exp(-((angle / _GLOW_RAD) ** 2)) + 2.5 * np.exp(-angle / 0.2)
    )
    white = np.array([2.6, 2.5, 2.4])
    return np.asarray(clear * (1.0 - cloud) + white * cloud + glow)


def _walls(towards: F64, up: F64) -> F64:
    """Arcades: stone in courses, openings that are dark below and lit by lamps above."""
    # Where along the wall a direction meets it, and how far from a bay's middle.
    x, z = towards[..., 0], towards[..., 2]
    facing_x = np.abs(x) > np.abs(z)
    along = _HALF_M * np.where(
        facing_x, z / np.maximum(np.abs(x), 1e-9), x / np.maximum(np.abs(z), 1e-9)
    )
    aside = np.abs(np.mod(along, _BAY_M) - 0.5 * _BAY_M)

    # Two storeys of arches, the upper ones small and lit from inside.
    storey = up > 0.62 * _EAVES_M
    rise = np.where(storey, up - 0.62 * _EAVES_M, up)
    half, spring = np.where(storey, 0.4, _ARCH_M), np.where(storey, 1.0, _SPRING_M)
    arched = spring + np.sqrt(np.maximum(half**2 - aside**2, 0.0))
    open_ = (aside < half) & (rise < arched) & ~(storey & (rise < 0.35))
    # The wall that faces the sun has it on its upper half; the others see the sky alone.
    sunlit = (z > 0.0) & ~facing_x & (up > 2.8 + 0.1 * along)
    course = 1.0 - 0.3 * ((np.mod(up, 0.5) < 0.06) | _joint(along, up))
    strength = course * (0.5 + 0.05 * up) * np.where(sunlit, 7.0, 1.0)
    stone = _STONE * strength[..., None]
    warm = np.where(storey[..., None], [3.2, 2.1, 1.0], [0.03, 0.026, 0.024])
    return np.where(open_[..., None], warm, stone)


def _joint(along: F64, up: F64) -> NDArray[np.bool_]:
    # Joints of every other course lie half a stone aside.
    shifted = along + 0.5 * np.mod(np.floor(up / 0.5), 2.0)
    return np.asarray(np.mod(shifted, 1.0) < 0.06)


def _ground(towards: F64) -> F64:
    """Cobbles, paler towards the middle of the court."""
    # Where a direction meets the ground; stones of one size in rows.
    distance = _EYE_M / np.maximum(-towards[..., 1], 1e-3)
    at = distance[..., None] * towards[..., ::2]
    cobble = 0.85 + 0.15 * np.prod(np.cos(np.pi * at / 0.7), axis=-1)
    pale = 0.28 + 0.2 * np.exp(-np.sum(at**2, axis=-1) / 60.0)
    return np.asarray(_STONE * (cobble * pale)[..., None])


def _unit(vector: Vec3) -> F64:
    v = np.array(vector)
    return np.asarray(v / np.linalg.norm(v))
