"""What a lattice covers: surfaces and volumes and, where its light is in it, the medium."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from ..errors import SettingsError
from ..scene.checks import F64
from ..scene.medium import medium_box
from ..scene.scene import Scene

MEDIUM_BEYOND = 2.0
"""Of the surfaces' longest side: how far a lattice reaches for the medium alone. A camera that
frames an object stands about so far away, in a medium that fills the scene up to its camera."""
_HAIR = 0.01
"""Of the surfaces' longest side: a medium that ends so close to a wall adds nothing."""


def lattice_box(
    scene: Scene, bounds: Sequence[float] = (), *, in_medium: bool = False
) -> tuple[Any, Any]:
    """Lower and upper corner, metres, of what lattices cover.

    `bounds`: the setting of that name, six numbers, which has the last word. `in_medium`: whether
    the lattice holds light in the medium: then what that fills is covered, too. Raises
    SettingsError for bounds that are not a box.
    """
    if not bounds:
        return _with_medium(scene) if in_medium else scene.whole_bounds
    if len(bounds) != 6:
        raise SettingsError(
            f"setting bounds has {len(bounds)} numbers", remedy="Give x0,y0,z0,x1,y1,z1"
        )
    low, high = bounds[:3], bounds[3:]
    if any(a >= b for a, b in zip(low, high, strict=True)):
        raise SettingsError(f"setting bounds is empty: {list(low)} to {list(high)}")
    return low, high


def _with_medium(scene: Scene) -> tuple[F64, F64]:
    """Surfaces and the medium around them, as far as that is no waste of cells; metres.

    Of an endless medium what is far is in a table of its own (`media.half_space`).
    """
    low, high = scene.whole_bounds
    medium = scene.medium
    if medium is None or medium.endless:
        return low, high
    # Without bounds it reaches to the camera, wherever that goes.
    eyes = [scene.camera.position] if scene.animation is None else scene.animation.eyes(scene)
    boxes = [medium_box(medium, low, high, eye) for eye in eyes]
    longest = float(np.subtract(high, low).max())

    def reach(beyond: F64) -> F64:
        return np.where(beyond > _HAIR * longest, np.minimum(beyond, MEDIUM_BEYOND * longest), 0.0)

    below = reach(low - np.min([box[0] for box in boxes], axis=0))
    above = reach(np.max([box[1] for box in boxes], axis=0) - high)
    return low - below, high + above
