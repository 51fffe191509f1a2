"""The fire: temperatures of burning wood, flames below smoke, moving upwards, inside its box."""

from __future__ import annotations

import numpy as np
import pytest

from airlight.errors import SceneError
from airlight.scene.builtin.fire import HOTTEST_K, SHAPE, fire, soot, temperature


def test_it_is_its_own_light_and_says_its_optics() -> None:
    scene = fire(time=1.0)
    (volume,) = scene.volumes
    assert not scene.lights
    assert volume.is_emissive
    assert volume.density.shape == volume.emission.size == SHAPE
    assert volume.density.min() >= 0.0 and 0.3 < volume.density.max() <= 1.0
    kelvin = volume.emission.temperature
    assert 1700.0 < kelvin.max() <= HOTTEST_K
    with pytest.raises(SceneError, match="time must be a number"):
        fire(time="now")


def test_flames_are_low_and_narrow_and_smoke_rises_out_of_them() -> None:
    glow = fire(time=1.0).volumes[0].emission.values.mean(axis=3)
    height = np.arange(SHAPE[1])
    flames, smoke = (np.average(height, weights=g.sum(axis=(0, 2))) for g in (glow, soot(1.0, 4)))
    assert flames < 0.35 * SHAPE[1] < smoke
    for grid in (glow, soot(1.0, 4)):
        sides = (grid[0], grid[-1], grid[..., 0], grid[..., -1], grid[:, -1])
        assert max(float(side.max()) for side in sides) < 0.02 * grid.max()


def test_it_burns_smoothly_and_both_grids_move_with_the_scenes_time() -> None:
    scene = fire()
    now, soon, later = (scene.at(t).volumes[0] for t in (0.0, 0.01, 1.0))
    assert now is scene.at(0.0).volumes[0] or np.array_equal(now.density, soot(0.0, 4))
    np.testing.assert_array_equal(later.emission.temperature, temperature(1.0, 4))
    np.testing.assert_array_equal(later.density, soot(1.0, 4))
    first, second, last = (v.emission.temperature for v in (now, soon, later))
    assert 0.0 < np.abs(second - first).sum() < 0.3 * np.abs(last - first).sum()
