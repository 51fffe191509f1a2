"""Blockers as the paper has them: from what the camera and the lights see (Kaplanyan2010, 3.2)."""

from __future__ import annotations

from collections.abc import Sequence

from ..gpu.commands import Commands
from ..gpu.device import Gpu
from ..lattice.blockers import Blockers
from ..maths.transforms import F64
from ..scene.scene import Scene
from ..surface.geometry import GpuScene
from ..surface.light_views import light_views, view_count
from ..surface.surfel_views import SurfelViews, camera_view
from .geometry_volume import GeometryVolume


class SeenBlockers:
    """A geometry volume for each lattice, all filled from the same views."""

    def __init__(
        self, gpu: Gpu, scene: Scene, blockers: Sequence[Blockers], *, resolution: int,
        peels: int, keeps: bool, aspect: float,
    ) -> None:  # fmt: skip
        """Maps of `resolution` texels, `peels` layers each; `aspect` of the picture."""
        self._aspect = aspect
        count = 1 + sum(view_count(light) for light in scene.lights)
        self.maps = SurfelViews(gpu, resolution, count, peels)
        self.volumes = [GeometryVolume(gpu, of, keeps=keeps) for of in blockers]

    def encode(
        self, commands: Commands, meshes: GpuScene, scene: Scene, low: F64, high: F64
    ) -> list[bool]:
        """Bring the blockers of all lattices up to date; returns which of them changed."""
        side = self.maps.resolution
        views = [camera_view(scene.camera, self._aspect, low, high, side)]
        views += light_views(scene.lights, low, high, side)
        is_drawn = self.maps.encode(commands, meshes, views)
        return [
            volume.encode(commands, meshes, self.maps, views, is_drawn=is_drawn)
            for volume in self.volumes
        ]

    def release(self) -> None:
        """Give the memory back."""
        self.maps.release()
        for volume in self.volumes:
            volume.release()
