"""Volume: a grid or a shape, never both, never negative."""

from __future__ import annotations

import numpy as np
import pytest

from airlight.errors import SceneError
from airlight.scene import Volume

GRID = np.ones((2, 3, 4), np.float32)


def test_a_grid_is_kept_read_only():
    volume = Volume(sigma_t=3, density=GRID)
    assert volume.density.shape == (2, 3, 4)
    assert not volume.density.flags.writeable
    assert volume.sigma_t == (3.0, 3.0, 3.0)
    np.testing.assert_array_equal(volume.world_from_volume, np.eye(4))


def test_a_shape_has_no_grid():
    assert Volume(sigma_t=1, shape="sphere").density is None


@pytest.mark.parametrize(
    ("values", "expected"),
    [
        ({}, "needs either a density grid or a shape"),
        ({"density": GRID, "shape": "box"}, "needs either a density grid or a shape"),
        ({"shape": "cone"}, "volume shape 'cone' is unknown. Use box or sphere."),
        ({"density": -GRID}, r"volume density is negative \(down to -1\)"),
        ({"density": GRID[0]}, r"volume density has shape \(3, 4\), it must be \(n, n, n\)"),
        ({"density": GRID[:0]}, "volume density is empty"),
        ({"density": GRID * np.nan}, "volume density has 24 values that are NaN"),
        ({"shape": "box", "bounds": ((0, 0, 0), (1, 1, 0))}, "volume bounds is empty"),
        ({"shape": "box", "world_from_volume": np.eye(3)}, r"volume transform has shape \(3, 3\)"),
        ({"shape": "box", "detail": -1}, r"detail = -1 is outside \[0, 10\]"),
    ],
)
def test_impossible_volumes_are_refused(values, expected):
    with pytest.raises(SceneError) as caught:
        Volume(sigma_t=1, **values)
    assert caught.match(expected)


@pytest.mark.parametrize("name", ["density", "albedo", "emission"])
def test_lists_of_unequal_lengths_are_no_grids(name):
    from airlight.scene import Emission

    ragged, grid = [[[1.0, 2.0], [3.0]]], np.ones((2, 2, 2), np.float32)
    with pytest.raises(SceneError, match="must be"):
        if name == "emission":
            Volume(sigma_t=1.0, density=grid, emission=Emission(radiance=1.0, grid=ragged))
        else:
            Volume(sigma_t=1.0, **{"density": grid, name: ragged})
