"""The unit cube of Elek2014 Figs. 12 and 13: light along +z, its directions in the middle slice."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..maths import delta_beam as db
from ..maths import ordinate_hops as hop
from ..maths.phase import henyey_greenstein
from ..scene.checks import F64

CELLS, SIGMA_S = 16, 4.0
MU_BINS, PHI_BINS, FINER = 5, 36, 3
SLICE = CELLS // 2
SHOWN = (1, 4, 8, 11, 14)  # cells of a row and of a column that are plotted

# Light of a cell whose flux nears its fluence is a beam; its lobe is drawn a little wider.
_STRONGEST_FLUX = 0.95


@dataclass(frozen=True, eq=False)
class Angular:
    """Scattered radiance (z, x, phi) in the slice y = 1/2 near the plane, W m^-2 sr^-1."""

    radiance: F64
    noise: float = 0.0
    """Relative L2 of Monte Carlo's own noise."""

    @property
    def shown(self) -> F64:
        """Plots (row, column, phi) of SHOWN: the light comes from below."""
        return self.radiance[np.ix_(SHOWN, SHOWN)]

    def scores(self, truth: Angular) -> dict[str, float]:
        """The error, and the light of all cells and azimuths over the truth's."""
        # Energy beside the error: a scheme may be right but for its brightness.
        ratio = float(self.radiance.mean() / truth.radiance.mean())
        return {
            "relative_l2": self.error(truth),
            "energy_ratio": ratio,
            "noise_floor_l2": truth.noise,
        }

    def error(self, truth: Angular) -> float:
        """Relative L2 over all cells and azimuths."""
        return float(
            np.linalg.norm(self.radiance - truth.radiance) / np.linalg.norm(truth.radiance)
        )


def directions() -> F64:
    """Directions (mu, phi, finer, 3) of the bins that are plotted, `tracer`'s middle ones."""
    # Finer directions within each bin, whose mean the tracer tallies.
    part = (np.arange(FINER) + 0.5) / FINER - 0.5
    mu = 2.0 * part / MU_BINS
    phi = 2.0 * np.pi * (np.arange(PHI_BINS)[:, None] + part) / PHI_BINS
    sine = np.sqrt(1.0 - mu**2)
    x = sine[:, None, None] * np.cos(phi)
    z = sine[:, None, None] * np.sin(phi)
    return np.stack([x, np.broadcast_to(mu[:, None, None], x.shape), z], axis=-1)


def _binned(of_direction: F64) -> F64:
    """(mu, phi, finer, z, x) -> (z, x, phi)."""
    return np.moveaxis(of_direction.mean(axis=(0, 2)), 0, -1)


def truth(g: float, photons: int) -> Angular:
    """Monte Carlo, both halves of the cube taken together. Raises ReferenceFailure."""
    # Light of one slice by direction, from below.
    from ..reference.tracer import Beam, BoxMedium, Slice, trace

    light = trace(
        BoxMedium(SIGMA_S, 1.0, g),
        Beam((0.0, 0.0, 1.0)),
        cells=(CELLS,) * 3,
        photons=photons,
        plane=Slice(1, SLICE),
        directions=(MU_BINS, PHI_BINS),
    )

    # The slice's two halves mirror each other: their mean halves the variance.
    one_side, error = (
        v[1][:, :, MU_BINS // 2] for v in (light.slice_radiance, light.slice_radiance_error)
    )
    seen = 0.5 * (one_side + mirrored(one_side))
    noise = np.linalg.norm(error) / np.linalg.norm(seen) / np.sqrt(2.0)
    return Angular(seen, float(noise))


def mirrored(radiance: F64) -> F64:
    """The slice (z, x, phi) as a mirror at x = 1/2 shows it, which changes nothing but noise."""
    return radiance[:, ::-1, (PHI_BINS // 2 - np.arange(PHI_BINS)) % PHI_BINS]


def _medium(g: float) -> db.MediumGrid:
    one = np.ones((CELLS,) * 3)
    return db.MediumGrid(np.ones(3), one, one, np.array([SIGMA_S]), np.ones(1), np.array([g]))


def by_beams(g: float, steps: int = 60) -> Angular:
    """The scheme delta-beam."""
    # One beam through a homogeneous cube.
    medium = _medium(g)
    done = db.light(medium, [db.beam(medium, (0.0, 0.0, 1.0), np.ones(1), 1.0)], steps)
    d = directions()

    # Light that the beam scattered forwards, as a lobe about it.
    _, quasi, a = done.quasi_forward(done.beams[0])
    q, lobe = (np.broadcast_to(v, done.fluence.shape)[:, SLICE, :, 0] for v in (quasi, a))
    way = d[..., 2][..., None, None]
    forward = q * henyey_greenstein(way, lobe)

    # Diffuse light as a lobe along its flux, as sharp as that is beside the fluence.
    flux, phi = done.flux[:, :, SLICE, :, 0], np.maximum(done.fluence[:, SLICE, :, 0], 0.0)
    size = np.maximum(np.linalg.norm(flux, axis=0), 1e-30)
    mu = np.clip(np.einsum("mpfa,azx->mpfzx", d, flux / size), -1.0, 1.0)
    strength = np.minimum(_STRONGEST_FLUX, size / np.maximum(phi, 1e-30))
    return Angular(_binned(forward + phi * henyey_greenstein(mu, strength)))


def by_hops(g: float, iterations: int, *, is_paper: bool = False) -> Angular:
    """The schemes split and paper."""
    # A grid of cubes along the light; what is under way is watched in every hop.
    medium = _medium(g)
    hops = hop.parallel_hops((CELLS,) * 3, 1.0 / CELLS)
    d = directions()
    way = d[..., 2][..., None, None]
    total = np.zeros((*d.shape[:3], CELLS, CELLS))

    def watch(light: F64, a: F64) -> None:
        lobe = np.minimum(a[:, SLICE, :, 0], 0.999)
        total[...] += light[:, SLICE, :, 0] * henyey_greenstein(way, lobe)

    # Hops of what was put in at first.
    power = hop.first_light(
        hops, medium, medium.density, np.ones((*medium.density.shape, 1)), is_paper=is_paper
    )
    done = hop.propagate(
        hops,
        medium,
        medium.density,
        power,
        1.0,
        [],
        is_paper=is_paper,
        iterations=iterations,
        watch=watch,
    )

    # What joined the residuum has been solved for, and is added as the scheme shows it.
    if not is_paper:
        carried = np.zeros((3, *done.carried.shape))
        carried[2] = done.carried
        phi, flux = (v[..., 0] for v in hop.residual_light(medium, done.residual, carried))
        along = np.einsum("mpfa,azx->mpfzx", d, flux[:, :, SLICE])
        shown = phi[:, SLICE] + 3.0 * hop.RESIDUAL_LOBE * along
        total += np.maximum(0.1 * phi[:, SLICE], shown) / (4.0 * np.pi)
    return Angular(_binned(total))
