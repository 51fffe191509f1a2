"""Volumes that are a sequence of files, each with a box of its own."""

from __future__ import annotations

import threading
from collections import OrderedDict
from dataclasses import dataclass, field, replace
from functools import cached_property, lru_cache
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from ...errors import SceneError
from ...maths.colour import in_rgb
from ...maths.transforms import triple
from ..checks import F32, F64, Bounds
from .boxes import mixed
from .density import changed_grids, with_grid

if TYPE_CHECKING:
    from ..io.ledger import Stamp
    from ..volume import Volume

_FEWEST, _MOST_BYTES = 3, 1 << 28  # files whose grids are cached, and up to which size more are
_SAME = 1e-5  # of a voxel's side: voxels turned by less are turned alike


@dataclass(frozen=True, eq=False)
class FileSequence:
    """`files`, one after the other, `fps` a second from `start_s` on.

    Between two files their grids are mixed; with `between` "step" the earlier one holds.
    Before the first and after the last these hold; with `is_loop` the first follows the last.
    `grid` and `channels` as in `read_volume`; `emission_grid` and the grids of `colours`, pairs of
    coefficient and name, are of the same files, if any. `times`, where given, are as many as
    `files`: which of a file's several times each is, None where it has but one.

    Each file has its own box, as simulations grow: `shape` (z, y, x) and `bounds` are those of one
    that is not empty, `turn` (4, 4) what its file has after them. Without `bounds` all files are of
    one shape, and lie where the volume does.
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
    colours: tuple[tuple[str, str], ...] = ()
    bounds: Bounds | None = None
    turn: F64 = field(default_factory=lambda: np.eye(4))
    times: tuple[int | None, ...] = ()

    @property
    def changes_boxes(self) -> bool:
        """Whether the volume's box may be another one at another time."""
        return self.bounds is not None

    @property
    def end_s(self) -> float:
        """When the last file has been shown, seconds; infinite in a loop."""
        return float("inf") if self.is_loop else self.start_s + len(self.files) / self.fps

    @property
    def steps(self) -> tuple[int, float, float]:
        """How many files or times of files, when the first is shown, and how many a second."""
        return len(self.files), self.start_s, self.fps

    def of(self, volume: Volume, time_s: float) -> Volume:
        """The `volume` with the grids of a time, on the box of their file.

        Between two files that differ it is a box that holds both. Raises SceneError for a file that
        cannot be read or does not fit.
        """
        place, count = (time_s - self.start_s) * self.fps, len(self.files)
        # A frame's time is a quotient; a hair before a file's time is that time.
        nearest = round(place)
        place = float(nearest) if abs(place - nearest) < 1e-6 else place
        # Within the files: round and round, or the ends hold.
        place = place % count if self.is_loop else min(max(place, 0.0), count - 1.0)
        k, u = int(place), place - int(place)
        if u == 0.0 or self.between == "step":
            return self._with_file(volume, k)
        return mixed(self._with_file(volume, k), self._with_file(volume, (k + 1) % count), u)

    def check(self) -> None:
        """Read every file once. Raises SceneError for one that cannot be read or does not fit."""
        for k, path in enumerate(self.files):
            self._fitting(self._read(k), path)

    def _with_file(self, volume: Volume, k: int) -> Volume:
        """The volume with the grids of file number `k`."""
        path = self.files[k]
        read = self._fitting(self._read(k), path)
        emission = volume.emission
        if read.glow is not None:
            emission = with_grid(emission, read.glow)
        bounds = volume.bounds if read.bounds is None else read.bounds
        return changed_grids(
            volume, density=read.density, emission=emission, bounds=bounds, **read.colours
        )

    def _read(self, k: int) -> FileGrids:
        """The grids of file number `k` as it is now."""
        from ..io.ledger import stamp_of

        path = self.files[k]
        try:
            path.stat()
        except OSError as error:
            raise SceneError(
                f"cannot be read ({error.strerror or error})",
                where=path,
                remedy="The sequence had it when the scene was loaded.",
            ) from None
        # The file's time of change is part of the key, so that a file written again is read again.
        time = self.times[k] if self.times else None
        wanted = _Wanted(self.grid, self.channels, time, self.emission_grid, self.colours)
        return _RECENT.of((path, stamp_of(path), wanted, _Turn(self.turn.tobytes())))

    def _fitting(self, read: FileGrids, path: Path) -> FileGrids:
        """What was read, in this sequence's box where its own does not count."""
        if read.is_empty:
            # A frame with nothing in it may be of any size, as sparse files have no other for it.
            return _nothing(self.shape, self.bounds, read.channels)
        # Where each file says where it is, boxes may differ, but not the way in which voxels lie.
        if self.bounds is not None:
            if read.bounds is None:
                raise SceneError(
                    "does not say where it is, as others of the sequence do",
                    where=path,
                    remedy="Give the volume bounds, for all of them.",
                )
            if read.is_turned:
                raise SceneError(
                    "its voxels are turned otherwise than those of the sequence's first",
                    where=path,
                    remedy="Write all files with one transform.",
                )
            return read
        # Without places of their own all have one box, and so as many cells.
        if read.density.shape != self.shape:
            have, want = (" x ".join(map(str, s)) for s in (read.density.shape, self.shape))
            raise SceneError(
                f"its grid has {have} cells, the sequence's first has {want}",
                where=path,
                remedy="Resample the sequence to one size."
                if read.bounds is None
                else "Leave out bounds: each file says where it is.",
            )
        return replace(read, bounds=None)


@dataclass(frozen=True)
class _Turn:
    """A matrix (4, 4) as part of a key."""

    data: bytes

    @property
    def matrix(self) -> F64:
        return np.frombuffer(self.data).reshape(4, 4)


@dataclass(frozen=True, eq=False)
class FileGrids:
    """What a volume takes of one file: grids on one box, which cannot be written.

    `bounds`: the box, before the `turn` of the sequence; None where the file does not say it, or
    `is_turned` by another matrix than that. `colours`: arguments of a Volume. `channels`: by the
    name of each of them and "glow", where it has several.
    """

    density: F32
    glow: F32 | None
    colours: dict[str, F32]
    bounds: Bounds | None
    is_turned: bool = False

    @cached_property
    def is_empty(self) -> bool:
        """Whether it holds nothing that could be seen."""
        return not self.density.any() and (self.glow is None or not self.glow.any())

    @property
    def channels(self) -> tuple[tuple[str, tuple[int, ...]], ...]:
        """The grids beside the density, each with the shape of a voxel's value."""
        others = {**self.colours} if self.glow is None else {**self.colours, "glow": self.glow}
        return tuple((name, values.shape[3:]) for name, values in others.items())


@lru_cache(maxsize=3)
def _nothing(
    shape: tuple[int, ...],
    bounds: Bounds | None,
    channels: tuple[tuple[str, tuple[int, ...]], ...],
) -> FileGrids:
    """Zeros, always the same arrays."""
    made = {name: np.zeros((*shape, *of), np.float32) for name, of in channels}
    density = np.zeros(shape, np.float32)
    for values in (density, *made.values()):
        values.flags.writeable = False
    return FileGrids(density, made.pop("glow", None), made, bounds)


@dataclass(frozen=True)
class _Wanted:
    """Names of a file's grids, as `FileSequence` has them, at a `time` as `read_volume` has it."""

    grid: str
    channels: str
    time: int | None
    glow: str | None
    colours: tuple[tuple[str, str], ...]


def _file_grids(path: Path, stamp: Stamp | None, wanted: _Wanted, turn: _Turn) -> FileGrids:
    """The grids of a file as it was at `stamp`."""
    from ..io.coefficient_files import read_coefficients
    from ..io.emission_files import on_one_grid
    from ..io.volumes import NOWHERE, read_values, read_volume

    found, glow = read_volume(path, wanted.grid, wanted.channels, wanted.time), None
    if wanted.glow is not None:
        found, glow = on_one_grid(found, read_values(path, wanted.glow, wanted.time))
    made: dict[str, F32] = {}
    if wanted.colours:
        found, made = read_coefficients(path, found, dict(wanted.colours), {})
        # In three channels, as volumes have them, so that they stay one array from frame to frame.
        made = {name: in_rgb(values) for name, values in made.items()}
    for values in (found.density, glow, *made.values()):
        if values is not None:
            values.flags.writeable = False
    # Where its voxels lie, before the matrix of the sequence.
    bounds: Bounds | None = found.bounds
    is_turned = False
    if any(NOWHERE in text for text in found.warnings):
        bounds = None
    elif found.world_from_volume.tobytes() != turn.data:
        to_own = np.linalg.inv(turn.matrix) @ found.world_from_volume
        scale = np.diag(to_own[:3, :3])
        beside = np.abs(to_own[:3, :3] - np.diag(scale)).max()
        # A half turn leaves a diagonal, too, with numbers below 0.
        is_turned = bool(scale.min() <= 0.0 or beside > _SAME * scale.max())
        low, high = (np.array(corner) * scale + to_own[:3, 3] for corner in found.bounds)
        bounds = (triple(low), triple(high))
    return FileGrids(found.density, glow, made, bounds, is_turned)


class _RecentFiles:
    """Grids of the files read last: three, and more as long as they are small together.

    A frame with an open shutter asks for each of its files more than once: for the box that holds
    all of them, for the moments of its samples, and the next frame for most of them again.
    """

    def __init__(self) -> None:
        self._found: OrderedDict[tuple[Any, ...], FileGrids] = OrderedDict()
        self._lock = threading.Lock()  # renderers of several threads may show one sequence

    def of(self, key: tuple[Any, ...]) -> FileGrids:
        """What `_file_grids` gives for these arguments."""
        with self._lock:
            found = self._found.get(key)
        # Files are read outside of the lock: another thread may want another one.
        found = found or _file_grids(*key)
        with self._lock:
            self._found[key] = found
            self._found.move_to_end(key)
            self._drop_oldest()
        return found

    def _drop_oldest(self) -> None:
        """As long as there is too much."""
        while len(self._found) > _FEWEST and sum(map(_nbytes, self._found.values())) > _MOST_BYTES:
            self._found.popitem(last=False)


def _nbytes(read: FileGrids) -> int:
    """Bytes of its grids."""
    return sum(x.nbytes for x in (read.density, read.glow, *read.colours.values()) if x is not None)


_RECENT = _RecentFiles()
