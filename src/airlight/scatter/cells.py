"""What the cells of a lattice hold: the reduced media, and the walls between them.

scene's media -> reduced media (similarity theory) -> on the device, for its lights and the sky's
                                       |
             homogeneous: one sigma_s, sigma_t      varied: their means over each cell
blockers -> reflectance of each cell's walls, visibility of its hops
"""

from __future__ import annotations

import dataclasses

import numpy as np

from ..fields import Frame
from ..gpu.commands import Commands
from ..gpu.memory import Buffer
from ..lighting.kit import Kit
from ..media.gpu_media import GpuMedia
from ..scene.scene import Scene
from .cell_medium import CellMedium
from .hop_visibility import CellReflectance
from .level import LatticeKind
from .levels import Levels
from .reduced import is_forward, reduced_scene
from .settings import ScatterSettings, densest_medium, is_varied
from .surface_light import NO_MEDIUM, SurfaceMedium

_SKY_COLUMNS = 16  # texels along a density grid's columns towards each sky light


class LatticeCells:
    """The media and walls of one lattice, updated where they changed."""

    def __init__(self, kit: Kit, scene: Scene, settings: ScatterSettings) -> None:
        """Raises SettingsError where the scheme cannot do the scene's media."""
        gpu, cells = kit.gpu, kit.placement.cells
        self._kit, self._settings = kit, settings
        self.placement, self._blockers = kit.placement, kit.blockers
        self.is_varied = is_varied(scene, kit.placement, settings)
        # Light is attenuated towards the scene's lights and towards those that stand for the sky.
        reduced = reduced_scene(scene)
        self.media = GpuMedia(gpu, reduced, light_count=kit.lights.count)
        self.sky_media = GpuMedia(
            gpu,
            self._under_sky(reduced),
            light_count=sky_capacity(kit),
            column_resolution=_SKY_COLUMNS,
        )
        self._means = CellMedium(gpu, self.media) if self.is_varied else None
        self._medium = Buffer(gpu, "medium of cells", 3 * cells * 8 if self.is_varied else 16)
        self._reflectances = CellReflectance(gpu)
        self._reflectance = Buffer(gpu, "reflectance of cells", cells * 4)
        self.has_forward = self.is_reduced = False
        self.surface_medium, self.densest = NO_MEDIUM, NO_MEDIUM.sigma_t
        self._media_version = self._walls_version = -1

    def kind(self, scene: Scene) -> LatticeKind:
        """What propagation must know of these cells; settings as for solving `scene`."""
        scheme = self._settings.scheme
        return LatticeKind(
            has_walls=self._settings.occlusion,
            is_varied=self.is_varied,
            scheme=scheme if scheme.startswith("paper") else "deposit",
            is_straight=any(densest_medium(scene)[1]),
        )

    @property
    def reflectance(self) -> Buffer | None:
        """Of the walls in each cell, rgb unorm8 in a u32; None where walls do not count."""
        return self._reflectance if self._settings.occlusion else None

    def take_media(self, commands: Commands, frame: Frame, levels: Levels) -> bool:
        """Update the media and hand them to `levels`; whether they changed.

        Raises SettingsError (scheme paper in a dense medium).
        """
        reduced = reduced_scene(frame.scene)
        self.has_forward = is_forward(frame.scene)
        self.is_reduced = is_forward(frame.scene, least=0.0)
        self.media.update(commands, reduced, *frame.bounds)
        self.sky_media.update(commands, self._under_sky(reduced), *frame.bounds)
        if self.media.version == self._media_version:
            return False
        self._media_version = self.media.version
        sigma_s, self.densest = densest_medium(reduced)
        # One medium for all cells is a row of coefficients; else each cell has its own.
        if self._means is None:
            self.surface_medium = SurfaceMedium(sigma_s, self.densest)
            levels.set_homogeneous(sigma_s, self.densest)
        else:
            self.surface_medium = SurfaceMedium(cells=self._medium)
            self._means.encode(commands, self.placement, self._medium, self._samples())
            levels.set_varied(commands, self._medium)
        return True

    def take_walls(self, commands: Commands, levels: Levels) -> bool:
        """Update the walls and hand them to `levels`; whether they changed."""
        version = self._kit.meshes.version
        if version == self._walls_version:
            return False
        self._walls_version = version
        if self._settings.occlusion:
            self._reflectances.encode(
                commands, self.placement.count, self._blockers.faces, self._reflectance
            )
            levels.set_walls(commands, self._blockers.face_visibility, self._reflectance)
        return True

    def _under_sky(self, reduced: Scene) -> Scene:
        """The reduced media under the lights that stand for the sky."""
        return dataclasses.replace(reduced, lights=tuple(self._kit.sky.lights))

    def _samples(self) -> int:
        """Sample points per cell and axis: one per voxel of the finest grid, within reason."""
        fine = self.placement.cell / self.media.finest_voxel_m
        return int(min(max(np.ceil(fine), 3), 6))


def sky_capacity(kit: Kit) -> int:
    """The most lights that will ever stand for the sky: a turning sky may bring more."""
    return max(len(kit.sky.lights), kit.sky.maps.layers)
