"""The solved lattice of the room cut open along its axes, and an atrium's cascades in colours."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from ..lpv.solver import LpvSolver
from ..maths.arrays import U8
from ..maths.colour import luminance
from ..scene.builtin import room
from ..techniques.technique import Technique
from .cascades import cascades_coloured
from .panels import Drawn, Request, renderer, sheet
from .slices import SolvedLattice, from_texels, slice_image

CELL_PX = 16


def draw(request: Request) -> Drawn:
    """Slices through the middle of `builtin:room`, what the lattice holds, and which cascade
    gives how much of the light on the atrium's surfaces.
    """
    # A small lattice is cut open; nearly all of its cells are below white.
    lattice = solved(request, {"resolution": 12 if request.quick else 32})
    light = luminance(lattice.fluence)
    brightest = float(np.percentile(light, 99.5))
    middle = dict(zip("zyx", (n // 2 for n in light.shape), strict=True))

    # One slice across each axis, through the middle.
    cells: list[tuple[str, U8 | None]] = [
        (f"across {axis} = {middle[axis]}", _square(lattice, axis, middle[axis], brightest))
        for axis in "xyz"
    ]
    numbers = {
        "cells_zyx": list(light.shape),
        "cell_m": lattice.cell_m,
        "white_at_w_m2": brightest,
        "mean_fluence_w_m2": float(light.mean()),
        "mean_directedness": float(np.linalg.norm(lattice.direction, axis=-1).mean()),
        "closed_share_of_faces": float(np.mean(1.0 - lattice.openness)),
    }

    # And which of the nested lattices lights what.
    coloured, numbers["cascades"] = cascades_coloured(request)
    rows: list[tuple[str, list[tuple[str, U8 | None]]]] = [("slice", cells), ("atrium", coloured)]
    return Drawn(sheet(request, "Lattices cut open, and cascades", rows), numbers)


def solved(request: Request, settings: Mapping[str, Any]) -> SolvedLattice:
    """The lattice of `builtin:room` after one frame."""
    with renderer(request, room(), settings) as made:
        made.frame(read=False)
        return read_lattice(made.technique)


def read_lattice(technique: Technique) -> SolvedLattice:
    """What a technique with a lattice of indirect light has solved, from the device."""
    # The textures of lattice and blockers, as the device has them.
    solver = technique.find(LpvSolver)
    assert solver is not None
    textures, blockers, place = solver.textures, technique.kit.blockers, technique.kit.placement
    columns, rows, layers = place.count

    def own(texels: Any) -> Any:
        """Nested lattices share textures; the largest one's part."""
        return texels[:layers, place.first_row : place.first_row + rows, :columns]

    return from_texels(
        own(textures.red.read()),
        own(textures.green.read()),
        own(textures.blue.read()),
        own(blockers.visibility_a.read()),
        own(blockers.visibility_b.read()),
        power_scale=solver.power_scale,
        cell_m=place.cell,
    )


def _square(lattice: SolvedLattice, across: str, index: int, brightest: float) -> U8:
    """A slice in the middle of a square ground, so that all three are drawn to one scale."""
    image = slice_image(lattice, across, index, brightest=brightest, cell_px=CELL_PX)
    side = max(lattice.openness.shape[:3]) * CELL_PX
    square = np.full((side, side, 3), 22, dtype=np.uint8)
    height, width = image.shape[:2]
    top, left = (side - height) // 2, (side - width) // 2
    square[top : top + height, left : left + width] = image
    return square
