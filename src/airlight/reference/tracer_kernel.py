"""Photons through a box of scattering air: the compiled inner loop of `tracer`.

Importing this module needs Numba; `tracer` imports it when a trace is asked for.
A photon carries power (W). It flies by delta tracking (Woodcock1965): exponential steps at the
majorant extinction, each end a real collision with probability sigma_t density / majorant.
Absorption lowers the weight; below a thousandth of it, Russian roulette ends the walk unbiased.

Vectors are tuples (x, y, z); tally arrays are indexed [z, y, x]. Order 0 is unscattered light,
1 scattered once, 2 scattered twice or more. All in float64.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any, TypeVar, cast

import numba
import numpy as np

from ..scene.checks import F64
from .tracer_setup import (
    BEAM,
    ELLIPSOID,
    HOMOGENEOUS,
    POINT,
    VOXELS,
    Domain,
    Emitter,
    Slice,
    Tally,
    Vector,
)

F = TypeVar("F", bound=Callable[..., Any])


def compiled(function: F) -> F:
    """Compile for the CPU, without the interpreter lock, kept on disk for the next run."""
    return cast(F, numba.njit(cache=True, nogil=True)(function))


@compiled
def run_batch(
    domain: Domain,
    emitter: Emitter,
    plane: Slice,
    views: F64,
    photons: int,
    power: float,
    seed: int,
    tally: Tally,
) -> None:
    """Trace `photons` of `power` W together into `tally`; the same seed gives the same bits."""
    np.random.seed(seed)  # noqa: NPY002  Numba's own generator, one per thread
    weight = power / photons
    for _ in range(photons):
        p, d, hit = _start(domain, emitter)
        if hit:
            tally.totals[0] += weight
            _walk(domain, plane, views, p, d, weight, tally)


@compiled
def _walk(
    domain: Domain, plane: Slice, views: F64, p: Vector, d: Vector, weight: float, tally: Tally
) -> None:
    order = 0
    survivor = 1e-3 * weight
    while True:
        wall, face = _exit(domain, p, d)
        # A tentative free flight by the largest extinction (delta tracking).
        step = math.inf
        if domain.majorant > 0.0:
            step = -math.log(1.0 - np.random.random()) / domain.majorant  # noqa: NPY002
        _deposit(domain, plane, p, d, min(step, wall), weight, order, tally)
        # Light that reaches the wall first leaves the box.
        if step >= wall:
            tally.exits[order, face] += weight
            return
        p = _advance(p, d, step)
        # A null collision where the extinction here is less than the largest: nothing happened.
        if np.random.random() * domain.majorant >= _extinction(domain, p):  # noqa: NPY002
            continue
        # Absorption takes its share of the weight; Russian roulette ends what became too weak.
        tally.totals[1] += weight * (1.0 - domain.albedo)
        weight *= domain.albedo
        if weight < survivor:
            if np.random.random() < 0.5 or weight == 0.0:  # noqa: NPY002
                return
            weight *= 2.0
        # The light that goes on: towards distant eyes, and in a new direction.
        _look(domain, views, p, d, weight, min(order, 1), tally.brightness)
        d = _scatter(d, domain.g)
        order = min(order + 1, 2)


@compiled
def _look(
    domain: Domain, views: F64, p: Vector, d: Vector, weight: float, order: int, brightness: F64
) -> None:
    """Next event: what this scattering sends towards each view direction and out of the box."""
    for k in range(views.shape[0]):
        v = (views[k, 0], views[k, 1], views[k, 2])
        cosine = d[0] * v[0] + d[1] * v[1] + d[2] * v[2]
        brightness[order, k] += weight * _phase(cosine, domain.g) * _transmittance(domain, p, v)


@compiled
def _transmittance(domain: Domain, p: Vector, d: Vector) -> float:
    """To the wall along d: exact in homogeneous air, else ratio tracking (Novak2014)."""
    wall, _ = _exit(domain, p, d)
    if domain.kind == HOMOGENEOUS:
        return math.exp(-domain.sigma_t * wall)
    t, through = 0.0, 1.0
    while through > 0.0:
        t -= math.log(1.0 - np.random.random()) / domain.majorant  # noqa: NPY002
        if t >= wall:
            break
        through *= 1.0 - _extinction(domain, _advance(p, d, t)) / domain.majorant
    return through


@compiled
def _advance(p: Vector, d: Vector, t: float) -> Vector:
    return (p[0] + d[0] * t, p[1] + d[1] * t, p[2] + d[2] * t)


@compiled
def _extinction(domain: Domain, p: Vector) -> float:
    """sigma_t * density at p, m^-1: voxel-centred, trilinear, clamped at the border."""
    if domain.kind == HOMOGENEOUS:
        return domain.sigma_t
    low, high = domain.low, domain.high
    x = (p[0] - low[0]) / (high[0] - low[0])
    y = (p[1] - low[1]) / (high[1] - low[1])
    z = (p[2] - low[2]) / (high[2] - low[2])
    if domain.kind == ELLIPSOID:
        inside = (x - 0.5) ** 2 + (y - 0.5) ** 2 + (z - 0.5) ** 2 <= 0.25
        return domain.sigma_t if inside else 0.0
    # Trilinear between the eight voxels around the point.
    grid = domain.density
    k, k1, w = _bracket(z, grid.shape[0])
    j, j1, v = _bracket(y, grid.shape[1])
    i, i1, u = _bracket(x, grid.shape[2])
    near = (grid[k, j, i] * (1 - u) + grid[k, j, i1] * u) * (1 - v)
    near += (grid[k, j1, i] * (1 - u) + grid[k, j1, i1] * u) * v
    far = (grid[k1, j, i] * (1 - u) + grid[k1, j, i1] * u) * (1 - v)
    far += (grid[k1, j1, i] * (1 - u) + grid[k1, j1, i1] * u) * v
    return float(domain.sigma_t * (near * (1 - w) + far * w))


@compiled
def _bracket(unit: float, count: int) -> tuple[int, int, float]:
    """The two voxels around a coordinate in [0, 1], and how far it is to the second."""
    at = min(max(unit * count - 0.5, 0.0), count - 1.0)
    index = int(at)
    return index, min(index + 1, count - 1), at - index


@compiled
def _exit(domain: Domain, p: Vector, d: Vector) -> tuple[float, int]:
    """Distance to the wall along d, and which face: 2 axis + (1 if the upper one)."""
    best, face = math.inf, 0
    for axis in range(3):
        if d[axis] > 0.0:
            t, candidate = (domain.high[axis] - p[axis]) / d[axis], 2 * axis + 1
        elif d[axis] < 0.0:
            t, candidate = (domain.low[axis] - p[axis]) / d[axis], 2 * axis
        else:
            continue
        if t < best:
            best, face = t, candidate
    return max(best, 0.0), face


@compiled
def _deposit(
    domain: Domain,
    plane: Slice,
    p: Vector,
    d: Vector,
    length: float,
    weight: float,
    order: int,
    tally: Tally,
) -> None:
    """Share a flight of `length` m among the cells it crosses (Amanatides1987)."""
    # The first cell, and where the flight leaves it on each axis.
    counts = (tally.track.shape[3], tally.track.shape[2], tally.track.shape[1])
    i, next_x, per_x, step_x = _first_cell(domain, p, d, 0, counts[0])
    j, next_y, per_y, step_y = _first_cell(domain, p, d, 1, counts[1])
    k, next_z, per_z, step_z = _first_cell(domain, p, d, 2, counts[2])
    mu, phi = _direction_bin(plane, d, tally.slice_track)
    t = 0.0
    while 0 <= i < counts[0] and 0 <= j < counts[1] and 0 <= k < counts[2]:
        # Flux and its vector in this cell, and in the slice's bins of directions.
        end = min(next_x, next_y, next_z, length)
        amount = weight * max(end - t, 0.0)
        cell = tally.track[order, k, j, i]
        cell[0] += amount
        cell[1] += amount * d[0]
        cell[2] += amount * d[1]
        cell[3] += amount * d[2]
        if mu >= 0:
            _record(plane, i, j, k, mu, phi, min(order, 1), amount, tally.slice_track)
        if end >= length:
            return
        # On into the neighbour whose face is met first.
        t = end
        if end == next_x:
            i, next_x = i + step_x, next_x + per_x
        elif end == next_y:
            j, next_y = j + step_y, next_y + per_y
        else:
            k, next_z = k + step_z, next_z + per_z


@compiled
def _first_cell(
    domain: Domain, p: Vector, d: Vector, axis: int, count: int
) -> tuple[int, float, float, int]:
    """Cell index, distance to its far side along d, distance per cell, and step, on one axis."""
    size = (domain.high[axis] - domain.low[axis]) / count
    at = (p[axis] - domain.low[axis]) / size
    index = min(max(int(at), 0), count - 1)
    if d[axis] > 0.0:
        return index, (index + 1 - at) * size / d[axis], size / d[axis], 1
    if d[axis] < 0.0:
        return index, (index - at) * size / d[axis], -size / d[axis], -1
    return index, math.inf, math.inf, 0


@compiled
def _direction_bin(plane: Slice, d: Vector, slice_track: F64) -> tuple[int, int]:
    """Equal solid angles: cosine to the slice's axis, azimuth in its plane; -1 for no slice."""
    if plane.axis < 0:
        return -1, -1
    a, b = (d[1], d[2]) if plane.axis == 0 else (d[0], d[2] if plane.axis == 1 else d[1])
    mu_count, phi_count = slice_track.shape[3], slice_track.shape[4]
    mu = min(int((d[plane.axis] + 1.0) * 0.5 * mu_count), mu_count - 1)
    phi = int((math.atan2(b, a) / (2.0 * math.pi) + 1.0) * phi_count + 0.5) % phi_count
    return max(mu, 0), phi


@compiled
def _record(
    plane: Slice,
    i: int,
    j: int,
    k: int,
    mu: int,
    phi: int,
    part: int,
    amount: float,
    slice_track: F64,
) -> None:
    if plane.axis == 0 and i == plane.layer:
        slice_track[part, k, j, mu, phi] += amount
    elif plane.axis == 1 and j == plane.layer:
        slice_track[part, k, i, mu, phi] += amount
    elif plane.axis == 2 and k == plane.layer:
        slice_track[part, j, i, mu, phi] += amount


@compiled
def _phase(cosine: float, g: float) -> float:
    """Henyey-Greenstein, sr^-1; g > 0 scatters forward."""
    spread = 1.0 + g * g - 2.0 * g * cosine
    return (1.0 - g * g) / (4.0 * math.pi * spread * math.sqrt(spread))


@compiled
def _scatter(d: Vector, g: float) -> Vector:
    """A new direction about d, drawn from the Henyey-Greenstein function."""
    u = np.random.random()  # noqa: NPY002
    if abs(g) < 1e-4:
        cosine = 1.0 - 2.0 * u
    else:
        s = (1.0 - g * g) / (1.0 - g + 2.0 * g * u)
        cosine = (1.0 + g * g - s * s) / (2.0 * g)
    return _turned(d, min(max(cosine, -1.0), 1.0))


@compiled
def _turned(axis: Vector, cosine: float) -> Vector:
    """A unit vector at `cosine` to the axis, azimuth uniform (frame: Duff2017)."""
    # A frame about the axis, then the direction in it, normalised against rounding.
    azimuth = 2.0 * math.pi * np.random.random()  # noqa: NPY002
    sine = math.sqrt(max(0.0, 1.0 - cosine * cosine))
    x, y, z = axis
    sign = math.copysign(1.0, z)
    a = -1.0 / (sign + z)
    b = x * y * a
    c, s = sine * math.cos(azimuth), sine * math.sin(azimuth)
    nx = c * (1.0 + sign * x * x * a) + s * b + cosine * x
    ny = c * sign * b + s * (sign + y * y * a) + cosine * y
    nz = -c * sign * x - s * y + cosine * z
    scale = 1.0 / math.sqrt(nx * nx + ny * ny + nz * nz)
    return (nx * scale, ny * scale, nz * scale)


@compiled
def _start(domain: Domain, emitter: Emitter) -> tuple[Vector, Vector, bool]:
    """A photon on the box's surface, in it or at the light: position, direction, if it enters."""
    # A point light's photons start where their ray enters the box.
    if emitter.kind == POINT:
        span = 1.0 - emitter.cone_cosine
        d = _turned(emitter.direction, 1.0 - span * np.random.random())  # noqa: NPY002
        entry, hit = _entry(domain, emitter.position, d)
        return _advance(emitter.position, d, entry), d, hit
    # Of the others a rectangle is drawn by its power, and a point on it evenly.
    face = np.searchsorted(emitter.cumulative, np.random.random(), side="right")  # noqa: NPY002
    face = min(face, emitter.cumulative.shape[0] - 1)
    low, high = emitter.rect_low[face], emitter.rect_high[face]
    p = (
        low[0] + (high[0] - low[0]) * np.random.random(),  # noqa: NPY002
        low[1] + (high[1] - low[1]) * np.random.random(),  # noqa: NPY002
        low[2] + (high[2] - low[2]) * np.random.random(),  # noqa: NPY002
    )
    if emitter.kind == BEAM:
        return p, emitter.direction, True
    if emitter.kind == VOXELS:
        upwards = (0.0, 0.0, 1.0)
        return p, _turned(upwards, 1.0 - 2.0 * np.random.random()), True  # noqa: NPY002
    n = emitter.inward[face]
    return p, _turned((n[0], n[1], n[2]), math.sqrt(1.0 - np.random.random())), True  # noqa: NPY002


@compiled
def _entry(domain: Domain, p: Vector, d: Vector) -> tuple[float, bool]:
    """Distance at which a ray enters the box (0 if it starts inside), and whether it does."""
    near, far = 0.0, math.inf
    for axis in range(3):
        if d[axis] == 0.0:
            if p[axis] < domain.low[axis] or p[axis] > domain.high[axis]:
                return 0.0, False
            continue
        t0 = (domain.low[axis] - p[axis]) / d[axis]
        t1 = (domain.high[axis] - p[axis]) / d[axis]
        near, far = max(near, min(t0, t1)), min(far, max(t0, t1))
    return near, near < far
