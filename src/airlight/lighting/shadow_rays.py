"""Shadows of lights without extent where their maps are unsure: a ray decides.

A shadow map's texel is as wide as the scene is large: at edges it is soft, and at seams between
thin walls it lets light through. Where all samples around a point agree, it is right.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from ..gpu.commands import Commands
from ..gpu.device import Gpu
from ..maths.transforms import F64
from ..rays.rays import RayScene
from ..scene.scene import Scene
from ..surface.geometry import GpuScene
from ..surface.hits import PIXELS, Points

_REACH = 2.5  # times as far as the map's own filter: samples that must agree
_RAISED_M = 2e-5  # of the scene's diagonal: where they start above surfaces that rays met


class SceneRays:
    """The hierarchy of a frame's meshes for all who send rays, built when the first one does."""

    def __init__(self, gpu: Gpu, meshes: GpuScene) -> None:
        self._gpu, self._meshes = gpu, meshes
        self._scene: Scene | None = None
        self._box: tuple[F64, F64] = (np.zeros(3), np.ones(3))

    def take(self, scene: Scene, low: F64, high: F64) -> None:
        """Follow `scene` from here on; low..high, metres: the box around it."""
        self._scene, self._box = scene, (low, high)

    @property
    def raised(self) -> float:
        """Where rays start above surfaces that other rays met, m."""
        return _RAISED_M * float(np.linalg.norm(self._box[1] - self._box[0]))

    def of_frame(self, commands: Commands) -> RayScene:
        """The hierarchy, up to date; the frame's scene has meshes."""
        assert self._scene is not None, "no scene was taken"
        # Built for the first who sends rays, then brought up to date with the frame.
        made = self._made
        with commands.stage("rays"):
            made.update(self._scene)
        return made

    @cached_property
    def _made(self) -> RayScene:
        return RayScene(self._gpu, self._meshes)

    def shadows(self, commands: Commands) -> ShadowRays:
        """Rays that decide where shadow maps are unsure."""
        return ShadowRays(self.of_frame(commands), self.raised)


@dataclass(frozen=True, eq=False)
class ShadowRays:
    """What rays meet. `raised`, m: where they start above surfaces that other rays met."""

    scene: RayScene
    raised: float

    @property
    def bound(self) -> dict[str, Any]:
        """By slot name, for lighting passes."""
        return self.scene.bound

    def constants(self, points: Points) -> dict[str, float]:
        """For `wgsl/traced_shadow.wgsl` and `wgsl/shadow.wgsl`."""
        return {
            **self.scene.constants,
            # The transmittance of translucent surfaces is in maps of their own.
            "RAYS_MEET_TRANSLUCENT": 0.0,
            "SHADOW_REACH": _REACH,
            "ARE_PIXELS": float(points is PIXELS),
        }


def shadow_key(shadows: ShadowRays | None) -> tuple[Any, ...]:
    """What tells passes apart that look for shadows with `shadows`; instances may begin to move."""
    return tuple(shadows.scene.constants.items()) if shadows else ()
