"""Directional light in a scattering medium: a delta-scaled beam per ordinate and one diffusion."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from .arrays import F64
from .beam_phase import beam_phase, beam_phase_table
from .diffusion import Diffusion, diffusivity, largest_diffusivity, solve
from .outgoing_light import (
    arriving,
    deposited_anisotropy,
    first_directions,
    forward_share,
    leaving_lobe,
    smooth_scattering,
)
from .phase import henyey_greenstein
from .voxels import density_behind


@dataclass(frozen=True, eq=False)
class MediumGrid:
    """A medium in a box: `extent` (3,) m, cell mean density (z, y, x), coefficients (channel,).

    `sigma_t` m^-1 at density 1. `fine` (z, y, x) is the density that rays sample.
    """

    extent: F64
    density: F64
    fine: F64
    sigma_t: F64
    albedo: F64
    g: F64

    @property
    def count(self) -> tuple[int, int, int]:
        """Cells along x, y, z."""
        nz, ny, nx = self.density.shape
        return nx, ny, nz

    @property
    def cell(self) -> F64:
        """Size of a cell (3,), m."""
        return np.asarray(self.extent / np.array(self.count))

    @property
    def centres(self) -> F64:
        """Cell centres (z, y, x, 3), m."""
        # z varies slowest, as arrays are indexed.
        axes = [(np.arange(n) + 0.5) * h for n, h in zip(self.count, self.cell, strict=True)]
        z, y, x = np.meshgrid(*axes[::-1], indexing="ij")
        return np.stack([x, y, z], axis=-1)


def resolved_by(mean_cosine: ArrayLike) -> F64:
    """The sharpest lobe, a mean cosine, that ordinates sum up without spots; 1 for a point.

    N equal parts of a sky have a mean cosine of 1 - 1/N. Degree sqrt(N) is the first that they do
    not integrate: the share g^degree of a lobe is 5 % then. Narrow parts resolve more, and where
    one holds a small bright light its spot is there.
    """
    return np.asarray(0.05 ** np.sqrt(np.maximum(1.0 - np.asarray(mean_cosine), 0.0)))


def beam_loss(g: ArrayLike, albedo: ArrayLike) -> F64:
    """k1 = 1 - albedo f: extinction of the forward-scaled beam in units of sigma_t."""
    return np.asarray(1.0 - np.asarray(albedo) * forward_share(g))


def quasi_forward_anisotropy(g: ArrayLike, albedo: ArrayLike, tau: ArrayLike) -> F64:
    """Mean cosine of the beam's scattered part at optical depth tau.

    Each scattering inside the beam keeps g_p = (1 + 2 g)/3; their number is Poisson distributed
    about M = f albedo tau, none left out.
    """
    m = forward_share(g) * np.asarray(albedo) * np.asarray(tau)
    kept = (1.0 + 2.0 * np.asarray(g)) / 3.0
    small = m < 0.01
    safe = np.where(small, 1.0, m)
    # e^-m over both: (e^(m kept) - 1)/(e^m - 1), written with negative exponents only
    exact = (np.exp(-safe * (1.0 - kept)) - np.exp(-safe)) / -np.expm1(-safe)
    return np.where(small, kept * (1.0 - 0.5 * m * (1.0 - kept)), exact)


def unturned(medium: MediumGrid, largest: float, mean_density: float | None = None) -> F64:
    """The share of diffuse light (channel,) that leaves the medium, or is absorbed, unturned.

    Light that would be turned anywhere in an endless medium leaves this one before it is with
    exp(-x^2): x is one and a half radii (three times the `largest` diffusivity, m) in units of the
    transport mean free path at `mean_density` (else the mean over the mass). Measured in cubes, g
    of .5 to .96 and x of .2 to 4: media of x below .3 want all of it, of .5 to .7 three quarters,
    of 1.2 a fifth, from 2.5 nothing.
    """
    if mean_density is None:
        mean_density = float((medium.density**2).sum()) / max(float(medium.density.sum()), 1e-30)
    turning = medium.sigma_t * medium.albedo * (1.0 - medium.g)

    # How fast light is turned, and how fast it is turned or absorbed.
    either = medium.sigma_t * (1.0 - medium.albedo * medium.g)
    inside = 1.0 - np.exp(-((4.5 * largest * either * mean_density) ** 2))
    return np.asarray(1.0 - turning / np.maximum(either, 1e-30) * inside)


@dataclass(frozen=True, eq=False)
class Beam:
    """One ordinate: unit `direction` of travel (3,), `irradiance` (channel,) W m^-2.

    Around a point both differ by cell: (z, y, x, 3), (z, y, x, channel); see `point_light_beam`.
    `mean_cosine` is that of its part of the sky; `passed` (z, y, x), m, the density that its light
    has passed on reaching each cell's centre. `missing` (z, y, x, channel), W m^-2, is light beside
    it that comes from all sides; see `point_light_beam.missing_irradiance`. `sharpness` (z, y, x):
    mean cosine of the directions in each cell; see `point_light_beam.local_sharpness`.
    """

    direction: F64
    irradiance: F64
    mean_cosine: float
    passed: F64
    missing: F64 | float = 0.0
    sharpness: F64 | None = None

    def optical_depth(self, medium: MediumGrid) -> F64:
        """tau (z, y, x, channel) from the light to every cell's centre."""
        return np.asarray(self.passed[..., None] * medium.sigma_t)


def beam(
    medium: MediumGrid, direction: ArrayLike, irradiance: ArrayLike, mean_cosine: float
) -> Beam:
    """The beam of one ordinate, marched in steps of at most a cell's shortest side."""
    # What each cell's light has passed, from the fine density.
    d, step = np.asarray(direction, dtype=np.float64), float(medium.cell.min())
    passed = density_behind(medium.fine, medium.extent, medium.centres, d, step)
    return Beam(d, np.asarray(irradiance, dtype=np.float64), mean_cosine, passed)


def mean_transmission(depth: F64) -> F64:
    """exp(-depth) averaged over every cell, of depths (z, y, x, channel) at their centres.

    The depth is taken as linear in a cell; along each axis its slope is the gentler of both sides'
    and 0 at an extremum, so that the rim of a shadow does not overshoot.
    """
    mean = np.exp(-depth)
    for axis in range(3):
        # Slopes on both sides of each cell; at the border there is only one.
        rise = np.diff(depth, axis=axis)
        ends = [np.take(rise, [0], axis), np.take(rise, [-1], axis)]
        before = np.concatenate([ends[0], rise], axis=axis)
        after = np.concatenate([rise, ends[1]], axis=axis)
        # exp of a linear depth has the mean sinh(s/2) / (s/2) times that at the middle.
        gentler = np.minimum(np.abs(before), np.abs(after))
        mean = mean * _sinh_quotient(0.5 * np.where(before * after > 0.0, gentler, 0.0))
    return np.asarray(np.minimum(mean, 1.0))


def _sinh_quotient(x: F64) -> F64:
    """sinh(x)/x for 0 <= x, its argument limited to 20."""
    # The series where the quotient loses its digits.
    small = x < 0.1
    safe = np.where(small, 1.0, np.minimum(x, 20.0))
    return np.where(small, 1.0 + x * x / 6.0 * (1.0 + x * x / 20.0), np.sinh(safe) / safe)


def deposit(medium: MediumGrid, beams: list[Beam]) -> tuple[F64, F64]:
    """(P, B), W: what leaves all beams per cell; see `diffusion`."""
    shape = (*medium.density.shape, 3)
    power, forward = np.zeros(shape), np.zeros((3, *shape))
    # sigma_t of the beam counts the forward peak as unscattered; what leaves is the rest of
    # sigma_s.
    loss = beam_loss(medium.g, medium.albedo)
    leaving = medium.sigma_t * medium.albedo * (1.0 - forward_share(medium.g))
    scale = leaving * medium.density[..., None] * float(np.prod(medium.cell))
    g1 = deposited_anisotropy(medium.g)
    # Each beam, attenuated to the cell, gives W = E sigma rho V, and forwards g1 of it.
    for one in beams:
        through = mean_transmission(loss * one.optical_depth(medium))
        s = one.irradiance * scale * through
        power += s + one.missing * scale
        along = np.broadcast_to(one.direction, (*shape[:3], 3))
        forward += s * g1 * one.mean_cosine * np.moveaxis(along, -1, 0)[..., None]
    return np.maximum(power, 0.0), forward


@dataclass(frozen=True, eq=False)
class Solution:
    """Everything but the view: beams, diffuse fluence (z, y, x, channel) and flux, W m^-2.

    `power` and `forward`: what `deposit` leaves in the cells, W.
    """

    medium: MediumGrid
    beams: list[Beam]
    fluence: F64
    flux: F64
    residual: F64
    power: F64
    forward: F64
    unturned: F64 | float = 0.0

    def quasi_forward(self, one: Beam) -> tuple[F64, F64, F64]:
        """(Phi_b, Phi_q, a): beam and quasi-forward fluence of one ordinate, and the latter's a."""
        # The beam loses all extinction; with what it scatters forwards, only k1 of it.
        m = self.medium
        tau = one.optical_depth(m)
        direct = np.exp(-tau)
        k1 = beam_loss(m.g, m.albedo)
        a = quasi_forward_anisotropy(m.g, m.albedo, tau)
        return one.irradiance * direct, one.irradiance * (np.exp(-k1 * tau) - direct), a

    def scattered_fluence(self) -> F64:
        """(z, y, x, channel) W m^-2 of light scattered at least once."""
        return self.fluence + sum(self.quasi_forward(one)[1] for one in self.beams)

    def emission(self, towards_eye: F64) -> F64:
        """In-scattered radiance per unit sigma_s (z, y, x, channel), W m^-2 sr^-1.

        `towards_eye` (z, y, x, 3) or (3,): unit directions of travel to the eye. Multiply by
        sigma_s and density for radiance per metre.
        """
        beams, quasi = self.beam_emission(towards_eye)
        return beams + quasi + self.diffuse_emission(towards_eye)

    def beam_emission(self, towards_eye: F64) -> tuple[F64, F64]:
        """The parts of `emission` from the beams and from quasi-forward light."""
        # Each ordinate's beam, as sharp as its part of the sky, and its light scattered forwards.
        g = self.medium.g
        beams, quasi_forward = np.zeros_like(self.fluence), np.zeros_like(self.fluence)
        table = beam_phase_table(g, [one.mean_cosine for one in self.beams])
        for one, phase in zip(self.beams, table, strict=True):
            mu = np.clip((towards_eye * one.direction).sum(axis=-1), -1.0, 1.0)
            direct, quasi, a = self.quasi_forward(one)
            once, lobe = beam_phase(phase, mu), g * a * one.mean_cosine
            # Around a point directions differ within a cell.
            if one.sharpness is not None:
                once = henyey_greenstein(mu[..., None], g * one.sharpness[..., None])
                lobe = lobe * one.sharpness[..., None]
            beams += direct * once
            lobe = np.minimum(lobe, resolved_by(one.mean_cosine))
            quasi_forward += quasi * henyey_greenstein(mu[..., None], lobe)
        return beams, quasi_forward

    def diffuse_emission(self, towards_eye: F64) -> F64:
        """The diffuse part of `emission`; see `outgoing_light`."""
        m = self.medium
        towards = np.broadcast_to(towards_eye, (*self.fluence.shape[:3], 3))
        f, g1 = forward_share(m.g), deposited_anisotropy(m.g)
        smooth = smooth_scattering(self.fluence, self.flux, towards, m.g, self.unturned)
        # What leaves the beams towards the eye, and what is scattered there smoothly.
        direction, sharpness = first_directions(self.power, self.forward, g1)
        mu = np.clip(np.einsum("azyxc,zyxa->zyxc", direction, towards), -1.0, 1.0)
        lobe = leaving_lobe(mu, m.g, sharpness, self.unturned)
        turned = m.sigma_t * m.albedo * (1.0 - f) * m.density[..., None]
        source = self.power / float(np.prod(m.cell)) * lobe + turned * smooth
        extinction = m.density[..., None] * m.sigma_t * beam_loss(m.g, m.albedo)
        per_depth = source / np.maximum(extinction, 1e-30)
        return (1.0 - f) * smooth + f * arriving(per_depth, extinction, towards, m.cell)


def diffusion_of(medium: MediumGrid, largest: float | None = None) -> Diffusion:
    """The operator of a medium; see `light`."""
    # Transport coefficients: forward scattering does not slow diffusion.
    sigma_s = medium.sigma_t * medium.albedo
    sigma_a = medium.sigma_t - sigma_s
    sigma_tr = sigma_s * (1.0 - medium.g)
    if largest is None:
        largest = largest_diffusivity(medium.density, medium.cell)
    d = diffusivity(medium.density, sigma_tr, sigma_a, largest)
    return Diffusion(medium.cell, d, medium.density[..., None] * sigma_a)


def light(
    medium: MediumGrid,
    beams: list[Beam],
    steps: int = 60,
    largest: float | None = None,
    mean_density: float | None = None,
) -> Solution:
    """Solve for the light that `beams` bring into `medium`, `steps` of conjugate gradients.

    `largest` diffusivity, m, and `mean_density` over its mass: else those of the medium's cells.
    """
    # Beams first: what they leave in cells is the source of the diffusion.
    largest = largest_diffusivity(medium.density, medium.cell) if largest is None else largest
    system = diffusion_of(medium, largest)
    power, forward = deposit(medium, beams)
    phi, residual = solve(system, system.source(power, forward), steps)
    share = unturned(medium, largest, mean_density)
    return Solution(medium, beams, phi, system.flux(phi, forward), residual, power, forward, share)
