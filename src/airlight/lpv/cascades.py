"""The light of one lattice among nested ones (Kaplanyan2010 section 4).

All share the reflective shadow maps, the textures and the surfels; each has its own cells and its
own propagation. Light that depends on the sky, the geometry and the lattice's placement alone is
injected once and stored.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import cast

from ..gpu.memory import Buffer
from ..lattice.blockers import Blockers
from ..lattice.inject import EVERYTHING, SmallObjects, new_sums
from ..lattice.lattices import Level
from ..lattice.lobes import InjectionTarget
from ..lattice.placement import Placement
from ..lighting.kit import Kit
from ..maths.lattice6 import Scheme, spread_kept
from .propagate import Propagate
from .settings import LpvSettings
from .step import StepKind


@dataclass(eq=False)
class Cascade:
    """The light of the cells of `level`: injected, static and propagated."""

    level: Level
    propagate: Propagate
    sums: Buffer
    static: Buffer
    injected: Buffer
    small: SmallObjects
    is_stale: bool = True  # whether the static light must be injected again
    blocked: int = -1  # the version of the blockers under which it was

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


def cascades(kit: Kit, settings: LpvSettings, steps: int) -> list[Cascade]:
    """The light of all lattices of `kit`, the finest first, nothing in them yet."""
    scene, levels = kit.context.scene, kit.lattices.levels
    # A medium everywhere changes the direction of light: hops keep the least spread.
    steps = 0 if scene.medium else steps
    made = []

    # A step of its own kind for each lattice: what hops keep of spread follows from its cells.
    for index, level in enumerate(levels):
        kind = StepKind(
            cast(Scheme, settings.scheme),
            is_blocked=settings.occlusion,
            is_reflecting=settings.occlusion and settings.bounces,
            kept=spread_kept(level.placement.count, steps),
        )
        propagate = Propagate(kit.gpu, level.placement, kind, settings.storage)

        # Injected sums, what is static of them, and all of it.
        small = _small([other.placement for other in levels], index, settings)
        nbytes = 3 * level.placement.cells * 16
        static, injected = (Buffer(kit.gpu, n, nbytes) for n in ("static light", "injected"))
        sums = new_sums(kit.gpu, level.placement)
        made.append(Cascade(level, propagate, sums, static, injected, small))
    return made


def _small(placements: list[Placement], index: int, settings: LpvSettings) -> SmallObjects:
    """The objects that a lattice leaves out because they are smaller than its cells."""
    if settings.small_objects == "none":
        return EVERYTHING

    # A lattice leaves out what is smaller than its own cells; the finest leaves out nothing.
    cells = [0.0, *(placement.cell for placement in placements[1:]), 0.0]
    return SmallObjects(cells[index], cells[index + 1], has_static=settings.small_objects == "all")
