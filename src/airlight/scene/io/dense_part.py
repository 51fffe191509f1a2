"""Where the media of a scene are: grids of simulations are mostly empty."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import suppress

import numpy as np

from ...errors import SceneError
from ...maths.transforms import box_around, box_corners, transformed
from ..animation import Animation
from ..animation.density import VolumeTrack
from ..checks import F32, F64
from ..scene import Scene
from ..volume import Volume

_MOMENTS, _MOST_MOMENTS = 5, 48
_VOXELS = 1 << 25
"""Of all moments that are looked at together, unless their grids are so large that _MOMENTS have
more."""
_LEFT_OUT = 0.005
"""Of all there is, beyond each of a box's six sides."""
_ROOM = 0.03
"""Of the box's own size, kept around it on each side: a full grid's box is all of it again."""


def dense_box(scene: Scene) -> tuple[F64, F64]:
    """Lower and upper corner (3,), metres, of the boxes that hold nearly all of each volume.

    What glows counts as well as what is dense; of files that follow each other all are looked at,
    of many or large ones some, evenly through them, and the last; of what moves otherwise a few
    moments. Scenes of empty grids have `whole_bounds`.
    """
    found = [_corners(v) for moment in _moments(scene) for v in moment.volumes if _holds_any(v)]
    if not found:
        return scene.whole_bounds
    points = np.concatenate(found)
    return points.min(axis=0), points.max(axis=0)


def air_beside(scene: Scene, points: F64) -> F64:
    """Corners (N, 3), metres, of the boxes of grids that stand beside `points` (M, 3) of meshes.

    A grid around all of them is the air that they stand in, and shapes are that, too.
    """
    found = [np.zeros((0, 3))]
    for volume in (volume for moment in _moments(scene) for volume in moment.volumes):
        if volume.density is None or not _holds_any(volume):
            continue
        corners = _corners(volume)
        low, high = corners.min(axis=0), corners.max(axis=0)
        if not ((low <= points) & (points <= high)).all() or not len(points):
            found.append(corners)
    return np.concatenate(found)


def _moments(scene: Scene) -> Iterator[Scene]:
    """The scene, and as it is at more times where its volumes change.

    A file that cannot be read is told of when it is shown.
    """
    yield scene
    moving = scene.animation
    if moving is None or not any(isinstance(track, VolumeTrack) for track in moving.tracks):
        return
    # Between them grids are mixed, and fill no more than the two boxes: each file's own time, as
    # many as are read soon.
    size = max((v.density.size for v in scene.volumes if v.density is not None), default=0)
    most = int(np.clip(_VOXELS // max(size, 1), _MOMENTS, _MOST_MOMENTS))
    for time in _times(moving, most):
        with suppress(SceneError):
            yield scene.at(float(time))


def _times(moving: Animation, most: int) -> F64:
    """Seconds at which an animation is looked at, at most `most`: those of its files where it has
    any, else a few."""
    count, start_s, fps = moving.steps
    if not count:
        return np.linspace(moving.start_s, moving.last_s, _MOMENTS)
    # Files before the start, as those without any density, are not shown.
    numbers = np.unique(np.linspace(0, count - 1, min(most, count)).round())
    return np.clip(start_s + numbers / fps, moving.start_s, moving.last_s).astype(np.float64)


def _grids(volume: Volume) -> list[F32]:
    """What says where a volume is seen, (z, y, x); none of a shape, which is full."""
    glow = volume.emission.values if volume.emission else None
    grids = [volume.density] if glow is None else [volume.density, glow]
    return [g if g.ndim == 3 else g.max(axis=-1) for g in grids if g is not None]


def _holds_any(volume: Volume) -> bool:
    grids = _grids(volume)
    return not grids or any(bool(grid.any()) for grid in grids)


def _corners(volume: Volume) -> F64:
    """Corners (8, 3) in the world of the box that holds nearly all of a volume."""
    low, high = (np.array(corner) for corner in volume.bounds)
    parts = [_part(grid) for grid in _grids(volume) if grid.any()]
    if parts:
        first, last = box_around(parts)
        low, high = low + first * (high - low), low + last * (high - low)
    return transformed(box_corners(low, high), volume.world_from_volume)


def _part(grid: F32) -> tuple[F64, F64]:
    """Shares (x, y, z) of a grid's sides between which nearly all of its values lie."""
    across = grid.sum(axis=2, dtype=np.float64)
    lines = (grid.sum(axis=(0, 1), dtype=np.float64), across.sum(axis=0), across.sum(axis=1))
    first, last = np.empty(3), np.empty(3)
    # Along each axis, where the sum up to a place passes the share left out.
    for k, line in enumerate(lines):
        sums = np.concatenate([[0.0], np.cumsum(line)]) / line.sum()
        places = np.linspace(0.0, 1.0, len(sums))
        low, high = np.interp((_LEFT_OUT, 1.0 - _LEFT_OUT), sums, places)
        room = _ROOM * (high - low)
        first[k], last[k] = max(low - room, 0.0), min(high + room, 1.0)
    return first, last
