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
from ..emission import Emission

if TYPE_CHECKING:
    from ..scene import Scene
    from ..volume import Volume


class Density(Protocol):
    """A density grid by time."""

    @property
    def end_s(self) -> float:
        """When it comes to rest, seconds; infinite where it never does."""

    def at(self, time_s: float) -> F32:
        """The grid (z, y, x), always of one shape."""

    def emission_at(self, time_s: float) -> F32 | None:
        """The grid of emission or temperature, as the volume's `Emission` has it; None without."""


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
        volume = volumes[self.index]
        volumes[self.index] = self.of(volume, time_s)
        if volumes[self.index] is volume:
            return scene  # what did not change need not be uploaded or solved again
        return replace(scene, volumes=tuple(volumes))

    def of(self, volume: Volume, time_s: float) -> Volume:
        """The `volume` as dense as it is then; the very same where it is."""
        # Both grids of the moment; what stays the same object counts as unchanged.
        density, glow = self.density.at(time_s), self.density.emission_at(time_s)
        emission = volume.emission if glow is None else _with_grid(volume.emission, glow)
        if volume.density is density and volume.emission is emission:
            return volume
        return replace(volume, density=density, emission=emission)


def _with_grid(emission: Emission | None, grid: F32) -> Emission | None:
    """The emission with another grid; the very same where the grid is its own."""
    if emission is None:
        return None
    if emission.temperature is None:
        return emission if emission.grid is grid else replace(emission, grid=grid)
    return emission if emission.temperature is grid else replace(emission, temperature=grid)


@dataclass(frozen=True, eq=False)
class MadeDensity:
    """`make(time_s)`: a function of a module, or a functools.partial of one.

    `make_emission` likewise, where the volume has an emission grid.
    """

    make: Callable[[float], F32]
    end_s: float = float("inf")
    make_emission: Callable[[float], F32] | None = None

    def at(self, time_s: float) -> F32:
        """The grid (z, y, x)."""
        return self.make(time_s)

    def emission_at(self, time_s: float) -> F32 | None:
        """The grid of emission or temperature, if there is one."""
        return None if self.make_emission is None else self.make_emission(time_s)


@dataclass(frozen=True, eq=False)
class FileSequence:
    """`files`, one after the other, `fps` a second from `start_s` on, all of one `shape`.

    Between two files their densities are mixed; with `between` "step" the earlier one holds.
    Before the first and after the last these hold; with `is_loop` the first follows the last.
    `grid` and `channels` as in `read_volume`; `emission_grid`: of the same files, if any.
    """

    files: tuple[Path, ...]
    shape: tuple[int, ...]
    fps: float = 24.0
    start_s: float = 0.0
    between: str = "linear"
    is_loop: bool = False
    grid: str = "density"
    channels: str = "density"
    emission_grid: str | None = None

    @property
    def end_s(self) -> float:
        """When the last file has been shown, seconds; infinite in a loop."""
        return float("inf") if self.is_loop else self.start_s + len(self.files) / self.fps

    def at(self, time_s: float) -> F32:
        """The grid (z, y, x). Raises SceneError for a file that cannot be read or does not fit."""
        return self._mixed(time_s, self._read)

    def emission_at(self, time_s: float) -> F32 | None:
        """The emission grid, if there is one. Raises SceneError as `at` does."""
        return None if self.emission_grid is None else self._mixed(time_s, self._read_emission)

    def _mixed(self, time_s: float, read: Callable[[int], F32]) -> F32:
        place, count = (time_s - self.start_s) * self.fps, len(self.files)
        # A frame's time is a quotient; a hair before a file's time is that time.
        nearest = round(place)
        place = float(nearest) if abs(place - nearest) < 1e-6 else place
        # Within the files: round and round, or the ends hold.
        place = place % count if self.is_loop else min(max(place, 0.0), count - 1.0)
        k, u = int(place), place - int(place)
        if u == 0.0 or self.between == "step":
            return read(k)
        mixed = (1.0 - u) * read(k) + u * read((k + 1) % count)
        return np.asarray(mixed, np.float32)

    def check(self) -> None:
        """Read every file once. Raises SceneError for one that cannot be read or does not fit."""
        for k in range(len(self.files)):
            self._read(k)
            if self.emission_grid is not None:
                self._read_emission(k)

    def _stamp(self, path: Path) -> int:
        try:
            return path.stat().st_mtime_ns
        except OSError as error:
            raise SceneError(
                f"cannot be read ({error.strerror or error})",
                where=path,
                remedy="The sequence had it when the scene was loaded.",
            ) from None

    def _read_emission(self, k: int) -> F32:
        assert self.emission_grid is not None
        # The file's time of change is part of the key, so that a file written again is read again.
        path = self.files[k]
        key = (path, self._stamp(path), self.grid, self.channels)
        return self._fitting(_with_emission(*key, self.emission_grid)[1], path)

    def _read(self, k: int) -> F32:
        path = self.files[k]
        key = (path, self._stamp(path), self.grid, self.channels)
        if self.emission_grid is None:
            # With an emission the density comes on the box that holds both.
            return self._fitting(_density(*key), path)
        return self._fitting(_with_emission(*key, self.emission_grid)[0], path)

    def _fitting(self, density: F32, path: Path) -> F32:
        # A frame with nothing in it may be of any size, as sparse files have no other for it.
        if density.shape[:3] != self.shape and not density.any():
            return _nothing((*self.shape, *density.shape[3:]))
        if density.shape[:3] != self.shape:
            have, want = (" x ".join(map(str, s)) for s in (density.shape[:3], self.shape))
            raise SceneError(
                f"its grid has {have} cells, the sequence's first has {want}",
                where=path,
                remedy="Resample the sequence to one size.",
            )
        return density


@lru_cache(maxsize=3)
def _nothing(shape: tuple[int, ...]) -> F32:
    """Zeros, always the same array."""
    nothing = np.zeros(shape, np.float32)
    nothing.flags.writeable = False
    return nothing


@lru_cache(maxsize=3)
def _density(path: Path, stamp_ns: int, grid: str, channels: str) -> F32:
    """A file's grid as it was at `stamp_ns`; the last few are kept."""
    from ..io.volumes import read_volume

    density = read_volume(path, grid, channels).density
    density.flags.writeable = False
    return density


@lru_cache(maxsize=3)
def _with_emission(
    path: Path, stamp_ns: int, grid: str, channels: str, emission_grid: str
) -> tuple[F32, F32]:
    """A file's density and its emission grid, on one box that holds both."""
    from ..io.emission_files import on_one_grid
    from ..io.volumes import read_values, read_volume

    found, glow = on_one_grid(read_volume(path, grid, channels), read_values(path, emission_grid))
    for values in (found.density, glow):
        values.flags.writeable = False
    return found.density, glow
