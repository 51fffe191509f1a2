"""The light of one lattice among nested ones (Kaplanyan2010 section 4).

All share the reflective shadow maps, the textures and the surfels; each has its own cells and its
own propagation. What only the sky, the geometry and the lattice's place change is put in once and
stored.
"""

from __future__ import annotations

from dataclasses import dataclass

from ..gpu.device import Gpu
from ..gpu.memory import Buffer
from ..lattice.blockers import Blockers
from ..lattice.inject import SmallObjects, new_sums
from ..lattice.lattices import Level
from ..lattice.lobes import InjectionTarget
from ..lattice.placement import Placement
from .propagate import Propagate


@dataclass(eq=False)
class Cascade:
    """The light of the cells of `level`: injected, static and propagated."""

    level: Level
    propagate: Propagate
    sums: Buffer
    static: Buffer
    injected: Buffer
    small: SmallObjects
    is_stale: bool = True  # whether the static light must be put in again
    blocked: int = -1  # the blockers' version under which it was put in

    @property
    def placement(self) -> Placement:
        """Where its cells are."""
        return self.level.placement

    @property
    def blockers(self) -> Blockers:
        """What blocks between them."""
        return self.level.blockers

    def target(self, scale: float) -> InjectionTarget:
        """Its sums, to be added to in units of `scale` per W sr^-1."""
        return InjectionTarget(self.placement, self.blockers.walls, self.sums, scale)


def cascade(gpu: Gpu, level: Level, propagate: Propagate, small: SmallObjects) -> Cascade:
    """A lattice with nothing in it."""
    nbytes = 3 * level.placement.cells * 16
    return Cascade(
        level,
        propagate,
        new_sums(gpu, level.placement),
        Buffer(gpu, "static light", nbytes),
        Buffer(gpu, "injected", nbytes),
        small,
    )
