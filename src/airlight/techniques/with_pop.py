"""Volumes solved by principal ordinates inside another technique in air."""

from __future__ import annotations

from dataclasses import fields, replace
from typing import Any

import numpy as np

from ..gpu.commands import Commands
from ..gpu.device import Gpu
from ..lighting.direct import Direct
from ..lighting.view import View
from ..march.march import Source
from ..pop.bounce import Bounced
from ..pop.importance import Look
from ..pop.reflected_maps import reflected_maps
from ..pop.settings import PopSettings
from ..pop.solver import Frame, PopSolver
from ..pop.together import encode, introduce
from ..pop.visibility import Surfaces
from ..scene.scene import Scene
from ..scene.volume import Volume
from ..surface.geometry import GpuScene


def with_pop(base: type[Direct]) -> type[Direct]:
    """`base` (a technique in air) with the scene's volumes solved by principal ordinates."""

    class WithPop(base):  # type: ignore[valid-type,misc]
        def __init__(
            self, gpu: Gpu, scene: Scene, meshes: GpuScene, settings: Any, size: tuple[int, int]
        ) -> None:
            self.source_count = len(scene.volumes)
            super().__init__(gpu, scene, meshes, settings, size)
            self._scene = scene
            pop = _pop_settings(settings, base.Settings)
            self._maps = reflected_maps(scene, pop, self, self.air_light.air)
            virtual = self._maps.reflected if self._maps else None
            surfaces = Surfaces(meshes, self.lights, self.sky, virtual, self.blockers)
            self._surfaces = surfaces if scene.meshes else None
            grids = iter(self.air_light.air.grids)
            self.solvers = [
                PopSolver(gpu, volume, pop, lights=len(scene.lights) + surfaces.virtual_lights,
                          voxels=next(grids) if volume.density is not None else None,
                          others=len(scene.volumes) - 1)
                for volume in scene.volumes
            ]  # fmt: skip
            introduce(self.solvers)

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
            if self._maps:
                with commands.stage("reflective shadow maps"):
                    self._maps.encode(commands, self.meshes, scene.lights, *self._bounds(scene))

        def draw(self, commands: Commands, view: View) -> None:
            scene, eye = self._scene, np.asarray(view.eye)
            look = Look(view.camera, view.size[0] / view.size[1])
            frame = Frame(scene.lights, scene.environment, np.asarray(eye, np.float64),
                          self._surfaces, self._bounced(), look)  # fmt: skip
            encode(commands, self.solvers, scene.volumes, frame)
            super().draw(commands, view)

        def _bounced(self) -> Bounced | None:
            """What surfaces reflect, and fog scatters, into the volumes."""
            scene, source = self._scene, self.bounced_source()
            version = (scene.lights, scene.environment, scene.medium, self.meshes.version)
            if source is None or not scene.meshes or self._maps:
                return None
            return Bounced(source, version, knows_media=self.volumes_in_lattice)

        def release(self) -> None:
            super().release()
            for part in (*self.solvers, self._maps):
                if part is not None:
                    part.release()

    return WithPop


def _pop_settings(settings: Any, base: type) -> PopSettings:
    """What of the settings is meant for the volumes: names that the technique itself lacks."""
    own = {f.name for f in fields(base)}
    names = [f.name for f in fields(PopSettings) if f.name not in own and hasattr(settings, f.name)]
    return PopSettings(**{name: getattr(settings, name) for name in names})
