"""Shadows of lights without extent where their maps are unsure: a ray decides.

A shadow map's texel is as wide as the scene is large: at edges it is soft, and at seams between
thin walls it lets light through. Where all samples around a point agree, it is right.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from ..rays.rays import RayScene
from ..surface.hits import PIXELS, Points

_REACH = 2.5  # times as far as the map's own filter: samples that must agree
_RAISED = 2e-4  # of the distance to the eye: where rays start above surfaces that pixels show


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
        is_pixel = points is PIXELS
        return {
            **self.scene.constants,
            # The transmittance of translucent surfaces is in maps of their own.
            "RAYS_MEET_TRANSLUCENT": 0.0,
            "SHADOW_REACH": _REACH,
            "SHADOW_RAISED": _RAISED if is_pixel else 0.0,
            "SHADOW_RAISED_M": 0.0 if is_pixel else self.raised,
        }


def shadow_key(shadows: ShadowRays | None) -> tuple[Any, ...]:
    """What tells passes apart that look for shadows with `shadows`; instances may begin to move."""
    return tuple(shadows.scene.constants.items()) if shadows else ()
