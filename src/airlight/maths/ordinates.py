"""Distant light as a few directions: a partition of an environment map, without noise.

Every texel belongs to the nearest of N centres, which k-means places densely where light is:
weight sqrt(luminance) times solid angle. An ordinate carries all the light of its part and
travels along the part's radiance-weighted centroid. Nothing is random, so nothing flickers; a
bright texel that crosses a border takes both centroids with it, so that little jumps.
differs: Elek2014 section 5.1 importance-samples the map, which `importance_sampled` does.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from .arrays import F64, I64
from .colour import luminance
from .latlong import latlong_row_solid_angles, latlong_texel_directions
from .sampling import GOLDEN_RATIO

ROUNDS = 8  # of k-means: the centres of a sky move by less than a texel after that
DARK_SHARE = 0.05  # of the centres goes where the map is black, so that its parts stay compact
WORKING_HEIGHT = 48  # rows of the map that is partitioned; directions inside a texel are kept


@dataclass(frozen=True, eq=False)
class Ordinates:
    """N directions of distant light.

    `direction` (N, 3): of travel, unit. `irradiance` (N, 3): radiance times solid angle, W m^-2.
    `solid_angle` (N,): sr, 0 for a light without extent. `mean_cosine` (N,): of the light of each
    part to its direction, 1 for a light without extent.
    """

    direction: F64
    irradiance: F64
    solid_angle: F64
    mean_cosine: F64

    @property
    def count(self) -> int:
        """N."""
        return len(self.direction)

    def turned(self, rotation: F64) -> Ordinates:
        """The same light with `rotation` (3, 3) applied to its directions."""
        return Ordinates(
            self.direction @ rotation.T, self.irradiance, self.solid_angle, self.mean_cosine
        )


def joined(parts: list[Ordinates]) -> Ordinates:
    """All ordinates of `parts`, in order."""
    fields = ("direction", "irradiance", "solid_angle", "mean_cosine")
    return Ordinates(*(np.concatenate([getattr(p, name) for p in parts]) for name in fields))


def parallel(direction: ArrayLike, irradiance: ArrayLike) -> Ordinates:
    """Lights without extent: directions of travel (N, 3), irradiance (N, 3) W m^-2."""
    d = np.asarray(direction, dtype=np.float64).reshape(-1, 3)
    e = np.asarray(irradiance, dtype=np.float64).reshape(-1, 3)
    return Ordinates(d, e, np.zeros(len(d)), np.ones(len(d)))


def partition(radiance: ArrayLike, count: int, rounds: int = ROUNDS) -> Ordinates:
    """`count` ordinates of a latitude-longitude map (H, W, 3), W m^-2 sr^-1; see `latlong`.

    They carry the map's light exactly: irradiance sums to the integral of radiance, and each
    channel's share goes with its part. Black parts get irradiance 0.
    """
    power, weight, towards, solid_angle = map_texels(np.asarray(radiance, dtype=np.float64))
    centre = seeds(weight, count)
    flat = towards.reshape(-1, 3)
    # Spherical k-means: texels join the nearest centre, centres move to their texels' mean.
    pull = np.maximum(weight, 1e-12 * weight.max(initial=1e-300)).ravel()
    unit = flat / np.maximum(np.linalg.norm(flat, axis=1, keepdims=True), 1e-300)
    for _ in range(rounds):
        part = np.argmax(unit @ centre.T, axis=1)
        centre = unit_rows(_sums(part, pull[:, None] * unit, count), centre)
    part = np.argmax(unit @ centre.T, axis=1)
    # Each part's light: its power, mean direction, and mean cosine, that mean's length.
    light = luminance(power).reshape(-1, 1)
    carried = _sums(part, light, count)[:, 0]
    vector = _sums(part, light * flat, count)
    cosine = np.linalg.norm(vector, axis=1) / np.maximum(carried, 1e-300)
    omega = _sums(part, solid_angle.reshape(-1, 1), count)[:, 0]
    # A black part's cosine is that of a cone of its solid angle; it weighs nothing.
    cosine = np.where(carried > 0.0, np.minimum(cosine, 1.0), 1.0 - omega / (4.0 * np.pi))
    return Ordinates(
        -unit_rows(vector, centre), _sums(part, power.reshape(-1, 3), count), omega, cosine
    )


def importance_sampled(radiance: ArrayLike, count: int, importance: F64 | None = None) -> Ordinates:
    """`count` ordinates of a map where its light is, each with as much of it: Elek2014, 5.1.

    Light counts by `importance` (H, W), 1 where there is none given: product sampling, 5.2.

    Directions follow the map's luminance through a Fibonacci lattice, so that nothing is random;
    colours are those of single texels. An ordinate's solid angle is the inverse of the sampling
    density; brighter texels get narrower ones.
    """
    rgb = np.asarray(radiance, dtype=np.float64)
    height, width = rgb.shape[:2]
    omega = latlong_row_solid_angles(height, width)[:, None]
    # Density: luminance times solid angle times importance, nowhere quite zero.
    light = luminance(rgb) * (1.0 if importance is None else importance)
    total = float((light * omega).sum())
    towards = seeds(light * omega + 1e-12 * max(total, 1e-300) / light.size, count)
    # The texel at each ordinate.
    u = np.arctan2(towards[:, 0], -towards[:, 2]) / (2.0 * np.pi) % 1.0
    v = np.arccos(np.clip(towards[:, 1], -1.0, 1.0)) / np.pi
    at = (
        np.minimum((v * height).astype(int), height - 1),
        np.minimum((u * width).astype(int), width - 1),
    )
    # A share 1/N of all light each: omega = total / (N L), and its colour is the texel's.
    here = np.maximum(light[at], 1e-300)
    solid_angle = np.minimum(total / (count * here), 4.0 * np.pi)
    irradiance = rgb[at] / here[:, None] * (total / count)
    return Ordinates(-towards, irradiance, solid_angle, 1.0 - solid_angle / (4.0 * np.pi))


def uniform_sky(count: int) -> Ordinates:
    """`count` ordinates of an environment of radiance 1 everywhere."""
    height = WORKING_HEIGHT
    return partition(np.ones((height, 2 * height, 3)), count)


def map_texels(radiance: F64) -> tuple[F64, F64, F64, F64]:
    """Power (h, w, 3) W m^-2, k-means weight (h, w), mean direction (h, w, 3), solid angle.

    Blocks of texels are merged; their mean direction is weighted by luminance and keeps its
    length, so that the parts' centroids and cosines are those of the whole map.
    """
    # Each texel's power and direction.
    height, width = radiance.shape[:2]
    omega = np.repeat(latlong_row_solid_angles(height, width)[:, None], width, axis=1)
    direction = latlong_texel_directions(height, width)
    power = radiance * omega[..., None]
    # A uniform sky's centroids are weighted by a little of everything, and black texels by all.
    light = luminance(power) + 1e-9 * omega * max(float(luminance(power).sum()), 1e-30)

    # Blocks of texels, as many as the working height leaves to merge.
    rows, columns = max(1, height // WORKING_HEIGHT), max(1, width // (2 * WORKING_HEIGHT))
    blocks = (rows, columns)
    light_sum = _blocks(light, blocks)
    mean = _blocks(light[..., None] * direction, blocks) / light_sum[..., None]
    omega, power = _blocks(omega, blocks), _blocks(power, blocks)
    # The square root of radiance: bright parts are cut finely, dark ones not forgotten.
    root = np.sqrt(np.maximum(luminance(power), 0.0) / omega)
    weight = omega * (root + DARK_SHARE * max(float((root * omega).sum()) / (4 * np.pi), 1e-30))
    return power, weight, mean, omega


def _blocks(values: F64, blocks: tuple[int, int]) -> F64:
    """Sums over blocks of (rows, columns); the last ones take the remainder."""
    # Whole blocks start at equal steps; what remains joins the last one.
    by_row = np.add.reduceat(values, np.arange(0, len(values) - blocks[0] + 1, blocks[0]), axis=0)
    starts = np.arange(0, values.shape[1] - blocks[1] + 1, blocks[1])
    return np.asarray(np.add.reduceat(by_row, starts, axis=1))


def seeds(weight: F64, count: int) -> F64:
    """Unit directions (count, 3) towards the map, spread by `weight` (h, w).

    A Fibonacci lattice through the map's cumulative weights: of a uniform map the sphere.
    """
    height, width = weight.shape

    # A rank-1 lattice in the unit square, by the golden ratio.
    i = np.arange(count)
    down, across = (i + 0.5) / count, np.mod(i / GOLDEN_RATIO, 1.0)

    # Down the map by the cumulative weight of rows, then across by that of the row's texels.
    rows = np.concatenate([[0.0], np.cumsum(weight.sum(axis=1))])
    v = np.interp(down * rows[-1], rows, np.arange(height + 1.0))
    row = np.minimum(v.astype(np.int64), height - 1)
    columns = np.concatenate([np.zeros((height, 1)), np.cumsum(weight, axis=1)], axis=1)
    columns /= columns[:, -1:]
    # One sorted line of all rows: row r occupies [r, r + 1).
    line = (columns + np.arange(height)[:, None]).ravel()
    at = np.interp(row + across, line, np.arange(line.size)) - row * (width + 1)
    # Equal areas inside a row: interpolate the cosine, not the angle.
    edges = np.cos(np.linspace(0.0, np.pi, height + 1))
    y = edges[row] + (v - row) * (edges[row + 1] - edges[row])
    phi = 2.0 * np.pi * at / width
    s = np.sqrt(np.maximum(0.0, 1.0 - y * y))
    return np.stack([s * np.sin(phi), y, -s * np.cos(phi)], axis=-1)


def _sums(part: I64, values: F64, count: int) -> F64:
    """Sums (count, k) of rows (n, k) by part."""
    columns = [np.bincount(part, weights=column, minlength=count) for column in values.T]
    return np.stack(columns, axis=-1)


def unit_rows(vectors: F64, otherwise: F64) -> F64:
    """Rows scaled to length 1; rows of (nearly) no length replaced by `otherwise`'s."""
    # Rows that are nothing beside the longest one have no direction.
    length = np.linalg.norm(vectors, axis=1, keepdims=True)
    scale = float(length.max(initial=0.0))
    return np.where(length > 1e-9 * scale, vectors / np.maximum(length, 1e-300), otherwise)
