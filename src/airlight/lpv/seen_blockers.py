"""Blockers from what the camera and the lights see (Kaplanyan2010, 3.2), in both schemes."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial

from ..gpu.commands import Commands
from ..gpu.device import Gpu
from ..lattice.blockers import Blockers
from ..lattice.view_surfels import ViewSurfels
from ..maths.transforms import F64
from ..scene.scene import Scene
from ..surface.geometry import GpuScene
from ..surface.light_views import light_views, view_count
from ..surface.surfel_views import SurfelViews, camera_view
from .geometry_volume import GeometryVolume

SOURCES = ("meshes", "views", "both")
"""Where surfels come from."""


class SeenBlockers:
    """A volume for each lattice, all filled from the same views."""

    def __init__(
        self, gpu: Gpu, scene: Scene, blockers: Sequence[Blockers], *, resolution: int,
        peels: int, keeps: bool, aspect: float, is_paper: bool, source: str,
    ) -> None:  # fmt: skip
        """Maps of `resolution` texels, `peels` layers each; `aspect` of the picture.

        `is_paper`: as spherical harmonics; else with the surfels of the meshes if `source` is
        "both".
        """
        self._aspect = aspect
        count = 1 + sum(view_count(light) for light in scene.lights)
        self.maps = SurfelViews(gpu, resolution, count, peels)
        volume: Callable[[Gpu, Blockers], GeometryVolume | ViewSurfels] = (
            partial(GeometryVolume, keeps=keeps) if is_paper
            else partial(ViewSurfels, keeps=keeps, has_meshes=source == "both")
        )  # fmt: skip
        self.volumes = [volume(gpu, of) for of in blockers]

    def encode(
        self, commands: Commands, meshes: GpuScene, scene: Scene, low: F64, high: F64
    ) -> list[bool]:
        """Bring the blockers of all lattices up to date; returns which of them changed."""
        side = self.maps.resolution
        views = [camera_view(scene.camera, self._aspect, low, high, side)]
        views += light_views(scene.lights, low, high, side)
        is_drawn = self.maps.encode(commands, meshes, views)
        for volume in self.volumes:
            volume.blockers.follow_vertices()  # what glows is sampled from the meshes
        return [
            volume.encode(commands, meshes, self.maps, views, is_drawn=is_drawn)
            for volume in self.volumes
        ]

    def release(self) -> None:
        """Give the memory back."""
        self.maps.release()
        for volume in self.volumes:
            volume.release()
