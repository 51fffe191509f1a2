"""Density grids as boxes of one texture."""

from __future__ import annotations

import numpy as np
import pytest

from airlight.errors import SceneError
from airlight.gpu.device import Gpu
from airlight.media.atlas import DensityAtlas, Region, packed

RNG = np.random.default_rng(3)


def grid(*shape: int) -> np.ndarray:
    return RNG.uniform(0, 1, shape).astype(np.float32)


def read(atlas: DensityAtlas, region: Region) -> np.ndarray:
    (x, y, z), (nx, ny, nz) = region.first, region.count
    return atlas.texture.read().reshape(*atlas.texture.size[::-1], 2)[
        z : z + nz, y : y + ny, x : x + nx, 0
    ]


@pytest.mark.parametrize("count", [1, 2, 7, 100])
def test_boxes_lie_apart(count: int) -> None:
    counts = [(int(a), int(b), int(c)) for a, b, c in RNG.integers(1, 30, (count, 3))]
    regions, size = packed(counts, 2048)
    taken = np.zeros(size, int)
    for region, want in zip(regions, counts, strict=True):
        assert region.count == want
        (x, y, z), (nx, ny, nz) = region.first, region.count
        taken[x : x + nx, y : y + ny, z : z + nz] += 1
    assert taken.max() == 1
    assert taken.sum() == sum(a * b * c for a, b, c in counts)
    # Boxes of all sizes leave gaps; the texture is not many times what they hold.
    assert taken.mean() > 0.25
    assert count > 1 or size == counts[0]


def test_what_does_not_fit_is_refused() -> None:
    with pytest.raises(SceneError, match="do not fit into one texture of 64 on a side"):
        packed([(60, 60, 60)] * 2, 64)


def test_equal_arrays_share_texels_until_they_differ(gpu: Gpu) -> None:
    a, b = grid(4, 5, 6), grid(3, 3, 3)
    atlas = DensityAtlas(gpu, [a, b, a])
    assert atlas.regions[0] == atlas.regions[2] != atlas.regions[1]
    before = atlas.version
    atlas.update([a, b, a])
    assert atlas.version == before
    for now in ([a, b, grid(4, 5, 6)], [grid(4, 5, 6), b, a]):
        atlas.update(now)
        assert atlas.version > before
        before = atlas.version
        for region, density in zip(atlas.regions, now, strict=True):
            np.testing.assert_array_equal(read(atlas, region), density.astype(np.float16))


def test_a_grid_keeps_its_size(gpu: Gpu) -> None:
    atlas = DensityAtlas(gpu, [grid(4, 4, 4), grid(2, 2, 2)])
    with pytest.raises(SceneError, match=r"changed from \(2, 2, 2\) to \(2, 2, 3\) cells"):
        atlas.update([grid(4, 4, 4), grid(2, 2, 3)])
