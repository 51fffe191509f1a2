"""The environment as light: a background map, and directional lights that stand for it.

The sphere is cut into the Voronoi cells of Fibonacci points; each cell becomes a directional light
with the cell's whole irradiance, along its radiance-weighted mean direction. The partition has no
noise and no seed, so a turning map does not flicker.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..gpu.device import Gpu
from ..gpu.memory import Sampler, Texture
from ..maths.chunks import chunks
from ..maths.half import half_floats
from ..maths.latlong import (
    latlong_row_solid_angles,
    latlong_texel_directions,
    turned_about_y,
)
from ..maths.sampling import fibonacci_sphere
from ..maths.sunlight import SUN_RADIUS_DEG
from ..scene.checks import F64
from ..scene.environment import Environment
from ..scene.fingerprint import array_digest
from ..scene.lights import DirectionalLight
from ..scene.map_suns import SunlessEnvironment

_BAND_BYTES = 1 << 26
_ROWS = 64  # of the map that is partitioned; finer detail is averaged first


@dataclass(frozen=True)
class SkyLight(DirectionalLight):
    """A part of the sky. `spread`: tangent of the angular radius of its disc."""

    spread: float


def sky_lights(environment: Environment | None, count: int) -> list[SkyLight]:
    """At most `count` directional lights that carry the environment's light; none if it is black.

    Their irradiances sum to the integral of the radiance over the sphere.
    """
    if environment is None or count < 1:
        return []
    # The flux of each texel of the environment, from its direction.
    radiance = shrunk_map(environment)
    height, width = radiance.shape[:2]
    directions = turned_about_y(latlong_texel_directions(height, width), environment.rotation_deg)
    towards = directions.reshape(-1, 3)
    solid_angles = np.repeat(latlong_row_solid_angles(height, width), width)
    flux = radiance.reshape(-1, 3) * solid_angles[:, None]
    # Voronoi cells of Fibonacci points: their irradiance, and the mean direction of their flux.
    cell = np.argmax(towards @ fibonacci_sphere(count).T, axis=1)
    irradiance = np.stack([np.bincount(cell, flux[:, k], count) for k in range(3)], axis=1)
    weight = flux.sum(axis=1)
    centroid = np.stack(
        [np.bincount(cell, weight * towards[:, k], count) for k in range(3)], axis=1
    )
    # A light for each cell that is not black.
    lit = irradiance.max(axis=1) > 1e-6 * max(float(irradiance.max()), 1e-30)
    total = np.bincount(cell, weight, count)
    return [
        SkyLight(
            (float(-d[0]), float(-d[1]), float(-d[2])),
            (float(e[0]), float(e[1]), float(e[2])),
            _spread(float(np.linalg.norm(d)) / float(w)),
        )
        for d, e, w in zip(centroid[lit], irradiance[lit], total[lit], strict=True)
        if np.linalg.norm(d) > 0.0
    ]


def _spread(mean_length: float) -> float:
    """The tangent of a disc's angular radius.

    The mean of its directions has the length `mean_length` = (1 + cos radius) / 2.
    """
    # Capped at a radius of 84 degrees: towards 90 the tangent has no bound.
    cosine = min(max(2.0 * mean_length - 1.0, 0.1), 1.0)
    return float(np.sqrt(1.0 - cosine**2) / cosine)


def environment_map(environment: Environment) -> F64:
    """Scaled radiance (H, W, 3); a constant environment becomes a small map."""
    # A constant sky is a map as coarse as its light is smooth.
    if environment.map is None:
        return np.tile(np.asarray(environment.radiance), (32, 64, 1)) * environment.scale
    return environment.map.astype(np.float64) * environment.scale


def shrunk_map(environment: Environment) -> F64:
    """`environment_map`, averaged over squares of texels to about _ROWS rows.

    A large map is averaged one row of squares at a time, because as a whole it would take eight
    bytes per value.
    """
    if environment.map is None:
        return environment_map(environment)
    # Squares hold whole texels; the rest at the right and the bottom is less than a square.
    height, width = environment.map.shape[:2]
    factor = max(1, height // _ROWS)
    rows, columns = height // factor, width // factor
    # Sums in double precision: a sun's texels outweigh thousands of others.
    shrunk = np.empty((rows, columns, 3))
    for row in range(rows):
        texels = environment.map[row * factor : (row + 1) * factor, : columns * factor]
        radiance = texels.astype(np.float64) * environment.scale
        squares = radiance.reshape(1, factor, columns, factor, 3)
        shrunk[row] = squares.mean(axis=(1, 3))[0]
    return shrunk


def _half_pixels(
    radiance: NDArray[Any], sun_luminance: NDArray[Any] | None, scale: float
) -> NDArray[np.float16]:
    """Texels (H, W, 4) of the background; a: the luminance of suns that are lights, too."""
    # Alpha holds what a directional light sends already, so that the background alone shows it.
    pixels = np.zeros((*radiance.shape[:2], 4), np.float16)
    half_floats(radiance, scale, out=pixels[..., :3])
    if sun_luminance is not None:
        half_floats(sun_luminance[..., None], scale, out=pixels[..., 3:])
    return pixels


class EnvironmentTexture:
    """The map on the device, for the background; black where there is none or it is invisible.

    Scenes on one device share it while they show the same.
    """

    def __init__(self, gpu: Gpu, environment: Environment | None) -> None:
        self._gpu = gpu
        self._leased = gpu.uploads.lease(
            gpu, _texels_of(environment), lambda scope: _made(scope, environment)
        )
        self.texture = self._leased.value
        self.sampler = Sampler(
            gpu,
            "environment",
            mag_filter="linear",
            min_filter="linear",
            address_mode_u="repeat",
            address_mode_v="clamp-to-edge",
        )
        self._turn(environment)

    def take(self, environment: Environment | None) -> bool:
        """Show another environment; returns False if its map has another size.

        While other scenes show the one before, `texture` is another afterwards.
        """
        old = self._shown

        # Texels are compared by address, not by value; a turned map is the same.
        is_same = old and environment and _pixels_of(old) == _pixels_of(environment)
        if not is_same:
            if _background_map(environment)[0].shape[1::-1] != self.texture.size[:2]:
                return False
            # One of its own, which nobody finds: the next map is written into it.
            before = self.texture
            self._leased = self._leased.owned(self._gpu, lambda scope: _made(scope, environment))
            self.texture = self._leased.value
            if self.texture is before:
                _upload(self.texture, environment)
        self._turn(environment)
        return True

    def release(self) -> None:
        """Give the texture back, unless other scenes show it."""
        self._leased.release()

    @property
    def seen(self) -> dict[str, Any]:
        """Beside the texels: the horizon between them and the sun, for `LightingParams`."""
        # A sharp horizon stops filtering from mixing ground into the lowest row of sky.
        shown = self._shown
        is_sharp = shown is not None and shown.visible and shown.horizon and shown.map is not None
        sky = shown.sky if shown is not None and shown.visible else None
        colour = shown.sun_colour if isinstance(shown, SunlessEnvironment) else (0.0, 0.0, 0.0)
        return {
            "towards_sun": (0.0, 1.0, 0.0) if sky is None else tuple(sky.towards_sun.tolist()),
            "sun_cosine": float(np.cos(np.radians(SUN_RADIUS_DEG))),
            "sun_radiance": (0.0, 0.0, 0.0) if sky is None else sky.disk_radiance,
            "map_sun_colour": colour,
            "horizon": 0.5 / self.texture.size[1] if is_sharp else 0.0,
        }

    def _turn(self, environment: Environment | None) -> None:
        self._shown = environment
        self.rotation = np.radians(environment.rotation_deg) if environment else 0.0


def _upload(texture: Texture, environment: Environment | None) -> None:
    """Upload the texels, in bands where they are many: the device copies each upload."""
    # The device copies each upload: bands bound what is in flight.
    radiance, scale = _background_map(environment)
    suns = _sun_luminance(environment)
    height, width = radiance.shape[:2]
    for rows in chunks(height, max(1, _BAND_BYTES // (8 * width))):
        if rows.start:
            texture.gpu.wait()
        texels = _half_pixels(radiance[rows], None if suns is None else suns[rows], scale)
        texture.write(texels, row=rows.start)


def _made(scope: Gpu, environment: Environment | None) -> Texture:
    """A texture with the map of the background."""
    height, width = _background_map(environment)[0].shape[:2]
    texture = Texture(scope, "environment", (width, height), "rgba16float")
    _upload(texture, environment)
    return texture


def _texels_of(environment: Environment | None) -> tuple[object, ...]:
    """What is equal for environments whose texels on the device are the same."""
    radiance, scale = _background_map(environment)
    return ("environment", array_digest(radiance, _sun_luminance(environment)), scale)


def _background_map(environment: Environment | None) -> tuple[NDArray[Any], float]:
    """The map (H, W, 3) of the background, and the factor that scales it."""
    # An invisible environment is black behind the surfaces, and still lights them.
    if environment is None or not environment.visible:
        return np.zeros((1, 1, 3)), 1.0
    if environment.map is None:
        return environment_map(environment), 1.0
    return environment.map, environment.scale


def _sun_luminance(environment: Environment | None) -> NDArray[Any] | None:
    """Of the background's texels, (H, W): what suns that are lights add to them."""
    if not isinstance(environment, SunlessEnvironment) or not environment.visible:
        return None
    return environment.sun_luminance


def _pixels_of(environment: Environment) -> tuple[object, ...]:
    """What the texture's pixels depend on; maps are identified by their address."""
    where = None if environment.map is None else environment.map.ctypes.data
    return (environment.radiance, where, environment.scale, environment.visible)
