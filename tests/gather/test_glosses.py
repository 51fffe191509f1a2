"""What mirrored rays are told of materials."""

from __future__ import annotations

import numpy as np
import pytest

from airlight.gather.glosses import gloss_row
from airlight.maths.colour import srgb_decode
from airlight.maths.reflection import bihemispherical_albedo
from airlight.scene.material import Material, Texture


def test_a_plain_material():
    row = gloss_row(Material(metallic=0.7, roughness=0.5, emission=(1.0, 2.0, 3.0)))
    assert row["metallic"] == 0.7 and row["alpha"] == 0.25
    assert row["glow"] == (1.0, 2.0, 3.0)


def test_maps_count_by_their_means():
    pixels = np.random.default_rng(4).integers(0, 256, (6, 5, 4)).astype(np.uint8)
    material = Material(
        metallic=1.0,
        roughness=0.8,
        emission=(2.0, 2.0, 2.0),
        metallic_roughness_texture=Texture(pixels, is_srgb=False),
        emission_texture=Texture(pixels),
    )
    row, means = gloss_row(material), pixels.reshape(-1, 4).mean(axis=0) / 255.0
    assert row["metallic"] == pytest.approx(means[2])
    assert row["alpha"] == pytest.approx((0.8 * means[1]) ** 2)
    glow = 2.0 * srgb_decode(pixels[..., :3] / 255.0).mean(axis=(0, 1))
    np.testing.assert_allclose(row["glow"], glow)


def test_coats_are_those_of_materials():
    """Without a base colour a dielectric reflects what its coat does."""
    row = gloss_row(Material(roughness=0.3, specular=0.5))
    assert row["f0"] == pytest.approx(0.02)
    assert row["coat"] == pytest.approx(
        bihemispherical_albedo([[0.0] * 3], [0], [0.3], [0.5])[0, 0]
    )
    assert gloss_row(Material(specular=0.0))["coat"] == 0.0


def test_mirrors_keep_some_roughness():
    assert gloss_row(Material(roughness=0.0))["alpha"] == 0.002
