"""Noise tiles, is normalised, and its octaves are exact B-splines."""

from __future__ import annotations

import numpy as np
import pytest

from airlight.scene.builtin import noise
from airlight.scene.builtin.noise import fractal_noise, smoothstep


@pytest.mark.parametrize("shape", [(96, 64), (24, 32, 40)])
def test_normalised_and_tileable(shape: tuple[int, ...]) -> None:
    cells = (3, 4, 5)[: len(shape)]
    field = fractal_noise(shape, cells, np.random.default_rng(1), octaves=3)
    assert field.shape == shape and field.dtype == np.float32
    assert abs(field.mean()) < 1e-4 and field.std() == pytest.approx(1.0, abs=1e-4)
    for axis in range(len(shape)):
        steps = np.abs(np.diff(field, axis=axis, append=np.take(field, [0], axis)))
        seam, inside = np.take(steps, -1, axis), np.delete(steps, -1, axis)
        assert seam.mean() < 1.6 * inside.mean()


def test_halving_keeps_the_spline() -> None:
    coarse = np.random.default_rng(2).standard_normal((6, 5)).astype(np.float32)
    fine = noise._halved(coarse)
    assert fine.shape == (12, 10)
    assert np.allclose(noise._spread(coarse, (60, 40)), noise._spread(fine, (60, 40)), atol=1e-5)


def test_constant_stays_constant_and_fine_octaves_stop() -> None:
    assert np.allclose(noise._spread(np.ones((4, 4), np.float32), (9, 7)), 1.0, atol=1e-6)
    rng = np.random.default_rng
    many, few = (fractal_noise((32, 32), (4, 4), rng(3), octaves=n) for n in (12, 3))
    assert np.array_equal(many, few)


def test_smoothstep() -> None:
    x = np.array([-1.0, 0.0, 0.5, 1.0, 2.0], np.float32)
    assert np.allclose(smoothstep(0.0, 1.0, x), (0, 0, 0.5, 1, 1))
    assert np.allclose(smoothstep(1.0, 0.0, x), (1, 1, 0.5, 0, 0))
