"""Final gather: which rays a point sends, and how far its neighbours' rays stand for its own.

Twin of `wgsl/gather.wgsl`, with `gather_turning`.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from .arrays import F64
from .phase import ISOTROPIC, henyey_greenstein
from .sampling import orthonormal_frame, pcg_hash, uniform_from_hash

RAY_STEPS: tuple[int, int] = (3242174889, 2447445413)
"""2^32 over powers of the plastic number: R2 (Roberts2018) along a point's rays."""
POINT_STEPS: tuple[int, int, int, int] = (3679390609, 3152041523, 2700274807, 2313257605)
"""2^32 over powers of the root of x^5 = x + 1: the same in four dimensions, across the image."""
SECOND_STEPS: tuple[tuple[int, int], ...] = (
    (1013904242, 2773480762),
    (1359893119, 2600822924),
    (1779033703, 3144134277),
)
"""2^32 times the fractions of square roots of primes: along x, along y, along a point's rays."""
NORMAL_POWER = 8.0
"""Of the cosine between two points' normals, by which their light stands for one another."""
PLANE_SHARE = 0.0025
"""Distance from a point's plane, over its texel's width, at which a neighbour's weight is 1/e."""
REACH = 0.1
"""Of the distance of a surface that all rays meet: how far towards it light counts 1/e."""
LEAST_RAY = 3.0
"""Widths of a gather point that each ray is taken to be long at least."""
ALONG = 0.25
"""How much light changes along a surface that lights a point, over how it does towards it."""
FAR = 24.0
"""Widths of a gather point, at the mean distance of all, beyond which light comes from afar."""
FAR_POWER = 32.0
"""As `NORMAL_POWER`, for light from afar between points off each other's planes."""
THROUGH = 0.15
"""Of `far_closeness`: the product of a path through a wall and what rays met there at 1/e."""
LEAST_SIDE = 0.5
"""As `LEAST_RAY`, where it is asked what lies between two points."""
SAME = 0.02
"""Of the sum of two lights: by what they may differ without noise."""
DOUBT = 4.0
"""Variances by whose root two lights differ at which one counts 1/e for the other."""
CALIBRATION_DOUBT = 0.3
"""How much the lattices' light is off from place to place, over how much it is as a whole."""
MOST_CALIBRATION = 4.0
"""How many times brighter or darker the lattices' light is made at most."""


def ray_numbers(x: ArrayLike, y: ArrayLike, ray: ArrayLike) -> F64:
    """Two numbers in [0, 1) (..., 2) for a ray of the gather point at texel (x, y).

    The rays of one point, over all samples of an image, follow the R2 sequence; each point begins
    it elsewhere, such that neighbours' rays lie between its own. Exact in u32 arithmetic.
    """
    px, py, k = (np.asarray(v, dtype=np.uint32) for v in (x, y, ray))
    a, b, c, d = (np.uint32(step) for step in POINT_STEPS)
    u, v = (np.uint32(step) for step in RAY_STEPS)
    # Steps are in units of 2^-32: the overflow is the modulo of the sequence.
    with np.errstate(over="ignore"):
        first = px * a + py * b + k * u
        second = px * c + py * d + k * v
    return np.stack([uniform_from_hash(first), uniform_from_hash(second)], axis=-1)


def later_numbers(x: ArrayLike, y: ArrayLike, ray: ArrayLike, segment: ArrayLike) -> F64:
    """The same for segment 1 or later of a path: numbers that follow from no other segment's.

    The first steps by square roots of primes (Richtmyer1951), along a point's rays and across the
    image. No small multiples of its steps add up to nearly a whole number with those of R2: where
    some do, the mean over thousands of paths is that over a few planes of all there are. Later
    segments take a hash, since some multiples of six steps always do.
    """
    px, py, k, s = (np.asarray(v, dtype=np.uint32) for v in (x, y, ray, segment))
    (a, b), (c, d), (u, v) = np.array(SECOND_STEPS, dtype=np.uint32)
    with np.errstate(over="ignore"):
        # Each hash takes in one more number: no two points, rays or segments are in step.
        mixed = pcg_hash(px + pcg_hash(py + pcg_hash(k + pcg_hash(s))))
        first = np.where(s < 2, px * a + py * c + k * u, mixed)
        second = np.where(s < 2, px * b + py * d + k * v, pcg_hash(mixed + np.uint32(1)))
    return np.stack([uniform_from_hash(first), uniform_from_hash(second)], axis=-1)


def cosine_direction(normal: ArrayLike, numbers: ArrayLike) -> F64:
    """Unit directions (..., 3) about unit normals (..., 3), distributed as their cosine.

    `numbers` (..., 2) in [0, 1), uniform. Their mean radiance times pi is irradiance.
    """
    n, u = np.asarray(normal, dtype=np.float64), np.asarray(numbers, dtype=np.float64)

    # A disk's points lifted to the hemisphere over the normal.
    radius, angle = np.sqrt(u[..., 0]), 2.0 * np.pi * u[..., 1]
    tangent, bitangent = orthonormal_frame(n)
    x, y = (radius * f(angle) for f in (np.cos, np.sin))
    z = np.sqrt(np.maximum(1.0 - u[..., 0], 0.0))
    return np.asarray(x[..., None] * tangent + y[..., None] * bitangent + z[..., None] * n)


def sphere_direction(numbers: ArrayLike) -> F64:
    """Unit directions (..., 3), all alike; `numbers` (..., 2) in [0, 1), uniform.

    Their mean radiance times 4 pi is fluence.
    """
    u = np.asarray(numbers, dtype=np.float64)

    # Equal steps of the height are equal areas of the sphere.
    z, angle = 1.0 - 2.0 * u[..., 0], 2.0 * np.pi * u[..., 1]
    radius = np.sqrt(np.maximum(1.0 - z * z, 0.0))
    return np.stack([radius * np.cos(angle), radius * np.sin(angle), z], axis=-1)


def lobe_direction(axis: ArrayLike, g: ArrayLike, numbers: ArrayLike) -> F64:
    """Unit directions (..., 3): half of them all alike, half by Henyey and Greenstein's function.

    That has the mean cosine `g` (...) about the unit `axis` (..., 3); `numbers` (..., 2) in [0, 1).
    """
    n, u = np.asarray(axis, dtype=np.float64), np.asarray(numbers, dtype=np.float64)
    # One half of the first number chooses the kind, where it lies in that half is the direction.
    is_lobe, c = u[..., 0] >= 0.5, np.asarray(g, dtype=np.float64)
    again = np.stack([2.0 * u[..., 0] - is_lobe, u[..., 1]], axis=-1)
    # The inverse of the function's cumulative distribution.
    safe = np.where(np.abs(c) < 1e-3, 1.0, c)
    square = (1.0 - safe * safe) / (1.0 + safe - 2.0 * safe * again[..., 0])
    bent = (1.0 + safe * safe - square * square) / (2.0 * safe)
    z = np.clip(np.where(np.abs(c) < 1e-3, 1.0 - 2.0 * again[..., 0], bent), -1.0, 1.0)
    radius, angle = np.sqrt(1.0 - z * z), 2.0 * np.pi * again[..., 1]
    tangent, bitangent = orthonormal_frame(n)
    x, y = (radius * f(angle) for f in (np.cos, np.sin))
    lobe = x[..., None] * tangent + y[..., None] * bitangent + z[..., None] * n
    return np.asarray(np.where(is_lobe[..., None], lobe, sphere_direction(again)))


def lobe_density(cosine: ArrayLike, g: ArrayLike) -> F64:
    """sr^-1, of `lobe_direction` at a `cosine` from its axis."""
    return np.asarray(0.5 * (ISOTROPIC + henyey_greenstein(cosine, g)))


def likeness(
    place: ArrayLike, normal: ArrayLike, other: ArrayLike, its_normal: ArrayLike, texel_m: ArrayLike
) -> F64:
    """How far (...) the light on `other` stands for that on `place`, 0 to 1.

    Places (..., 3) in metres and their unit normals (..., 3); `texel_m` is how wide a gather point
    is on the surface at `place`. Points that face elsewhere count less, and those that lie off its
    plane by more than a surface bends between their normals.
    """
    p, n, q, m = (np.asarray(v, dtype=np.float64) for v in (place, normal, other, its_normal))
    cosine = np.clip((n * m).sum(axis=-1), 0.0, 1.0)
    # By this a round surface that has both normals leaves the plane: a circle's chord. A turn of
    # more than about 20 degrees is taken for an edge.
    is_round = np.clip(25.0 * cosine - 23.5, 0.0, 1.0)
    bend = np.linalg.norm(q - p, axis=-1) * np.sqrt(0.5 - 0.5 * cosine) * is_round
    above = np.maximum(np.abs(((q - p) * n).sum(axis=-1)) - bend, 0.0)
    return np.asarray(cosine**NORMAL_POWER * np.exp(-above / (PLANE_SHARE * np.asarray(texel_m))))


def variance_of_sum(sum: ArrayLike, squares: ArrayLike, count: int) -> F64:
    """The variance of a sum of `count` numbers that are alike, from that of their squares."""
    total, squared = np.asarray(sum, dtype=np.float64), np.asarray(squares, dtype=np.float64)
    return np.asarray(np.maximum(squared - total * total / count, 0.0))


def sameness(a: ArrayLike, b: ArrayLike, variance: ArrayLike) -> F64:
    """How far (...) two lights are the same but for their noise, 0 to 1.

    `variance`: the sum of both. What is to be expected of noise is taken from their difference.
    Source: Rousselle2012 (pixel distances of non-local means).
    """
    x, y, v = (np.asarray(value, dtype=np.float64) for value in (a, b, variance))

    # Only what noise does not explain counts as a difference.
    off = np.maximum((x - y) ** 2 - v, 0.0)
    return np.asarray(np.exp(-off / np.maximum(DOUBT * v + (SAME * (x + y)) ** 2, 1e-30)))


def nearness(side: ArrayLike, inverse_m: ArrayLike, haze: ArrayLike) -> tuple[F64, F64]:
    """How fast a point's light changes by one of its rays, m^-1: a symmetric matrix.

    Its squares (..., 3) (xx, yy, zz) and products (..., 3) (yz, zx, xy). The ray met a surface of
    unit normal `side` (..., 3); `inverse_m` is the inverse of its length; `haze` is the share that
    media took of its light, and their own comes from all around. A point that moves towards a
    surface sees it change; one that moves along it hardly does.
    Source: Ward1988 (irradiance changes over the harmonic mean of distances, here by direction).
    """
    m, inverse = np.asarray(side, dtype=np.float64), np.asarray(inverse_m, dtype=np.float64)

    # Along the surface light changes less than towards it.
    along = (ALONG + (1.0 - ALONG) * np.asarray(haze, dtype=np.float64))[..., None]
    across = (1.0 - along) * np.roll(m, -1, axis=-1) * np.roll(m, 1, axis=-1)
    return inverse[..., None] * (along + (1.0 - along) * m * m), inverse[..., None] * across


def closeness(offset: ArrayLike, squares: ArrayLike, products: ArrayLike) -> F64:
    """How far (...) the light of a neighbour stands for a point's, 0 to 1.

    `offset` (..., 3) to it, m; the mean of `nearness` over rays, m^-1. Neighbours share along the
    seam of two walls, and little across it.
    """
    return np.asarray(np.exp(-approach(offset, squares, products) / REACH**2))


def approach(offset: ArrayLike, squares: ArrayLike, products: ArrayLike) -> F64:
    """The square of how far (...) `offset` (..., 3), m, leads by the mean of `nearness`, m^-1."""
    d, a, b = (np.asarray(v, dtype=np.float64) for v in (offset, squares, products))
    turned = a * d + np.roll(b, -1, -1) * np.roll(d, 1, -1) + np.roll(b, 1, -1) * np.roll(d, -1, -1)
    return np.asarray((turned**2).sum(axis=-1))


def far_closeness(
    offset: ArrayLike, inverse_m: ArrayLike, side: ArrayLike, its_side: ArrayLike
) -> F64:
    """How far (...) a neighbour's light from afar stands for a point's, 0 to 1.

    `offset` (..., 3) to it, m; `inverse_m` (...) the mean inverse length of the rays that it came
    along and of one at which far begins, m^-1; `side` and `its_side` (..., 3) the means over all
    rays of the normal that they met over their length, m^-1. As `closeness` by those lengths; and
    where that leads towards what is near both of them, that is a wall between them: each may see
    what it hides from the other.
    """
    d, inverse, m, k = (
        np.asarray(v, dtype=np.float64) for v in (offset, inverse_m, side, its_side)
    )

    # Above 0 where the offset leads towards what is near both points.
    through = np.minimum(-(m * d).sum(axis=-1), (k * d).sum(axis=-1))
    through = np.maximum(through, 0.0) / THROUGH
    return np.asarray(np.exp(-(through**2) - (inverse / REACH) ** 2 * (d**2).sum(axis=-1)))


def far_likeness(like: ArrayLike, normal: ArrayLike, its_normal: ArrayLike) -> F64:
    """`likeness` (...) of two points for light from afar: off their planes it is the same, too."""
    n, m = (np.asarray(v, dtype=np.float64) for v in (normal, its_normal))
    cosine = np.clip((n * m).sum(axis=-1), 0.0, 1.0)
    return np.asarray(np.maximum(np.asarray(like, dtype=np.float64), cosine**FAR_POWER))


def sky_share(cosine: ArrayLike, density: ArrayLike, rays: int, sky_rays: int) -> F64:
    """What a ray (...) that leaves the scene counts, whichever way its direction was chosen.

    `cosine` to the normal; `density`, sr^-1, at which rays towards the sky go there. With it
    (Veach1995, the balance heuristic) pi over `rays` times the sum of share times radiance, over
    cosine-distributed `rays` and `sky_rays` together, is irradiance: neither a small sun nor a dim
    horizon is found by luck.
    """
    # The balance heuristic of the two ways to choose the ray.
    by_cosine = rays * np.maximum(np.asarray(cosine, dtype=np.float64), 0.0) / np.pi
    return np.asarray(by_cosine / np.maximum(by_cosine + sky_rays * np.asarray(density), 1e-30))


def calibration(traced: float, known: float, ends: float) -> float:
    """The factor that makes lattices agree with what paths trace, as far as that is sure.

    `known` is the light of lattices where the second last segments of paths end; the last ones
    find the light of lights there, `traced`, and at their own ends lattices' light, `ends`, all
    summed over paths, times what each path passes on. With the factor f, f `known` is `traced` +
    f `ends`, but that lattices are not off by the same everywhere. So f is the likeliest where they
    are off by s as a whole and by k s (`CALIBRATION_DOUBT`) from place to place: the least of
    (traced + f (ends - known))^2 / (k ends)^2 + (f - 1)^2. Where lattices bring nearly all
    light themselves, and little is traced, it stays near 1.
    """
    # The light that paths would trace by themselves, were the lattices right.
    own = known - ends
    sure = own * own + (CALIBRATION_DOUBT * ends) ** 2
    factor = 1.0 + own * (traced - own) / max(sure, 1e-30)
    return min(max(factor, 1.0 / MOST_CALIBRATION), MOST_CALIBRATION)
