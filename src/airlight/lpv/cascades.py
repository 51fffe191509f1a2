"""Nested lattices that follow the camera (Kaplanyan2010 section 4).

All share the reflective shadow maps, the textures and the surfels; each has its own cells,
blockers and sky light. A lattice that moved by some of its cells makes what stands still
(blockers, the sky's light and its bounce) anew, and at most one does so in a frame, as long as
the others still hold what is read of them.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ..gpu.device import Gpu
from ..gpu.memory import Buffer
from ..lattice.blockers import Blockers
from ..lattice.inject import SmallObjects, new_sums
from ..lattice.nested import Nest, faded, is_lost, snapped, wanted_centre
from ..lattice.placement import Placement
from ..lattice.skylight import Skylight
from ..scene.camera import Camera
from .propagate import Propagate


@dataclass(eq=False)
class Cascade:
    """One lattice: where it is, what blocks in it, what is put into it."""

    placement: Placement
    blockers: Blockers
    skylight: Skylight
    propagate: Propagate
    sums: Buffer
    steady: Buffer
    injected: Buffer
    small: SmallObjects
    is_stale: bool = True  # whether the steady light must be put in anew

    def place(self, placement: Placement) -> None:
        """Move it; what depends on the place is made anew when it is encoded."""
        self.placement = placement
        self.blockers.place(placement)
        self.skylight.placement = placement

    def release(self) -> None:
        """Give the memory back; blockers and sky light are their owner's."""
        for part in (self.propagate, self.sums, self.steady, self.injected):
            part.release()


def cascade(
    gpu: Gpu, placement: Placement, blockers: Blockers, skylight: Skylight,
    propagate: Propagate, small: SmallObjects,
) -> Cascade:  # fmt: skip
    """A lattice with nothing in it."""
    nbytes = 3 * placement.cells * 16
    return Cascade(
        placement, blockers, skylight, propagate, new_sums(gpu, placement),
        Buffer(gpu, "steady light", nbytes), Buffer(gpu, "injected", nbytes), small,
    )  # fmt: skip


def follow(nest: Nest, cascades: Sequence[Cascade], camera: Camera, *, is_first: bool) -> bool:
    """Move the lattices (the finest first) to where the camera wants them.

    One of them at most, but for those whose cells would no longer reach what is read of them.
    Returns whether all are where it wants them: then the same camera moves none.
    """
    eye = np.asarray(camera.position, np.float64)
    look = np.subtract(camera.target, camera.position)
    may_move = is_settled = True
    for level, part in enumerate(cascades):
        if not nest.follows(level):
            continue
        centre = wanted_centre(nest, level, eye, look)
        now = snapped(nest, level, centre, None if is_first else part.placement)
        moves = now.origin != part.placement.origin
        if moves and not (may_move or is_first or is_lost(part.placement, centre)):
            now, moves, is_settled = part.placement, False, False
        may_move = may_move and not moves
        part.place(faded(nest, level, now, centre))
    return is_settled
