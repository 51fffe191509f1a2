"""Beams of point lights in scattering media, and their light close to the source.

A local light is an ordinate whose direction and strength differ from cell to cell. Diffusion alone
loses a quarter of its light, most of it close by, where light that has scattered once still flies
straight. That part is added in closed form, from an infinite homogeneous medium, in which the
fluence of a point source is known (Case1953).

differs: Elek2014 section 6 propagates in a radial grid around each light.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from .arrays import F64
from .delta_beam import Beam, MediumGrid, beam_loss
from .outgoing_light import forward_share
from .voxels import density_behind

NEAR_TABLE = 64
_BLOCK = 4  # cells a side around a light, whose power is known
THIN_GAIN = 2.5  # fitted to Monte Carlo in balls of radius 0.1 to 3 mean free paths


def point_light_beam(
    medium: MediumGrid,
    position: ArrayLike,
    intensity: ArrayLike,
    lit_mean: ArrayLike | None = None,
    spread_m: float = 0.0,
) -> Beam:
    """The beam of a point light at `position` (3,), m in the medium's box; W sr^-1 (channel,).

    `intensity` may differ by cell: (z, y, x, channel), for spot lights, of which `lit_mean`
    (channel,) is the mean over all directions. `spread_m`: of light that comes from all around the
    point, the root mean square distance from it.
    """
    # The light's direction and distance from every cell.
    away = medium.centres - np.asarray(position, dtype=np.float64)
    distance = np.linalg.norm(away, axis=-1)
    direction = away / np.maximum(distance, 1e-9)[..., None]
    passed = density_behind(
        medium.fine, medium.extent, medium.centres, direction, float(medium.cell.min()), distance
    )
    irradiance = np.asarray(intensity) * mean_inverse_square(away, medium.cell)[..., None]
    mean = intensity if lit_mean is None else lit_mean
    missing = missing_irradiance(medium, away, mean)
    sharpness = local_sharpness(distance, spread_m, medium.cell)
    return Beam(direction, irradiance, 1.0, passed, missing, sharpness)


def missing_irradiance(medium: MediumGrid, away: F64, intensity: ArrayLike) -> F64:
    """What the means of `point_light_beam` leave out around a light (z, y, x, channel), W m^-2.

    `away` (z, y, x, 3), m, from the light; `intensity` (channel,), its mean over all directions.
    Means of 1/r^2 over cells and transmittance to their middles lose up to a sixth of what leaves
    the beam there. The integral of exp(-loss r)/r^2 over the block of 4^3 cells around the light is
    known along rays; what the cells' means lack of it goes to the eight cells whose middles
    surround the light, by their trilinear weights.
    """
    h, volume = medium.cell, float(np.prod(medium.cell))
    leaving = medium.sigma_t * medium.albedo * (1.0 - forward_share(medium.g))
    loss = medium.density[..., None] * (medium.sigma_t * (1.0 - medium.albedo) + leaving)
    share = np.maximum(1.0 - np.abs(away) / h, 0.0).prod(axis=-1)
    found = np.zeros_like(loss)
    for cell in zip(*np.nonzero(share), strict=True):
        missing = _missing_integral(away[cell], h, loss[cell])
        found[cell] = np.asarray(intensity) * share[cell] / volume * missing
    return found


def _missing_integral(away: F64, h: F64, loss: F64) -> F64:
    """The integral of exp(-loss r)/r^2 over the block of a light, m, less that of its cells."""
    # The eight cells around the light, and one more on each side.
    first = away + np.where(away <= 0.0, -1.0, -2.0) * h
    z, y, x = np.meshgrid(*[np.arange(_BLOCK)] * 3, indexing="ij")
    at = first + np.stack([x, y, z], axis=-1).reshape(-1, 3) * h
    r = np.linalg.norm(at, axis=-1)[:, None]
    cells = np.prod(h) * (mean_inverse_square(at, h)[:, None] * np.exp(-loss * r)).sum(axis=0)
    # Along rays to the middles of the block's faces it is (1 - exp(-loss r))/loss.
    whole, directions = np.zeros_like(loss), 0.0
    for axis in range(3):
        for side in (-0.5, _BLOCK - 0.5):
            u, v = (k.reshape(-1) for k in np.meshgrid(*[np.arange(_BLOCK)] * 2))
            step = np.zeros((_BLOCK**2, 3))
            step[:, axis], step[:, (axis + 1) % 3], step[:, (axis + 2) % 3] = side, u, v
            at = first + step * h
            r = np.linalg.norm(at, axis=-1)
            solid = np.abs(at[:, axis]) / (h[axis] * r**3)
            depth = np.maximum(loss * r[:, None], 1e-4)
            whole += ((solid * r)[:, None] * -np.expm1(-depth) / depth).sum(axis=0)
            directions += float(solid.sum())
    return np.asarray(4.0 * np.pi * whole / directions - cells)


def local_sharpness(distance: ArrayLike, spread_m: float, cell: ArrayLike) -> F64:
    """The mean cosine of a light's directions in a cell of `cell` (3,), m, `distance`, m, away.

    Points of the light and of the cell lie apart by the sum of their mean squares. A phase function
    of mean cosine g counts as one of g times this: a cell that touches a light is lit from all
    sides, not from the light's middle to its own.
    """
    apart = spread_m**2 + float((np.asarray(cell, np.float64) ** 2).sum()) / 12.0
    r = np.asarray(distance, np.float64)
    return np.asarray(r / np.sqrt(r * r + apart))


def mean_inverse_square(away: F64, cell: F64) -> F64:
    """1/r^2 averaged over a cell (...), m^-2; `away` (..., 3), m, from the light to its centre.

    The mean over eight parts, each to second order, 1/r^2 (1 + h^2/(12 r^2)).
    """
    # Second order in each of the cell's eight parts.
    total: F64 = np.zeros(away.shape[:-1])
    half = 0.5 * float(np.mean(cell))
    for corner in range(8):
        side = np.array([(corner >> axis) & 1 for axis in range(3)]) - 0.5
        # In the light's own cell the mean is finite: the distance is held above a part of the cell.
        r2 = np.maximum(((away + 0.5 * side * cell) ** 2).sum(axis=-1), 0.1 * half**2)
        total += (1.0 + half**2 / (12.0 * r2)) / (8.0 * r2)
    return total


def inner_share(position: ArrayLike, extent: ArrayLike, radius_m: float) -> float:
    """How far a light at `position` (3,), m, counts as one in a medium's box of `extent` (3,), m.

    1 inside, 0 from a medium's radius beside it on. A white furnace corrects what diffusion gets
    wrong of light that enters at the border. Around a light inside, fluence is right to a percent
    without (boxes of 2 to 16 mean free paths, beside Monte Carlo); corrected, it was 1.05.
    """
    p = np.asarray(position, dtype=np.float64)
    outside = np.maximum(np.maximum(-p, p - np.asarray(extent)), 0.0)
    return float(np.clip(1.0 - np.linalg.norm(outside) / radius_m, 0.0, 1.0))


def near_table(albedo: float) -> F64:
    """H (NEAR_TABLE,) at s/(1 + s) = 0 .. 1 in equal steps, s the optical distance to the light.

    Missing fluence in units of I sigma_s/r. The exact fluence of a point source of unit power has
    the transform A/(1 - albedo A), A = arctan(k)/k; beam and diffusion have A + albedo A/(D k^2 +
    1 - albedo), D = 1/3. Their difference, transformed back, times s/albedo; pi^2/4 at s = 0.
    """
    # Dense where the transforms change, then as far as their rest takes to vanish.
    k = np.concatenate([np.linspace(1e-4, 40.0, 6000), np.geomspace(40.0, 4000.0, 6001)[1:]])
    a = np.arctan(k) / k
    # The part that falls as 1/k^2 is transformed by hand: pi^2/4 exp(-s)/s.
    rest = a * a / (1.0 - albedo * a) - a / (k * k / 3.0 + 1.0 - albedo)
    rest -= 0.25 * np.pi**2 / (k * k + 1.0)
    x = np.linspace(0.0, 1.0, NEAR_TABLE)[:-1]
    s = x / (1.0 - x)
    # The inverse transform of a radial function: 2/pi times the integral of k sin(k s) f(k).
    whole = 2.0 / np.pi * np.trapezoid(k * np.sin(k * s[:, None]) * rest, k, axis=1)
    return np.append(whole + 0.25 * np.pi**2 * np.exp(-s), 0.0)


def near_fluence(
    medium: MediumGrid,
    one: Beam,
    away_m: F64,
    intensity: ArrayLike,
    radius_m: float,
    mean_density: float,
) -> F64:
    """Fluence (z, y, x, channel), W m^-2, that beam and diffusion miss around a point light.

    `away_m` (z, y, x): distance to it; `radius_m`: the medium's (three times the largest
    diffusivity); `mean_density`: over its mass. In a medium thinner than the radius the lost part
    falls faster than an infinite one's. Where little of the path is filled, the light is outside:
    no loss.
    """
    # The beam's coefficients: the forward peak counts as unscattered.
    f = forward_share(medium.g)
    scattering = medium.sigma_t * medium.albedo * (1.0 - f)
    loss = medium.sigma_t * beam_loss(medium.g, medium.albedo)
    albedo = scattering / np.maximum(loss, 1e-30)
    # A thin medium loses light at its border, as if its extinction were larger.
    thickness = loss * mean_density * radius_m
    thin = THIN_GAIN * np.exp(-(thickness**2)) / radius_m
    # Read the infinite medium's table at s / (1 + s), s the optical distance.
    r = np.maximum(away_m, 0.4 * float(np.mean(medium.cell)))
    s = loss * one.passed[..., None] + thin * r[..., None]
    tables = np.stack([near_table(float(w)) for w in albedo], axis=-1)
    at = s / (1.0 + s) * (NEAR_TABLE - 1)
    low = np.minimum(at.astype(np.int64), NEAR_TABLE - 2)
    channel = np.arange(len(albedo))
    missing = (1.0 + low - at) * tables[low, channel] + (at - low) * tables[low + 1, channel]
    # As much of it as the path lies in the medium.
    filled = one.passed / r
    share = filled * np.minimum(1.0, filled / max(mean_density, 1e-30))
    return np.asarray(np.asarray(intensity) * scattering * missing * (share / r)[..., None])


def axis_share(position: ArrayLike, axis: ArrayLike, extent: ArrayLike, points: F64) -> F64:
    """How much of a spot's axis is in a medium's box (3,), m, beside the path to points (..., 3).

    Both as far as the points are away; at most 1. What scatters close to a spot is in its cone: one
    that turns its back on a medium, however near by, has none. (A light of which nothing was known
    but the lit share of the sphere tripled the light of a cube .1 m behind it.)
    """
    # Each point's own ray, and the spot's axis as far.
    p, d, size = (np.asarray(x, dtype=np.float64) for x in (position, axis, extent))
    away = points - p
    r = np.linalg.norm(away, axis=-1)
    own = _path_in_box(p, away / np.maximum(r, 1e-9)[..., None], size, r)
    lit = _path_in_box(p, np.broadcast_to(d, away.shape), size, r)
    return np.asarray(np.minimum(1.0, lit / np.maximum(own, 1e-9)))


def _path_in_box(p: F64, direction: F64, size: F64, r: F64) -> F64:
    # The interval inside the box, cut to 0 .. r.
    still = np.abs(direction) < 1e-12
    inverse = 1.0 / np.where(still, 1.0, direction)
    a, b = -p * inverse, (size - p) * inverse
    inside = (p >= 0.0) & (p <= size)
    begin = np.where(still, np.where(inside, -np.inf, np.inf), np.minimum(a, b)).max(axis=-1)
    end = np.where(still, np.where(inside, np.inf, -np.inf), np.maximum(a, b)).min(axis=-1)
    return np.asarray(np.maximum(0.0, np.minimum(end, r) - np.maximum(begin, 0.0)))
