"""One lattice among nested ones: what its cells hold, what enters them, and what solves them.

All share the media, the lights with their maps, and the textures that surfaces and media read.
"""

from __future__ import annotations

from dataclasses import dataclass

from ..gpu.commands import Commands
from ..lattice.lattices import Level
from ..lattice.placement import Placement
from ..lighting.kit import Kit
from ..media.reduced import reduced_scene
from ..scene.scene import Scene
from .cells import LatticeCells
from .entering_light import EnteringLight
from .injection import Injection
from .schedule import Schedule, iterations_to, region_steps_to, schedule
from .settings import ScatterSettings, densest_medium, is_varied, iterations_of
from .state_sum import StateSum


@dataclass(frozen=True, eq=False)
class Cascade:
    """A lattice: `cells` with media and walls, `injection` of light, `states` that solve it."""

    level: Level
    cells: LatticeCells
    injection: Injection
    states: StateSum
    plans: tuple[Schedule, Schedule]  # of frames, of stills

    @property
    def placement(self) -> Placement:
        """Where its cells are."""
        return self.level.placement

    def take(self, commands: Commands) -> bool:
        """Take on media and walls, which are up to date; whether they changed or it moved.

        Raises SettingsError (scheme paper in a dense medium).
        """
        # What the lattice's cells hold: the reduced media, and the walls between them.
        with commands.stage("air"):
            is_new = self.cells.take_media(commands, self.states)
        with commands.stage("prepare blockers"):
            return self.cells.take_walls(commands, self.states) or is_new


def cascades(
    kit: Kit, scene: Scene, settings: ScatterSettings, light: EnteringLight
) -> list[Cascade]:
    """All lattices of `kit`, the finest first, nothing in them yet.

    Raises SettingsError where the scheme cannot do the scene's media.
    """
    gpu, made = kit.gpu, []
    # Where the medium varies in any lattice, the cells of all have coefficients of their own.
    inner = kit.lattices.nest.over_inner
    varies = any(is_varied(scene, place, settings) for place in (inner, kit.placement))
    for level in kit.lattices.levels:
        placement = level.placement
        cells = LatticeCells(gpu, level, light.media, settings, is_varied=varies)
        reduced = reduced_scene(scene)
        # Stills may take more iterations than frames.
        frames, stills = (
            _schedule(reduced, settings, placement, is_still=s) for s in (False, True)
        )
        states = StateSum(gpu, placement.count, placement.cell, frames, cells.kind(scene, inner))
        # What fills its cells with light, and what spreads that.
        injection = Injection(kit, scene, light, cells)
        made.append(Cascade(level, cells, injection, states, (frames, stills)))
    return made


def _schedule(
    reduced: Scene, settings: ScatterSettings, placement: Placement, *, is_still: bool
) -> Schedule:
    s, count = settings, placement.count
    # The paper has one lattice.
    faster = "none" if s.scheme.startswith("paper") else s.acceleration
    # As many iterations as were asked for, or as leave the residual that was.
    sigma_s, sigma_t = densest_medium(reduced)
    steps = iterations_of(s, is_still=is_still)
    if s.residual > 0.0 and faster == "regions":
        steps = region_steps_to(s.residual)
    elif s.residual > 0.0:
        steps = iterations_to(s.residual, sigma_s, sigma_t, placement.cell, count)
    return schedule(faster, steps)
