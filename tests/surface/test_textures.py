"""Mip chains keep the mean of the light, and uploads keep the image."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest

from airlight.maths.colour import srgb_decode
from airlight.scene import Material, Texture
from airlight.surface.textures import MaterialTextures, TextureStore, mip_chain

RNG = np.random.default_rng(2)


def test_sizes_halve_down_to_one():
    chain = mip_chain(np.zeros((12, 5, 4), np.uint8), is_srgb=False)
    assert [level.shape[:2] for level in chain] == [(12, 5), (6, 2), (3, 1), (1, 1)]


@pytest.mark.parametrize("is_srgb", [False, True])
def test_the_mean_is_kept_in_linear_light(is_srgb):
    pixels = RNG.integers(0, 256, size=(32, 16, 4), dtype=np.uint8)
    pixels[..., 3] = 255

    def mean(level):
        linear = level[..., :3] / 255.0
        return (srgb_decode(linear) if is_srgb else linear).mean(axis=(0, 1))

    chain = mip_chain(pixels, is_srgb=is_srgb)
    np.testing.assert_array_equal(chain[0], pixels)
    for level in chain[1:]:
        np.testing.assert_allclose(mean(level), mean(pixels), atol=0.006)


def test_what_is_cut_away_does_not_colour_the_rest():
    pixels = np.zeros((4, 4, 4), np.uint8)
    pixels[:, ::2] = (255, 0, 0, 255)
    pixels[:, 1::2] = (0, 255, 0, 0)  # green, but not there
    for level in mip_chain(pixels, is_srgb=False)[1:]:
        assert (level == (255, 0, 0, 128)).all()


def test_wholly_transparent_texels_keep_their_colour():
    pixels = np.full((2, 2, 4), (10, 20, 30, 0), np.uint8)
    assert mip_chain(pixels, is_srgb=False)[1][0, 0].tolist() == [10, 20, 30, 0]


def test_a_texture_is_uploaded_once(gpu, owned):
    store = owned(TextureStore(gpu))
    pixels = RNG.integers(0, 256, size=(4, 8, 4), dtype=np.uint8)
    texture = Texture(pixels, is_srgb=True)
    made = store.get(texture, store.white)
    assert store.get(texture, store.white) is made
    assert (made.format, made.mips, made.size[:2]) == ("rgba8unorm-srgb", 4, (8, 4))
    np.testing.assert_array_equal(made.read(), pixels)
    assert store.get(Texture(pixels, is_srgb=False), store.white).format == "rgba8unorm"
    assert store.get(None, store.flat_normal) is store.flat_normal
    placed = dataclasses.replace(texture, scale=(2.0, 2.0))  # another of the same image
    assert store.get(placed, store.white) is made


def test_samplers_are_shared_by_their_wrapping(gpu, owned):
    store = owned(TextureStore(gpu))
    pixels = np.zeros((1, 1, 4), np.uint8)
    clamped = [Texture(pixels, wrap=("clamp", "mirror")) for _ in range(2)]
    assert store.sampler(clamped[0]) is store.sampler(clamped[1])
    assert store.sampler(clamped[0]) is not store.sampler(None)


@pytest.mark.parametrize("is_packed", [True, False])
def test_chains_are_kept_only_where_they_are_packed_later(gpu, owned, monkeypatch, is_packed):
    monkeypatch.setattr("airlight.surface.textures.uses_visibility_buffer", lambda gpu: is_packed)
    store, texture = owned(TextureStore(gpu)), Texture(np.full((4, 4, 4), 90, np.uint8))
    chain = store.chain(texture)
    assert (store.chain(texture) is chain) is is_packed
    store.packed([Material(base_color_texture=texture)])
    assert store.chain(texture) is not chain


def test_scenes_of_the_same_materials_share_packed_maps(gpu, owned):
    store = owned(TextureStore(gpu))
    one, two = (
        Material(base_color_texture=Texture(np.full((2, 2, 4), code, np.uint8))) for code in (9, 7)
    )
    places, texels = store.packed([one, two])
    assert store.packed([one, two]) == (places, texels)
    assert store.packed([two, one])[1] is not texels
    # Another scene's, of copies of the same images.
    copies = [
        dataclasses.replace(m, base_color_texture=Texture(m.base_color_texture.pixels.copy()))
        for m in (one, two)
    ]
    other = owned(TextureStore(gpu))
    assert other.packed(copies) == (places, texels)
    shown = [store.get(m.base_color_texture, store.white) for m in (one, two)]
    assert [other.get(m.base_color_texture, other.white) for m in copies] == shown
    assert other.get(Texture(copies[0].base_color_texture.pixels + 1), other.white) not in shown


def test_maps_that_no_pass_binds_are_not_uploaded(gpu, owned):
    store = owned(TextureStore(gpu))
    before = gpu.allocated_bytes
    texture = Texture(np.full((64, 64, 4), 9, np.uint8))
    maps = MaterialTextures(store, {"base_color": texture, "normal": None})
    assert gpu.allocated_bytes == before
    assert maps.bound["base_color_map"] is store.get(texture, store.white)
    assert maps.bound["normal_map"] is store.flat_normal
    assert gpu.allocated_bytes >= before + 4 * 64 * 64
