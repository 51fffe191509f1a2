"""Which maps can be packed, and what a texel holds."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from airlight.maths.colour import srgb_decode
from airlight.scene import Material, Texture
from airlight.surface.packed_maps import (
    PackedMaps,
    image_of,
    is_packable,
    metallic_factor,
    most_texels,
    packed_sets,
)
from airlight.surface.textures import mip_chain

RNG = np.random.default_rng(5)


def _image(height=4, width=8, **how):
    return Texture(RNG.integers(0, 256, (height, width, 4), np.uint8), **how)


def _chain(texture):
    return mip_chain(texture.pixels, is_srgb=texture.is_srgb)


def _packed(materials, most=1 << 20):
    """Packed maps, and where those of each of the `materials` are."""
    keys, sets = packed_sets(materials, image_of)
    maps = PackedMaps(sets, _chain, most)
    return maps, [None if key is None else maps.locations[key] for key in keys]


def _even(metallic):
    image = _image(is_srgb=False)
    pixels = image.pixels.copy()
    pixels[..., 2] = metallic
    return replace(image, pixels=pixels)


@pytest.mark.parametrize(
    ("maps", "expected"),
    [
        ({}, True),
        ({"base_color_texture": _image(), "normal_texture": _image(is_srgb=False)}, True),
        ({"base_color_texture": _image(), "normal_texture": _image(8, is_srgb=False)}, False),
        (
            {
                "base_color_texture": _image(),
                "normal_texture": _image(is_srgb=False, scale=(2.0, 2.0)),
            },
            False,
        ),
        (
            {
                "base_color_texture": _image(wrap=("clamp", "clamp")),
                "normal_texture": _image(is_srgb=False),
            },
            False,
        ),
        ({"emission_texture": _image()}, False),
        ({"metallic": 1.0, "metallic_roughness_texture": _image(is_srgb=False)}, False),
        ({"metallic": 0.0, "metallic_roughness_texture": _image(is_srgb=False)}, True),
        ({"metallic": 1.0, "metallic_roughness_texture": _even(51)}, True),
    ],
)
def test_maps_are_packed_where_they_lie_alike(maps, expected):
    assert is_packable(Material(**maps)) is expected
    assert (_packed([Material(**maps)])[1][0] is not None) is expected


def test_an_even_map_of_metal_is_a_factor():
    assert metallic_factor(Material(metallic=1.0, metallic_roughness_texture=_even(51))) == 0.2


def test_a_texel_holds_roots_of_light_and_the_surface():
    base, normal = _image(), _image(is_srgb=False)
    rough = _even(255)
    m = Material(base_color_texture=base, normal_texture=normal, metallic_roughness_texture=rough)
    maps, places = _packed([Material(base_color_texture=_image(2, 2)), m, m])
    first, size, flags, levels = places[1]
    assert (size, flags, levels) == (8 | 4 << 16, 7, 4)
    table = maps.texels[first : first + levels]
    np.testing.assert_array_equal(table[:-1, 1], table[1:, 0])
    for level, side in enumerate([(4, 8), (2, 4), (1, 2), (1, 1)]):
        begin, count = table[level, 0], side[0] * side[1]
        texels = maps.texels[begin : begin + count]
        roots = (texels[:, :1] >> np.array([0, 10, 20])) & 1023
        light = srgb_decode(_chain(base)[level].reshape(-1, 4)[:, :3] / 255.0)
        np.testing.assert_allclose((roots / 1023.0) ** 2, light, atol=1e-3)
        surface = (texels[:, 1:] >> np.array([0, 8, 16, 24])) & 255
        np.testing.assert_array_equal(surface[:, :3], _chain(normal)[level].reshape(-1, 4)[:, :3])
        np.testing.assert_array_equal(surface[:, 3], _chain(rough)[level].reshape(-1, 4)[:, 1])
    assert places[2] == places[1]


@pytest.mark.parametrize("side", [(8, 8), (5, 13), (1, 6)])
def test_no_more_texels_are_packed_than_there_may_be(side):
    chain = mip_chain(_image(*side).pixels, is_srgb=True)
    needed = len(chain) + sum(level.shape[0] * level.shape[1] for level in chain) + 1
    for most in (needed - 1, needed, 2 * needed - 2, 2 * needed - 1):
        materials = [Material(base_color_texture=_image(*side)) for _ in range(3)]
        maps, (*packed, plain) = _packed([*materials, Material()], most)
        assert sum(place is not None for place in packed) == (most - 1) // (needed - 1)
        assert len(maps.texels) <= most
        assert plain is not None


def test_all_maps_fit_what_the_device_binds(gpu, monkeypatch):
    bound = most_texels(gpu) * 8
    assert bound == min(1 << 29, gpu.limits["max-storage-buffer-binding-size"])
    monkeypatch.setitem(gpu.limits, "max-buffer-size", 4096)
    assert most_texels(gpu) == 512
