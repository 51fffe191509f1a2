"""Importance of directions for a camera (Elek2014 section 5.2): adjoint light from the eye.

Importance enters the medium along the eye's rays, scatters as light does and leaves towards the
sky; where it leaves says which parts of the sky matter to the image. It propagates in a grid that
is warped into the view, as light does in `ordinate_hops`. It depends smoothly on the camera and the
medium, and on no earlier frame.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from .arrays import F64
from .delta_beam import MediumGrid
from .latlong import latlong_row_solid_angles
from .ordinate_hops import Hops, first_light, parallel_hops, propagate
from .phase import ISOTROPIC, henyey_greenstein
from .voxels import density_behind, trilinear

SIDE = 16  # cells of the view's grid along each axis (Elek2014)
ROWS = 16  # of the map, 32 columns (Elek2014)
HOPS = 16
_MERGED = 2  # cells along each axis that leave as one
_NEAREST = 1e-3  # of the farthest depth: where the view's grid begins around an eye in the medium
_LEAVING = 4  # points along each axis of the medium's box from which the path out is marched
_SHARPEST = 0.98


@dataclass(frozen=True, eq=False)
class Frustum:
    """A camera in the medium's frame: `eye` (3,) m, unit `right`, `up`, `forward` (3,).

    `tangents` of half the field of view: across, up.
    """

    eye: F64
    right: F64
    up: F64
    forward: F64
    tangents: tuple[float, float]


@dataclass(frozen=True, eq=False)
class ViewGrid:
    """The part of a view that the medium's box fills: SIDE columns and rows, SIDE layers.

    `centres` (z, y, x, 3) m, `ray` (y, x, 3) unit; `hops`: its geometry.
    """

    centres: F64
    ray: F64
    hops: Hops


def view_grid(view: Frustum, extent: F64) -> ViewGrid | None:
    """None where the box is not in the image."""
    window = _window(view, extent)
    if window is None:
        return None
    (near, far), low, high = window
    # Cells in perspective: equal steps on the image, equal slices in depth.
    x, y = low[:, None] + (np.arange(SIDE) + 0.5) / SIDE * (high - low)[:, None]
    slant = view.forward + x[None, :, None] * view.right + y[:, None, None] * view.up
    thick = (far - near) / SIDE
    z = (near + (np.arange(SIDE) + 0.5) * thick)[:, None, None, None]
    length = np.linalg.norm(slant, axis=-1, keepdims=True)
    # Their sections grow with z^2; neighbours are those of a grid of cubes.
    section = np.broadcast_to(z**2 * float(np.prod((high - low) / SIDE)), (SIDE, SIDE, SIDE, 1))
    plain = parallel_hops((SIDE,) * 3, 1.0)
    path = np.full((SIDE, 1, 1, 1), thick * float(length.mean()))
    hops = Hops(path, section * path, section, plain.beside, plain.side_gain, plain.curvature)
    return ViewGrid(view.eye + z * slant, slant / length, hops)


def _window(view: Frustum, extent: F64) -> tuple[tuple[float, float], F64, F64] | None:
    """((near, far) m, lower and upper tangents (2,)) of a box in a view."""
    # The box's corners as the eye sees them.
    corners = np.stack(np.meshgrid(*[[0.0, 1.0]] * 3), axis=-1).reshape(8, 3) * extent
    away = corners - view.eye
    depth = away @ view.forward
    far = float(depth.max())
    half = np.array(view.tangents)
    low, high = -half, half
    # A box that is wholly before the eye covers a part of the image; else all of it.
    if depth.min() > 0.0:
        place = (away @ np.stack([view.right, view.up]).T) / depth[:, None]
        low = np.clip(place.min(axis=0), -half, half)
        high = np.clip(place.max(axis=0), -half, half)
    if far <= 0.0 or np.any(high - low <= 1e-6 * half):
        return None
    return (max(float(depth.min()), _NEAREST * far), far), low, high


@dataclass(frozen=True, eq=False)
class Lobes:
    """Importance that scatters at `point` (n, 3) m: `power` (n,), about `travel` (n, 3), unit.

    `a` (n,): mean cosine. `isotropic`: power that has no direction any more.
    """

    point: F64
    travel: F64
    power: F64
    a: F64
    isotropic: float


def scattered_importance(grid: ViewGrid, medium: MediumGrid) -> Lobes:
    """Of an image whose pixels all matter alike. `medium` has one channel."""
    # The medium's density at the cells of the view's grid.
    inside = np.all((grid.centres >= 0.0) & (grid.centres <= medium.extent), axis=-1)
    density = np.where(inside, trilinear(medium.density, grid.centres / medium.cell), 0.0)
    here = MediumGrid(medium.extent, density, density, medium.sigma_t, medium.albedo, medium.g)
    hops = grid.hops
    # Importance leaves the eye as light would, and is scattered at each hop.
    light = first_light(hops, here, density, 1.0 / hops.section, is_paper=False)
    sigma_s = density[..., None] * medium.sigma_t * medium.albedo
    power, along = light.copy(), light * medium.g

    def watch(fluence: F64, a: F64) -> None:
        again = sigma_s * fluence * hops.volume
        power[...] += again
        along[...] += again * a * medium.g

    done = propagate(hops, here, density, light, 1.0, [], iterations=HOPS, watch=watch)
    return _merged(grid, power[..., 0], along[..., 0], float(done.residual.sum()))


def _merged(grid: ViewGrid, power: F64, along: F64, isotropic: float) -> Lobes:
    n, k = SIDE // _MERGED, _MERGED

    def joined(values: F64) -> F64:
        blocks = values.reshape(n, k, n, k, n, k, -1).sum(axis=(1, 3, 5))
        return np.asarray(blocks.reshape(n**3, -1))

    # Blocks of cells become a lobe each: place, direction and sharpness weighted by power.
    total = joined(power)
    kept = total[:, 0] > 1e-6 * total.max(initial=1e-30)
    total = total[kept]
    travel = joined(power[..., None] * grid.ray)[kept]
    travel = travel / np.linalg.norm(travel, axis=1, keepdims=True)
    a = np.clip(joined(along)[kept] / total, -_SHARPEST, _SHARPEST)
    point = joined(power[..., None] * grid.centres)[kept] / total
    return Lobes(point, travel, total[:, 0], a[:, 0], isotropic)


@dataclass(frozen=True, eq=False)
class ExitDensity:
    """Density passed (point, direction), m, on leaving the medium along `directions` (n, 3).

    It is the same for every view.
    """

    directions: F64
    passed: F64


def exit_density(medium: MediumGrid, directions: F64) -> ExitDensity:
    """From a few points of the medium's box, in steps of a sixth of its shortest side."""
    # The middles of a coarse grid over the box, each with all directions.
    unit = (np.arange(_LEAVING) + 0.5) / _LEAVING
    z, y, x = np.meshgrid(unit, unit, unit, indexing="ij")
    points = (np.stack([x, y, z], axis=-1) * medium.extent)[..., None, :]
    points = np.broadcast_to(points, (*x.shape, len(directions), 3))
    step = float(medium.extent.min()) / 6.0
    passed = density_behind(medium.fine, medium.extent, points, -directions, step)
    return ExitDensity(directions, passed.reshape(-1, len(directions)))


def _nearness(place: F64) -> F64:
    """(n, point): shares of the points of `exit_density` at places (n, 3) in 0..1, trilinear."""
    # The nearest points along each axis, and their products.
    at = np.clip(place * _LEAVING - 0.5, 0.0, _LEAVING - 1.0)
    x, y, z = np.maximum(0.0, 1.0 - np.abs(at.T[..., None] - np.arange(_LEAVING)))
    shares = np.einsum("nz,ny,nx->nzyx", z, y, x)
    return np.asarray(shares.reshape(len(place), _LEAVING**3))


def importance_map(
    lobes: Lobes, out: ExitDensity, medium: MediumGrid, shape: tuple[int, int]
) -> F64:
    """(h, w), mean 1 over the sphere: what leaves along `out.directions`, a map's row by row."""
    h, w = shape
    # Density on each lobe's path out, between the few points from which it was marched.
    passed = _nearness(lobes.point / medium.extent) @ out.passed
    mu = lobes.travel @ out.directions.T
    phase = henyey_greenstein(mu, lobes.a[:, None])
    left = np.exp(-float(medium.sigma_t[0]) * passed)
    omega = np.repeat(latlong_row_solid_angles(h, w), w)
    # Lobes have what leaves at once; only what scatters again leaves evenly.
    at_once = float(lobes.power @ left @ omega) * ISOTROPIC
    again = lobes.isotropic * (1.0 - at_once / max(float(lobes.power.sum()), 1e-300))
    seen = lobes.power @ (phase * left) + again * ISOTROPIC
    total = float(seen @ omega)
    return np.asarray(
        (seen * (4.0 * np.pi / total) if total > 0.0 else np.ones(h * w)).reshape(h, w)
    )
