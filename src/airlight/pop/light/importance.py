"""Importance of the light around a medium for one view, as a map; see `maths.view_importance`.

The host computes it, where volumes are known: on about twelve cells a side, again where the medium
changed, and in 30 ms of propagation and sums for a new view. Nothing is read back.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from ...maths.delta_beam import MediumGrid
from ...maths.latlong import latlong_from_direction, latlong_texel_directions
from ...maths.transforms import F64
from ...maths.view_importance import (
    ROWS,
    ExitDensity,
    Frustum,
    exit_density,
    importance_map,
    scattered_importance,
    view_grid,
)
from ...maths.voxels import box_averaged, trilinear
from ...scene.camera import Camera
from ...scene.volume import Volume
from ..medium.placement import SPHERE_SIDE, MediumPlacement, shape_density

IMPORTANCE = ("none", "view")
"""Values of the setting: whether ordinates are chosen for what the camera sees."""
_SIDE = 12  # cells along a side of a cube-shaped medium
_AVERAGED = 24  # cells along each axis that voxels are averaged to before
_SHAPE = (ROWS, 2 * ROWS)


@dataclass(frozen=True)
class Look:
    """A camera, and the width of its image over the height."""

    camera: Camera
    aspect: float

    def frustum(self, placement: MediumPlacement) -> Frustum:
        """The view frustum in the frame of a medium."""
        # Axes in the medium's frame: right, up at right angles to both others, forward.
        c = self.camera
        forward = np.subtract(c.target, c.position)
        right = np.cross(forward, c.up)
        axes = np.stack([right, np.cross(right, forward), forward])
        axes = placement.direction(axes / np.linalg.norm(axes, axis=1, keepdims=True))
        up = float(np.tan(0.5 * np.radians(c.fov_y_deg)))
        eye = placement.point(np.array(c.position))
        return Frustum(eye, axes[0], axes[1], axes[2], (self.aspect * up, up))


class ViewImportance:
    """Importance of the sky of one medium, cached by medium and view."""

    def __init__(self) -> None:
        # Maps are kept with what they were found for: a medium, and a view of it.
        self._key: tuple[Any, ...] = ()
        self._view_key: tuple[Any, ...] = ()
        self._map = np.ones(_SHAPE)
        self._volume: Volume | None = None
        self._medium: MediumGrid | None = None
        self._out: ExitDensity | None = None

    def of(
        self, volume: Volume, placement: MediumPlacement, look: Look, rotation_deg: float
    ) -> F64:
        """(16, 32), mean 1, by direction towards an environment rotated by `rotation_deg`.

        It is 1 everywhere where the camera does not see the medium. The array is the same object
        for the same view.
        """
        medium, out = self._of_medium(volume, placement)
        # The importance depends on the view; how light leaves the medium does not.
        view_key = (*self._key, look, rotation_deg, placement.world_from_medium.tobytes())
        if view_key != self._view_key:
            self._view_key = view_key
            self._map = _importance(medium, out, placement, look, rotation_deg)
        return self._map

    def _of_medium(
        self, volume: Volume, placement: MediumPlacement
    ) -> tuple[MediumGrid, ExitDensity]:
        """The coarse medium, and how light leaves it; cached while volume and box stay the same."""
        # Where the volume lies in the world does not matter to how light leaves it.
        matrices = (placement.unit_from_medium.tobytes(), placement.extent.tobytes())
        key = (id(volume.density), volume.sigma_t, volume.albedo, volume.g, *matrices)
        if self._medium is None or self._out is None or key != self._key:
            self._key, self._volume = key, volume
            self._medium = coarse_medium(volume, placement)
            towards = latlong_texel_directions(*_SHAPE).reshape(-1, 3)
            self._out = exit_density(self._medium, towards)
        return self._medium, self._out


def coarse_medium(volume: Volume, placement: MediumPlacement) -> MediumGrid:
    """The mean of three channels, on about twelve cells a side of the medium's box."""
    voxels = box_averaged(shape_density(volume, SPHERE_SIDE), (_AVERAGED,) * 3)
    # Cells that are nearly cubes, with coefficients at density 1.
    extent = placement.extent
    side = float(np.cbrt(np.prod(extent))) / _SIDE
    x, y, z = np.clip(np.round(extent / side), 4, 3 * _SIDE).astype(int)
    one = np.ones((z, y, x))
    mean = [np.array([float(np.mean(v))]) for v in (volume.sigma_t, volume.albedo, volume.g)]
    cells = MediumGrid(extent, one, one, *mean)
    # Their densities, 0 outside the volume.
    unit = cells.centres @ placement.unit_from_medium[:3, :3].T + placement.unit_from_medium[:3, 3]
    inside = np.all((unit >= 0.0) & (unit <= 1.0), axis=-1)
    density = np.where(inside, trilinear(voxels, unit * _AVERAGED), 0.0)
    return MediumGrid(extent, density, density, *mean)


def _importance(
    medium: MediumGrid,
    out: ExitDensity,
    placement: MediumPlacement,
    look: Look,
    rotation_deg: float,
) -> F64:
    """Importance by direction towards the rotated environment."""
    grid = view_grid(look.frustum(placement), medium.extent)
    if grid is None:
        return np.ones(_SHAPE)
    # Importance from the eye, scattered in the medium, that leaves it in each direction.
    seen = importance_map(scattered_importance(grid, medium), out, medium, _SHAPE)
    # The map is rotated by the environment, the importance is known in the medium's frame.
    angle = np.radians(rotation_deg)
    c, s = np.cos(angle), np.sin(angle)
    about_y = np.array([[c, 0.0, s], [0.0, 1.0, 0.0], [-s, 0.0, c]])
    towards = latlong_texel_directions(*_SHAPE) @ about_y.T
    return _looked_up(seen, placement.direction(towards))


def _looked_up(seen: F64, towards: F64) -> F64:
    """A map (h, w) at directions (..., 3), bilinear."""
    # The map goes on across the seam at u = 0.
    wide = np.pad(seen, ((0, 0), (1, 1)), mode="wrap")[None]
    u, v = np.moveaxis(latlong_from_direction(towards), -1, 0)
    h, w = seen.shape
    return trilinear(wide, np.stack([u * w + 1.0, v * h, np.full(u.shape, 0.5)], axis=-1))
