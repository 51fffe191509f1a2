"""Diffuse light that enters a finer grid from the solution of a larger one around it.

At a face with the outward normal n a diffuse field of fluence Phi and net flux J sends the partial
current (Phi - 2 J.n)/4 inwards. Both grids have the same condition at outer faces,
Phi - 2 J.n = G: with G = 0 nothing comes in; at the border of a finer grid G is that of the larger
grid's solution. The operator of the diffusion solve is the same for both.
"""

from __future__ import annotations

import numpy as np

from .transforms import F64
from .voxels import trilinear


def entering_fluence(phi: F64, flux: F64, cell: F64, points: F64, outwards: F64) -> F64:
    """G (n, channel), W m^-2, at `points` (n, 3), m from the larger grid's lower corner.

    `phi` (z, y, x, channel) and `flux` (z, y, x, channel, 3), W m^-2, are its solution in cells of
    size `cell` (3,), m; `outwards` (3,): the unit normal. 0 outside the grid. Twin:
    wgsl/outer_solution.wgsl.
    """
    # The partial current inwards, times 4, between cells.
    extent = cell * np.array(phi.shape[2::-1])
    sent = phi - 2.0 * flux @ outwards
    is_inside = np.all((points >= -1e-4 * cell) & (points <= extent + 1e-4 * cell), axis=-1)
    channels = [trilinear(sent[..., c], points / cell) for c in range(sent.shape[-1])]
    return np.asarray(np.stack(channels, axis=-1) * is_inside[:, None])


def entering_flux(entering: F64, h: float, d: F64) -> F64:
    """The flux inwards, W m^-2, into a cell of side `h`, m, and diffusivity `d`, m."""
    return np.asarray(entering / (0.5 * h / d + 2.0))
