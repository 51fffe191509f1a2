"""Suns in environment maps, as directional lights.

A photographed sky holds most of its light in a few texels. Lattices, sky lights and ordinates
spread it over many degrees and lose its shadows. As a light of its own it has what every
directional light has: sharp shadows, shafts, reflective shadow maps.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from ..maths.colour import luminance
from ..maths.latlong import (
    latlong_row_solid_angles,
    latlong_texel_directions,
    turned_about_y,
)
from .checks import F32, F64, Rgb
from .environment import Environment
from .lights import DirectionalLight
from .scene import Scene

MOST = 4
"""Suns that are taken out of a map."""
_CONE_DEG = 1.5  # around a sun's middle: all of its light is here
_WIDEST_DEG = 0.8  # root mean square radius; what is wider casts no sharp shadow
_LEAST_SHARE = 0.03  # of the map's light


Texels = tuple[NDArray[np.int64], NDArray[np.int64]]
"""Rows and columns."""


@dataclass(frozen=True, eq=False)
class SunlessEnvironment(Environment):
    """An environment whose `map` lacks its suns, which are lights of the scene.

    They are still seen: `sun_luminance` (H, W) float32, before `scale`, is what its texels show
    more, of the colour `sun_colour`, whose luminance is 1.
    """

    sun_luminance: F32 | None = None
    sun_colour: Rgb = (0.0, 0.0, 0.0)


@dataclass(frozen=True, eq=False)
class MapSuns:
    """A map in two: `rest` (H, W, 3) without suns, and their light.

    `towards` (n, 3): unit directions in the map's own frame; `irradiance` (n, 3), W m^-2, at
    normal incidence; `luminance` (H, W) what the map has beyond `rest`. The brightest is first.
    """

    rest: F32
    towards: F64
    irradiance: F64
    luminance: F32

    @property
    def colour(self) -> Rgb:
        """That of all suns together, of luminance 1."""
        total = self.irradiance.sum(axis=0)
        r, g, b = (total / max(float(luminance(total)), 1e-30)).tolist()
        return (r, g, b)


def map_suns(pixels: F32, most: int = MOST) -> MapSuns | None:
    """At most `most` suns of a map (H, W, 3) of radiance; None where there is none.

    A sun is at most some 2 degrees wide, holds at least 3 % of the map's light, and is what
    stands out from the median around it.
    """
    height, width = pixels.shape[:2]
    # A texel, blended with its neighbours, is a light of its own width.
    texel = np.pi / height
    if most < 1 or texel**2 / 3.0 > np.radians(_WIDEST_DEG) ** 2:
        return None
    solid = latlong_row_solid_angles(height, width)
    bright = luminance(pixels)
    total = float((bright * solid[:, None]).sum())
    if not total > 0.0:
        return None
    # The brightest spot of what remains, again and again, until one is no sun.
    rest, found = pixels.copy(), []
    for _ in range(most):
        spot = _brightest(rest, bright, solid, texel)
        if spot is None or float(luminance(spot[1])) < _LEAST_SHARE * total:
            break
        towards, irradiance, (rows, columns), level = spot
        # The spot is cut down to its surroundings before the next one is looked for.
        rest[rows, columns] = np.minimum(rest[rows, columns], level)
        bright[rows, columns] = luminance(rest[rows, columns])
        found.append((towards, irradiance))
    if not found:
        return None
    towards, irradiance = (np.array(values) for values in zip(*found, strict=True))
    # What the map loses is what its suns are still seen by.
    beyond = luminance(pixels).astype(np.float32) - luminance(rest).astype(np.float32)
    return MapSuns(rest, towards, irradiance, np.maximum(beyond, np.float32(0.0)))


def _brightest(
    pixels: F32, bright: F64, solid: F64, texel: float
) -> tuple[F64, F64, Texels, F64] | None:
    """Middle, irradiance, texels and surroundings of the brightest spot; None if it is wide."""
    height, width = bright.shape
    # Texels near the brightest one: whole rows, since columns meet at the poles.
    row, column = np.unravel_index(int(np.argmax(bright)), bright.shape)
    cone = max(np.radians(_CONE_DEG), 1.5 * texel)
    reach = int(np.ceil(3.0 * cone / texel)) + 1
    first, last = max(0, int(row) - reach), min(height, int(row) + reach + 1)
    towards = latlong_texel_directions(height, width)[first:last]
    light = bright[first:last] * solid[first:last, None]
    middle = towards[int(row) - first, int(column)]
    # The cone moves to the middle of the light that is in it.
    for _ in range(4):
        inside = towards @ middle > np.cos(cone)
        middle = (towards[inside] * light[inside][:, None]).sum(axis=0)
        middle /= np.linalg.norm(middle)
    cosine = towards @ middle
    inside = cosine > np.cos(cone)
    around = (cosine > np.cos(2.0 * cone)) & ~inside
    if not inside.any() or not around.any():
        return None
    # What stands out from the median around it, and how wide that is.
    texels = pixels[first:last]
    level = np.median(texels[around], axis=0)
    weight = np.broadcast_to(solid[first:last, None], inside.shape)[inside][:, None]
    over = np.maximum(texels[inside].astype(np.float64) - level, 0.0) * weight
    # For small angles 2 (1 - cos) is their square; a texel has a width of its own.
    away = 2.0 * float((over.sum(axis=1) * (1.0 - cosine[inside])).sum())
    square = away / max(float(over.sum()), 1e-30) + texel**2 / 3.0
    if square > np.radians(_WIDEST_DEG) ** 2:
        return None
    rows, columns = np.nonzero(inside)
    return middle, over.sum(axis=0), (rows + first, columns), level


class SunLights:
    """Puts the suns of a scene's environment among its lights.

    There are as many from the first scene on: later maps with fewer get black ones, of maps with
    more the weakest stay in the map.
    """

    def __init__(self) -> None:
        self._count: int | None = None
        self._pixels: F32 | None = None
        self._suns: MapSuns | None = None
        self._last: tuple[Environment, Environment, tuple[DirectionalLight, ...]] | None = None

    def of(self, scene: Scene) -> Scene:
        """The scene with the suns of its environment as its last lights; itself without any."""
        environment = scene.environment
        # A clear sky's sun is a light of the scene already.
        pixels = None if environment is None or environment.sky else environment.map
        if self._pixels is not pixels:
            most = MOST if self._count is None else self._count
            self._suns = None if pixels is None else map_suns(pixels, most)
            self._pixels, self._last = pixels, None
        # The first scene decides how many lights there are; a renderer cannot add any.
        if self._count is None:
            self._count = 0 if self._suns is None else len(self._suns.towards)
        if not self._count:
            return scene
        # Suns that later maps lack are black, so that the number of lights stays.
        black = DirectionalLight((0.0, -1.0, 0.0), (0.0, 0.0, 0.0))
        if environment is None or self._suns is None:
            return replace(scene, lights=scene.lights + (black,) * self._count)
        if self._last is None or self._last[0] is not environment:
            self._last = (environment, *_parted(environment, self._suns))
        _, rest, suns = self._last
        lights = scene.lights + suns + (black,) * (self._count - len(suns))
        return replace(scene, environment=rest, lights=lights)


def _parted(
    environment: Environment, suns: MapSuns
) -> tuple[SunlessEnvironment, tuple[DirectionalLight, ...]]:
    """The environment without its suns, and these as lights."""
    rest = SunlessEnvironment(
        map=suns.rest,
        scale=environment.scale,
        rotation_deg=environment.rotation_deg,
        visible=environment.visible,
        source=environment.source,
        horizon=environment.horizon,
        sun_luminance=suns.luminance,
        sun_colour=suns.colour,
    )
    # Lights in the world: the map's directions, turned as the environment is.
    along = -turned_about_y(suns.towards, environment.rotation_deg)
    irradiance = suns.irradiance * environment.scale
    lights = [
        DirectionalLight((d[0], d[1], d[2]), (e[0], e[1], e[2]))
        for d, e in zip(along.tolist(), irradiance.tolist(), strict=True)
    ]
    return rest, tuple(lights)
