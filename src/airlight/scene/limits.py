"""What single precision can still render."""

from __future__ import annotations

import numpy as np

from ..errors import SceneError
from .checks import F64
from .scene import Scene, volume_world_bounds

LEAST_M = 1e-9
"""Metres of all of a scene: of 1e-10 m images are right, of 1e-12 m black."""
FARTHEST_M = 1e8
"""Metres of a scene's reach: cameras and lattices around it still have places."""


def check_extent(scene: Scene) -> None:
    """Raise SceneError for a mesh or a volume that reaches too far from the origin, and where all
    of them are hardly more than a point."""
    named = [(mesh.world_bounds, f"mesh '{mesh.name}'") for mesh in scene.meshes]
    for number, volume in enumerate(scene.volumes, start=1):
        named.append((volume_world_bounds(volume), f"volume {number}"))
    for box, what in named:
        _check(box, what)
    # A lattice over a point would have no cells, and one over next to nothing none whose volume is
    # a number to a shader.
    corners = np.array([box for box, _ in named]).reshape(-1, 3)
    if len(corners) and (largest := float(np.ptp(corners, axis=0).max())) < LEAST_M:
        size = f"is {largest:g} m large, at least {LEAST_M:g} m can be used"
        raise SceneError(
            f"all that the scene holds {size if largest else 'lies in one point'}",
            remedy="Is a scale 0? Give it a size." if not largest else "Make its scale larger.",
        )


def _check(box: tuple[F64, F64], what: str) -> None:
    farthest = float(np.abs(box).max())
    if not farthest <= FARTHEST_M:
        raise SceneError(
            f"{what} reaches {farthest:g} m from the origin, at most {FARTHEST_M:g} m can be used",
            remedy="Make its scale smaller.",
        )
