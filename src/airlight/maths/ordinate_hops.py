"""Light hopping between the six neighbours of a grid along its ordinate (Elek2014 section 4).

Every cell holds power and the mean cosine a of its Henyey-Greenstein lobe about the ordinate. A
hop moves the lobe's part inside polar caps of 45 degrees ahead and behind, a quarter of the rest to
each side. Two schemes:

split  first-scattered light only is put in; a hop over dz lowers a by exp(-sigma_s (1 - g) dz), a
       share of that by handing light to an isotropic residuum, which diffuses (`diffusion`).
paper  as printed. Every cell starts with all light that reaches it, so that light counts once for
       every cell upstream: measured 3 to 17 times too bright.

Arrays are (z, y, x, channel): z along the light. Radial grids: `radial_grid`.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .arrays import F64, I64
from .delta_beam import MediumGrid, diffusion_of, resolved_by
from .diffusion import solve
from .phase import cap_fractions, henyey_greenstein

Watch = Callable[[F64, F64], None]

SHARE, SHARE_RADIAL, SHARE_RADIAL_PEAKED = 0.6, 0.5, 0.25  # of lost anisotropy: to the residuum
HAND_OVER = (0.65, 0.45)  # a between which a cell of light along z joins the residuum
CARRIED = 0.15  # of its mean cosine that light takes into the residuum; fitted, with SHARE
RESIDUAL_LOBE = 0.5  # share of the flux that the residuum's emission shows
ISOTROPIC_PATH = 0.674  # of a hop along the axes: the straight path of isotropic light
_PEAKED = 0.8  # g
_LARGEST_A = 0.999


@dataclass(frozen=True, eq=False)
class Hops:
    """A grid's geometry as hops see it.

    `path` (z, 1, 1, 1), m: of a hop in each layer; `volume` (z, y, x, 1), m^3; `section`
    (z, y, x, 1), m^2: across the light. `beside` (4, y, x): the flat (y, x) index of each
    neighbour, -1 outside. `side_gain` (4, y, x): share of the sideways light that each neighbour
    takes, the rest stays. `curvature` (z, 1, 1, 1): path/radius, 0 where light is parallel.
    `inside` (z, y, x, 1), of shells: where light is not lost. A box is convex, and what has left it
    does not come back, as hops around a point light outside of it would.
    """

    path: F64
    volume: F64
    section: F64
    beside: I64
    side_gain: F64
    curvature: F64
    inside: NDArray[np.bool_] | None = None

    @property
    def is_radial(self) -> bool:
        """Whether the layers are shells around a point light."""
        return bool(self.curvature.any())


def parallel_hops(count: tuple[int, int, int], cell_m: float) -> Hops:
    """Of a grid of cubes, `count` = (x, y, z)."""
    nx, ny, nz = count
    index = np.pad(np.arange(nx * ny).reshape(ny, nx), 1, constant_values=-1)
    beside = np.stack([index[1:-1, :-2], index[1:-1, 2:], index[:-2, 1:-1], index[2:, 1:-1]])
    shape = (nz, ny, nx, 1)
    return Hops(
        np.full((nz, 1, 1, 1), cell_m),
        np.full(shape, cell_m**3),
        np.full(shape, cell_m**2),
        beside,
        np.ones(beside.shape),
        np.zeros((nz, 1, 1, 1)),
    )


@dataclass(frozen=True, eq=False)
class Propagated:
    """What one grid's light did.

    `seen` (view, z, y, x, channel): W m^-2 sr^-1, in-scattered radiance per unit sigma_s towards
    each view, of all light but the residuum (split: nor the beam). `residual`, `carried`: W, handed
    to the residuum, and what of it still goes along the light. `fluence` W m^-2. `exits`
    (3, channel): W out at the entry, the far side, the sides. `iterations` that were made.
    """

    seen: F64
    residual: F64
    carried: F64
    fluence: F64
    exits: F64
    iterations: int


def first_light(
    hops: Hops, medium: MediumGrid, density: F64, irradiance: F64, *, is_paper: bool
) -> F64:
    """Power W per cell before the first hop.

    `irradiance` (z, y, x, channel) W m^-2 before the medium takes any.
    """
    depth = density[..., None] * medium.sigma_t * hops.path
    after = np.cumsum(depth, axis=0)
    if is_paper:
        return np.asarray(irradiance * hops.section * np.exp(-(after - 0.5 * depth)))
    lost = np.exp(-(after - depth)) - np.exp(-after)
    return np.asarray(irradiance * hops.section * medium.albedo * lost)


def propagate(
    hops: Hops,
    medium: MediumGrid,
    density: F64,
    power: F64,
    mean_cosine: float,
    towards: list[F64],
    *,
    is_paper: bool = False,
    iterations: int = 24,
    watch: Watch | None = None,
) -> Propagated:
    """`iterations` hops of `power`; the rest goes to the residuum.

    `density` (z, y, x); `towards`: the cosine (z, y, x) of the light's direction to each view.
    `watch(fluence, a)` is told every iteration's light.
    """
    sigma_s = density[..., None] * medium.sigma_t * medium.albedo
    passed = np.exp(-(density[..., None] * medium.sigma_t - sigma_s) * hops.path)
    g = np.maximum(medium.g, 0.0) if is_paper else medium.g
    a = np.broadcast_to((1.0 if is_paper else g) * mean_cosine, power.shape)
    seen = np.zeros((len(towards), *power.shape))
    out = {name: np.zeros(power.shape) for name in ("residual", "carried", "fluence")}
    exits = np.zeros((3, power.shape[-1]))
    sharpest = _LARGEST_A if is_paper else min(_LARGEST_A, float(resolved_by(mean_cosine)))
    for m in range(iterations + 1):
        # Fluence of the light on its path: the mean over the attenuated path in its cell.
        weight = (1.0 if m else 0.0) if is_paper else (1.0 if m else 0.5)
        path = _path(hops, a, is_paper=is_paper) if m else 1.0
        light = weight * _mean_on_path(passed**path) * power * path * hops.path / hops.volume
        out["fluence"] += light
        if watch is not None:
            watch(light, a)
        # What is scattered towards each view, by the lobe as wide as it is by now.
        for v, mu in enumerate(towards):
            lobe = a if is_paper else a * g
            seen[v] += light * henyey_greenstein(mu[..., None], np.minimum(lobe, sharpest))
        if m == iterations:
            break
        # On into the neighbours; what crosses the border has left.
        power, a, left = _hop(hops, power, a)
        exits += left
        if hops.inside is not None and not is_paper:
            power = power * hops.inside
        # Absorbed on the path; what was scattered widely enough by then joins the residuum.
        power = power * passed ** _path(hops, a, is_paper=is_paper)
        leaving, a = _scattered(hops, sigma_s, g, a, is_paper=is_paper)
        out["residual"] += leaving * power
        out["carried"] += _carried(hops, is_paper) * leaving * power * a
        power = power * (1.0 - leaving)
    out["residual"] += power
    out["carried"] += _carried(hops, is_paper) * power * a
    return Propagated(seen, out["residual"], out["carried"], out["fluence"], exits, iterations)


def straight_path(a: F64) -> F64:
    """How long the path of a lobe's light is, in hops: hops follow the axes, light does not.

    The mean of 1/(|x| + |y| + |z|) over Henyey-Greenstein directions about z; within 0.01.
    """
    return np.asarray(1.0 - (1.0 - ISOTROPIC_PATH) * (1.0 - np.abs(a) ** 5) ** 0.65)


def _path(hops: Hops, a: F64, *, is_paper: bool) -> F64 | float:
    return 1.0 if is_paper or hops.is_radial else straight_path(a)


def _carried(hops: Hops, is_paper: bool) -> float:
    return 0.0 if is_paper or hops.is_radial else CARRIED


def _mean_on_path(passed: F64) -> F64:
    """Mean of exp(-x t) over t = 0..1, exp(-x) = passed."""
    x = -np.log(np.maximum(passed, 1e-30))
    return np.where(x > 1e-3, (1.0 - passed) / np.maximum(x, 1e-12), 1.0 - 0.5 * x)


def _scattered(hops: Hops, sigma_s: F64, g: F64, a: F64, *, is_paper: bool) -> tuple[F64, F64]:
    """(share that joins the residuum, the rest's a) after the path through a cell."""
    # As printed (Elek2014 section 4.2): all light stays, and a falls by g^(sigma_s l).
    if is_paper:
        depth = sigma_s * hops.path
        return np.zeros(a.shape), a * np.where(depth > 0.0, g**depth, 1.0)
    # As corrected: of what scattering turns away a share joins the residuum, the rest widens the
    # lobe.
    lost = sigma_s * (1.0 - g) * hops.path
    if hops.is_radial:
        share = np.where(g >= _PEAKED, SHARE_RADIAL_PEAKED, SHARE_RADIAL)
        turned = 2.0 / 3.0 * (1.0 - a * a) * hops.curvature
        after = np.clip(a * np.exp(-(1.0 - share) * lost) + turned, 0.0, _LARGEST_A)
        return -np.expm1(-share * lost), after
    # Lobes wide enough are handed over to it whole.
    after = a * np.exp(-(1.0 - SHARE) * lost)
    high, low = HAND_OVER
    handed = np.clip((high - after) / (high - low), 0.0, 1.0)
    return 1.0 - np.exp(-SHARE * lost) * (1.0 - handed), after


def _hop(hops: Hops, power: F64, a: F64) -> tuple[F64, F64, F64]:
    """(power, a, exits (3, channel)) after one hop."""
    ahead, side, behind = (fraction * power for fraction in cap_fractions(a))
    light, along = np.zeros_like(power), np.zeros_like(power)
    for target, source, moved in (
        (slice(1, None), slice(None, -1), ahead),
        (slice(None, -1), slice(1, None), behind),
    ):
        light[target] += moved[source]
        along[target] += moved[source] * a[source]
    entry = behind[0].sum(axis=(0, 1))
    if hops.is_radial:  # what goes back into the innermost shell crosses it
        light[0] += behind[0]
        along[0] += behind[0] * a[0]
        entry = 0.0 * entry
    # To the four cells beside; what leaves a border cell is lost.
    nz, ny, nx, channels = power.shape
    flat_light, flat_along = (v.reshape(nz, ny * nx, channels) for v in (light, along))
    flat_side, flat_a = (v.reshape(nz, ny * nx, channels) for v in (side, a))
    sides: F64 = np.zeros(channels)
    for beside, gain in zip(hops.beside.reshape(4, -1), hops.side_gain.reshape(4, -1), strict=True):
        inside = beside >= 0
        # Sides are mutual: what a cell gets from a neighbour is what that one sends to it.
        back = (2.0 - gain[inside])[:, None]
        got = back * flat_side[:, beside[inside]]
        flat_light[:, inside] += got
        flat_along[:, inside] += got * flat_a[:, beside[inside]]
        stays = (1.0 - gain)[:, None] * flat_side
        flat_light += stays
        flat_along += stays * flat_a
        sides = sides + flat_side[:, ~inside].sum(axis=(0, 1))
    # What has arrived has the mean sharpness of its parts, weighted by power.
    arrived = np.where(light > 1e-30, along / np.maximum(light, 1e-30), 0.0)
    return light, arrived, np.stack([entry, ahead[-1].sum(axis=(0, 1)), sides])


def residual_light(
    medium: MediumGrid,
    residual: F64,
    carried: F64,
    steps: int = 60,
    largest: float | None = None,
) -> tuple[F64, F64]:
    """(Phi, J): fluence and flux (3, ...) W m^-2 of the residuum on the medium's cells.

    `residual` W (z, y, x, channel), `carried` W (3, z, y, x, channel). One solve for all grids.
    """
    system = diffusion_of(medium, largest)
    phi, _ = solve(system, system.source(residual, carried), steps)
    return phi, system.flux(phi, carried)


def residual_emission(medium: MediumGrid, phi: F64, flux: F64, towards: F64) -> F64:
    """In-scattered radiance per unit sigma_s, W m^-2 sr^-1, towards views (..., 3)."""
    travel = np.broadcast_to(towards, (*phi.shape[:3], 3))
    along = np.einsum("azyxc,zyxa->zyxc", flux, travel)
    shown = phi + 3.0 * RESIDUAL_LOBE * medium.g * along
    return np.asarray(np.maximum(0.1 * phi, shown) / (4.0 * np.pi))


def isotropic_hops(light: F64, passed: F64, iterations: int) -> F64:
    """The paper's residuum: radiance hopping a sixth each way, summed over `iterations`.

    `passed` (z, y, x, channel): transmittance of absorption over a cell.
    """
    total = np.zeros_like(light)
    for _ in range(iterations):
        wide = np.pad(light, [(1, 1)] * 3 + [(0, 0)])
        gathered = np.zeros_like(light)
        for axis in range(3):
            inner = [slice(1, -1)] * 3
            for shift in (slice(None, -2), slice(2, None)):
                inner[axis] = shift
                gathered += wide[tuple(inner)] / 6.0
        light = gathered * passed
        total += light
    return total


def switch_iteration(a: float, g: float, sigma_s: float, spacing_m: float) -> float:
    """Elek2014 eq. 10: hops after which the anisotropy of light is below 0.1.

    `sigma_s` m^-1: the medium's mean. Infinite where nothing scatters, or for g = 1.
    """
    threshold = 0.1
    if a <= threshold or g <= 0.0:
        return 0.0
    loss = -np.log(g) * sigma_s * spacing_m
    return float((np.log(a) - np.log(threshold)) / loss) if loss > 0.0 else float("inf")
