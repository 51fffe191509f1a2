"""Another view of what a technique has solved: its own surfaces and gather, no solution."""

from __future__ import annotations

import copy
from collections.abc import Mapping
from dataclasses import fields as fields_of
from dataclasses import replace
from typing import Any

from ..area.lighting import AreaShadows
from ..gather.settings import GatherSettings
from ..gpu.commands import Commands
from ..gpu.device import Gpu
from ..gpu.shared import Shared
from ..lighting.kit import Kit, SurfaceSettings
from ..lighting.shadow_rays import SceneRays
from ..lighting.view import View
from ..scene.scene import Scene
from .technique import Technique

OF_VIEWS = frozenset(f.name for f in fields_of(GatherSettings))
"""The settings in which views of one solution may differ."""


def settings_of_views(settings: Any) -> dict[str, Any]:
    """Those of a technique's `settings`, by name."""
    return {name: getattr(settings, name) for name in sorted(OF_VIEWS) if hasattr(settings, name)}


class Beside(Technique):
    """`first` solves, and has solved when this draws; it may solve while this does not draw.

    Two threads may draw with the two of them: what a view writes is its own.
    """

    def __init__(
        self, first: Technique, gpu: Gpu, size: tuple[int, int], changes: Mapping[str, Any]
    ) -> None:
        """`changes`: of settings `OF_VIEWS`."""
        assert first.views is not None and OF_VIEWS.issuperset(changes)
        self._first = first
        settings = replace(first.kit.settings, **changes)
        kit = _kit_beside(first.kit, gpu, size, settings)
        super().__init__(first.name, kit, first.views(kit, settings))

    def solve(
        self, commands: Commands, scene: Scene, *, is_still: bool = False, lags: bool = False
    ) -> None:
        """Take what the first one has solved: its frame, of this scene, and its fields.

        Nothing that both have is written, as the first one may be solving another scene by now;
        then nobody wants what this draws.
        """
        kit, frame, fields = self.kit, self._first.frame, self._first.fields
        assert frame is not None and fields is not None, "the first one solves first"
        kit.box = frame.bounds
        kit.rays.take(frame.scene, *kit.box)
        # Solvers of views are told what scene it is; none of them adds a field.
        for solver in self.solvers:
            solver.solve(commands, replace(frame, is_still=is_still), fields)

    def draw(self, commands: Commands, view: View) -> None:
        """Draw the view's surfaces."""
        self.fields = self._first.fields
        super().draw(commands, view)

    @property
    def stats(self) -> dict[str, Any]:
        """The values of --stats; what the first one says stands."""
        return {**super().stats, **self._first.stats}


def _kit_beside(first: Kit, gpu: Gpu, size: tuple[int, int], settings: SurfaceSettings) -> Kit:
    """A kit with the lights, the sky and the lattices of the `first`, for another view."""
    kit = copy.copy(first)
    kit.gpu, kit.settings, kit.shared = gpu.scope(), settings, Shared()
    kit.context = replace(first.context, gpu=kit.gpu, size=size, commands=None)
    # What a view's sample writes is its own: the hierarchy, shadow maps of lights with extent.
    kit.rays = SceneRays(kit.gpu, kit.meshes)
    if first.area_shadows is not None:
        kit.area_shadows = AreaShadows(kit.gpu, kit.emitters, settings.lamp_resolution)
    return kit
