"""Blockers from the surfels that camera and lights see (Kaplanyan2010, 3.2), in both schemes."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial

from ..gpu.commands import Commands
from ..gpu.device import Gpu
from ..lattice.blockers import Blockers
from ..lattice.view_surfels import ViewBlockers, ViewSurfels
from ..lighting.kit import Kit
from ..scene.scene import Scene
from ..surface.light_views import light_views, view_count
from ..surface.surfel_views import SurfelViews, camera_view
from .geometry_volume import GeometryVolume
from .settings import LpvSettings


class SeenBlockers:
    """The blockers of each lattice of a kit, all filled from the same views."""

    def __init__(self, kit: Kit, settings: LpvSettings) -> None:
        """In scheme paper as spherical harmonics; else surfels, with the meshes' own if asked."""
        self._kit = kit
        width, height = kit.context.size
        self._aspect = width / height
        # One view for the camera, and those of each light's shadow maps.
        count = 1 + sum(view_count(light) for light in kit.context.scene.lights)
        resolution, peels = settings.surfel_resolution, settings.peel_layers
        self.maps = SurfelViews(kit.gpu, resolution, count, peels)
        accumulates, source = settings.keep_surfels, settings.surfel_source

        # The paper's volumes of harmonics, or sums by faces.
        volume: Callable[[Gpu, Blockers], ViewBlockers] = (
            partial(GeometryVolume, accumulates=accumulates)
            if settings.scheme == "paper"
            else partial(ViewSurfels, accumulates=accumulates, has_meshes=source == "both")
        )
        self.volumes = [volume(kit.gpu, level.blockers) for level in kit.lattices.levels]

    def encode(self, commands: Commands, scene: Scene) -> None:
        """Bring the blockers of all lattices up to date."""
        # Peeled views of the camera and of each light.
        low, high = self._kit.bounds(scene)
        side = self.maps.resolution
        views = [camera_view(scene.camera, self._aspect, low, high, side)]
        views += light_views(scene.lights, low, high, side)
        is_drawn = self.maps.encode(commands, self._kit.meshes, views)
        # Their surfels, into each lattice.
        for volume in self.volumes:
            volume.blockers.follow_vertices()  # samples of the meshes themselves
            volume.encode(commands, self._kit.meshes, self.maps, views, is_drawn=is_drawn)
