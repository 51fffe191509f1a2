"""Path-traced panels: grain goes, light and edges stay, and scores compare like with like."""

from __future__ import annotations

import numpy as np
import pytest

from airlight.app.compare.reference import Reference
from airlight.figures import truths
from airlight.figures.panels import Request
from airlight.scene.image import Image


def test_smoothing_takes_noise_away_and_keeps_edges():
    light = 1.0 + np.random.default_rng(3).uniform(-0.5, 0.5, (24, 32, 3)).astype(np.float32)
    light[:, 16:] *= 4.0
    normal = np.zeros_like(light)
    normal[:, :16, 0] = normal[:, 16:, 1] = 1.0
    depth = np.full((24, 32), 3.0, np.float32)
    smooth = truths.smoothed(light, Image(light, {"normal": normal, "depth": depth}))
    left, right = smooth[4:-4, 4:16], smooth[4:-4, 16:-4]
    assert left.std() < 0.2 * light[:, :16].std()
    assert (left.mean(), right.mean()) == (
        pytest.approx(1.0, abs=0.05),
        pytest.approx(4.0, abs=0.2),
    )
    assert truths.smoothed(light, Image(light, {})) is light


def test_a_spark_leaves_no_mark_and_keeps_its_light():
    light = np.full((48, 64, 3), 1.0, np.float32)
    light[24, 32] = 200.0
    normal = np.zeros_like(light)
    normal[..., 1] = 1.0
    flat = Image(light, {"normal": normal, "depth": np.full((48, 64), 2.0, np.float32)})
    smooth = truths.smoothed(light, flat)
    assert smooth.max() < 1.6
    assert smooth.sum() == pytest.approx(light.sum(), rel=1e-4)


def test_an_image_is_averaged_over_a_truth_s_pixels():
    image = np.arange(4 * 6 * 3, dtype=np.float32).reshape(4, 6, 3)
    small = np.zeros((2, 3, 3), np.float32)
    np.testing.assert_allclose(truths.averaged(image, small)[1, 2], image[2:, 4:].mean((0, 1)))
    assert truths.averaged(image[..., 0], small).shape == (2, 3)
    assert truths.averaged(image, image) is image
    image = truths.as_large_as(Image(image, {"depth": image[..., 0]}), small)
    assert (image.radiance.shape, image.layers["depth"].shape) == ((2, 3, 3), (2, 3))


def layered(variance: float = 0.0) -> Reference:
    one = np.ones((4, 4, 3), np.float32)
    layers = {"indirect": 0.5 * one, "multiple_scatter": 0.0 * one}
    layers |= {f"{name}_variance": variance * one for name in layers}
    return Reference(Image(one, layers), 16, 1.0, False)


def test_a_truth_has_half_the_size_where_that_is_whole(monkeypatch):
    asked = []

    def pretended(scene, size, spp, *, report):
        asked.append((size, spp))
        return layered()

    monkeypatch.setattr(truths, "reference_for", pretended)
    truths.traced(Request((64, 36)), None)
    truths.traced(Request((63, 36)), None)
    assert asked == [((32, 18), 1024), ((63, 36), 1024)]
    assert truths.truth_of(Request((64, 36), quick=True), None) is None


def test_noise_is_the_error_of_a_perfect_image():
    truth = layered(variance=0.01)
    assert truths.noise_l2(truth, "indirect") == pytest.approx(0.2)
    assert truths.told_of(truth) == "path traced, 4x4, 16 samples, smoothed"


def test_a_truth_without_layers_is_shown_as_it_was_traced_and_said_to_be(monkeypatch):
    radiance = layered().image.radiance
    whole = Reference(Image(radiance, {}), 16, 1.0, False, ("no layers: why",))
    monkeypatch.setattr(truths, "reference_for", lambda *_, **__: whole)
    lacks: list[str] = []
    assert truths.traced(Request((8, 8), warn=lacks.append), None) is whole
    assert lacks == ["no layers: why"]
    assert truths.told_of(whole) == "path traced, 4x4, 16 samples"
    guide = Image(radiance, {"normal": radiance, "depth": radiance[..., 0]})
    assert truths.without_noise(whole, guide) is radiance
    # With layers, light that is even already stays as it is.
    np.testing.assert_allclose(truths.without_noise(layered(), guide), radiance, rtol=1e-6)
