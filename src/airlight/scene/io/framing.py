"""A camera for a scene that has none: from inside a room, through its open side, or around.

A room is a place from which most rays end at the front of a surface; the inside of a teapot
shows backs instead. Within a room the eye stands near one end of the longer axis and looks
along it; of the few places tried, the one that sees furthest and most different things wins.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ...maths.transforms import box_corners
from ..camera import Camera, view_directions
from ..checks import F64
from .probe import Hits, Probe, sphere_directions
from .viewpoint import AZIMUTH_DEG, BELOW_DEG, around, from_front, rounded_camera, towards_eye

ROOM_FOV_DEG = 60.0
EYE_HEIGHT_M = 1.6
_RAYS = 96
_ROOM_TRIANGLES = 3000
_CONE_COSINE = 0.77
_STANDING_M = 1.5
_WALLS = 12
"""Directions that walls of one room face."""


@dataclass(frozen=True, eq=False)
class Room:
    """A box (3,) to (3,) metres around an enclosed place; open sides are infinite."""

    low: F64
    high: F64

    @property
    def size(self) -> F64:
        """Metres per axis."""
        return self.high - self.low


def framing_camera(probe: Probe, points: F64 | None = None) -> Camera:
    """A camera that shows the scene of `probe` well.

    `points` (N, 3), metres, are to be in the image of what stands free: the scene's `outline`, or
    without it what the probe holds, which of large meshes lacks the small triangles.
    """
    points = probe.corners.reshape(-1, 3) if points is None else points
    if len(probe.corners) == 0:
        return Camera()
    # Inside a room, through its open wall, or around an object that stands free.
    room = find_room(probe)
    if room is None:
        return from_front(points)
    if not np.isfinite(room.size[[0, 2]]).all():
        return _through_open_side(points, room)
    return _inside(probe, room)


def framing_box(low: F64, high: F64, *, is_on_ground: bool = False) -> Camera:
    """A camera that shows the air in the box low..high (3,), metres, from outside: from below, or
    from above where it stands on a ground."""
    corners = box_corners(low, high)
    if is_on_ground:
        return from_front(corners)
    return around(towards_eye(BELOW_DEG, AZIMUTH_DEG), corners)


def find_room(probe: Probe) -> Room | None:
    """The room that the middle of the scene lies in, if it lies in one.

    Free space that is walled in, not the inside of a solid; see `_is_for_people`.
    """
    points = probe.corners.reshape(-1, 3)
    if len(points) == 0:
        return None
    # A large scene is searched by its largest triangles.
    low, high = points.min(axis=0), points.max(axis=0)
    rounds_of = probe.winding
    probe = probe.largest(_ROOM_TRIANGLES)
    # The middle may lie in a table or a pillar, so places around and above it are tried, too.
    offsets = np.array([(0, 0, 0), (1, 0, 1), (-1, 0, 1), (1, 0, -1), (-1, 0, -1), (0, 1, 0)])
    directions = sphere_directions(_RAYS)
    best, best_distance = None, 0.0
    # From points around the middle, look for walls on all sides; the largest room counts.
    for place in (low + high) / 2.0 + 0.15 * (high - low) * offsets:
        hits = probe.cast(np.repeat(place[None], _RAYS, axis=0), directions)
        struck = np.isfinite(hits.distance)
        typical = float(np.median(np.where(struck, hits.distance, 0.0)))
        # Mostly walls, further away than those of the best place, and seen from the front.
        if struck.mean() <= 0.72 or typical <= best_distance or not _are_walls(probe, hits):
            continue
        # By its winding number the place is outside of solids; closed walls have to make a room.
        rounds = float(rounds_of(place[None])[0])
        room = _room_around(probe, place, directions, hits.distance)
        if rounds < 0.5 and (not struck.all() or _is_for_people(probe, hits, room, rounds)):
            best, best_distance = room, typical
    return best


def _is_for_people(probe: Probe, hits: Hits, room: Room, rounds: float) -> bool:
    """Whether walls without an opening make a room.

    A sheet whose front is inside is made to be seen from there, unless it is round: then it is
    more likely a solid turned inside out. The cavity of a closed solid, as of a hollow cake, is a
    room where somebody could stand in it.
    """
    if rounds > -0.5:
        return float(room.size[1]) >= _STANDING_M
    # Upright walls of a room face few directions, those of something round face many.
    normals = probe.normals[hits.triangle]
    upright = normals[np.abs(normals[:, 1]) < 0.1]
    _, counts = np.unique(np.round(10.0 * upright), axis=0, return_counts=True)
    most = np.sort(counts)[::-1][:_WALLS].sum()
    return bool(most >= 0.8 * len(upright))


def _are_walls(probe: Probe, hits: Hits) -> bool:
    """Whether most rays met the front of something upright or level.

    The inside of a thin shell shows backs; that of a thick one, say a teapot, is round.
    """
    struck = hits.triangle >= 0
    slope = np.abs(probe.normals[hits.triangle[struck], 1])
    is_built = (slope < 0.1) | (slope > 0.98)
    return bool((hits.is_front[struck] & is_built).mean() > 0.55)


def _room_around(probe: Probe, place: F64, directions: F64, distance: F64) -> Room:
    """The walls: per side, how far most rays of a cone and of a bundle get along the axis."""
    low, high = np.empty(3), np.empty(3)
    for axis in range(3):
        for side, corner in ((-1.0, low), (1.0, high)):
            # Rays of a cone about the axis, by how far they get along it.
            cosine = side * directions[:, axis]
            reach = distance[cosine > _CONE_COSINE] * cosine[cosine > _CONE_COSINE]
            far = np.inf
            if np.isinf(reach).mean() <= 0.5:
                # In a long room most of the cone meets the side walls, the bundle does not.
                cone = float(np.quantile(reach[np.isfinite(reach)], 0.7))
                far = max(cone, _bundle_reach(probe, place, axis, side))
            corner[axis] = place[axis] + side * far
    return Room(low, high)


def _bundle_reach(probe: Probe, place: F64, axis: int, side: float) -> float:
    """The median length of the parallel rays around `place` that hit anything; 0 without."""
    # A parallel bundle about the place, 16 % of the scene wide.
    spread = 0.08 * np.ptp(probe.corners.reshape(-1, 3), axis=0)
    spread[axis] = 0.0
    steps = np.array(np.meshgrid([-1, 0, 1], [-1, 0, 1])).reshape(2, -1).T
    direction = np.zeros(3)
    direction[axis] = side
    origins = place + spread * np.insert(steps, axis, 0, axis=1)
    distance = probe.cast(origins, np.repeat(direction[None], len(origins), axis=0)).distance
    struck = distance[np.isfinite(distance)]
    return float(np.median(struck)) if len(struck) else 0.0


def _inside(probe: Probe, room: Room) -> Camera:
    """The best of a few places near the ends of the longer horizontal axis."""
    # Along the longer axis; along both where the room is nearly square.
    axes = [0, 2] if room.size[0] > room.size[2] else [2, 0]
    if room.size[axes[0]] > 1.2 * room.size[axes[1]]:
        axes = axes[:1]
    # From both ends, somewhat off the middle; the view that shows most wins.
    places = [
        _look_along(room, axis, side, shift)
        for axis in axes
        for side in (1.0, -1.0)
        for shift in (0.08, -0.18, 0.25)
    ]
    coarse = probe.largest(_ROOM_TRIANGLES)
    scores = [_interest(coarse, camera, room) for camera in places]
    return places[int(np.argmax(scores))]


def _look_along(room: Room, axis: int, side: float, shift: float) -> Camera:
    """Eye near the `side` end of an axis, `shift` of the width off its middle."""
    # An open side has no wall: 0, or 3 m from the other side, stands for it.
    low = np.where(np.isfinite(room.low), room.low, 0.0)
    high = np.where(np.isfinite(room.high), room.high, low + 3.0)
    across = 2 - axis
    length, height = float(high[axis] - low[axis]), float(high[1] - low[1])
    is_human = 2.0 <= height <= 8.0
    # At the eye's height of a person where the room is a person's, a little down.
    eye = (low + high) / 2.0
    eye[1] = low[1] + (EYE_HEIGHT_M if is_human else 0.4 * height)
    eye[axis] += side * 0.4 * length
    eye[across] += shift * (high[across] - low[across])
    # The view crosses the room a little, towards its middle.
    target = eye.copy()
    target[axis] -= side * 0.65 * length
    target[across] -= 0.5 * shift * (high[across] - low[across])
    target[1] -= 0.065 * length
    return rounded_camera(eye, target, ROOM_FOV_DEG)


def _interest(probe: Probe, camera: Camera, room: Room) -> float:
    """How far a camera sees, times how many different things (2 to the power of the entropy);
    up to half as much again where some of the view leads out of a window."""
    eye = np.array(camera.position)
    directions = view_directions(camera, 11, 7)
    # What the view sees; most of it has to face the camera.
    hits = probe.cast(np.repeat(eye[None], len(directions), axis=0), directions)
    struck = hits.triangle >= 0
    length = float(room.size[[0, 2]].max())
    if not struck.any() or hits.is_front[struck].mean() < 0.6:
        return 0.0
    # How far, and how many different things.
    near: F64 = np.clip(hits.distance[struck] / length, 0.0, 1.0)
    share = np.bincount(probe.mesh[hits.triangle[struck]]) / struck.sum()
    entropy = -float(np.sum(share[share > 0] * np.log2(share[share > 0])))
    # Something close to the eye in a tenth of the view hides what lies behind it.
    is_blocked = bool(np.quantile(near, 0.1) < 0.05)
    # Rays that end outside of the room's box lead through a window: 5 % of them count fully.
    ends = eye + directions * np.minimum(hits.distance, 1e6 * length)[:, None]
    margin = 0.15 * length
    is_out = ((ends < room.low - margin) | (ends > room.high + margin)).any(axis=1).mean()
    window = 1.0 + 10.0 * min(float(is_out), 0.05)
    score: float = float(near.mean()) * 2.0**entropy * window * (0.1 if is_blocked else 1.0)
    return score


def _through_open_side(points: F64, room: Room) -> Camera:
    """From outside, straight through the open wall, so that the whole inside fits."""
    # The first open side: towards +Z, where models show themselves, before any other.
    sides = [(axis, side) for axis in (2, 0) for side in (1.0, -1.0)]
    axis, side = next(
        (a, s) for a, s in sides if np.isinf(room.high[a] if s > 0.0 else room.low[a])
    )
    direction = np.zeros(3)
    direction[axis] = side
    return around(direction, points)
