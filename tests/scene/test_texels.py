"""Texels beyond an image: repeated, mirrored or those of its border."""

import numpy as np
import pytest

from airlight.area.sources import texture_light
from airlight.lattice.surfels import surfels
from airlight.scene import shapes
from airlight.scene.material import Material, Texture
from airlight.scene.mesh import Mesh
from airlight.scene.texels import interpolated, nearest, wrapped

# An image of one row, red only: 0, 100, 200. Two images to the left, two to the right.
RAMP = np.zeros((1, 3, 4), np.uint8)
RAMP[0, :, 0], RAMP[..., 3] = (0, 100, 200), 255
BEYOND = {
    "repeat": [0, 1, 2] * 4,
    "mirror": [0, 1, 2, 2, 1, 0] * 2,
    "clamp": [0] * 6 + [0, 1, 2] + [2] * 3,
}


@pytest.mark.parametrize("wrap", BEYOND)
def test_texels_beyond_the_image(wrap):
    """Images -2 to 1 along u; the centres of texels, where interpolated values are theirs."""
    expected = np.array(BEYOND[wrap])
    assert list(wrapped(np.arange(-6, 6), 3, wrap)) == list(expected)
    texture = Texture(RAMP, wrap=(wrap, "repeat"))
    uv = np.stack([(np.arange(-6, 6) + 0.5) / 3.0, np.full(12, 7.5)], axis=1)
    np.testing.assert_array_equal(nearest(texture, uv)[:, 0], 100 * expected)
    np.testing.assert_allclose(interpolated(RAMP, uv, texture.wrap)[:, 0], 100 * expected)


@pytest.mark.parametrize(("wrap", "between"), [("repeat", 100), ("mirror", 200), ("clamp", 200)])
def test_values_between_the_last_texel_and_what_follows_it(wrap, between):
    assert interpolated(RAMP, np.array([[1.0, 0.5]]), (wrap, wrap))[0, 0] == between


@pytest.mark.parametrize(("wrap", "share"), [("repeat", 0.5), ("mirror", 0.5), ("clamp", 0.125)])
def test_surfaces_reflect_and_glow_as_their_textures_are_wrapped(wrap, share):
    """A white half beside a black one, on a board four images wide."""
    halves = np.zeros((1, 2, 4), np.uint8)
    halves[0, 0, :3], halves[..., 3] = 255, 255
    texture = Texture(halves, is_srgb=False, scale=(4.0, 1.0), wrap=(wrap, wrap))
    white = Material(base_color=(1.0, 1.0, 1.0), base_color_texture=texture, specular=0.0)
    board = Mesh(shapes.quad(), white)
    made = surfels((board,), [0], 4000)
    assert made["reflectance"][:, 0].mean() == pytest.approx(share, abs=0.02)
    uv = np.stack([(np.arange(800) + 0.5) / 800.0, np.full(800, 0.5)], axis=1)
    assert texture_light(texture, uv).mean() == pytest.approx(share, abs=1e-9)
