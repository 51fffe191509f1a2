"""Encodings of colour, normals and roughness into bytes."""

from __future__ import annotations

import numpy as np
import pytest

from airlight.scene.builtin.images import color_texture, normal_texture, roughness_texture


def test_colours_are_srgb_encoded() -> None:
    image = color_texture(np.full((2, 3), 0.5), (1.0, 0.43, 4.0), "grey")
    # sRGB of 0.5, 0.215 and a clamped 2.0, from the standard's formula.
    assert np.abs(image.pixels[0, 0].astype(int) - (188, 128, 255, 255)).max() <= 1
    assert image.is_srgb
    masked = color_texture(np.ones((1, 2)), (1.0, 1.0, 1.0), "mask", np.array([[0.0, 1.0]]))
    assert masked.pixels[0, :, 3].tolist() == [0, 255]


@pytest.mark.parametrize(("axis", "expected"), [(1, (-1, 0, 1)), (0, (0, 1, 1))])
def test_normals_of_a_slope(axis: int, expected: tuple[int, int, int]) -> None:
    """Rising to the right tilts the normal left; rising downwards tilts it up."""
    size = 16
    ramp = np.broadcast_to(np.arange(size) / size, (size, size))
    ramp = ramp if axis == 1 else ramp.T
    image = normal_texture(ramp, width_m=1.0, source="ramp")
    normal = image.pixels[size // 2, size // 2, :3] / 127.5 - 1.0
    assert np.allclose(normal, np.array(expected) / np.sqrt(2.0), atol=0.01)
    assert not image.is_srgb
    flat = normal_texture(np.zeros((4, 4)), 1.0, "flat")
    assert flat.pixels[0, 0].tolist() == [128, 128, 255, 255]


def test_roughness_is_green() -> None:
    assert roughness_texture(np.full((1, 1), 0.5), "r").pixels[0, 0].tolist() == [
        255,
        128,
        255,
        255,
    ]
