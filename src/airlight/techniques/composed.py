"""The technique `auto`: the solvers that suit a scene, together in one frame.

surfaces  no air: lpv; air: lpv-scatter, whose lattice carries bounced and scattered light
volumes   lit by suns and sky alone: pop, a solver each, marched as sources; else they are part
          of the lattice's air
"""

from __future__ import annotations

from dataclasses import dataclass, fields, replace
from typing import Any

import numpy as np

from ..gpu.commands import Commands
from ..gpu.device import Gpu
from ..gpu.memory import Texture
from ..lighting.direct import Direct, SurfaceSettings
from ..lighting.view import View
from ..lpv.lpv import Lpv, LpvSettings
from ..march.march import MAX_SOURCES, Source
from ..pop.solver import PopSettings, PopSolver, sun_count
from ..scene.lights import DirectionalLight
from ..scene.scene import Scene
from ..scene.volume import Volume
from ..surface.geometry import GpuScene
from .air import InAir, LpvMarchSettings, LpvScatter, LpvScatterSettings


@dataclass(frozen=True)
class AutoSettings(SurfaceSettings):
    """What every technique for surfaces knows; the solvers take their defaults."""


class _LpvWithVolumes(InAir, Lpv):
    """Bounced light on a lattice; volumes by principal ordinates."""

    Settings = LpvMarchSettings


class Auto:
    """Chooses at creation; then does as the chosen technique does."""

    Settings = AutoSettings

    def __init__(
        self, gpu: Gpu, scene: Scene, meshes: GpuScene, settings: AutoSettings,
        size: tuple[int, int],
    ) -> None:  # fmt: skip
        self.chosen = _chosen(gpu, scene, meshes, settings, size)

    def solve(self, commands: Commands, scene: Scene) -> None:
        """Everything that does not depend on the camera."""
        self.chosen.solve(commands, scene)

    def draw(self, commands: Commands, view: View) -> None:
        """Write the pictures."""
        self.chosen.draw(commands, view)

    def pictures(self, view: View) -> dict[str, Texture]:
        """The radiance layers that `draw` writes."""
        return self.chosen.pictures(view)

    @property
    def stats(self) -> dict[str, Any]:
        """What was chosen and solved."""
        return {"chosen": type(self.chosen).__name__, **self.chosen.stats}

    def release(self) -> None:
        """Give the memory back."""
        self.chosen.release()


def _with_pop(base: type[Direct]) -> type[Direct]:
    """`base` (a technique in air) with the scene's volumes solved by principal ordinates."""

    class WithPop(base):  # type: ignore[valid-type,misc]
        def __init__(
            self, gpu: Gpu, scene: Scene, meshes: GpuScene, settings: Any, size: tuple[int, int]
        ) -> None:
            self.source_count = len(scene.volumes)
            super().__init__(gpu, scene, meshes, settings, size)
            self._scene = scene
            grids = iter(self.air_light.air.grids)
            suns = sun_count(scene.lights)
            self.solvers = [
                PopSolver(gpu, volume, PopSettings(), suns=suns,
                          voxels=next(grids) if volume.density is not None else None)
                for volume in scene.volumes
            ]  # fmt: skip

        def solved(self, scene: Scene) -> tuple[Volume, ...]:
            return scene.volumes

        def lattice_scene(self, scene: Scene) -> Scene:
            return replace(scene, volumes=())

        def sources(self) -> list[Source]:
            first = int(self._scene.medium is not None)
            return [solver.source(first + i) for i, solver in enumerate(self.solvers)]

        def solve(self, commands: Commands, scene: Scene) -> None:
            self._scene = scene
            super().solve(commands, scene)

        def draw(self, commands: Commands, view: View) -> None:
            scene, eye = self._scene, np.asarray(view.eye)
            for solver, volume in zip(self.solvers, scene.volumes, strict=True):
                solver.encode(commands, scene.lights, scene.environment, eye, volume)
            super().draw(commands, view)

        def release(self) -> None:
            super().release()
            for solver in self.solvers:
                solver.release()

    return WithPop


def _chosen(
    gpu: Gpu, scene: Scene, meshes: GpuScene, settings: AutoSettings, size: tuple[int, int]
) -> Direct:
    common = {f.name: getattr(settings, f.name) for f in fields(settings)}
    if scene.medium is None and not scene.volumes:
        return Lpv(gpu, scene, meshes, LpvSettings(**common), size)
    is_distant = all(isinstance(light, DirectionalLight) for light in scene.lights)
    by_pop = scene.volumes and is_distant and len(scene.volumes) <= MAX_SOURCES
    if by_pop and scene.medium is None:
        return _with_pop(_LpvWithVolumes)(gpu, scene, meshes, LpvMarchSettings(**common), size)
    scatter = LpvScatterSettings(**common)
    if by_pop:
        return _with_pop(LpvScatter)(gpu, scene, meshes, scatter, size)
    return LpvScatter(gpu, scene, meshes, scatter, size)
