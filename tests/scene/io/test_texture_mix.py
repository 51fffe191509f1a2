"""Packing images into channels."""

from __future__ import annotations

import numpy as np

from airlight.scene.io.texture_mix import packed_roughness_metallic, with_alpha
from airlight.scene.material import Texture


def grey(value: int, size: int = 2, alpha: int = 255) -> Texture:
    pixels = np.full((size, size, 4), value, dtype=np.uint8)
    pixels[..., 3] = alpha
    return Texture(pixels=pixels, is_srgb=False, source=f"grey {value}")


def test_absent_channels_are_one():
    packed = packed_roughness_metallic(None, grey(7))
    assert packed is not None
    assert packed.pixels[0, 0].tolist() == [255, 255, 7, 255]
    assert packed_roughness_metallic(None, None) is None


def test_sizes_may_differ():
    packed = packed_roughness_metallic(grey(3, 2), grey(9, 8))
    assert packed is not None
    assert packed.pixels.shape == (8, 8, 4)
    assert packed.pixels[5, 5].tolist() == [255, 3, 9, 255]


def test_alpha_comes_from_the_masks_own_alpha_where_it_has_one():
    assert with_alpha(grey(50), grey(10, alpha=99)).pixels[0, 0].tolist() == [50, 50, 50, 99]
    assert with_alpha(grey(50), grey(10)).pixels[0, 0].tolist() == [50, 50, 50, 10]
    white = with_alpha(None, grey(10))
    assert white.pixels[0, 0].tolist() == [255, 255, 255, 10]
    assert white.is_srgb
