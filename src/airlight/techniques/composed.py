"""The technique `auto`: the solvers that suit a scene, together in one frame.

surfaces  no air: lpv; air: lpv-scatter, whose lattice carries bounced and scattered light
volumes   lit by suns and sky alone: pop, a solver each, marched as sources; else they are part
          of the lattice's air
"""

from __future__ import annotations

from dataclasses import dataclass, fields
from typing import Any

from ..gpu.commands import Commands
from ..gpu.device import Gpu
from ..gpu.memory import Texture
from ..lighting.direct import Direct, SurfaceSettings
from ..lighting.view import View
from ..lpv.lpv import Lpv, LpvSettings
from ..scene.lights import DirectionalLight
from ..scene.scene import Scene
from ..surface.geometry import GpuScene

_MOST_SOLVED = 4  # volumes that can be marched as sources of their own


@dataclass(frozen=True)
class AutoSettings(SurfaceSettings):
    """What every technique for surfaces knows; the solvers take their defaults."""


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

    def resize(self, size: tuple[int, int]) -> None:
        """Go on with pictures of `size`, pixels."""
        self.chosen.resize(size)

    @property
    def stats(self) -> dict[str, Any]:
        """What was chosen and solved."""
        return {"chosen": type(self.chosen).__name__, **self.chosen.stats}

    def release(self) -> None:
        """Give the memory back."""
        self.chosen.release()


def _chosen(
    gpu: Gpu, scene: Scene, meshes: GpuScene, settings: AutoSettings, size: tuple[int, int]
) -> Direct:
    common = {f.name: getattr(settings, f.name) for f in fields(settings)}
    if scene.medium is None and not scene.volumes:
        return Lpv(gpu, scene, meshes, LpvSettings(**common), size)
    from .air import LpvMarchSettings, LpvScatter, LpvScatterSettings, LpvWithVolumes

    is_distant = all(isinstance(light, DirectionalLight) for light in scene.lights)
    if not scene.volumes or not is_distant or len(scene.volumes) > _MOST_SOLVED:
        return LpvScatter(gpu, scene, meshes, LpvScatterSettings(**common), size)
    from .with_pop import with_pop

    if scene.medium is None:
        base, own = LpvWithVolumes, LpvMarchSettings(**common)
        return with_pop(base)(gpu, scene, meshes, own, size)
    return with_pop(LpvScatter)(gpu, scene, meshes, LpvScatterSettings(**common), size)
