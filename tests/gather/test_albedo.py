"""Maps of what materials reflect, beside the formula texel by texel."""

from __future__ import annotations

import numpy as np
import pytest

from airlight.gather.albedo import MOST_GRAZING, albedo_map, packed
from airlight.maths.colour import srgb_decode
from airlight.maths.reflection import bihemispherical_albedo
from airlight.scene.material import Material, Texture

RNG = np.random.default_rng(3)


def texture(height, width, **more):
    pixels = RNG.integers(0, 256, (height, width, 4)).astype(np.uint8)
    return Texture(pixels, **more)


def one(material):
    values = ([x] for x in (material.metallic, material.roughness, material.specular))
    return bihemispherical_albedo([material.base_color], *values)[0]


def whole(found):
    return found[..., :3] + found[..., 3:]


def test_a_plain_material_is_one_texel():
    material = Material(base_color=(0.2, 0.5, 0.9), roughness=0.4, metallic=0.3)
    found = albedo_map(material)
    assert found.shape == (1, 1, 4)
    np.testing.assert_allclose(whole(found)[0, 0], one(material))


def test_small_maps_are_taken_texel_by_texel():
    colour, gloss = texture(5, 9), texture(5, 9, is_srgb=False)
    found = albedo_map(
        Material(base_color_texture=colour, metallic_roughness_texture=gloss, metallic=1.0)
    )
    rgb = 0.8 * srgb_decode(colour.pixels[..., :3] / 255.0)
    g, b = (gloss.pixels[..., k].ravel() / 255.0 for k in (1, 2))
    truth = bihemispherical_albedo(rgb.reshape(-1, 3), b, g, np.ones(45))
    np.testing.assert_allclose(whole(found).reshape(-1, 3), truth, atol=1e-12)


@pytest.mark.parametrize("size", [(300, 200), (1030, 70)])
def test_large_maps_keep_their_mean(size):
    """Of pixels of which at most every second stands for its neighbours: 3 deviations of a mean."""
    colour = texture(*size, is_srgb=False)
    found = albedo_map(Material(base_color=(1, 1, 1), base_color_texture=colour, specular=0.0))
    assert max(found.shape[:2]) <= 64
    truth = (colour.pixels[..., :3] / 255.0).mean(axis=(0, 1))
    np.testing.assert_allclose(
        found[..., :3].mean(axis=(0, 1)), truth, atol=3 * 0.29 / np.sqrt(64 * 64 * 8)
    )


def test_a_packed_albedo_is_within_a_step_of_its_square_root():
    albedo = RNG.random((20, 30, 4)) * (1.0, 1.0, 1.0, MOST_GRAZING)
    words = packed(albedo)
    byte = (words[..., None] >> np.array([0, 8, 16, 24], np.uint32)) & np.uint32(255)
    np.testing.assert_allclose((byte[..., :3] / 255.0) ** 2, albedo[..., :3], atol=1.01 / 255)
    np.testing.assert_allclose(byte[..., 3] * MOST_GRAZING / 255.0, albedo[..., 3], atol=2e-4)


def test_a_coat_reflects_more_of_what_grazes_it():
    """Of light from all around a smooth dielectric of F0 .04 mirrors some .085, of the sun .04."""
    found = albedo_map(Material(base_color=(0, 0, 0), roughness=0.05))[0, 0]
    assert found[0] == pytest.approx(0.04, abs=0.003)
    assert found[0] + found[3] == pytest.approx(0.085, abs=0.005)
