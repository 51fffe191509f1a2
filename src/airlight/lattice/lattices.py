"""All lattices of a scene: their placement, blockers, and the sky's light in their cells.

One lattice covers the surfaces, and may have an outer one around it for a medium that goes on far
beyond them; neither moves. Finer ones may be nested in it and follow the camera (Kaplanyan2010
section 4). All share textures, in which each has rows of its own, and the table that shaders loop
over, the finest first. Every solver works on these cells.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from ..gpu.commands import Commands
from ..gpu.device import Gpu
from ..gpu.memory import Texture
from ..scene.camera import Camera
from ..scene.scene import Scene
from ..surface.geometry import GpuScene
from .blockers import Blockers
from .nested import Nest, faded, must_move, snapped, wanted_centre
from .placement import Placement
from .skylight import Skylight
from .table import LatticeTable


@dataclass(eq=False)
class Level:
    """One lattice: its placement, its blockers, the sky's light in its cells."""

    placement: Placement
    blockers: Blockers
    skylight: Skylight
    lit: tuple[int, int] | None = None  # the versions of sky and blockers when it was last lit

    def move_to(self, placement: Placement) -> None:
        """Move the lattice; blockers and sky light are updated when they are encoded."""
        self.placement = placement
        self.blockers.move_to(placement)
        self.skylight.placement = placement


class BlockerSource(Protocol):
    """Fills the blockers of all lattices instead of the surfels of meshes."""

    def encode(self, commands: Commands, scene: Scene) -> None:
        """Update the blockers; those that change raise their version."""


class MakeBlockers(Protocol):
    """Makes the blockers of the largest lattice."""

    def __call__(
        self,
        gpu: Gpu,
        scene: Scene,
        meshes: GpuScene,
        placement: Placement,
        count: int,
        *,
        size: tuple[int, int, int],
    ) -> Blockers:
        """As `Blockers`."""


class Lattices:
    """The lattices of one scene, the finest first.

    `source` fills the blockers where surfels of meshes do not.
    """

    def __init__(
        self,
        gpu: Gpu,
        scene: Scene,
        meshes: GpuScene,
        nest: Nest,
        *,
        surfels: int,
        sky_lights: int,
        make_blockers: MakeBlockers = Blockers,
    ) -> None:
        """`surfels`: samples of all surfaces. `sky_lights`: the most there may be."""
        self.nest, self.texture_size = nest, nest.texture_size
        # The largest lattice owns what all share: surfels, and textures with rows for each.
        placement = nest.levels[-1]
        blockers = make_blockers(gpu, scene, meshes, placement, surfels, size=self.texture_size)
        skylight = Skylight(gpu, placement, sky_lights, size=self.texture_size)
        self.levels = [
            Level(
                finer,
                Blockers(gpu, scene, meshes, finer, 0, owner=blockers),
                Skylight(gpu, finer, sky_lights, owner=skylight),
            )
            for finer in nest.levels[:-1]
        ]
        self.levels.append(Level(placement, blockers, skylight))
        self.table = LatticeTable(gpu, len(self.levels))
        self.source: BlockerSource | None = None
        self._is_first = True
        self._settled_for: Camera | None = None

    @property
    def largest(self) -> Level:
        """The lattice that covers the scene; its blockers and sky own the shared textures."""
        return self.levels[-1]

    @property
    def placements(self) -> tuple[Placement, ...]:
        """The placements of all lattices, the finest first."""
        return tuple(level.placement for level in self.levels)

    @property
    def cube(self) -> Texture:
        """The ambient cubes of the sky's light in all cells."""
        return self.largest.skylight.cube

    def follow(self, camera: Camera) -> None:
        """Move the lattices to where `camera` wants them."""
        if camera != self._settled_for:
            is_settled = follow(self.nest, self.levels, camera, is_first=self._is_first)
            self._settled_for = camera if is_settled else None
            self._is_first = False

    def encode(self, commands: Commands, scene: Scene) -> None:
        """Update the blockers of all lattices."""
        # Blockers from elsewhere replace those of the surfels.
        if self.source is not None:
            self.source.encode(commands, scene)
            return

        # Rooms first, since they turn surfels that all lattices share.
        self.largest.blockers.find_rooms(scene)
        for level in self.levels:
            level.blockers.encode(commands)


def follow(nest: Nest, levels: Sequence[Level], camera: Camera, *, is_first: bool) -> bool:
    """Move the lattices (the finest first) to where the camera wants them.

    One of them at most, but for those whose cells would no longer reach what is read of them.
    Returns whether all are where it wants them: then the same camera moves none.
    """
    eye = np.asarray(camera.position, np.float64)
    look = np.subtract(camera.target, camera.position)
    # A lattice that moves is filled again: one a frame, where its borders are not read yet.
    may_move = is_settled = True
    for index, level in enumerate(levels):
        if not nest.follows(index):
            continue

        # Where the camera wants it, on its grid, and whether that is another place.
        centre = wanted_centre(nest, index, eye, look)
        now = snapped(nest, index, centre, None if is_first else level.placement)
        moves = now.origin != level.placement.origin
        if moves and not (may_move or is_first or must_move(level.placement, centre)):
            now, moves, is_settled = level.placement, False, False
        may_move = may_move and not moves

        # Fading follows the camera in every frame, even where cells wait.
        level.move_to(faded(nest, index, now, centre))
    return is_settled
