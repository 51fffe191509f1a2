"""Irradiance of lights with extent, in closed form; twins of wgsl/area_light.wgsl.

All are seen from a receiver at the origin with its normal along +z, over a radiance of 1 from every
point of the light towards the receiver, and without anything in between.
"""

from __future__ import annotations

from functools import cache
from pathlib import Path

import numpy as np

from .arrays import F32, F64
from .sampling import orthonormal_frame

RIM_CORNERS = 12
"""Corners of the polygon of the same area that stands for a disk."""
RIM_SCALE = float(np.sqrt(2.0 * np.pi / (RIM_CORNERS * np.sin(2.0 * np.pi / RIM_CORNERS))))
"""Its radius over the disk's."""


def softened_gain(nearest: F64, squared: F64) -> F64:
    """What a softened light is multiplied by, to light as much in all of space as a point does.

    A point stands for a part of a surface: 1/s in place of 1/r^2, s = r^2 + n (m^2), with n
    `nearest` and s `squared`, keeps its dots out of the air and loses the light near it. With
    1 + n/s + 4 (n/s)^2 the integral of r^2/s over r is that of 1, since those of n/s, r^2 n/s^2 and
    r^2 n^2/s^3 are pi sqrt(n) times 1/2, 1/4 and 1/16; and far away only terms of r^-6 are left.
    Source: ours.
    """
    share = nearest / squared
    return np.asarray(1.0 + share + 4.0 * share**2, np.float64)


def polygon_irradiance(corners: F64) -> float:
    """Irradiance, W m^-2, of a convex polygon with corners (n, 3), metres; of either winding.

    Lambert's sum over the edges, angle times cosine of the edge's plane (Heitz2016 section 2), of
    the part above the receiver's horizon: where an edge goes below, the sum is closed along it.
    """
    # Seen from the receiver only directions count.
    unit = corners / np.linalg.norm(corners, axis=1, keepdims=True)
    total, down, up = 0.0, np.zeros(3), np.zeros(3)
    for a, b in zip(np.roll(unit, 1, axis=0), unit, strict=True):
        # Where an edge crosses the horizon it ends, or begins, at the crossing.
        is_above, goes_on = a[2] > 0.0, b[2] > 0.0
        cut = a * b[2] - b * a[2]
        cut = cut * np.sign(b[2] - a[2]) / max(float(np.linalg.norm(cut)), 1e-30)
        if is_above and not goes_on:
            down = cut
        if goes_on and not is_above:
            up = cut
        if is_above or goes_on:
            total += edge_integral(a if is_above else cut, b if goes_on else cut)
    return 0.5 * abs(total + edge_integral(down, up))


def edge_integral(a: F64, b: F64) -> float:
    """The angle between unit vectors times the z of the unit normal of their plane."""
    # Unit vectors: their cross product is as long as the sine of the angle.
    normal = np.cross(a, b)
    sine = float(np.linalg.norm(normal))
    return float(normal[2] * np.arctan2(sine, a @ b) / max(sine, 1e-30))


def sphere_irradiance(centre: F64, radius: float) -> float:
    """Irradiance, W m^-2, of a sphere, metres, also where the horizon cuts it (Snyder1996).

    A receiver inside the sphere sees radiance in all of its hemisphere.
    """
    # A receiver inside the sphere is taken to stand on its surface.
    distance = max(float(np.linalg.norm(centre)), radius * 1.0001)
    cosine = float(np.clip(centre[2] / distance, -1.0, 1.0))
    sine2 = (radius / distance) ** 2
    # Wholly above the horizon, or wholly below: pi (r/d)^2 cos, or nothing.
    if cosine * cosine >= sine2:
        return np.pi * sine2 * max(cosine, 0.0)
    # Cut by the horizon: the closed form for the part above it (Snyder1996).
    x = np.sqrt(1.0 / sine2 - 1.0)
    sine = np.sqrt(1.0 - cosine * cosine)
    y = float(np.clip(-x * cosine / sine, -1.0, 1.0))
    root = sine * np.sqrt(1.0 - y * y)
    return float((cosine * np.arccos(y) - x * root) * sine2 + np.arctan(root / x))


def segment_irradiance(a: F64, b: F64, normal: F64, width: float) -> tuple[float, float]:
    """Integrals along the line a-b, metres, of the receiver's cosine over squares of distances.

    The first is weighted by the sine at the line, as a thin cylinder of radiance 1 / its diameter
    sends (Heitz2017), the second is that of points which send evenly. `normal` (3,), unit: of the
    receiver. Only what lies above its horizon counts; lines closer than `width` are as far as it.
    """
    a_up, b_up = float(a @ normal), float(b @ normal)
    if max(a_up, b_up) <= 0.0:
        return 0.0, 0.0
    along = (b - a) / float(np.linalg.norm(b - a))
    # What lies below the horizon ends at the crossing.
    cut = (a * b_up - b * a_up) / (b_up - a_up if min(a_up, b_up) < 0.0 else 1.0)
    low = float((cut if a_up < 0.0 else a) @ along)
    high = float((cut if b_up < 0.0 else b) @ along)
    nearest = a - (a @ along) * along
    h = max(float(np.linalg.norm(nearest)), width)
    # Angles from the nearest point: along the line l = h tan(angle).
    first, last = np.arctan2((low, high), h)
    # The cosine has a part across the line and one along it; each has its antiderivatives.
    across, ahead = float(nearest @ normal) / h, float(along @ normal)
    sines, cosines = np.sin((first, last)), np.cos((first, last))
    products = float(sines[1] * cosines[1] - sines[0] * cosines[0])
    squares = float(sines[1] ** 2 - sines[0] ** 2)
    cylinder = 0.5 * (across * (last - first + products) + ahead * squares)
    points = across * (sines[1] - sines[0]) - ahead * (cosines[1] - cosines[0])
    return max(float(cylinder) / h, 0.0), max(float(points) / h, 0.0)


def leaving_share(away: F64, normal: F64, body: float, gap_m: float) -> float:
    """The share of the light reflected at a point that misses the disk that it came from.

    `away` (3,), metres, from the disk to the point; `body`, m^2, the square of the disk's radius.
    The view factor of a disk from an equal one across a gap is 1 less this (Howell2010, C-40); from
    a point on the axis body / (body + distance^2). The larger share counts. Points farther than
    about `gap_m` from the disk's plane lose nothing: lattices know what surfaces take there.
    """
    # The two view factors, of a disk across a gap and of a point on the axis.
    squared, height = float(away @ away), float(away @ normal)
    gap = max(height * height, 1e-12) / max(body, 1e-12)
    across = 0.5 * gap * (np.sqrt(4.0 / gap + 1.0) - 1.0)
    share = max(float(across), squared / (squared + body))

    # From half the gap on the share rises smoothly to 1.
    t = float(np.clip((abs(height) - 0.5 * gap_m) / (gap_m + 1e-9), 0.0, 1.0))
    return share + (1.0 - share) * t * t * (3.0 - 2.0 * t)


def rim(centre: F64, normal: F64, radius: float) -> F64:
    """Corners (RIM_CORNERS, 3) of the polygon that stands for a disk: as large as the disk."""
    # A regular polygon with the disk's area, not its radius.
    side, up = orthonormal_frame(normal)
    angle = 2.0 * np.pi * np.arange(RIM_CORNERS)[:, None] / RIM_CORNERS
    around = np.cos(angle) * side + np.sin(angle) * up
    corners: F64 = centre + radius * RIM_SCALE * around
    return corners


def sphere_disk(centre: F64, radius: float) -> tuple[F64, float]:
    """The disk at a sphere's centre that fills the same cone: its unit normal and radius."""
    distance = max(float(np.linalg.norm(centre)), radius * 1.001)
    return -centre / distance, radius * distance / float(np.sqrt(distance**2 - radius**2))


@cache
def cosine_table() -> F32:
    """(rows of roughness, columns of sqrt(1 - n.v), 6), as `maths.cosines_fit` makes it."""
    table: F32 = np.load(Path(__file__).with_name("cosines.npy"))
    table.flags.writeable = False
    return table


def specular_cosine(view_cosine: float, alpha: float) -> tuple[F64, F64]:
    """The inverse matrix (3, 3) of GGX's transformed cosine in the frame of n and view; albedos.

    The frame's x lies in the plane of normal and view, on the viewer's side. The albedos (2,) are
    of the reflectance at normal incidence, and of that at grazing (Heitz2016; cosines_fit.py).
    """
    table = cosine_table().astype(np.float64)
    last = len(table) - 1
    # Rows and columns are denser where the lobe changes fast: smooth, and near normal incidence.
    row = np.sqrt(np.clip(alpha, 0.0, 1.0)) * last
    column = np.sqrt(1.0 - np.clip(view_cosine, 0.0, 1.0)) * last
    r, c = min(int(row), last - 1), min(int(column), last - 1)
    v, u = row - r, column - c
    # Bilinear; the matrices are stored over their middle element, so that they may be blended.
    near = table[r, c] * (1.0 - u) + table[r, c + 1] * u
    far = table[r + 1, c] * (1.0 - u) + table[r + 1, c + 1] * u
    m11, m13, m31, m33, *albedos = near * (1.0 - v) + far * v
    return np.array([[m11, 0.0, m13], [0.0, 1.0, 0.0], [m31, 0.0, m33]]), np.array(albedos)


def specular_share(corners: F64, view: F64, alpha: float) -> float:
    """Share (0 to 1) of GGX's lobe that a convex polygon fills; `view`, unit, towards the eye."""
    inverse, _ = specular_cosine(float(view[2]), alpha)
    # The frame of normal and view; along the normal any x will do.
    flat = np.array((view[0], view[1], 0.0))
    length = float(np.linalg.norm(flat))
    x = flat / length if length > 1e-6 else np.array((1.0, 0.0, 0.0))
    y = np.cross(np.array((0.0, 0.0, 1.0)), x)
    # The inverse turns the lobe into a cosine: Lambert's sum is its share (Heitz2016).
    own = corners @ np.stack([x, y, np.array((0.0, 0.0, 1.0))], axis=1)
    return polygon_irradiance(own @ inverse.T) / np.pi
