"""Dense and overlapping media have their light, beside path tracing of scenes that do not ship."""

from __future__ import annotations

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
