"""Volumes of several moments on one box: grids of a growing simulation have boxes of their own."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from ..checks import F32
from ..one_grid import GridBox
from .density import with_grid

if TYPE_CHECKING:
    from ..emission import Emission
    from ..scene import Scene
    from ..volume import Volume


def box_of(volume: Volume) -> GridBox | None:
    """Where the grid of a volume lies; None of a shape."""
    if volume.density is None:
        return None
    return GridBox(volume.density.shape, volume.bounds, volume.world_from_volume)


def is_same_box(one: GridBox | None, other: GridBox | None) -> bool:
    """Whether grids on both boxes have the same voxels in the same places."""
    if one is None or other is None:
        return one is other
    is_same = one.shape == other.shape and one.bounds == other.bounds
    return is_same and np.array_equal(one.world_from_volume, other.world_from_volume)


def common_box(boxes: Iterable[GridBox]) -> GridBox:
    """A box of the smallest voxels among `boxes` that holds all of them. Raises SceneError."""
    every = list(boxes)
    found = min(every, key=lambda box: box.voxel_m3)
    for box in every:
        found = found.holding(box)
    return found


def on_box(volume: Volume, box: GridBox) -> Volume:
    """The volume with its grids on the voxels of `box`; the very same where it has them.

    Albedo and mean cosine are means over what is in a voxel, so that all extinction, scattering and
    emission stay.
    """
    own = box_of(volume)
    if own is None or is_same_box(own, box):
        return volume
    assert volume.density is not None
    extinction = (
        volume.density[..., None]
        if volume.tint is None
        else (volume.density[..., None] * volume.tint)
    )
    scattering = extinction if volume.albedo_grid is None else extinction * volume.albedo_grid
    made: dict[str, Any] = {"density": box.values_of(volume.density, own)}
    # What is multiplied with something is placed with it, and divided by it.
    weights = (volume.density[..., None], extinction, scattering)
    for name, weight in zip(("tint", "albedo_grid", "g_grid"), weights, strict=True):
        values = getattr(volume, name)
        if values is not None:
            made[name] = _placed_mean(box, own, values, weight)
    glow = _glow(volume.emission)
    if glow is not None:
        made["emission"] = with_grid(volume.emission, box.values_of(glow, own))
    made |= {"bounds": box.bounds, "world_from_volume": box.world_from_volume}
    return replace(volume, **made)


def _is_empty(volume: Volume) -> bool:
    """Whether its grids hold nothing that could be seen."""
    grids = (volume.density, _glow(volume.emission))
    return not any(grid is not None and grid.any() for grid in grids)


def _placed_mean(box: GridBox, own: GridBox, values: F32, weight: F32) -> F32:
    sums = box.values_of(np.asarray(values * weight, np.float32), own)
    weights = box.values_of(np.asarray(weight, np.float32), own)
    means = np.divide(sums, weights, where=weights > 0.0, out=np.zeros_like(sums))
    return np.asarray(np.clip(means, min(0.0, values.min()), values.max()))  # beside rounding


def _glow(emission: Emission | None) -> F32 | None:
    """The grid of an emission, of light or of temperature."""
    if emission is None:
        return None
    return emission.grid if emission.temperature is None else emission.temperature


def mixed(one: Volume, other: Volume, u: float) -> Volume:
    """`one` on the way to `other`, of the same file sequence: 0 is one, 1 the other.

    Where their boxes differ it is on a box that holds both. Raises SceneError.
    """
    # Where there is nothing, the box is that of what there is.
    filled = [volume for volume in (one, other) if not _is_empty(volume)] or [one]
    box = common_box([box for box in map(box_of, filled) if box])
    one, other = on_box(one, box), on_box(other, box)
    made: dict[str, Any] = {"density": _between(one.density, other.density, u)}
    glow = _between(_glow(one.emission), _glow(other.emission), u)
    if glow is not None:
        made["emission"] = with_grid(one.emission, glow)
    # Colours count by what there is of each: extinction and scattering are mixed.
    assert one.density is not None and other.density is not None
    weights = [one.density[..., None] * (1.0 - u), other.density[..., None] * u]
    for name in ("albedo_grid", "g_grid"):
        pair = [getattr(v, name) for v in (one, other)]
        if pair[0] is not None and pair[1] is not None:
            parts = [values * weight for values, weight in zip(pair, weights, strict=True)]
            whole = np.maximum(weights[0] + weights[1], np.float32(1e-30))
            low, high = min(0.0, *(v.min() for v in pair)), max(v.max() for v in pair)
            made[name] = np.clip((parts[0] + parts[1]) / whole, low, high)  # beside rounding
            weights = parts
    return replace(one, **made)


def _between(one: F32 | None, other: F32 | None, u: float) -> F32 | None:
    if one is None or other is None:
        return None
    return np.asarray((1.0 - u) * one + u * other, np.float32)


@dataclass(frozen=True, eq=False)
class CommonBoxes:
    """For each volume of a scene the box that holds its grid at several moments.

    None where it has one and the same box at all of them.
    """

    boxes: tuple[GridBox | None, ...]

    @classmethod
    def at(cls, scene: Scene, times_s: Iterable[float]) -> CommonBoxes:
        """Those of a scene at some times, seconds. Raises SceneError."""
        if scene.animation is None or not scene.animation.changes_boxes:
            return cls((None,) * len(scene.volumes))
        # Boxes alone stay in memory, one for each place that a grid has had.
        found: list[list[GridBox]] = [[] for _ in scene.volumes]
        for time in times_s:
            for volume, boxes in zip(scene.at(time).volumes, found, strict=True):
                box = box_of(volume)
                if box and not any(is_same_box(box, other) for other in boxes):
                    boxes.append(box)
        return cls(tuple(common_box(boxes) if len(boxes) > 1 else None for boxes in found))

    def on(self, scene: Scene) -> Scene:
        """The scene with its volumes on these boxes; the very same where none has several."""
        if not any(self.boxes):
            return scene
        pairs = zip(scene.volumes, self.boxes, strict=True)
        return replace(scene, volumes=tuple(on_box(v, box) if box else v for v, box in pairs))
