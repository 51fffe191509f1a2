"""One hop taken apart: what is passed on, lost and scattered (Billeter2012 Fig. 3)."""

from __future__ import annotations

from typing import Any

import numpy as np

from ..maths import lattice26
from ..maths.arrays import U8
from ..scene.checks import F64
from .clpv_5 import peaks, polar_image
from .panels import Drawn, Request, sheet

DEPTH = 0.4  # optical depth of a hop of one cell
CELL_PX = 84


def draw(request: Request) -> Drawn:
    """The plane of 3 x 3 cells around one that sends light to the upper right; lobes to one scale.

    The lobe is the sharpest of two bands that is nowhere negative.
    """
    # A lobe along the path whose two bands are just not negative.
    way = np.array([2.0, 1.0, 0.0]) / np.sqrt(5.0)
    state = np.zeros((1, 3, 3, 3, 4))
    state[0, 1, 1, 1, 0] = 1.0
    state[0, 1, 1, 1, 1:] = way

    # A step without a medium, with absorption alone, and with scattering alone.
    clear, _ = lattice26.deposit_step(state, [0.0], [1.0], 1.0)
    dark, _ = lattice26.deposit_step(state, [DEPTH], [0.0], 1.0)
    whole, scattered = lattice26.deposit_step(state, [DEPTH], [1.0], 1.0)
    shared = np.zeros_like(whole)
    shared[..., 0] = scattered
    steps = {
        "before": state,
        "passed on": clear,
        "left after extinction": dark,
        "scattered": shared,
        "together": whole,
    }

    # Lobes of all steps to the scale of the brightest.
    brightest = float(peaks(flat(state)).max())
    cells: list[tuple[str, U8 | None]] = [
        ("transfer functions", polar_image(flat(_transfer()), CELL_PX))
    ]
    for label, step in steps.items():
        name = f"{label}: {float(step[..., 0].sum()):.2f}"
        cells.append((name, polar_image(flat(step), CELL_PX, brightest)))

    # Powers, and the transfer functions of the three kinds of hops.
    table = lattice26.hops()
    numbers: dict[str, Any] = {
        "optical_depth_of_a_cell": DEPTH,
        "power": {label: float(step[..., 0].sum()) for label, step in steps.items()},
        "transfer_functions": {
            name: {"band_0": float(table.gain0[j]), "band_1": float(table.gain1[j])}
            for name, j in (("face", 0), ("edge", 6), ("corner", 18))
        },
    }
    rows = [("power", cells[1:4]), ("one hop", [*cells[4:], cells[0]])]
    return Drawn(sheet(request, "One hop", rows), numbers)


def _transfer() -> F64:
    """(1, 3, 3, 3, 4): what goes to each neighbour of a cell, from light of all directions."""
    table = lattice26.hops()
    made = np.zeros((1, 3, 3, 3, 4))
    x, y, z = (1 + table.offsets).T
    made[0, z, y, x, 0] = table.weights
    made[0, z, y, x, 1:] = 3.0 * lattice26.RHO * table.weights[:, None] * table.directions
    return made


def flat(state: F64) -> F64:
    """(3, 3, 3) of flatland's two bands: the middle layer's intensity over angles in its plane.

    Negative parts of lobes are not drawn; powers are.
    """
    # From (a, bx, by) in space to circular harmonics in the plane.
    plane = state[0, 1]
    a, b = plane[..., 0] / (4.0 * np.pi), plane[..., 1:3] / (4.0 * np.pi)
    even = np.sqrt(2.0 * np.pi) * a[..., None]
    return np.asarray(np.concatenate([even, np.sqrt(np.pi) * b], axis=-1))
