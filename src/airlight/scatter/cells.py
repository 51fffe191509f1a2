"""What the cells of a lattice hold: the reduced media, and the walls between them.

reduced media -> homogeneous: one sigma_s, sigma_t      varied: their means over each cell
blockers      -> reflectance of each cell's walls, visibility of its hops
"""

from __future__ import annotations

import dataclasses
from typing import Any

import numpy as np

from ..gpu.commands import Commands
from ..gpu.device import Gpu
from ..gpu.memory import Buffer
from ..lattice.blockers import Blockers
from ..lattice.lattices import Level
from ..lattice.placement import Placement
from ..scene.scene import Scene
from .cell_medium import CellMedium
from .hop_visibility import CellReflectance
from .reduced_media import ReducedMedia
from .settings import ScatterSettings, densest_medium
from .state_sum import LatticeKind, StateSum
from .surface_light import NO_MEDIUM, SurfaceMedium


class LatticeCells:
    """The media and walls of one lattice, updated where they changed or the lattice moved."""

    def __init__(
        self,
        gpu: Gpu,
        level: Level,
        media: ReducedMedia,
        settings: ScatterSettings,
        *,
        is_varied: bool,
    ) -> None:
        """`is_varied`: whether the media differ from cell to cell."""
        cells = level.placement.cells
        self._level, self._settings = level, settings
        self.media, self.is_varied = media, is_varied
        # A homogeneous medium is one row of coefficients for all cells, which need no means then.
        self._means = CellMedium(gpu, media.lights) if is_varied else None
        self._medium = Buffer(gpu, "medium of cells", 3 * cells * 8 if is_varied else 16)
        self._reflectances = CellReflectance(gpu)
        self._reflectance = Buffer(gpu, "reflectance of cells", cells * 4)
        self.surface_medium = NO_MEDIUM
        self._media_of: tuple[Any, ...] = ()
        self._walls_version = -1

    @property
    def placement(self) -> Placement:
        """Where the cells are now."""
        return self._level.placement

    @property
    def blockers(self) -> Blockers:
        """What blocks between them."""
        return self._level.blockers

    def kind(self, scene: Scene, inner: Placement) -> LatticeKind:
        """What propagation must know of these cells; settings as for solving `scene`.

        Light goes on in the largest lattice over surfaces, `inner`, if that is larger.
        """
        # Light keeps straighter the more cells it has around it, beyond the lattice, too.
        extents = [max(place.count) * place.cell for place in (inner, self.placement)]
        scheme = self._settings.scheme
        return LatticeKind(
            has_walls=self._settings.occlusion,
            is_varied=self.is_varied,
            scheme=scheme if scheme.startswith("paper") else "deposit",
            is_clear=not any(densest_medium(scene)[1]),
            span=round(max(extents) / self.placement.cell),
        )

    @property
    def reflectance(self) -> Buffer | None:
        """Of the walls in each cell, rgb unorm8 in a u32; None where walls do not count."""
        return self._reflectance if self._settings.occlusion else None

    def take_media(self, commands: Commands, states: StateSum) -> bool:
        """Take on the media, which are up to date, and hand them to `states`; whether they changed.

        Raises SettingsError (scheme paper in a dense medium).
        """
        # The coefficients of a homogeneous medium are the same wherever the lattice is.
        media, placement = self.media, dataclasses.replace(self.placement, fade=None)
        known = (media.version, placement if self._means else None)
        if known == self._media_of:
            return False
        self._media_of = known
        # One medium for all cells is a row of coefficients; else each cell has its own.
        if self._means is None:
            self.surface_medium = SurfaceMedium(media.sigma_s, media.sigma_t)
            states.set_homogeneous(media.sigma_s, media.sigma_t)
        else:
            self.surface_medium = SurfaceMedium(cells=self._medium)
            self._means.encode(commands, placement, self._medium, self._samples())
            states.set_varied(self._medium)
        return True

    def take_walls(self, commands: Commands, states: StateSum) -> bool:
        """Update the walls and hand them to `states`; whether they changed."""
        version = self.blockers.version
        # Walls that stay as they were are known already.
        if version == self._walls_version:
            return False
        self._walls_version = version
        # Without `occlusion` every hop is open.
        if self._settings.occlusion:
            self._reflectances.encode(
                commands, self.placement.count, self.blockers.faces, self._reflectance
            )
            states.set_walls(commands, self.blockers.face_visibility, self._reflectance)
        return True

    def _samples(self) -> int:
        """Sample points per cell and axis: one per voxel of the finest grid, within reason."""
        fine = self.placement.cell / self.media.lights.finest_voxel_m
        return int(min(max(np.ceil(fine), 3), 6))
