"""How many texels the columns of a density grid have: few in thin matter, more in dense."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from ..maths.transforms import F64
from ..scene.volume import Volume
from .atlas import Size

_FEWEST_TEXELS = 4  # along a side of a grid that is small beside what reads its columns
_FINER = 3
"""Times as many texels at most along a side of a grid of dense matter, which has sharp shadows."""
_FINE_BYTES = 128 << 20
"""Of columns, on the device; if all took more, dense matter has no finer ones."""
_TEXEL_BYTES = 8


@dataclass(frozen=True)
class Fineness:
    """How fine columns are.

    `most`: texels along a grid's longest side, more only as long as one has an optical depth beyond
    `depth`. `texel_m`: they need not be finer than that, metres.
    """

    most: int
    texel_m: float = 0.0
    depth: float = math.inf


def all_texels(
    volumes: Sequence[Volume], fineness: Fineness, groups: int, limit: int
) -> list[Size]:
    """Texels of each grid towards four lights; finer in dense matter where all have room for it."""
    # Fine for dense matter, unless that takes too much memory or too deep a texture.
    fine = [_texels(volume, fineness) for volume in volumes]
    nbytes = _TEXEL_BYTES * groups * sum(x * y * z for x, y, z in fine)
    if nbytes <= _FINE_BYTES and groups * max(z for _, _, z in fine) <= limit:
        return fine
    return [_texels(volume, replace(fineness, depth=math.inf)) for volume in volumes]


def _texels(volume: Volume, fineness: Fineness) -> Size:
    """At most so many texels on the longest side, at least 2 on each.

    Two per voxel, where that allows: the mean density is not linear within voxels.
    """
    assert volume.density is not None
    shape = np.array(volume.density.shape[::-1])
    # Where light ends within a texel, the texels show along the edge of the shadow.
    sides = side_lengths(volume)
    deep = max(volume.sigma_t) * float(volume.density.max()) * float(sides.max())
    longest = min(max(fineness.most, deep / fineness.depth), _FINER * fineness.most)
    # Two texels per voxel, as long as the longest side has no more than it may.
    count = np.ceil(shape * min(2.0, longest / shape.max()))
    # Whoever reads the columns may need no texels as fine as that.
    if fineness.texel_m > 0.0:
        enough = np.ceil(sides / fineness.texel_m) + 1.0
        count = np.minimum(count, np.maximum(enough, _FEWEST_TEXELS))
    nx, ny, nz = (int(n) for n in np.maximum(2, count))
    return nx, ny, nz


def side_lengths(volume: Volume) -> F64:
    """Of a volume's box in the world, metres."""
    extent = np.subtract(volume.bounds[1], volume.bounds[0])
    sides: F64 = np.linalg.norm(np.asarray(volume.world_from_volume)[:3, :3], axis=0) * extent
    return sides
