"""Where the eye may go in a scene: inside a room an orbit does not lead through its walls."""

from __future__ import annotations

import numpy as np

from ...maths.transforms import F64
from ...scene.io.probe import Probe, sphere_directions
from ...scene.scene import Scene

ENCLOSED_SHARE = 0.6
"""Of all directions from the eye that end at a surface: with so many it is in a room."""
_RAYS = 64
_GAP = 0.01  # of the scene's size, between the eye and a surface
_SHORTER = 0.94  # one arm after the other that is tried
_ARMS = 40
_LONGER = 1.06  # the most by which an arm grows at a time, so that the eye does not jump
_PIVOT_SHARE = 0.5  # of the way to what is seen, where the target lies behind it
_BESIDE = 0.8  # of the way to the target, from which on a surface is that of the target itself


class FreeSpace:
    """The largest surfaces of a scene, cast at by rays; made when first asked.

    Positions and lengths in metres, directions are unit vectors.
    """

    def __init__(self, scene: Scene) -> None:
        self.scene = scene
        low, high = scene.bounds
        self.gap_m = _GAP * float(np.linalg.norm(high - low))
        self._probe: Probe | None = None

    def warm(self) -> None:
        """Make what rays are cast at now, so that the first drag need not wait for it."""
        self._probe = self._probe or Probe.of(self.scene, through_panes=False)

    def is_enclosed(self, eye: F64) -> bool:
        """Whether the eye stands in a room, so that walls are to hold it."""
        directions = sphere_directions(_RAYS)
        return bool(np.isfinite(self._reaches(eye, directions)).mean() > ENCLOSED_SHARE)

    def pivot(self, eye: F64, target: F64) -> F64:
        """What the eye is to orbit about: the target, unless it lies behind a wall.

        Then it is a point on the way to that wall, so that the view stays as it is.
        """
        towards = target - eye
        length = float(np.linalg.norm(towards))
        reach = float(self._reaches(eye, (towards / length)[None])[0])
        # The target lies on the surface that is hit, or before it.
        if reach >= _BESIDE * length:
            return target
        return np.asarray(eye + towards * (_PIVOT_SHARE * reach / length))

    def orbited(self, eye: F64, pivot: F64, outwards: F64, arm_m: float) -> F64 | None:
        """Where the eye goes from `eye` to look at `pivot` against `outwards`.

        `arm_m` away from it where the straight way there is free, else nearer: the longest of some
        arms. None where no arm is free.
        """
        # The arm grows little at a time, and shrinks until the straight way there is free.
        now = float(np.linalg.norm(eye - pivot))
        longest = min(arm_m, now * _LONGER)
        ends = pivot + outwards * (longest * _SHORTER ** np.arange(_ARMS))[:, None]
        free = np.flatnonzero(self._is_free(eye, ends))
        return np.asarray(ends[free[0]]) if len(free) else None

    def _is_free(self, eye: F64, ends: F64) -> F64:
        """Whether nothing is in the way from `eye` to each of `ends` (N, 3), and a gap beyond."""
        offsets = ends - eye
        length = np.linalg.norm(offsets, axis=1)
        unit = offsets / np.maximum(length, 1e-12)[:, None]
        return np.asarray(self._reaches(eye, unit) > length + self.gap_m)

    def moved(self, eye: F64, by: F64) -> F64:
        """`by` (3,), shortened to end before the first surface in its way."""
        length = float(np.linalg.norm(by))
        if length == 0.0:
            return by
        # A gap stays before the surface.
        reach = float(self._reaches(eye, (by / length)[None])[0]) - self.gap_m
        return np.asarray(by * (np.clip(reach, 0.0, length) / length))

    def _reaches(self, eye: F64, directions: F64) -> F64:
        """How far rays (N, 3) from the eye get, metres."""
        self.warm()
        assert self._probe is not None
        return self._probe.cast(np.repeat(eye[None], len(directions), axis=0), directions).distance
