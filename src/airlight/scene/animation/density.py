"""Volumes whose density changes; `file_sequence` has those of files."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any, ClassVar, Protocol

import numpy as np

from ...errors import SceneError
from ..checks import F32
from ..emission import Emission

if TYPE_CHECKING:
    from ..scene import Scene
    from ..volume import Volume


class Density(Protocol):
    """What a volume's grids are by time."""

    @property
    def end_s(self) -> float:
        """When it comes to rest, seconds; infinite where it never does."""

    @property
    def changes_boxes(self) -> bool:
        """Whether the volume's box may be another one at another time."""

    def of(self, volume: Volume, time_s: float) -> Volume:
        """The `volume` as it is at a time, whatever it was before; the very same where it is."""


@dataclass(frozen=True, eq=False)
class VolumeTrack:
    """The scene's volume number `index`, a density grid."""

    index: int
    density: Density

    @property
    def changes_boxes(self) -> bool:
        """Whether the volume's box may be another one at another time."""
        return self.density.changes_boxes

    @property
    def end_s(self) -> float:
        """When it comes to rest, seconds."""
        return self.density.end_s

    @property
    def steps(self) -> tuple[int, float, float] | None:
        """Of a sequence of files as `Animation.steps` has it."""
        return getattr(self.density, "steps", None)

    def apply(self, scene: Scene, time_s: float) -> Scene:
        """The scene with the volume as dense as it is."""
        volumes = list(scene.volumes)
        if self.index >= len(volumes):
            raise SceneError(
                f"the animation changes volume {self.index + 1}, but the scene has {len(volumes)}"
            )
        volume = volumes[self.index]
        volumes[self.index] = self.density.of(volume, time_s)
        if volumes[self.index] is volume:
            return scene  # what did not change need not be uploaded or solved again
        return replace(scene, volumes=tuple(volumes))


def changed_grids(volume: Volume, **values: Any) -> Volume:
    """The volume with other `values`; the very same where they are its own.

    Arrays of the same memory count as unchanged, and so do equal bounds.
    """
    own = {name: getattr(volume, name) for name in values}
    is_same = all(_is_same(own[name], value) for name, value in values.items())
    return volume if is_same else replace(volume, **values)


def _is_same(one: Any, other: Any) -> bool:
    """Whether bounds are equal, or arrays one and the same memory."""
    if isinstance(one, np.ndarray) and isinstance(other, np.ndarray):
        return one is other or (one.shape == other.shape and np.shares_memory(one, other))
    return one is other or (isinstance(one, tuple) and one == other)


def with_grid(emission: Emission | None, grid: F32) -> Emission | None:
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
    changes_boxes: ClassVar[bool] = False

    def of(self, volume: Volume, time_s: float) -> Volume:
        """The `volume` with the grids of a time."""
        glow = None if self.make_emission is None else self.make_emission(time_s)
        emission = volume.emission if glow is None else with_grid(volume.emission, glow)
        return changed_grids(volume, density=self.make(time_s), emission=emission)
