"""The technique `auto`: the solvers that suit a scene, together in one frame.

surfaces  no air: lpv; air: lpv-scatter, whose lattice carries bounced and scattered light
volumes   pop, a solver each for the light of suns, lamps and sky, marched as sources; light that
          surfaces reflect into them comes from the lattice, which they dim and add to
          (`volumes`). Part of the lattice's air where there are more than four, or where a box or
          ball takes much of a lamp's light from the room: there single scattering is exact (a
          thick ball in the Cornell box: relative L2 error of its light .21, by pop .33; of density
          grids pop has the smaller error, .27 where the lattice's air has .55)
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, fields, make_dataclass
from functools import cache
from typing import Any

import numpy as np

from ..gpu.commands import Commands
from ..gpu.device import Gpu
from ..gpu.memory import Texture
from ..lighting.direct import Direct, SurfaceSettings
from ..lighting.view import View
from ..lpv.lpv import Lpv
from ..maths.transforms import F64
from ..pop.settings import PopSettings
from ..scene.lights import DirectionalLight
from ..scene.scene import Scene, volume_world_bounds
from ..scene.volume import Volume
from ..surface.geometry import GpuScene

_MOST_SOLVED = 4  # volumes that can be marched as sources of their own
_SHADED_SHARE = 0.05


@dataclass(frozen=True)
class AutoSettings(SurfaceSettings):
    """What it can be told whatever it chooses; `Auto.settings_for` knows what more for a scene."""


@dataclass(frozen=True)
class Choice:
    """What suits a scene. `name`: of the technique whose settings it takes; `make` is one's class,
    or makes one as a class would.
    """

    name: str
    settings: type[SurfaceSettings]
    make: Callable[..., Direct]


class Auto:
    """Chooses at creation; then does as the chosen technique does."""

    Settings = AutoSettings

    def __init__(
        self, gpu: Gpu, scene: Scene, meshes: GpuScene, settings: SurfaceSettings,
        size: tuple[int, int],
    ) -> None:  # fmt: skip
        choice = choice_for(scene)
        given = {f.name: getattr(settings, f.name) for f in fields(settings)}
        self.chosen = choice.make(gpu, scene, meshes, choice.settings(**given), size)

    @staticmethod
    def settings_for(scene: Scene) -> tuple[str, type[SurfaceSettings]]:
        """The name of the technique that suits the scene, and what it can be told."""
        choice = choice_for(scene)
        return choice.name, choice.settings

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


def choice_for(scene: Scene) -> Choice:
    """What `auto` takes for a scene."""
    if scene.medium is None and not scene.volumes:
        return Choice("lpv", Lpv.Settings, Lpv)
    from .air import LpvScatter

    is_air = len(scene.volumes) > _MOST_SOLVED or _shades_a_room(scene)
    if not scene.volumes or is_air:
        return Choice("lpv-scatter", LpvScatter.Settings, LpvScatter)
    from .volumes import LpvWithVolumes
    from .with_pop import with_pop

    name, base = ("lpv", LpvWithVolumes) if scene.medium is None else ("lpv-scatter", LpvScatter)
    return Choice(f"{name} with pop", _joined(base.Settings, PopSettings), with_pop(base))


@cache
def _joined(base: type[SurfaceSettings], more: type) -> type[SurfaceSettings]:
    """Settings of both; where both have a name it means the first one's."""
    own = {f.name for f in fields(base)}
    added: list[tuple[str, Any, Any]] = [
        (f.name, f.type, field(default=f.default, metadata=f.metadata))
        for f in fields(more) if f.name not in own
    ]  # fmt: skip
    return make_dataclass(f"{base.__name__}And{more.__name__}", added, bases=(base,), frozen=True)


def _shades_a_room(scene: Scene) -> bool:
    """Whether a volume takes more than a few percent of the lamps' light from the surfaces.

    Density grids do not count where the lattice is lpv's: it knows them.
    """
    if all(isinstance(light, DirectionalLight) for light in scene.lights) or not scene.meshes:
        return False
    low, high = scene.bounds
    room = _section(high - low)
    is_even = [scene.medium is not None or v.density is None for v in scene.volumes]
    shapes = [volume for volume, even in zip(scene.volumes, is_even, strict=True) if even]
    return any(_shading(volume) > _SHADED_SHARE * room for volume in shapes)


def _shading(volume: Volume) -> float:
    """About how much a volume's box stops: its section, m^2, times the share it takes."""
    low, high = volume_world_bounds(volume)
    density = 1.0 if volume.density is None else float(volume.density.mean())
    depth = max(volume.sigma_t) * density * float(np.cbrt(np.prod(high - low)))
    return _section(high - low) * -float(np.expm1(-depth))


def _section(size: F64) -> float:
    """Mean area of a box's sides, m^2."""
    x, y, z = size
    return float(x * y + y * z + z * x) / 3.0
