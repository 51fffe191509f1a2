"""Linearly transformed cosines for GGX (Heitz2016), fitted: `python -m airlight.maths.cosines_fit`.

A clamped cosine, its directions transformed by a matrix M, takes the shape of the specular lobe of
a roughness and an angle of view; the integral of the lobe over a polygon is then that of a cosine
over the polygon transformed by the inverse of M. The script writes `cosines.npy`, which
`maths.area_light` reads. The lobe is that of wgsl/surface_reflection.wgsl without Fresnel's term;
its two albedos (reflectance at normal incidence, and at grazing) are integrated beside it.

Source: Heitz2016 section 3. differs: nodes and weights of a fixed quadrature in place of random
samples, so that the table is the same whenever it is made.
"""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np

from .arrays import F64

TABLE = Path(__file__).with_name("cosines.npy")
SIDE = 32
"""Rows of roughness (0 to 1) and columns of sqrt(1 - n.v), the borders included."""
_LEAST_ALPHA = 0.002  # as wgsl/surface_reflection.wgsl has it
_NODES = 32


def view_cosine(column: int) -> float:
    """n.v of a column of the table; not quite grazing, where the lobe has no albedo."""
    return max(1.0 - (column / (SIDE - 1)) ** 2, 0.01)


def row_alpha(row: int) -> float:
    """GGX's alpha of a row of the table."""
    return max((row / (SIDE - 1)) ** 2, _LEAST_ALPHA)


def ggx_lobe(view: F64, light: F64, alpha: float) -> tuple[F64, F64, F64]:
    """f cos, its density under `half_vectors`, and v.h, of directions `light` (n, 3)."""
    # The half vector, and its cosines to the normal and to the view.
    half = view + light
    half /= np.linalg.norm(half, axis=1, keepdims=True)
    n_h, v_h = np.clip(half[:, 2], 0.0, 1.0), np.clip(half @ view, 1e-9, 1.0)
    a2 = alpha * alpha
    # The GGX distribution (Walter2007 eq. 33).
    d = a2 / (np.pi * (n_h * n_h * (a2 - 1.0) + 1.0) ** 2)
    n_l, n_v = np.maximum(light[:, 2], 0.0), view[2]
    # Height-correlated Smith masking (Heitz2014): G / (4 n.l n.v) is one half over this sum.
    shadow = n_v * np.sqrt(n_l**2 * (1.0 - a2) + a2) + n_l * np.sqrt(n_v**2 * (1.0 - a2) + a2)
    value = np.where(light[:, 2] > 0.0, d * 0.5 / np.maximum(shadow, 1e-12) * n_l, 0.0)
    return value, d * n_h / (4.0 * v_h), v_h


def half_vectors(view: F64, alpha: float, u: F64) -> F64:
    """Directions (n, 3) mirrored at half vectors of GGX's distribution; `u` (n, 2) in 0..1."""
    # The inverse of the distribution's cumulative, then the view mirrored at each half vector.
    cosine = np.sqrt((1.0 - u[:, 0]) / (1.0 + (alpha**2 - 1.0) * u[:, 0]))
    sine, phi = np.sqrt(np.maximum(1.0 - cosine**2, 0.0)), 2.0 * np.pi * u[:, 1]
    half = np.stack([sine * np.cos(phi), sine * np.sin(phi), cosine], axis=1)
    return np.asarray(2.0 * (half @ view)[:, None] * half - view)


def cosine_directions(u: F64) -> F64:
    """Directions (n, 3) of a clamped cosine about +z."""
    # Malley's method: a disk's points lifted to the hemisphere.
    r, phi = np.sqrt(u[:, 0]), 2.0 * np.pi * u[:, 1]
    return np.stack([r * np.cos(phi), r * np.sin(phi), np.sqrt(1.0 - u[:, 0])], axis=1)


def transformed_density(inverse: F64, determinant: float, light: F64) -> F64:
    """Density (n,) of the transformed cosine; `determinant` of `inverse` (Heitz2016 eq. 1)."""
    # Back through M: the cosine there, times how M changes solid angles.
    back = light @ inverse.T
    length = np.linalg.norm(back, axis=1)
    return np.asarray(np.maximum(back[:, 2], 0.0) / np.pi * determinant / length**4)


def _grid() -> F64:
    steps = (np.arange(_NODES) + 0.5) / _NODES
    u, v = np.meshgrid(steps, steps, indexing="ij")
    # Rows are turned against each other, so that no plane of symmetry is left out.
    return np.stack([u.ravel(), ((v + u * 0.6180339887) % 1.0).ravel()], axis=1)


def _matrix(parameters: F64, frame: F64) -> F64:
    m11, m22, m13 = parameters
    shape = np.array([[m11, 0.0, m13], [0.0, m22, 0.0], [0.0, 0.0, 1.0]])
    return np.asarray(frame @ shape)


def _unit(vectors: F64) -> F64:
    return np.asarray(vectors / np.linalg.norm(vectors, axis=1, keepdims=True), np.float64)


def _simplex(error: Callable[[F64], float], start: F64, step: float) -> F64:
    """The minimum of a function of few variables (Nelder1965)."""
    # A point and one step along each axis from it.
    points = [start] + [start + step * row for row in np.eye(len(start))]
    values = [error(p) for p in points]
    for _ in range(120):
        order = np.argsort(values)
        points, values = [points[i] for i in order], [values[i] for i in order]
        if abs(values[-1] - values[0]) <= 1e-6 * abs(values[0]) + 1e-14:
            break
        # The worst point, reflected at the middle of the others; farther still where that is best.
        centre = np.mean(points[:-1], axis=0)
        tried = centre + (centre - points[-1])
        value = error(tried)
        if value < values[0]:
            far = centre + 2.0 * (centre - points[-1])
            far_value = error(far)
            if far_value < value:
                tried, value = far, far_value
        elif value >= values[-2]:
            # Where it is no better: half way, and all towards the best one where that fails.
            side = tried if value < values[-1] else points[-1]
            tried = centre + 0.5 * (side - centre)
            value = error(tried)
            if value >= values[-1]:
                points = [points[0] + 0.5 * (p - points[0]) for p in points]
                values = [error(p) for p in points]
                continue
        points[-1], values[-1] = tried, value
    return points[int(np.argmin(values))]


def fitted(cosine: float, alpha: float, start: F64 | None) -> tuple[F64, F64, F64]:
    """M (3, 3), its parameters, and the two albedos of the lobe at one angle and alpha."""
    # Directions mirrored at the lobe's own half vectors, with their values and densities.
    view = np.array([np.sqrt(1.0 - cosine**2), 0.0, cosine])
    u = _grid()
    light = half_vectors(view, alpha, u)
    value, density, v_h = ggx_lobe(view, light, alpha)
    # The samples' mean is the lobe's albedo; weighted by Schlick's factor, the part at grazing.
    weight = value / np.maximum(density, 1e-30) / len(u)
    albedo = weight.sum()
    grazing = (weight * (1.0 - v_h) ** 5).sum()
    # The frame: +z along the lobe's mean direction, in the plane of view.
    mean = (weight[:, None] * light).sum(axis=0) * np.array((1.0, 0.0, 1.0))
    mean = mean / np.linalg.norm(mean) if cosine < 0.9999 else np.array((0.0, 0.0, 1.0))
    frame = np.stack([[mean[2], 0.0, -mean[0]], [0.0, 1.0, 0.0], mean], axis=1)
    base = cosine_directions(u)

    def error(parameters: F64) -> float:
        if min(parameters[:2]) < 1e-5:
            return float("inf")
        matrix = _matrix(parameters, frame)
        inverse: F64 = np.asarray(np.linalg.inv(matrix), np.float64)
        determinant = abs(float(np.linalg.det(inverse)))
        # The cube of the difference over the sampling density of both lobes, by rays of either:
        # the measure of Heitz2016's own fit.
        total = 0.0
        for rays in (light, _unit(base @ matrix.T)):
            f, p, _ = ggx_lobe(view, rays, alpha)
            q = transformed_density(inverse, determinant, rays)
            weights = np.abs(f - albedo * q) ** 3 / np.maximum(p + q, 1e-30)
            total += float(weights[rays[:, 2] > -1.0].mean())
        return total

    # The first fit starts from a lobe as wide as the roughness.
    first = np.array((alpha, alpha, 0.0)) if start is None else start
    parameters = _simplex(error, first, 0.1 * max(alpha, 0.02))
    return _matrix(parameters, frame), parameters, np.array((albedo - grazing, grazing))


def made() -> F64:
    """The table (SIDE, SIDE, 6): m11, m13, m31, m33 of the inverse over its m22; the albedos."""
    table = np.zeros((SIDE, SIDE, 6))
    along: list[F64 | None] = [None] * SIDE
    for row in reversed(range(SIDE)):
        # From rough to smooth, each fit starts from its neighbour's: neighbours interpolate well.
        start = along[0]
        for column in range(SIDE):
            known = along[column] if column == 0 else start
            matrix, start, albedos = fitted(view_cosine(column), row_alpha(row), known)
            along[column] = start
            inverse = np.linalg.inv(matrix)
            inverse = inverse / inverse[1, 1]
            table[row, column, :4] = inverse[[0, 0, 2, 2], [0, 2, 0, 2]]
            table[row, column, 4:] = albedos
    return table


if __name__ == "__main__":
    np.save(TABLE, made().astype(np.float32))
