"""The tracks of a scene, and the times they span."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace
from itertools import groupby
from typing import TYPE_CHECKING, Protocol, cast

import numpy as np

from ...errors import SceneError
from ...maths.transforms import box_around
from .. import checks
from .tracks import MeshTrack

if TYPE_CHECKING:
    from ..checks import F64
    from ..scene import Scene

DEFAULT_FPS = 24.0
_ENDLESS_S = 10.0
_PROBES = 65


class Track(Protocol):
    """One thing that moves."""

    @property
    def end_s(self) -> float:
        """When it comes to rest, seconds; infinite where it never does."""

    def apply(self, scene: Scene, time_s: float) -> Scene:
        """`scene` with what this track moves as it is at a time, whatever it was before."""


@dataclass(frozen=True, eq=False)
class Animation:
    """What moves in a scene. Frames of a sequence run from `start_s` to before `end_s`, seconds.

    Without `end_s` it ends with the last keyframe, and where things move without end after 10 s.
    With `is_loop` time goes round from `end_s` to `start_s`.
    """

    tracks: tuple[Track, ...] = ()
    start_s: float = 0.0
    end_s: float | None = None
    fps: float = DEFAULT_FPS
    is_loop: bool = False

    def __post_init__(self) -> None:
        put = object.__setattr__
        put(self, "tracks", tuple(self.tracks))
        put(self, "start_s", checks.number(self.start_s, "animation start_s"))
        put(self, "fps", checks.number(self.fps, "animation fps", low=1e-3, high=1e4))
        if self.end_s is not None:
            put(self, "end_s", checks.number(self.end_s, "animation end_s"))
            if self.end_s <= self.start_s:
                raise SceneError(
                    f"animation end_s = {self.end_s:g} is not after start_s = {self.start_s:g}"
                )

    @property
    def last_s(self) -> float:
        """When it ends, seconds."""
        if self.end_s is not None:
            return self.end_s
        # The last keyframe of what comes to rest; endless motion alone has a span of its own.
        ends = [t.end_s for t in self.tracks]
        known = [end for end in ends if np.isfinite(end)]
        end = max(known, default=self.start_s)
        return end if end > self.start_s else self.start_s + _ENDLESS_S

    @property
    def changes_boxes(self) -> bool:
        """Whether volumes may have other boxes at other times."""
        return any(getattr(track, "changes_boxes", False) for track in self.tracks)

    @property
    def steps(self) -> tuple[int, float, float]:
        """Of the longest sequence of files: how many, when the first is shown, how many a second.

        Without one there are none.
        """
        files = [getattr(track, "steps", None) for track in self.tracks]
        return max((known for known in files if known), default=(0, self.start_s, self.fps))

    def at(self, scene: Scene, time_s: float) -> Scene:
        """`scene` at a time. Raises SceneError, naming the time, where it cannot be."""
        time = checks.number(time_s, "time_s")
        # Time goes round within the span.
        if self.is_loop:
            time = self.start_s + (time - self.start_s) % (self.last_s - self.start_s)
        try:
            scene = _applied(self.tracks, scene, time)
        except SceneError as error:
            problem = f"at {time:g} s: {error.problem}"
            raise SceneError(problem, where=error.where, remedy=error.remedy) from None
        return scene

    def bounds(self, scene: Scene) -> tuple[F64, F64]:
        """Lower and upper corner, metres, of all that the scene's meshes reach in the span.

        Volumes count with their boxes as they stand. Sampled at 65 times.
        """
        return box_around([scene.bounds, *(moment.bounds for moment in self.moments(scene))])

    def moments(self, scene: Scene) -> Iterator[Scene]:
        """`scene` with its meshes at 65 times of the span; none where no mesh moves."""
        # Only what moves meshes can change their box.
        moving = [t for t in self.tracks if getattr(t, "moves_meshes", False)]
        for time in np.linspace(self.start_s, self.last_s, _PROBES) if moving else ():
            scene = _applied(moving, scene, float(time))
            yield scene

    def eyes(self, scene: Scene) -> list[tuple[float, float, float]]:
        """Where the scene's camera is in the span, metres; sampled at as many times."""
        # The camera's motion alone: positions need no meshes.
        tracks = [getattr(track, "camera_alone", None) for track in self.tracks]
        moving: list[Track] = [track for track in tracks if track is not None]
        found = [scene.camera.position]
        for time in np.linspace(self.start_s, self.last_s, _PROBES) if moving else ():
            scene = _applied(moving, scene, float(time))
            found.append(scene.camera.position)
        return found


def _applied(tracks: Iterable[Track], scene: Scene, time_s: float) -> Scene:
    """`scene` at a time: tracks in their order, each on what the others have moved.

    Meshes that follow keyframes one after the other make one new scene together, not one each.
    """
    for is_mesh, run in groupby(tracks, lambda track: isinstance(track, MeshTrack)):
        if is_mesh:
            meshes = list(scene.meshes)
            for track in run:
                cast(MeshTrack, track).move(meshes, time_s)
            scene = replace(scene, meshes=tuple(meshes))
        else:
            for track in run:
                scene = track.apply(scene, time_s)
    return scene
