"""Volumes whose coefficients differ from voxel to voxel are sums of volumes whose do not."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from airlight.errors import SceneError
from airlight.scene import Emission, Scene, Volume
from airlight.scene.coefficients import grouped, in_parts
from airlight.scene.shown import drawn_alike

RNG = np.random.default_rng(8)
SHAPE = (3, 4, 5)
DENSITY = RNG.random(SHAPE, dtype=np.float32)
COLOURS = RNG.random((*SHAPE, 3), dtype=np.float32)
COSINES = (1.4 * RNG.random(SHAPE, dtype=np.float32) - 0.6).astype(np.float32)


def added_up(volume: Volume) -> dict[str, np.ndarray]:
    """sigma_s, sigma_a, sigma_s g in every voxel, of all parts."""
    sums = {name: np.zeros((*SHAPE, 3)) for name in ("sigma_s", "sigma_a", "g")}
    for part in volume.parts:
        assert not part.has_coefficient_grids
        sigma_t = part.density[..., None] * np.array(part.sigma_t)
        scattered = sigma_t * part.albedo
        sums["sigma_s"] += scattered
        sums["sigma_a"] += sigma_t - scattered
        sums["g"] += scattered * part.g
    return sums


@pytest.mark.parametrize(
    "grids",
    [
        {"tint": COLOURS},
        {"albedo_grid": COLOURS},
        {"albedo_grid": COLOURS[..., 0]},
        {"g_grid": COSINES},
        {"g_grid": COLOURS - 0.5},
        {"tint": COLOURS, "albedo_grid": COLOURS[::-1], "g_grid": COSINES},
    ],
    ids=["tint", "albedo", "grey albedo", "g", "g by channel", "all"],
)
def test_parts_add_up_to_the_coefficients(grids):
    volume = Volume((2.0, 3.0, 4.0), DENSITY, albedo=(0.9, 0.8, 0.7), g=(0.2,) * 3, **grids)
    full = {
        k: np.broadcast_to(v if v.ndim == 4 else v[..., None], (*SHAPE, 3))
        for k, v in grids.items()
    }
    sigma_t = DENSITY[..., None] * np.array([2.0, 3.0, 4.0]) * full.get("tint", 1.0)
    albedo = np.array([0.9, 0.8, 0.7]) * full.get("albedo_grid", 1.0)
    sums = added_up(volume)
    np.testing.assert_allclose(sums["sigma_s"], sigma_t * albedo, atol=2e-2)
    np.testing.assert_allclose(sums["sigma_a"], sigma_t * (1.0 - albedo), atol=2e-2)
    np.testing.assert_allclose(sums["g"], sigma_t * albedo * full.get("g_grid", 0.2), atol=2e-2)
    # A grid averaged over cells keeps all of it, because sums do.
    halves = sum(p.density[:, :2].mean() * np.array(p.sigma_t) for p in volume.parts)
    np.testing.assert_allclose(halves, sigma_t[:, :2].mean(axis=(0, 1, 2)), rtol=5e-3)


def test_two_colours_of_smoke_are_two_parts():
    share = np.linspace(0.0, 1.0, 60, dtype=np.float32).reshape(*SHAPE, 1)
    colours = share * np.float32([0.9, 0.2, 0.1]) + (1 - share) * np.float32([0.1, 0.3, 0.9])
    volume = Volume(5.0, DENSITY, albedo_grid=colours)
    assert len(volume.parts) == 2
    assert len(grouped(volume.parts)) == 1
    assert len(Volume(5.0, DENSITY, albedo_grid=0.5 * np.ones(SHAPE)).parts) == 1


def test_parts_of_one_phase_function_belong_together():
    """One solver's source is what all of them scatter; another phase function has another."""
    cosines = np.where(DENSITY > 0.5, 0.4, 0.0)
    volume = Volume(5.0, DENSITY, albedo_grid=COLOURS, g_grid=cosines)
    groups = grouped(in_parts(Scene(volumes=(Volume(1.0, DENSITY), volume))).volumes)
    found = [{round(p.g[0], 6) for p in group} for group in groups]
    assert found == [{0.0}, {0.0}, {0.4}]


def test_the_mean_cosine_is_that_of_what_scatters():
    cosines = np.linspace(-0.5, 0.8, 60, dtype=np.float32).reshape(SHAPE)
    volume = Volume(5.0, DENSITY, albedo_grid=COLOURS, g_grid=cosines)
    scattering = DENSITY[..., None] * COLOURS
    wanted = (scattering * cosines[..., None]).sum(axis=(0, 1, 2)) / scattering.sum(axis=(0, 1, 2))
    np.testing.assert_allclose(volume.g, wanted, rtol=1e-5)


def test_what_is_made_for_some_colours_is_not_for_others():
    """Solvers put parts into kinds when they are made, so other kinds need others."""
    share = np.linspace(0.0, 1.0, 60, dtype=np.float32).reshape(*SHAPE, 1)
    colours = share * np.float32([0.9, 0.2, 0.1]) + (1 - share) * np.float32([0.1, 0.3, 0.9])
    scene = Scene(volumes=(Volume(5.0, DENSITY, albedo_grid=colours),))
    thinner = Scene(volumes=(Volume(5.0, 0.5 * DENSITY, albedo_grid=colours),))
    other = Scene(volumes=(Volume(5.0, DENSITY, albedo_grid=colours[..., [1, 2, 0]]),))
    assert len(scene.volumes[0].parts) == len(other.volumes[0].parts)
    assert drawn_alike(scene, thinner) and not drawn_alike(scene, other)


def test_a_density_of_three_channels_is_a_tint():
    volume = Volume(2.0, COLOURS)
    np.testing.assert_allclose(volume.density[..., None] * volume.tint, COLOURS, rtol=1e-6)
    again = replace(volume, sigma_t=(3.0, 3.0, 3.0))
    np.testing.assert_array_equal(again.tint, volume.tint)


def test_every_form_of_every_coefficient():
    """Number, colour, grid, grid of colours; sigma_s with sigma_a, or sigma_t with albedo."""
    forms = (0.5, (0.1, 0.2, 0.3), DENSITY, COLOURS)

    def full(value):
        value = np.asarray(value, np.float64)
        return np.broadcast_to(value[..., None] if value.ndim == 3 else value, (*SHAPE, 3))

    for first in forms:
        for second in (*forms, None):
            if max(np.ndim(first), 0 if second is None else np.ndim(second)) < 3:
                with pytest.raises(SceneError, match="no coefficient is a grid"):
                    Volume.of_coefficients(sigma_s=first, sigma_a=second)
                continue
            sums = added_up(Volume.of_coefficients(sigma_s=first, sigma_a=second))
            absorbed = 0.0 * full(first) if second is None else full(second)
            np.testing.assert_allclose(sums["sigma_s"], full(first), atol=8e-3)
            np.testing.assert_allclose(sums["sigma_a"], absorbed, atol=8e-3)
            sums = added_up(Volume.of_coefficients(sigma_t=first, albedo=second, g=0.25))
            white = 1.0 + 0.0 * full(first) if second is None else full(second)
            np.testing.assert_allclose(sums["sigma_s"], full(first) * white, atol=8e-3)
            np.testing.assert_allclose(sums["g"], 0.25 * full(first) * white, atol=8e-3)


def test_what_it_emits_does_not_change():
    glow = Emission((1.0, 2.0, 3.0))
    parts = Volume(2.0, DENSITY, albedo_grid=COLOURS, emission=glow).parts
    assert [part.emission is None for part in parts] == [False, *[True] * (len(parts) - 1)]
    np.testing.assert_array_equal(parts[0].emission.values[..., 0], DENSITY)


@pytest.mark.parametrize(
    ("grids", "problem"),
    [
        ({"albedo_grid": 1.5 * COLOURS}, r"volume albedo_grid must lie in \[0, 1\], it has 1\.4"),
        ({"albedo_grid": -COLOURS}, r"must lie in \[0, 1\], it has -0\.9"),
        ({"albedo_grid": COLOURS * np.nan}, "volume albedo_grid has 180 values that are NaN"),
        ({"albedo_grid": COLOURS[:2]}, "has 5 x 4 x 2 voxels, the volume's density has 5 x 4 x 3"),
        ({"albedo_grid": COLOURS[..., :2]}, "has shape"),
        ({"tint": 2.0 * np.ones(SHAPE)}, r"volume tint must lie in \[0, 1\], it has 2"),
        ({"g_grid": np.ones(SHAPE)}, r"volume g_grid must lie in \[-0\.9999, 0\.9999\], it has 1"),
    ],
)
def test_impossible_grids_are_refused(grids, problem):
    with pytest.raises(SceneError, match=problem):
        Volume(1.0, DENSITY, **grids)


def test_shapes_and_mixed_pairs_are_refused():
    with pytest.raises(SceneError, match="no voxels that its albedo_grid could belong to"):
        Volume(1.0, shape="box", albedo_grid=COLOURS)
    with pytest.raises(SceneError, match="either sigma_s and sigma_a, or sigma_t and albedo"):
        Volume.of_coefficients(sigma_s=DENSITY, albedo=0.5)
    with pytest.raises(SceneError, match="has 5 x 4 x 2 voxels"):
        Volume.of_coefficients(sigma_s=DENSITY, sigma_a=DENSITY[:2])
