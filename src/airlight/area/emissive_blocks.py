"""What media emit in blocks of their voxels, for `glowing`: where it is, and how much."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..maths.transforms import transformed
from ..scene.checks import F64, I64
from ..scene.medium import Medium, medium_box
from ..scene.scene import Scene
from ..scene.volume import Volume

PER_AXIS = 16
"""A volume is cut into so many blocks along each axis, at most."""


@dataclass(frozen=True, eq=False)
class Blocks:
    """`positions` (n, 3), metres, of the light's centre in each; `intensity` (n, 3), W sr^-1.

    `variance` (n,), m^2: of the light's distance from that centre; `volume` (n,): which medium.
    """

    positions: F64
    intensity: F64
    variance: F64
    volume: I64

    @property
    def weight(self) -> F64:
        """The mean of the channels (n,)."""
        return np.asarray(self.intensity.mean(axis=1))


def emissive_blocks(scene: Scene) -> Blocks | None:
    """What the scene's media emit, in blocks that stay where they are while emission changes."""
    found = []

    # The medium first, then volumes, as rows of media are counted.
    if scene.medium is not None and max(scene.medium.emission) > 0.0:
        found.append(_of_medium(scene.medium, scene))
    found += [_of_volume(v) for v in scene.volumes if v.is_emissive]
    if not found:
        return None
    positions, intensity, variance = (np.concatenate(c) for c in zip(*found, strict=True))
    owners = np.repeat(np.arange(len(found)), [len(part[0]) for part in found])
    return Blocks(positions, intensity, variance, owners)


_Columns = tuple[F64, F64, F64]


def _of_volume(volume: Volume) -> _Columns:
    emission = volume.emission
    assert emission is not None
    radiance = np.array(emission.radiance, np.float64)
    # A volume glows by its own grid of emission, else as dense as it is, else all over its shape.
    values: NDArray[np.floating]
    if volume.density is None:
        values = _shape_values(volume.shape == "sphere")
    elif emission.values is None:
        values = volume.density[..., None]
    else:
        values = emission.values
    centres, sums = _summed(values)
    low, high = np.array(volume.bounds)
    matrix = volume.world_from_volume
    # A voxel emits its share of the volume, 1 at the box's own size.
    size = abs(float(np.linalg.det(matrix[:3, :3]))) * float(np.prod(high - low))
    intensity = sums * radiance * (size / np.prod(values.shape[:3]))
    # In the world its box may be turned and stretched: the variance takes its sides there.
    points = transformed(low + centres * (high - low), matrix)
    sides = np.linalg.norm(matrix[:3, :3] * (high - low), axis=0)
    return points, intensity, _variance(values.shape, sides, len(points))


def _of_medium(medium: Medium, scene: Scene) -> _Columns:
    # An endless medium counts as far as the scene reaches.
    low, high = scene.bounds if medium.endless else (None, None)
    if low is None or high is None:
        low, high = medium_box(medium, *scene.bounds, scene.camera.position)
    # Alike all over its box: each of 512 voxels sends an equal part.
    values = np.ones((8, 8, 8, 1))
    centres, sums = _summed(values)
    size = np.maximum(high - low, 0.0)
    intensity = sums * np.array(medium.emission) * (float(np.prod(size)) / 512.0)
    return low + centres * size, intensity, _variance(values.shape, size, len(centres))


def _shape_values(is_ball: bool) -> F64:
    """(16, 16, 16, 1): how much of each voxel is inside a box or the ball in it."""
    # Each of 16 voxels a side by 4 x 4 x 4 points.
    fine = (np.arange(64) + 0.5) / 32.0 - 1.0
    z, y, x = np.meshgrid(fine, fine, fine, indexing="ij")
    inside = np.where(x * x + y * y + z * z <= 1.0, 1.0, 0.0) if is_ball else np.ones_like(x)
    return np.asarray(inside.reshape(16, 4, 16, 4, 16, 4).mean(axis=(1, 3, 5))[..., None])


def _summed(values: NDArray[np.floating]) -> tuple[F64, F64]:
    """Centres of light (n, 3), 0..1 along x, y, z, and sums (n, 3) of blocks of voxels."""
    starts = [_starts(n) for n in values.shape[:3]]

    # Sums over blocks of the mean channel.
    shape = values.shape[:3]
    weight = values.mean(axis=3, dtype=np.float32)
    total = _reduced(weight, starts)
    # Each block's centre of light; its own centre where it is dark.
    centres = []
    for axis in (2, 1, 0):
        own = [1, 1, 1]
        own[axis] = -1
        at = ((np.arange(shape[axis]) + 0.5) / shape[axis]).astype(np.float32).reshape(own)
        middles = _reduced(np.broadcast_to(at, shape), starts) / _reduced(np.ones(shape), starts)
        centres.append(
            np.where(total > 0.0, _reduced(weight * at, starts) / np.maximum(total, 1e-30), middles)
        )
    # A grid of one channel is grey.
    sums = [_reduced(values[..., k], starts) for k in range(values.shape[3])]
    colours = np.stack(sums if len(sums) == 3 else sums * 3, axis=-1)
    points = np.stack(centres, axis=-1)
    return points.reshape(-1, 3).astype(np.float64), colours.reshape(-1, 3)


def _starts(size: int) -> I64:
    # Blocks of nearly equal numbers of voxels.
    count = min(size, PER_AXIS)
    return np.asarray(np.arange(count) * size // count)


def _reduced(values: NDArray[np.floating], starts: list[I64]) -> F64:
    # One axis after the other.
    summed = np.asarray(values)
    for axis, at in enumerate(starts):
        summed = np.add.reduceat(summed, at, axis=axis, dtype=np.float64)
    return np.asarray(summed)


def _variance(shape: tuple[int, ...], sides: F64, count: int) -> F64:
    """Of uniform light in a block: a twelfth of the squares of its sides."""
    blocks = np.minimum(np.array(shape[2::-1]), PER_AXIS)
    return np.full(count, float(((sides / blocks) ** 2).sum()) / 12.0)
