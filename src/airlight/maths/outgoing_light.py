"""Diffuse light that goes towards an eye, along straight paths through what scatters it forwards.

A phase function is taken for a peak that keeps the direction (the share f that beams keep, see
`delta_beam`) and a smooth rest. Of the diffuse radiance L(x, w) towards the eye, the peak scatters
f L on, the rest what fluence and net flux in x say. L is what left the beams and what the rest
scattered, of all cells behind x, attenuated as a beam is. So near a lit face, where fluence and net
flux know neither what comes out nor that nothing comes in, emission has the shape of transport.
Source: the delta-Eddington phase function (Joseph1976).
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .arrays import F64, I64
from .phase import henyey_greenstein

LEAST_TRANSMITTANCE = 0.005
"""Along a path, below which the rest of it counts for nothing."""


def forward_share(g: ArrayLike) -> F64:
    """f = g^1.5: the share of scattered light that stays in the beam; 0 for g <= 0."""
    return np.asarray(np.maximum(np.asarray(g, dtype=np.float64), 0.0) ** 1.5)


def deposited_anisotropy(g: ArrayLike) -> F64:
    """g1 = (g - f)/(1 - f): mean cosine of the light that leaves the beam."""
    # f = 0 leaves g as it is: no peak.
    k = np.asarray(g, dtype=np.float64)
    f = forward_share(k)
    return np.asarray((k - f) / (1.0 - f))


def leaving_lobe(mu: ArrayLike, g: ArrayLike, sharpness: ArrayLike, unturned: ArrayLike) -> F64:
    """Directions, sr^-1, of light that leaves beams; `sharpness`: the mean cosine of those beams.

    The share `unturned` leaves the medium as it is: what the phase function has beyond the peak,
    where the peak drawn as wide as it is, of mean cosine (1 + 2 g)/3, does not hide it. The other
    share is turned on its way: a lobe of the mean cosine g1.
    """
    # The phase function less its peak, and the smooth lobe of the same power.
    g, c = np.asarray(g, dtype=np.float64), np.asarray(sharpness, dtype=np.float64)
    f = forward_share(g)
    peak = f * henyey_greenstein(mu, (1.0 + 2.0 * g) / 3.0 * c)
    rest = np.maximum(henyey_greenstein(mu, g * c) - peak, 0.0) / (1.0 - f)
    smooth = henyey_greenstein(mu, deposited_anisotropy(g) * c)
    return np.asarray(smooth + np.asarray(unturned) * (rest - smooth))


def first_directions(power: F64, forward: F64, g1: F64) -> tuple[F64, F64]:
    """(d, c): mean direction (3, ...) and mean cosine (...) of the beams that left `power`.

    `forward` (3, ...) is what of `power` (...) keeps its direction; `g1` broadcasts to them.
    """
    # Where no power left beams there is no direction.
    scale = np.where(np.abs(power * g1) > 1e-30, power * g1, np.inf)
    mean = forward / scale
    size = np.linalg.norm(mean, axis=0)
    return np.asarray(mean / np.maximum(size, 1e-20)), np.minimum(size, 1.0)


def smooth_scattering(
    fluence: F64, flux: F64, towards: F64, g: ArrayLike, unturned: ArrayLike
) -> F64:
    """Radiance (z, y, x, channel) per unit of what a cell scatters smoothly.

    `flux` (3, z, y, x, channel), `towards` (z, y, x, 3).
    """
    # Fluence and flux as a lobe: as sharp as the one is beside the other.
    phi, size = np.maximum(fluence, 0.0), np.linalg.norm(flux, axis=0)
    along = np.einsum("azyxc,zyxa->zyxc", flux / np.maximum(size, 1e-300), towards)
    sharpness = np.minimum(size / np.maximum(phi, 1e-300), 1.0)
    return phi * leaving_lobe(np.clip(along, -1.0, 1.0), g, sharpness, unturned)


def reduced_emission(fluence: F64, indirect: F64, whole: F64, g: F64) -> F64:
    """Radiance (..., channel) per unit sigma_s that the reduced medium scatters, isotropically.

    `fluence` of light that it has not scattered, and the mean radiance `indirect` besides. A
    channel of g <= 0, which is not reduced, has the `whole` emission of the true medium.
    Source: similarity theory (Wyman1989), order one: sigma_s (1 - g).
    """
    scattered = (1.0 - g) * (fluence / (4.0 * np.pi) + indirect)
    return np.asarray(np.where(g > 0.0, scattered, whole))


def arriving(
    source: F64,
    extinction: F64,
    towards: F64,
    cell: F64,
    closed: NDArray[np.bool_] | None = None,
) -> F64:
    """L (z, y, x, channel) that arrives in the middle of every cell, travelling `towards` an eye.

    `source` (z, y, x, channel): radiance per unit of `extinction`, m^-1; `towards` (z, y, x, 3);
    `cell` (3,), m. Half a step in the cell itself, then steps of the shortest side, each in the
    cell that its middle lies in. `closed` (3, z, y, x) as in `diffusion.Diffusion`: nothing arrives
    from behind a face that a surface closes.
    """
    # Every cell's eye ray starts in its middle.
    shape, step = source.shape[:3], float(cell.min())
    at = np.stack(np.meshgrid(*map(np.arange, shape), indexing="ij"), axis=-1)[..., ::-1] + 0.5
    # The cell's own half step, behind which all others lie.
    through = np.exp(-0.5 * step * extinction)
    light = source * (1.0 - through)
    last = np.floor(at).astype(np.int64)[..., ::-1]
    is_open = np.ones((*shape, 1), bool)
    for n in range(1, _steps(shape, cell)):
        place = np.floor(at - towards * (n * step / cell)).astype(np.int64)[..., ::-1]
        inside = np.all((place >= 0) & (place < shape), axis=-1, keepdims=True)
        # A march ends at the border, at a wall, or where almost nothing would arrive.
        inside = inside & (through.max(axis=-1, keepdims=True) > LEAST_TRANSMITTANCE)
        place = np.clip(place, 0, np.array(shape) - 1)
        if closed is not None:
            is_open &= ~_is_walled(closed, last, place)[..., None]
            inside = inside & is_open
        last = place
        k, j, i = np.moveaxis(place, -1, 0)
        passed = np.where(inside, np.exp(-step * extinction[k, j, i]), 1.0)
        # A step of constant source sends S (1 - exp(-depth)), less what lies before it.
        light = light + through * source[k, j, i] * (1.0 - passed)
        through = through * passed
    return light


def _is_walled(closed: NDArray[np.bool_], one: I64, other: I64) -> NDArray[np.bool_]:
    """Whether a surface closes a face between cells (..., 3; z, y, x) at most a cell apart.

    Across an edge or a corner it is enough that one of the faces at either cell is closed.
    """
    walled = np.zeros(one.shape[:-1], bool)
    for axis in range(3):
        # Cells know their upper faces: those of the lower cell's row along this axis, at either.
        apart = one[..., 2 - axis] != other[..., 2 - axis]
        low = np.minimum(one, other)[..., 2 - axis]
        for cell in (one, other):
            k, j, i = (low if 2 - axis == a else cell[..., a] for a in range(3))
            walled |= apart & closed[axis][k, j, i]
    return walled


def _steps(shape: tuple[int, ...], cell: F64) -> int:
    """Steps that reach from corner to corner."""
    diagonal = float(np.linalg.norm(np.array(shape[::-1]) * cell))
    return math.ceil(diagonal / float(cell.min())) + 1
