"""Techniques by name.

direct       lights with shadows, emission and sky; no bounced light, no air
single       the same through air, with light scattered once
lpv          light propagation volumes (Kaplanyan2010); no air
lpv-march    the same, and the lattice marched as if it were lit air
lpv-sum      the sum of lpv-march and single
lpv-scatter  multiple scattering on a lattice (Billeter2012)
pop          principal-ordinates propagation for every medium (Elek2014)
auto         what suits the scene, together in one frame
"""

from __future__ import annotations

import importlib
from collections.abc import Mapping
from typing import Any, Protocol

from ..errors import SettingsError, nearest
from ..gpu.commands import Commands
from ..gpu.device import Gpu
from ..gpu.memory import Texture
from ..lighting.view import View
from ..scene.scene import Scene
from ..scene.settings import make_settings
from ..surface.geometry import GpuScene


class Technique(Protocol):
    """A solver of the whole picture; made once, then used for any number of frames."""

    def solve(self, commands: Commands, scene: Scene) -> None:
        """Everything that does not depend on the camera."""

    def draw(self, commands: Commands, view: View) -> None:
        """Write `view.layers`."""

    def pictures(self, view: View) -> dict[str, Texture]:
        """The radiance layers that `draw` writes, by name; they add up to the picture."""

    def resize(self, size: tuple[int, int]) -> None:
        """Go on with pictures of `size`, pixels; what was solved stays."""

    @property
    def stats(self) -> dict[str, Any]:
        """What was solved."""

    def release(self) -> None:
        """Give the memory back."""


# Imported when asked for: a picture without air needs no code about air.
TECHNIQUES: dict[str, tuple[str, str]] = {
    "direct": ("airlight.lighting.direct", "Direct"),
    "single": ("airlight.techniques.air", "Single"),
    "lpv": ("airlight.lpv.lpv", "Lpv"),
    "lpv-march": ("airlight.techniques.air", "LpvMarch"),
    "lpv-sum": ("airlight.techniques.air", "LpvSum"),
    "lpv-scatter": ("airlight.techniques.air", "LpvScatter"),
    "pop": ("airlight.techniques.pop", "Pop"),
    "auto": ("airlight.techniques.composed", "Auto"),
}


def technique_class(name: str) -> Any:
    """The class of a technique. Raises SettingsError naming the nearest."""
    if name not in TECHNIQUES:
        raise SettingsError(f"unknown technique '{name}'", remedy=nearest(name, TECHNIQUES))
    module, attribute = TECHNIQUES[name]
    return getattr(importlib.import_module(module), attribute)


def settings_class(name: str, scene: Scene) -> Any:
    """What the technique can be told; of `auto` what the one that it takes for `scene` can be."""
    cls = technique_class(name)
    return cls.settings_for(scene)[1] if hasattr(cls, "settings_for") else cls.Settings


def checked_settings(name: str, scene: Scene, settings: Mapping[str, Any]) -> Any:
    """The technique's settings for `scene`: the scene file's, then `settings` over them.

    Raises SettingsError for an unknown technique, or for a setting that it does not have, naming
    those that have it.
    """
    cls, merged = technique_class(name), {**scene.settings.get(name, {}), **settings}
    where, known = f"technique {name}", cls.Settings
    if hasattr(cls, "settings_for"):
        chosen, known = cls.settings_for(scene)
        where = f"technique {name}, here {chosen}"
    for key in merged:
        if key in known.__dataclass_fields__:
            continue
        having = [other for other in TECHNIQUES if key in _fields(other)]
        if having:
            raise SettingsError(
                f"there is no setting '{key}'", where=where,
                remedy=f"{', '.join(having)} {'has' if len(having) == 1 else 'have'} it",
            )  # fmt: skip
    return make_settings(known, merged, where=where)


def _fields(name: str) -> Mapping[str, Any]:
    fields: Mapping[str, Any] = technique_class(name).Settings.__dataclass_fields__
    return fields


def make_technique(
    gpu: Gpu, scene: Scene, meshes: GpuScene, name: str, settings: Mapping[str, Any],
    size: tuple[int, int],
) -> Technique:  # fmt: skip
    """The technique `name` for `scene`: the scene file's settings, then `settings` over them.

    `size` of the picture in pixels. Raises SettingsError for an unknown technique or setting.
    """
    made = checked_settings(name, scene, settings)
    technique: Technique = technique_class(name)(gpu, scene, meshes, made, size)
    return technique
