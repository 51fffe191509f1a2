"""Volumes whose density changes: files of a sequence, or a function of time."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import lru_cache
from pathlib import Path
from typing import TYPE_CHECKING, Protocol

import numpy as np

from ...errors import SceneError
from ..checks import F32

if TYPE_CHECKING:
    from ..scene import Scene


class Density(Protocol):
    """A density grid by time."""

    @property
    def end_s(self) -> float:
        """When it comes to rest, seconds; infinite where it never does."""

    def at(self, time_s: float) -> F32:
        """The grid (z, y, x), always of one shape."""


@dataclass(frozen=True, eq=False)
class VolumeTrack:
    """The scene's volume number `index`, a density grid."""

    index: int
    density: Density

    @property
    def end_s(self) -> float:
        """When it comes to rest, seconds."""
        return self.density.end_s

    def apply(self, scene: Scene, time_s: float) -> Scene:
        """The scene with the volume as dense as it is."""
        volumes = list(scene.volumes)
        if self.index >= len(volumes):
            raise SceneError(
                f"the animation changes volume {self.index + 1}, but the scene has {len(volumes)}"
            )
        density = self.density.at(time_s)
        if volumes[self.index].density is density:
            return scene  # what did not change need not be uploaded or solved again
        volumes[self.index] = replace(volumes[self.index], density=density)
        return replace(scene, volumes=tuple(volumes))


@dataclass(frozen=True, eq=False)
class MadeDensity:
    """`make(time_s)`: a function of a module, or a functools.partial of one."""

    make: Callable[[float], F32]
    end_s: float = float("inf")

    def at(self, time_s: float) -> F32:
        """The grid (z, y, x)."""
        return self.make(time_s)


@dataclass(frozen=True, eq=False)
class FileSequence:
    """`files`, one after the other, `fps` a second from `start_s` on, all of one `shape`.

    Between two files their densities are mixed; with `between` "step" the earlier one holds.
    Before the first and after the last these hold; with `is_loop` the first follows the last.
    `grid` and `channels` as in `read_volume`.
    """

    files: tuple[Path, ...]
    shape: tuple[int, ...]
    fps: float = 24.0
    start_s: float = 0.0
    between: str = "linear"
    is_loop: bool = False
    grid: str = "density"
    channels: str = "density"

    @property
    def end_s(self) -> float:
        """When the last file is reached, seconds; infinite in a loop."""
        return float("inf") if self.is_loop else self.start_s + len(self.files) / self.fps

    def at(self, time_s: float) -> F32:
        """The grid (z, y, x). Raises SceneError for a file that cannot be read or does not fit."""
        place, count = (time_s - self.start_s) * self.fps, len(self.files)
        # A frame's time is a quotient; a hair before a file's time is that time.
        nearest = round(place)
        place = float(nearest) if abs(place - nearest) < 1e-6 else place
        place = place % count if self.is_loop else min(max(place, 0.0), count - 1.0)
        k, u = int(place), place - int(place)
        if u == 0.0 or self.between == "step":
            return self._read(k)
        mixed = (1.0 - u) * self._read(k) + u * self._read((k + 1) % count)
        return np.asarray(mixed, np.float32)

    def check(self) -> None:
        """Read every file once. Raises SceneError for one that cannot be read or does not fit."""
        for k in range(len(self.files)):
            self._read(k)

    def _read(self, k: int) -> F32:
        path = self.files[k]
        try:
            stamp = path.stat().st_mtime_ns
        except OSError as error:
            raise SceneError(
                f"cannot be read ({error.strerror or error})",
                where=path,
                remedy="The sequence had it when the scene was loaded.",
            ) from None
        density = _density(path, stamp, self.grid, self.channels)
        if density.shape != self.shape:
            have, want = (" x ".join(map(str, s)) for s in (density.shape, self.shape))
            raise SceneError(
                f"its grid has {have} cells, the sequence's first has {want}",
                where=path,
                remedy="Resample the sequence to one size.",
            )
        return density


@lru_cache(maxsize=3)
def _density(path: Path, stamp_ns: int, grid: str, channels: str) -> F32:
    """A file's grid as it was at `stamp_ns`; the last few are kept."""
    from ..io.volumes import read_volume

    density = read_volume(path, grid, channels).density
    density.flags.writeable = False
    return density
