"""Propagation to 26 neighbours with extinction and in-scattering, in NumPy.

A state is (C, Z, Y, X, 4) in power units, W: (A, B) = 4pi (a, b) of the two-band intensity
a + b.w of lattice6; A is a cell's power, B/3 its net flux. One iteration moves all power one hop.
Source: Billeter2012 sections 3 and 4; weights and deposit are ours (see `Hops`, `deposit_step`).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache

import numpy as np
from numpy.typing import ArrayLike

from .arrays import F64, I64
from .lattice6 import shifted
from .medium import mean_absorption_depth, mean_transmittance
from .solid_angle import polygon_solid_angle, voronoi_cell

# How much of a cell's net direction a transfer function sees; the best of those measured.
RHO = 0.93
# Cells that light wanders across as RHO has it; on longer lattices it keeps straighter, by these
# powers of their length; measured.
_WANDERED = 25
_IN_CLEAR_AIR, _IN_MEDIUM = 0.75, 1.5
# Of the light that a lattice of a thin medium holds, this share is there in truth; measured.
_TRUE_SHARE = 0.95
# lattice6.surface_irradiance's `scale` for summed states of this scheme, no medium; measured.
LOOKUP_SCALE = 1.1  # scattered light: see scattered_lookup_scale


@dataclass(frozen=True)
class Hops:
    """The 26 neighbours: 6 across faces, 12 across edges, 8 across corners.

    `offsets` (26, 3) int dx, dy, dz; `lengths` (26,) in cells: 1, sqrt 2, sqrt 3; `directions`
    (26, 3) unit; `weights` (26,) sum to 1; `solid_angles` (26,), sr, sum to 4pi: the Voronoi
    cells. `gain0`, `gain1` (26,) are the transfer functions' coefficients in bands 0 and 1,
    Gamma_j = g0 y0 + g1 d_j.y1.
    differs: Billeter2012 section 4 rescales fitted transfer functions ("less than 1% loss"); here
    Gamma_j = sqrt(w_j) (y0 + sqrt(3) rho d_j.y1) keeps all power of any state.
    """

    offsets: I64
    lengths: F64
    directions: F64
    solid_angles: F64
    weights: F64
    gain0: F64
    gain1: F64


@cache
def hops() -> Hops:
    """The table: offsets sorted by face, edge, corner; weights as the squared Voronoi angles."""
    # The 26 neighbours: 6 across faces, 12 across edges, 8 across corners.
    cube = np.stack(np.meshgrid([-1, 0, 1], [-1, 0, 1], [-1, 0, 1], indexing="ij"), axis=-1)
    offsets = cube.reshape(-1, 3)
    offsets = offsets[np.abs(offsets).sum(axis=1) > 0]
    offsets = offsets[np.argsort(np.abs(offsets).sum(axis=1), kind="stable")]
    lengths = np.linalg.norm(offsets, axis=1)
    directions = offsets / lengths[:, None]
    # The solid angle of a hop is that of its Voronoi cell, alike for hops of one kind.
    one_of_each = {k: int(np.flatnonzero(np.abs(offsets).sum(axis=1) == k)[0]) for k in (1, 2, 3)}
    angle = {
        k: float(polygon_solid_angle(voronoi_cell(directions, i))) for k, i in one_of_each.items()
    }
    omega = np.array([angle[int(k)] for k in np.abs(offsets).sum(axis=1)])
    # Power weights w = omega^2 / sum omega^2, of two bands: gain0 = sqrt(w), gain1 = sqrt(3) rho
    # gain0.
    weights = omega**2 / (omega**2).sum()
    gain0 = np.sqrt(weights)
    return Hops(offsets, lengths, directions, omega, weights, gain0, np.sqrt(3.0) * RHO * gain0)


def persistence(longest_side: int, *, is_clear: bool = False) -> float:
    """Share of its net direction that light keeps on a hop, by the lattice's longest side, cells.

    What it loses is scattering that no medium does. RHO^2 fits 25 cells best, beside Monte Carlo.
    On more of them the same share would keep light in the lattice too long, 1.06 times its true
    path through 8 cells, 1.27 times through 24. In a medium the power is fitted to rooms of 32
    cells; clear air (`is_clear`) lies between far ends of halls and ends of walls (decisions.md).
    """
    power = _IN_CLEAR_AIR if is_clear else _IN_MEDIUM
    lost = (1.0 - RHO**2) * float((_WANDERED / longest_side) ** power)
    return max(RHO**2, 1.0 - lost)


def flux_extinction(albedo: ArrayLike) -> F64:
    """Of extinction: what two bands must take from the net flux, so that light goes far enough.

    Two bands alone would damp light in absorbing media as exp(-sqrt(3 (1 - c)) depth), c the
    albedo; in truth, far from its source, it falls as exp(-k depth) with c artanh(k) = k. With
    k^2 / (3 (1 - c)) of the extinction on the flux they agree: 1 at c = 1, a third at 0. This is
    that share, fitted within .002.
    Source: Case1967 (the eigenvalue of the asymptotic mode); asymptotic diffusion theory.
    Twin: wgsl/step26.wgsl.
    """
    c = np.asarray(albedo, dtype=np.float64)
    return np.asarray((1.0 + 2.0 * c) / 3.0 + c * (1.0 - c) * (0.25508 * c - 0.35534))


def flux_gain(
    sigma_s: ArrayLike, sigma_t: ArrayLike, cell_size_m: float, kept: float = RHO**2
) -> F64:
    """By how much more of the net direction than of the power half a hop transmits.

    `sigma_s`, `sigma_t` m^-1; `kept` the `persistence`: no flux grows on a hop. Hops of all lengths
    have the mean one's. Twin: wgsl/step26.wgsl.
    """
    # How much the medium scatters of what it takes, and the depth of half a mean hop.
    scatter, total = (np.asarray(v, dtype=np.float64) for v in (sigma_s, sigma_t))
    albedo = np.clip(scatter / np.maximum(total, 1e-30), 0.0, 1.0)
    depth = total * (0.5 * cell_size_m * mean_hop_length())
    gain = np.exp((1.0 - flux_extinction(albedo)) * depth)
    return np.asarray(np.minimum(gain, max(1.0, kept**-0.5)))


def true_share(sigma_t: ArrayLike, cell_size_m: float) -> F64:
    """How much of a solved lattice's track (...) there truly is, by extinction (...), m^-1.

    Light that passes hops unscattered wanders, and stays too long. The share is a fit to one foggy
    room (builtin:haze-box, 32 cells), not derived; others judge it in docs/accuracy.md.
    """
    passed = np.exp(-np.asarray(sigma_t, dtype=np.float64) * (cell_size_m * mean_hop_length()))
    return np.asarray(1.0 - (1.0 - _TRUE_SHARE) * passed)


def leaving_power(state: F64, hop: int) -> F64:
    """Power (C, Z, Y, X), W, that a state hands to hop number `hop`; unclamped, any sign."""
    table = hops()

    # The state's two bands towards the hop's direction.
    along = state[..., 1:] @ table.directions[hop]
    return np.asarray(table.weights[hop] * (state[..., 0] + RHO * along))


def _lobe(power: F64, direction: F64, sharpness: float) -> F64:
    """power (1, sharpness d): (..., 4)."""
    return np.asarray(power[..., None] * np.array([1.0, *(sharpness * direction)]))


def _isotropic(power: F64) -> F64:
    return np.asarray(power[..., None] * np.array([1.0, 0.0, 0.0, 0.0]))


def deposit_step(
    state: ArrayLike,
    sigma_t: ArrayLike,
    albedo: ArrayLike,
    cell_size_m: float,
    blocked: ArrayLike | None = None,
    kept: float = RHO**2,
) -> tuple[F64, F64]:
    """(state, scattered) after one iteration in a homogeneous medium, both power units.

    `sigma_t` (C,) m^-1 and `albedo` (C,); `scattered` (C, Z, Y, X) W is what this iteration
    scattered in each cell, to be summed; it is in the new state too, isotropic. `blocked`
    (26, Z, Y, X) is the share that surfaces stop, `kept` the `persistence`. Light that leaves the
    lattice is lost.
    differs: Billeter2012 eq. 3 needs an optical depth per cell below 1 and blows up near 2; the
    linear deposit along each hop is stable for all.
    """
    # What is moved, and how net flux is sharpened on both halves of a hop.
    before, table = np.asarray(state, dtype=np.float64), hops()
    sigma, ratio = (_per_channel(v) for v in (sigma_t, albedo))
    after, scattered = np.zeros_like(before), np.zeros(before.shape[:-1])
    ahead = flux_gain(sigma * ratio, sigma, cell_size_m, kept) ** 2
    for j, direction in enumerate(table.directions):
        power = leaving_power(before, j)
        # The source keeps its share of what every hop would scatter: the sum is isotropic,
        # sum w (1-p)(1-m) 4pi a, as opposite hops cancel.
        x = sigma * cell_size_m * table.lengths[j]
        lost, m = -np.expm1(-x), mean_absorption_depth(x)
        if blocked is not None:
            power = power * (1.0 - np.asarray(blocked)[j])
        scattered += ratio * lost * (1.0 - m) * power
        passed = np.exp(-x) * power
        # What passes goes on in its direction, less spread; what is scattered late arrives with it.
        arriving = _lobe(passed, direction, 0.0)
        arriving[..., 1:] = (3.0 * kept / RHO) * (ahead * passed)[..., None] * direction
        deposit = (ratio * m * lost * power)[..., None]
        moved = shifted(np.concatenate([arriving, deposit], axis=-1), table.offsets[j])
        after += moved[..., :4]
        scattered += moved[..., 4]
    return after + _isotropic(scattered), scattered


def _per_channel(value: ArrayLike) -> F64:
    return np.asarray(value, dtype=np.float64).reshape(-1, 1, 1, 1)


def half_linear_step(
    state: ArrayLike,
    sigma_s: ArrayLike,
    sigma_t: ArrayLike,
    cell_size_m: float,
    blocked: ArrayLike | None = None,
) -> tuple[F64, F64, F64]:
    """(state, scattered, track) after one iteration in a heterogeneous medium.

    `sigma_s`, `sigma_t` (C, Z, Y, X) m^-1. A hop runs half in its source cell and half in its
    destination; what is lost, and the length travelled, is shared between the two linearly.
    `scattered` as in deposit_step. `track` (C, Z, Y, X, 4) W m is the deposited track length:
    summed over all iterations, track_a/s^3 is fluence and track_b/s^3 net flux, W m^-2. Outside
    the lattice the medium goes on as at its border. Equals deposit_step in a constant medium.
    differs: ours; Billeter2012 knows homogeneous media only.
    """
    # Coefficients by cell; half of each hop lies in either of its cells.
    before, table = np.asarray(state, dtype=np.float64), hops()
    total = np.broadcast_to(np.asarray(sigma_t, dtype=np.float64), before.shape[:-1])
    scatter = np.broadcast_to(np.asarray(sigma_s, dtype=np.float64), before.shape[:-1])
    after, track = np.zeros_like(before), np.zeros_like(before)
    scattered = np.zeros(before.shape[:-1])
    ahead = flux_gain(scatter, total, cell_size_m)
    for j, offset in enumerate(table.offsets):
        power = leaving_power(before, j)
        if blocked is not None:
            power = power * (1.0 - np.asarray(blocked)[j])
        # Of each half of the hop: the shares scattered, kept as track, and transmitted.
        destination = [_from_destination(v, offset) for v in (scatter, total)]
        length_m = cell_size_m * float(table.lengths[j])
        kept, given, passed = _half_linear_shares((scatter, total), destination, length_m)
        # What stays in the source cell: scattered power, and track along the hop.
        lobe = power[..., None] * np.array([1.0, *(RHO * table.directions[j])])
        scattered += kept[0] * power
        track += kept[1][..., None] * lobe
        # What arrives, sharpened and damped by the flux gain of both cells, with the other half's
        # share.
        arriving = _lobe(passed * power, table.directions[j], 3.0 * RHO)
        arriving[..., 1:] *= (ahead * _from_destination(ahead, offset))[..., None]
        cells = [arriving, (given[0] * power)[..., None], given[1][..., None] * lobe]
        moved = shifted(np.concatenate(cells, axis=-1), offset)
        after += moved[..., :4]
        scattered += moved[..., 4]
        track += moved[..., 5:]
    return after + _isotropic(scattered), scattered, track


def _half_linear_shares(
    source: Sequence[F64], destination: Sequence[F64], length_m: float
) -> tuple[tuple[F64, F64], tuple[F64, F64], F64]:
    """What a hop of 1 W leaves in its source, in its destination, and what it passes on.

    `source` and `destination` are (sigma_s, sigma_t), m^-1; the first two results are (power
    scattered, W, and track length, W m).
    """
    # Optical depths of both halves, and the track of 1 W in each.
    half = 0.5 * length_m
    xs, xd = half * source[1], half * destination[1]
    track_s = half * mean_transmittance(xs)
    track_d = np.exp(-xs) * half * mean_transmittance(xd)
    # Where in the hop, 0 source to 1 destination, each half's light is lost on average.
    at_s, at_d = 0.5 * mean_absorption_depth(xs), 0.5 + 0.5 * mean_absorption_depth(xd)

    # Scattered power and track, handed to the destination by where they fall in the hop.
    lost_s, lost_d = source[0] * track_s, destination[0] * track_d
    given = (lost_s * at_s + lost_d * at_d, track_s * at_s + track_d * at_d)
    kept = (lost_s + lost_d - given[0], track_s + track_d - given[1])
    return kept, given, np.exp(-(xs + xd))


def _from_destination(cells: F64, offset: I64) -> F64:
    """The destination cell's value (..., Z, Y, X) at each source; at the border its own."""
    # Cells at the border stand for those beyond it.
    value = cells
    for step, axis in zip(offset.tolist(), (-1, -2, -3), strict=True):
        count = cells.shape[axis]
        if step:
            index = np.clip(np.arange(count) + step, 0, count - 1)
            value = np.take(value, index, axis=axis)
    return value


def mean_hop_length() -> float:
    """Mean length of a hop of isotropic light, in cells."""
    table = hops()
    return float(table.weights @ table.lengths)


def mean_track(sigma_t: ArrayLike, cell_size_m: float) -> F64:
    """Track length, m, of isotropic light per hop in extinction `sigma_t` (...), m^-1."""
    # Each hop's length by its mean transmittance, weighted by the power it takes.
    table, sigma = hops(), np.asarray(sigma_t, dtype=np.float64)
    lengths = cell_size_m * table.lengths
    return np.asarray((lengths * mean_transmittance(sigma[..., None] * lengths)) @ table.weights)


def scattered_lookup_scale() -> float:
    """lattice6.surface_irradiance's `scale` where light comes from all of the medium: 1.288.

    With it, what surfaces are lit by is what the hops of a state bring to a wall, so that no light
    is lost. Without a medium most light comes from few surfaces, and LOOKUP_SCALE errs less.
    """
    # What an isotropic state's hops bring down, over the quarter that isotropic light brings.
    table = hops()
    return 4.0 * float(table.weights[table.directions[:, 2] < -1e-9].sum())
