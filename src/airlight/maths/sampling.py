"""Point sequences, hashes, noise and frames: where to sample, the same in every run."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from .arrays import F64, I64, U32

GOLDEN_RATIO = float((1.0 + np.sqrt(5.0)) / 2.0)
# The real root of x^3 = x + 1: R2's base.
PLASTIC_NUMBER = 1.324717957244746


def fibonacci_sphere(count: int) -> F64:
    """`count` nearly equally spread unit directions (count, 3), from +z to -z.

    Source: Gonzalez2010, with the points half a step off the poles.
    """
    # Equal steps of z are equal areas; azimuths step by the golden ratio.
    i = np.arange(count)
    z = 1.0 - (2.0 * i + 1.0) / count
    phi = 2.0 * np.pi * np.mod(i / GOLDEN_RATIO, 1.0)
    s = np.sqrt((1.0 - z) * (1.0 + z))
    return np.stack([s * np.cos(phi), s * np.sin(phi), z], axis=-1)


def r2_sequence(count: int, start: int = 0) -> F64:
    """Points start .. start + count - 1 of the R2 sequence, (count, 2) in [0, 1).

    Source: Roberts2018, the generalised golden ratio in two dimensions.
    """
    # Steps of powers of the plastic number, modulo 1.
    i = np.arange(start, start + count)[:, None]
    step = np.array([1.0 / PLASTIC_NUMBER, 1.0 / PLASTIC_NUMBER**2])
    return np.asarray(np.mod(0.5 + i * step, 1.0))


def pixel_jitter(count: int) -> F64:
    """Offsets (count, 2), pixels from the centre, for anti-aliasing; a single one is (0, 0).

    A rank-1 lattice by the golden ratio, its second coordinate by rank, so that every row and every
    column of a `count` x `count` grid has one point: an edge along the pixels (a small light has
    little else) is off its coverage by half a step at most, and the image does not shift. In the
    order of bit-reversed rows, so that the first points of many are spread as well.
    """
    # The lattice's column is the rank of its fractional part: one point in each row and column.
    row = np.arange(count)
    column = np.mod(row / GOLDEN_RATIO, 1.0).argsort().argsort()

    # Rows in the order of their reversed bits.
    bits = np.arange(max(1, int(count - 1).bit_length()))
    reversed_row = ((row[:, None] >> bits & 1) << bits[::-1]).sum(axis=1)
    points = np.stack([row, column], axis=1)[reversed_row.argsort()]
    return np.asarray((points + 0.5) / count - 0.5)


def lens_points(sample: int) -> F64:
    """Point number `sample` (2,) of a sequence in the unit disc: the first of many are spread, too.

    Those of `r2_sequence`, by the area.
    """
    # Equal areas: the radius is a square root.
    radius, angle = r2_sequence(1, sample)[0]
    turn = 2.0 * np.pi * angle
    return np.asarray(np.sqrt(radius) * np.array([np.cos(turn), np.sin(turn)]))


def shutter_shares(count: int) -> F64:
    """When samples (count,) fall within a shutter's opening, 0 to 1: evenly, in mixed order.

    By rank of the numbers whose digits to the base 3 are reversed: rows and columns of
    `pixel_jitter`, which are of base 2 and the golden ratio, do not go with them.
    """
    # Digits to the base 3, reversed behind the point; ranks make them even.
    digits = 3 ** np.arange(1, 12)
    k = np.arange(count)[:, None]
    reversed_3 = (k * 3 // digits % 3 / digits).sum(axis=1)
    return np.asarray((reversed_3.argsort().argsort() + 0.5) / count)


def r2_noise(x_px: ArrayLike, y_px: ArrayLike, frame: ArrayLike = 0) -> F64:
    """Blue-noise-like dither in [0, 1) by whole pixel and frame.

    Frames fill in by the golden ratio. Exact in u32 arithmetic, so that large coordinates lose
    nothing. Source: Roberts2018.
    """
    # The sum of integers overflows as the sequence wraps.
    x, y, f = (np.asarray(v, dtype=np.uint32) for v in (x_px, y_px, frame))
    with np.errstate(over="ignore"):
        h = x * np.uint32(3242174889) + y * np.uint32(2447445413) + f * np.uint32(2654435769)
    return np.asarray((h >> np.uint32(8)).astype(np.float64) * 2.0**-24)


def pcg_hash(value: ArrayLike) -> U32:
    """A u32 (...) scrambled to a u32, the same bits as in WGSL.

    Source: Jarzynski2020, pcg (RXS-M-XS).
    """
    # The generator's one step, then its permutation of the bits.
    v = np.asarray(value, dtype=np.uint32)
    with np.errstate(over="ignore"):
        state = v * np.uint32(747796405) + np.uint32(2891336453)
        shift = (state >> np.uint32(28)) + np.uint32(4)
        word = ((state >> shift) ^ state) * np.uint32(277803737)
    return np.asarray((word >> np.uint32(22)) ^ word)


def uniform_from_hash(hashed: ArrayLike) -> F64:
    """A number in [0, 1) with 24 bits of a u32 hash, exact in float32."""
    return (np.asarray(hashed, dtype=np.uint32) >> np.uint32(8)).astype(np.float64) * 2.0**-24


def orthonormal_frame(normal: ArrayLike) -> tuple[F64, F64]:
    """Two unit vectors (..., 3) that make a right-handed frame with unit normals (..., 3).

    Source: Duff2017.
    """
    # The sign of z keeps the denominator away from 0.
    n = np.asarray(normal, dtype=np.float64)
    x, y, z = n[..., 0], n[..., 1], n[..., 2]
    sign = np.where(z < 0.0, -1.0, 1.0)
    a = -1.0 / (sign + z)
    b = x * y * a
    tangent = np.stack([1.0 + sign * x * x * a, sign * b, -sign * x], axis=-1)
    return tangent, np.stack([b, sign + y * y * a, -y], axis=-1)


def alias_table(weights: ArrayLike) -> tuple[F64, I64]:
    """(keep, other) (n,): item i is taken with `keep`[i], else item `other`[i], i chosen evenly.

    Items then come in proportion to their weights. Source: Vose1991.
    """
    # Shares of an even draw: what exceeds 1 is given to items below it.
    w = np.asarray(weights, dtype=np.float64)
    share = w * (len(w) / max(float(w.sum()), 1e-300))
    keep, other = np.minimum(share, 1.0), np.arange(len(w))
    small, large = np.flatnonzero(share < 1.0), np.flatnonzero(share >= 1.0)
    if not len(large):
        return np.ones(len(w)), other
    # A large item gives until its rest is below 1; the next one then fills that up.
    left = share[large].copy()
    at = 0
    stack = [int(i) for i in small]
    while stack and at < len(large):
        i = stack.pop()
        other[i] = large[at]
        left[at] -= 1.0 - keep[i]
        if left[at] < 1.0:
            keep[large[at]] = left[at]
            stack.append(int(large[at]))
            at += 1
    return keep, other
