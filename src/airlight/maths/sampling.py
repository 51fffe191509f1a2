"""Point sequences, hashes and warps: where to sample, the same in every run."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

F64 = NDArray[np.float64]
U32 = NDArray[np.uint32]

GOLDEN_RATIO = float((1.0 + np.sqrt(5.0)) / 2.0)
# The real root of x^3 = x + 1: R2's base.
PLASTIC_NUMBER = 1.324717957244746


def fibonacci_sphere(count: int) -> F64:
    """`count` nearly equally spread unit directions (count, 3), from +z to -z.

    Source: Gonzalez 2010, with the points half a step off the poles.
    """
    i = np.arange(count)
    z = 1.0 - (2.0 * i + 1.0) / count
    phi = 2.0 * np.pi * np.mod(i / GOLDEN_RATIO, 1.0)
    s = np.sqrt((1.0 - z) * (1.0 + z))
    return np.stack([s * np.cos(phi), s * np.sin(phi), z], axis=-1)


def r2_sequence(count: int, start: int = 0) -> F64:
    """Points start .. start + count - 1 of the R2 sequence, (count, 2) in [0, 1).

    Source: Roberts 2018, the generalised golden ratio in two dimensions.
    """
    i = np.arange(start, start + count)[:, None]
    step = np.array([1.0 / PLASTIC_NUMBER, 1.0 / PLASTIC_NUMBER**2])
    return np.asarray(np.mod(0.5 + i * step, 1.0))


def radical_inverse(index: ArrayLike, base: int) -> F64:
    """van der Corput's radical inverse in [0, 1) of whole numbers (...). Source: pbrt 8.6."""
    i = np.asarray(index, dtype=np.int64)
    value: F64 = np.zeros(i.shape)
    weight = 1.0 / base
    while np.any(i > 0):
        i, digit = np.divmod(i, base)
        value = value + weight * digit
        weight /= base
    return value


def halton(count: int, bases: tuple[int, ...] = (2, 3), start: int = 1) -> F64:
    """Points of the Halton sequence (count, len(bases)) in [0, 1). Source: Halton 1960."""
    i = np.arange(start, start + count)
    return np.stack([radical_inverse(i, base) for base in bases], axis=-1)


def pixel_jitter(count: int) -> F64:
    """Offsets (count, 2), pixels from the centre, for anti-aliasing; a single one is (0, 0).

    The first `count` R2 points with their mean taken off, so that the picture does not shift;
    that moves a few points out of [-1/2, 1/2) by less than 2/count.
    """
    points = r2_sequence(count)
    return np.asarray(points - points.mean(axis=0))


def interleaved_gradient_noise(x_px: ArrayLike, y_px: ArrayLike) -> F64:
    """Noise in [0, 1) that is even over every 3 x 3 pixels; whole-pixel coordinates (...).

    Source: Jimenez 2014, Next Generation Post Processing in Call of Duty.
    """
    x, y = np.asarray(x_px, dtype=np.float64), np.asarray(y_px, dtype=np.float64)
    return np.mod(52.9829189 * np.mod(0.06711056 * x + 0.00583715 * y, 1.0), 1.0)


def r2_noise(x_px: ArrayLike, y_px: ArrayLike, frame: ArrayLike = 0) -> F64:
    """Blue-noise-like dither in [0, 1) by whole pixel and frame.

    Frames fill in by the golden ratio. Exact in u32 arithmetic, so that large coordinates lose
    nothing. Source: Roberts 2018.
    """
    x, y, f = (np.asarray(v, dtype=np.uint32) for v in (x_px, y_px, frame))
    with np.errstate(over="ignore"):
        h = x * np.uint32(3242174889) + y * np.uint32(2447445413) + f * np.uint32(2654435769)
    return np.asarray((h >> np.uint32(8)).astype(np.float64) * 2.0**-24)


def pcg_hash(value: ArrayLike) -> U32:
    """A u32 (...) scrambled to a u32, the same bits as in WGSL.

    Source: Jarzynski and Olano 2020, pcg (RXS-M-XS).
    """
    v = np.asarray(value, dtype=np.uint32)
    with np.errstate(over="ignore"):
        state = v * np.uint32(747796405) + np.uint32(2891336453)
        shift = (state >> np.uint32(28)) + np.uint32(4)
        word = ((state >> shift) ^ state) * np.uint32(277803737)
    return np.asarray((word >> np.uint32(22)) ^ word)


def uniform_from_hash(hashed: ArrayLike) -> F64:
    """A number in [0, 1) with 24 bits of a u32 hash, exact in float32."""
    return (np.asarray(hashed, dtype=np.uint32) >> np.uint32(8)).astype(np.float64) * 2.0**-24


def equiangular_distance(
    u: ArrayLike, h_m: ArrayLike, t0_m: ArrayLike, t1_m: ArrayLike
) -> tuple[F64, F64]:
    """(t, density): a distance in [t0, t1] sampled like 1/(h^2 + t^2), metres and m^-1.

    u in [0, 1); h the distance of the light from the ray, t = 0 closest to it.
    Source: Kulla and Fajardo 2012, eq. 7.
    """
    h = np.asarray(h_m, dtype=np.float64)
    x0 = np.arctan2(np.asarray(t0_m, dtype=np.float64), h)
    x1 = np.arctan2(np.asarray(t1_m, dtype=np.float64), h)
    t = h * np.tan(x0 + np.asarray(u, dtype=np.float64) * (x1 - x0))
    return np.asarray(t), np.asarray(h / ((x1 - x0) * (h * h + t * t)))


def concentric_disk(u: ArrayLike) -> F64:
    """Points (..., 2) of the unit disk from uniform (..., 2). Source: Shirley and Chiu 1997."""
    p = 2.0 * np.asarray(u, dtype=np.float64) - 1.0
    a, b = p[..., 0], p[..., 1]
    first = np.abs(a) > np.abs(b)
    r = np.where(first, a, b)
    safe = np.where(r == 0.0, 1.0, r)
    quarter = np.pi / 4.0
    phi = np.where(first, quarter * (b / safe), 2.0 * quarter - quarter * (a / safe))
    return np.stack([r * np.cos(phi), r * np.sin(phi)], axis=-1)


def cosine_hemisphere(u: ArrayLike) -> F64:
    """Directions (..., 3) about +z with density z/pi from uniform (..., 2). Source: Malley."""
    disk = concentric_disk(u)
    z = np.sqrt(np.maximum(1.0 - (disk**2).sum(axis=-1, keepdims=True), 0.0))
    return np.concatenate([disk, z], axis=-1)


def orthonormal_frame(normal: ArrayLike) -> tuple[F64, F64]:
    """Two unit vectors (..., 3) that make a right-handed frame with unit normals (..., 3).

    Source: Duff et al. 2017, Building an Orthonormal Basis, Revisited.
    """
    n = np.asarray(normal, dtype=np.float64)
    x, y, z = n[..., 0], n[..., 1], n[..., 2]
    sign = np.where(z < 0.0, -1.0, 1.0)
    a = -1.0 / (sign + z)
    b = x * y * a
    tangent = np.stack([1.0 + sign * x * x * a, sign * b, -sign * x], axis=-1)
    return tangent, np.stack([b, sign + y * y * a, -y], axis=-1)
