"""Dense and overlapping media have their light, beside path tracing of scenes that do not ship."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from scripts import script

dense_media = script(Path(__file__).with_name("dense_media.py"))


@pytest.mark.slow
@pytest.mark.needs("mitsuba", "libLLVM")
@pytest.mark.parametrize("name", dense_media.CASES)
def test_dense_media_scatter_their_light(gpu, name):
    """Energy over Mitsuba's: of the whole within .08 (measured .077), of what media scatter .15."""
    scene = dense_media.CASES[name]()
    truth = dense_media.reference(scene, spp=128, seed=3)
    found = dense_media.score(scene, "auto", truth)
    assert found.whole[0] == pytest.approx(1.0, abs=0.08)
    assert found.scattered[0] == pytest.approx(1.0, abs=0.15)


def test_the_sum_of_grids_has_the_density_of_both():
    """Voxels of grids that overlap add up, and no density is lost or gained."""
    scene = dense_media.CASES["overlap g .7, 4 and 8 per m, towards the light"]()
    first, second = (volume.density for volume in scene.volumes)
    (whole,) = dense_media.in_one(scene).volumes
    assert dense_media.overlaps(scene) and not dense_media.overlaps(dense_media.in_one(scene))
    assert whole.density.max() == pytest.approx(12.0)
    assert float(np.sum(whole.density)) == pytest.approx(float(first.sum() + second.sum()))


def test_grids_overlap_where_they_are_placed():
    scene = dense_media.CASES["overlap g .7, 4 and 8 per m, towards the light"]()
    first, second = scene.volumes
    moved = np.eye(4)
    moved[0, 3] = 10.0
    apart = replace(scene, volumes=(first, replace(second, world_from_volume=moved)))
    assert not dense_media.overlaps(apart)
    # Beside each other in one grid, with what both hold.
    (whole,) = dense_media.in_one(apart).volumes
    assert whole.density.shape[2] > 200
    assert float(np.sum(whole.density)) == pytest.approx(
        float(first.density.sum() + second.density.sum())
    )
