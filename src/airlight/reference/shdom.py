"""Light in scattering air by discrete ordinates and spherical harmonics: a baseline.

Evans1998, The Spherical Harmonics Discrete Ordinate Method, in its plain form: every cell's
radiance is a series of `bands` harmonics; in-scattering multiplies band l by g^l; light is carried
along discrete ordinates from layer to layer, bilinear in between. What Elek2014 Fig. 11 compares
with: bilinear steps blur beams (false scattering), the series rings unless it is smoothed.
differs: Evans splits cells where light changes, and scales strong forward peaks away.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..maths.arrays import F64, I64
from ..maths.delta_beam import MediumGrid
from ..maths.latlong import latlong_row_solid_angles, latlong_texel_directions
from .harmonics import band_of, harmonics, quadrature_directions, window


@dataclass(frozen=True, eq=False)
class Shdom:
    """A solution: `radiance` (bands^2, z, y, x, channel), W m^-2 sr^-1 of travel directions.

    `change`: the last iteration's, relative.
    """

    medium: MediumGrid
    bands: int
    radiance: F64
    change: float

    @property
    def fluence(self) -> F64:
        """(z, y, x, channel), W m^-2."""
        return np.asarray(self.radiance[0] * np.sqrt(4.0 * np.pi))

    def emission(self, towards_eye: F64) -> F64:
        """In-scattered radiance per unit sigma_s (z, y, x, channel), towards (z, y, x, 3)."""
        # Band l of the series scatters with g^l (Funk-Hecke); ringing below zero is cut.
        basis = harmonics(np.broadcast_to(towards_eye, (*self.medium.density.shape, 3)), self.bands)
        g = self.medium.g ** band_of(self.bands)[:, None]
        scattered = np.einsum("zyxk,kzyxc,kc->zyxc", basis, self.radiance, g, optimize=True)
        return np.asarray(np.maximum(scattered, 0.0))


def environment_series(radiance: F64, bands: int, *, prefilter: bool = True) -> F64:
    """Series (bands^2, channel) of travel directions of a latitude-longitude map (H, W, 3).

    `prefilter`: smoothed by Hanning's window.
    """
    # The projection of every texel's radiance, row by row: texels of a row have one solid angle.
    height, width = radiance.shape[:2]
    travel = -latlong_texel_directions(height, width)
    weight = latlong_row_solid_angles(height, width)
    series = np.zeros((bands * bands, radiance.shape[2]))
    for row in range(height):
        series += weight[row] * harmonics(travel[row], bands).T @ radiance[row]
    return series * window(bands)[:, None] if prefilter else series


def solve(
    medium: MediumGrid, outside: F64, bands: int, *, iterations: int = 30, tolerance: float = 1e-3
) -> Shdom:
    """Radiance in `medium` under a series `outside` (bands^2, channel) of incident light.

    Iterates over orders of scattering, at most `iterations` times.
    """
    # Nodes that integrate products of two series of these bands without error.
    directions, weights = quadrature_directions(bands)
    basis = harmonics(directions, bands)
    incident = np.maximum(basis @ outside, 0.0)
    # Directions that cross layers of one axis to the same sides are swept together.
    groups = [_Group(medium, directions, member) for member in _grouped(medium, directions)]

    # In-scattering in the series' space, one factor for each band and channel.
    scattering = medium.albedo * medium.g ** band_of(bands)[:, None]
    scattering = scattering[:, None, None, None, :]
    shape = (bands * bands, *medium.density.shape, len(medium.g))
    radiance, change = np.zeros(shape), 1.0
    for _ in range(iterations):
        # One order of scattering: the source of the light so far, carried along all directions.
        source = np.tensordot(basis, radiance * scattering, axes=1)
        after = np.zeros(shape)
        for group in groups:
            m = group.member
            carried = group.sweep(source[m], incident[m])
            after += np.tensordot((weights[m, None] * basis[m]).T, carried, axes=1)
        # Converged once the mean radiance no longer changes.
        size = float(np.abs(after[0]).max())
        change = float(np.abs(after[0] - radiance[0]).max()) / max(size, 1e-30)
        radiance = after
        if change < tolerance:
            break
    return Shdom(medium, bands, radiance, change)


def _grouped(medium: MediumGrid, directions: F64) -> list[I64]:
    """Directions that cross layers of the same axis and lean to the same sides, together."""
    # The axis whose layers are crossed most often leads; the signs of all three split its group.
    steepness = np.abs(directions) / medium.cell
    axis = np.argmax(steepness, axis=1)
    key = axis * 8 + (directions > 0.0) @ np.array([1, 2, 4])
    return [np.nonzero(key == k)[0] for k in np.unique(key)]


class _Group:
    """Ordinates carried through the medium's layers together; arrays turned so that layers lead."""

    def __init__(self, medium: MediumGrid, directions: F64, member: I64) -> None:
        # The leading axis, the other two, and which of them run against the light.
        d, self.member = directions[member], member
        axis = int(np.argmax(np.abs(d[0]) / medium.cell))
        others = [k for k in (2, 1, 0) if k != axis]  # of the array: slower first
        self.order = [2 - axis, *(2 - k for k in others)]
        flips = [bool(d[0, k] < 0.0) for k in (axis, *others)]
        self._flipped = tuple(1 + k for k, flipped in enumerate(flips) if flipped)

        # A path's length through a layer, how many cells it leans aside, its optical depth.
        depth = medium.cell[axis] / np.abs(d[:, axis])
        self.lean = [np.abs(d[:, k]) * depth / medium.cell[k] for k in others]
        density = self._turned(medium.density[None, ..., None])[0]
        self.depth = density[None] * medium.sigma_t * depth[:, None, None, None, None]

    def _turned(self, values: F64) -> F64:
        """(n, z, y, x, c) -> (n, layer, a, b, c), light going up in all three."""
        turned = np.transpose(values, (0, *(1 + k for k in self.order), 4))
        return np.asarray(np.flip(turned, self._flipped))

    def sweep(self, source: F64, incident: F64) -> F64:
        """Radiance (n, z, y, x, c) from the source function (n, z, y, x, c)."""
        # Turned so that the light of this octant goes along the first axis, downstream.
        source = self._turned(source)
        out = np.zeros_like(source)
        behind = np.broadcast_to(incident[:, None, None, :], source[:, 0].shape)
        # L = L_upstream exp(-tau) + S (1 - exp(-tau)), layer by layer.
        for layer in range(source.shape[1]):
            here = self.depth[:, layer]
            way = 0.5 * here if layer == 0 else 0.5 * (here + self.depth[:, layer - 1])
            passed = np.exp(-way)
            came = behind if layer == 0 else self._upstream(behind, incident)
            behind = came * passed + source[:, layer] * (1.0 - passed)
            out[:, layer] = behind
        # Turned back.
        back = np.flip(out, self._flipped)
        inverse = np.argsort(self.order)
        return np.transpose(back, (0, *(1 + k for k in inverse), 4))

    def _upstream(self, layer: F64, incident: F64) -> F64:
        """The layer before (n, a, b, c), where each cell's light crossed it; outside: incident."""
        for axis, lean in ((1, self.lean[0]), (2, self.lean[1])):
            edge = np.broadcast_to(incident[:, None, None, :], np.take(layer, [0], axis=axis).shape)
            shifted = np.concatenate([edge, np.delete(layer, -1, axis=axis)], axis=axis)
            w = lean[:, None, None, None]
            layer = (1.0 - w) * layer + w * shifted
        return layer
