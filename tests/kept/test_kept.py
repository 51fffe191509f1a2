"""No technique is further from the truth than it was: kept references, without Mitsuba."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from airlight.errors import ReferenceFailure
from airlight.reference.metrics import compare
from airlight.reference.stored import SIZE_PX, STORED, load_stored, save_stored
from airlight.scene.image import Image
from airlight.techniques import TECHNIQUES
from airlight.techniques.auto import recipe_for
from scripts import script

FOLDER = Path(__file__).parent


measure = script(FOLDER / "measure.py")
CEILINGS = measure.read_ceilings()
SLOW = ("room", "atrium")
SLOW_PAIRS = tuple((name, "lpv-scatter") for name in ("cornell", "wall-floor"))
"""Lattices of scattered light without air, which `cornell-area` has, too."""
NO_LIGHT = {"relative_l2": 1.0, "energy_error": 1.0}
"""How far off a black image is."""
BRIGHTEST = 3.0
"""Times the truth's 99.9th percentile that the brightest pixel of a gathered still may have.

Measured: 1.4 of indirect light (`room`), 1.1 in the atrium, 1.6 of haze-box, whose truth has 4.0;
2.2 of haze-box's whole image, whose truth has 2.4.
"""


@pytest.mark.parametrize(
    ("name", "technique"),
    [
        pytest.param(n, t, marks=[pytest.mark.slow] * (n in SLOW or (n, t) in SLOW_PAIRS))
        for n in STORED
        for t in TECHNIQUES
    ],
)
def test_errors_stay_below_their_ceilings(gpu, name, technique):
    if technique not in measure.techniques_for(STORED[name].load()):
        pytest.skip(f"without air {technique} is {measure.ALIKE[technique]}")
    if technique == "auto" and (chosen := recipe_for(STORED[name].load())) in TECHNIQUES:
        pytest.skip(f"auto draws it by {chosen}, as tests/techniques/test_auto.py holds")
    # A technique nobody has measured yet must at least not be worse than direct light alone, and
    # light that only it draws no worse than none.
    known = CEILINGS[name]
    scores = measure.measure(name, technique)
    ceilings = known.get(technique) or {**dict.fromkeys(scores, NO_LIGHT), **known["direct"]}
    for layer, limits in ceilings.items():
        if layer != "measured":
            for error, limit in limits.items():
                assert getattr(scores[layer], error) <= limit, (layer, error)
    if technique in measure.GATHERS:
        for layer, score in scores.items():
            assert score.brightest <= BRIGHTEST, layer


@pytest.mark.parametrize("name", STORED)
def test_a_kept_reference_is_whole_and_adds_up(name):
    reference = load_stored(FOLDER / f"{name}.exr")
    assert reference.radiance.shape == (SIZE_PX[1], SIZE_PX[0], 3)
    parts = ("direct", "indirect", "single_scatter", "multiple_scatter")
    total = sum(reference.layers[p] for p in parts if p in reference.layers)
    np.testing.assert_allclose(total, reference.radiance, rtol=4e-3, atol=1e-3)
    scores = compare(reference, reference, perceptual=False)
    assert 0.0 < scores.noise_floor_l2 < 0.2
    assert reference.stats["spp"] >= STORED[name].spp


def test_kept_files_are_small():
    files = [FOLDER / f"{name}.exr" for name in STORED]
    assert sum(f.stat().st_size for f in files) < 4_000_000


def test_what_is_kept_comes_back_with_its_noise(tmp_path):
    rng = np.random.default_rng(1)
    pixels = rng.uniform(0.5, 1.0, (8, 12, 3)).astype(np.float32)
    variance = np.full((8, 12, 3), 4e-8, np.float32)  # less than the least half float
    layers = {"direct": pixels, "direct_variance": variance, "variance": variance}
    save_stored(Image(pixels, layers), tmp_path / "kept.exr", stats={"spp": 4})
    again = load_stored(tmp_path / "kept.exr")
    np.testing.assert_allclose(again.layers["direct"], pixels, rtol=5e-4)
    np.testing.assert_allclose(again.layers["direct_variance"], 4e-8, rtol=2e-3)
    half = load_stored(tmp_path / "kept.exr", shrink=2)
    assert half.radiance.shape == (4, 6, 3)
    np.testing.assert_allclose(half.radiance[0, 0], pixels[:2, :2].mean(axis=(0, 1)), rtol=5e-4)
    np.testing.assert_allclose(half.layers["variance"], 1e-8, rtol=2e-3)


def test_bad_requests_are_refused(tmp_path):
    pixels = np.ones((3, 4, 3), np.float32)
    path = tmp_path / "kept.exr"
    with pytest.raises(ReferenceFailure, match="the reference has no layer 'variance'"):
        save_stored(Image(pixels), path, stats={})
    assert not path.exists()
    save_stored(Image(pixels, {"variance": pixels}), path, stats={})
    with pytest.raises(ReferenceFailure, match=r"kept\.exr cannot be shrunk 2 times"):
        load_stored(path, shrink=2)


def test_a_firefly_is_found_by_its_luminance():
    """One pixel of 5184 is four times as bright as the truth's brightest."""
    truth = Image(np.ones((54, 96, 3), np.float32))
    pixels = truth.radiance.copy()
    assert measure.brightest(Image(pixels), truth, "whole") == pytest.approx(1.0)
    pixels[7, 7] = 4.0
    assert measure.brightest(Image(pixels), truth, "whole") == pytest.approx(4.0)


def test_light_that_a_technique_does_not_draw_is_not_held():
    """Direct light that falls to what is right makes a whole without indirect light darker."""
    Score = measure.Score
    scores = {"whole": Score(0.2, 0.74, 0.0), "direct": Score(0.1, 1.02, 0.0)}
    both = measure.ERRORS
    assert measure.held(scores) == {"whole": both, "direct": both}
    scores["indirect"] = Score(1.0, 0.0, 0.0)
    assert measure.held(scores) == {"whole": ("relative_l2",), "direct": both}
    ceilings = {}
    measure.lowered(ceilings, "atrium", "direct", scores)
    assert "whole = { relative_l2 = 0.215 }\ndirect = {" in measure.as_toml(ceilings)


def test_ceilings_only_fall():
    ceilings = {}
    Score = measure.Score
    measure.lowered(ceilings, "cornell", "lpv", {"whole": Score(0.2, 0.9, 0.01)})
    first = dict(ceilings["cornell"]["lpv"]["whole"])
    assert first == {"relative_l2": 0.215, "energy_error": 0.110}
    measure.lowered(ceilings, "cornell", "lpv", {"whole": Score(0.3, 0.95, 0.01)})
    assert ceilings["cornell"]["lpv"]["whole"] == {"relative_l2": 0.215, "energy_error": 0.058}
    text = measure.as_toml(ceilings)
    assert "whole = { relative_l2 = 0.215, energy_error = 0.058 }" in text
