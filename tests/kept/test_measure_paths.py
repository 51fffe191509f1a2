"""The code paths of GPUs and of CPUs make the same image, on whichever adapter there is."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from airlight.scene.image import Image
from scripts import script

measure = script(Path(__file__).with_name("measure_paths.py"))
CASES = measure.read_cases()


@pytest.mark.parametrize(
    "case",
    [pytest.param(c, marks=pytest.mark.slow) if CASES[c].get("is_slow") else c for c in CASES],
)
def test_both_paths_make_the_same_image(gpu, case, monkeypatch):
    ceilings = CASES[case]
    found = measure.distances(*measure.both(case, monkeypatch.setenv))
    assert found.keys() == ceilings.keys() - {"is_slow"}
    for layer, off in found.items():
        assert off <= ceilings[layer], layer
    assert max(found.values()) > 0.0  # the paths were not the same ones


def test_a_tenth_of_light_missing_is_seen():
    pixels = np.random.default_rng(3).random((4, 6, 3)).astype(np.float32)
    ours, other = (Image(k * pixels, {"direct": k * pixels}) for k in (0.9, 1.0))
    found = measure.distances(ours, other)
    assert found == {"radiance": pytest.approx(0.1), "direct": pytest.approx(0.1)}
