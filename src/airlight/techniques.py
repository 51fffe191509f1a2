"""Techniques by name.

direct   lights with shadows, emission and sky; no bounced light
lpv      light propagation volumes (Kaplanyan2010)
auto     the best there is so far: lpv
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, Protocol

from .errors import SettingsError, nearest
from .gpu.commands import Commands
from .gpu.device import Gpu
from .gpu.memory import Texture
from .lighting.direct import Direct
from .lighting.view import View
from .lpv.lpv import Lpv
from .scene.scene import Scene
from .scene.settings import make_settings
from .surface.geometry import GpuScene


class Technique(Protocol):
    """A solver of the whole picture; made once, then used for any number of frames."""

    def solve(self, commands: Commands, scene: Scene) -> None:
        """Everything that does not depend on the camera."""

    def draw(self, commands: Commands, view: View) -> None:
        """Write `view.layers`."""

    def pictures(self, view: View) -> dict[str, Texture]:
        """The radiance layers that `draw` writes, by name; they add up to the picture."""

    @property
    def stats(self) -> dict[str, Any]:
        """What was solved."""

    def release(self) -> None:
        """Give the memory back."""


TECHNIQUES: dict[str, type[Direct]] = {"direct": Direct, "lpv": Lpv}
DEFAULT = "lpv"


def technique_class(name: str) -> type[Direct]:
    """The class of a technique. Raises SettingsError naming the nearest."""
    known = {**TECHNIQUES, "auto": TECHNIQUES[DEFAULT]}
    if name not in known:
        raise SettingsError(f"unknown technique '{name}'", remedy=nearest(name, known))
    return known[name]


def make_technique(
    gpu: Gpu, scene: Scene, meshes: GpuScene, name: str, settings: Mapping[str, Any]
) -> Technique:
    """The technique `name` for `scene`: the scene file's settings, then `settings` over them.

    Raises SettingsError for an unknown technique or setting.
    """
    cls = technique_class(name)
    merged = {**scene_settings(scene, name), **settings}
    return cls(gpu, scene, meshes, make_settings(cls.Settings, merged, where=f"technique {name}"))


def scene_settings(scene: Scene, name: str) -> Mapping[str, Any]:
    """What the scene file says under [technique.NAME]; for `auto`, also what it stands for."""
    if name == "auto":
        return {**scene.settings.get(DEFAULT, {}), **scene.settings.get("auto", {})}
    return scene.settings.get(name, {})
