"""Densities: inside their boxes, moving smoothly, shaped as smoke and as a cloud."""

from __future__ import annotations

import importlib

import numpy as np
import pytest

from airlight.errors import SceneError
from airlight.scene.builtin.cloud import PER_M, cloud, cumulus_density
from airlight.scene.builtin.milk import knot, milk
from airlight.scene.builtin.smoke import SHAPE, plume_density, smoke


def test_smoke_has_the_optics_it_says() -> None:
    (volume,) = smoke(time=1.0).volumes
    assert volume.sigma_t == (8.0, 8.0, 8.0) and volume.albedo[0] == 0.95 and volume.g[0] == 0.6
    assert volume.density.shape == SHAPE == (64, 128, 64)
    assert volume.density.min() >= 0.0 and 0.5 < volume.density.max() <= 1.0
    with pytest.raises(SceneError, match="time must be a number, not 'now'"):
        smoke(time="now")


def test_plume_widens_and_thins_as_it_rises_and_stays_in_its_box() -> None:
    density = plume_density(0.0, 11)
    z, _, x = np.meshgrid(*(np.arange(n) - (n - 1) / 2 for n in SHAPE), indexing="ij")
    away = np.hypot(x, z)
    width = (density * away).sum(axis=(0, 2)) / np.maximum(density.sum(axis=(0, 2)), 1e-9)
    assert width[80:106].mean() > 2.0 * width[6:16].mean()
    assert density[:, 80:106].max() < density[:, 6:16].max()
    for side in (density[0], density[-1], density[..., 0], density[..., -1], density[:, -1]):
        assert side.max() < 0.02


def test_plume_moves_smoothly_upwards() -> None:
    now, soon, later = (plume_density(t, 11) for t in (2.0, 2.02, 3.0))
    change = np.abs(soon - now).sum() / now.sum()
    assert 0.0 < change < 0.25
    assert np.abs(later - now).sum() / now.sum() > 2.0 * change
    # Over an eighth of a second the mean flow carries smoke up by three cells of 37.5 mm.
    moved, middle = plume_density(2.125, 11), slice(27, 93)
    lifted = np.roll(now, 3, axis=1)
    assert np.abs(moved - lifted)[:, middle].sum() < np.abs(moved - now)[:, middle].sum()


def test_paths_between_traced_cells_are_those_that_would_be_traced(monkeypatch) -> None:
    # The module, whose name the scene in it has taken.
    made = importlib.import_module("airlight.scene.builtin.smoke")
    between = plume_density(1.0, 11)
    monkeypatch.setattr(made, "_TRACED", SHAPE)
    traced = plume_density(1.0, 11)
    assert np.abs(between - traced).sum() < 0.06 * traced.sum()
    assert between.sum() == pytest.approx(traced.sum(), rel=0.01)


def test_cloud_is_a_heap_with_a_flat_base_inside_its_box() -> None:
    (volume,) = cloud().volumes
    density = volume.density
    assert density.shape == (128, 80, 128) and volume.g[0] == 0.85
    assert density.max() == pytest.approx(1.0, abs=1e-3) and 0.05 < density.mean() < 0.3
    for axis in range(3):
        borders = np.take(density, [0, -1], axis)
        assert borders.max() < 0.05
    covered = (density > 0.3).sum(axis=(0, 2))
    base = int(np.argmax(covered > 50 * PER_M**2))  # 50 m^2
    assert covered[base + 4 * PER_M] > 0.6 * covered.max()
    assert not np.array_equal(density, cumulus_density(6))


def test_milk_is_the_inside_of_a_closed_knot():
    """The grid's mass is the volume that the mesh encloses, by the divergence theorem."""
    scene, mesh = milk(), knot()
    (volume,) = scene.volumes
    assert volume.density is not None
    low, high = np.array(volume.bounds)
    corners = mesh.positions.astype(float)[mesh.indices]
    enclosed = abs(np.linalg.det(corners).sum()) / 6.0
    mass = volume.density.mean() * np.prod(high - low)
    assert mass == pytest.approx(enclosed, rel=0.02)
    edges = np.concatenate([volume.density[[0, -1]].ravel(), volume.density[:, :, [0, -1]].ravel()])
    assert edges.max() == 0.0
    assert volume.density.max() == 1.0
