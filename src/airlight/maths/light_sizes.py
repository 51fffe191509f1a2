"""What lights with extent are as large as, from a point in media near them; twins of
wgsl/light_sizes.wgsl.

What a point gets from all directions of a surface of even radiance is that times its solid angle.
"""

from __future__ import annotations

import numpy as np

from .arrays import F64


def rectangle_angle(at: F64, half: F64) -> F64:
    """Solid angles, sr, of a rectangle at the origin from points `at` (n, 3), metres.

    Coordinates go along its sides, 2 `half` (2,), metres, and above it; below it there is none.
    The sum over the corners of that of the rectangle between a corner and the foot of the
    perpendicular, atan(x y / (h r)).
    """
    # The signed rectangles from the foot of the perpendicular to each corner.
    x, y, h = at[..., 0], at[..., 1], at[..., 2]
    total = np.zeros(x.shape)
    for i in (-1.0, 1.0):
        for k in (-1.0, 1.0):
            a, b = half[0] + i * x, half[1] + k * y
            total += np.arctan2(a * b, h * np.sqrt(a * a + b * b + h * h))
    return np.asarray(np.where(h > 0.0, np.maximum(total, 0.0), 0.0), np.float64)


def rectangle_reach(at: F64, half: F64) -> F64:
    """How far away, metres, that rectangle is for what attenuates its light.

    The harmonic mean of the distances to its nearest point and to the rim of a disk of twice its
    area. Light of squares and of strips ten times as long as wide, in media of .3 and 1 per half a
    side, is within 2 % of what it should be above them and before them, 8 to 39 % more beside them,
    where little of it goes. Source: ours.
    """
    # The nearest point, and the rim of a disk of twice the area: r^2 = 8 a b / pi.
    beside = np.maximum(np.abs(at[..., :2]) - half, 0.0)
    near = np.sqrt((beside**2).sum(axis=-1) + at[..., 2] ** 2)
    far = np.sqrt((at**2).sum(axis=-1) + 8.0 * half[0] * half[1] / np.pi)
    return np.asarray(2.0 * near * far / (near + far), np.float64)


def ball_share(distance: F64, radius: float) -> F64:
    """The solid angle of a ball, `distance` metres to its middle, over the area of its disk, m^-2.

    2 pi (1 - c) over pi r^2, c the cosine of its rim; from within it, as from its surface.
    """
    d = np.maximum(distance, radius)
    return np.asarray(2.0 / (d * d * (1.0 + np.sqrt(1.0 - (radius / d) ** 2))), np.float64)


def ball_reach(distance: F64, radius: float) -> F64:
    """How far away, metres, a ball is for what attenuates its light.

    The geometric mean of the distances to its nearest point, twice, and to its rim, once: from afar
    two thirds of the radius nearer than its middle, as its disk is in the mean. Source: ours.
    """
    near = np.maximum(distance - radius, 0.0)
    return np.asarray((near**5 * (distance + radius)) ** (1.0 / 6.0), np.float64)


def rectangle_direction(at: F64, half: F64, angle: F64) -> F64:
    """Mean directions (n, 3), unit, of a rectangle's light at points that see it under `angle`, sr.

    From afar it comes from its middle, close by from its nearest point, as from above a plane.
    Source: ours.
    """
    # The more of the hemisphere is filled, the nearer the mean lies to the closest point.
    share = np.minimum(angle / (2.0 * np.pi), 1.0)[..., None]
    direction = at.copy()
    direction[..., :2] -= share * np.clip(at[..., :2], -half, half)
    return np.asarray(direction / np.linalg.norm(direction, axis=-1, keepdims=True), np.float64)


def sharpness_over(angle: F64) -> F64:
    """What g of Henyey and Greenstein's function is multiplied by, over a light of `angle`, sr.

    The mean over its directions is nearly the function of a smaller g, of the mean direction. By
    the first moment that would be the mean cosine of a cap of that angle about its axis; by its
    square what is scattered straight on is right, too (.99 to 1.05 before and below squares and
    strips, 1.13 beside them, where the cosine alone has 1.07 to 1.23). Source: ours.
    """
    return np.asarray((1.0 - angle / (4.0 * np.pi)) ** 2, np.float64)
