"""Heights as normals: they lean down the slope, as steep as the heights are in metres."""

from __future__ import annotations

import numpy as np
import PIL.Image
import pytest

from airlight.scene.io.mitsuba import load_mitsuba
from airlight.scene.io.mitsuba_bumps import normals_of_heights
from airlight.scene.material import Texture

SIZE = 64


def waves(along: int) -> np.ndarray:
    """(H, W) heights 0 to 1: four waves along one axis of the image."""
    wave = 0.5 + 0.5 * np.sin(2.0 * np.pi * 4.0 * (np.arange(SIZE) + 0.5) / SIZE)
    return np.broadcast_to(wave if along == 1 else wave[:, None], (SIZE, SIZE))


def slopes(texture: Texture, scale: float) -> np.ndarray:
    """(H, W, 2) of a normal map: how the surface falls along u and v."""
    normals = texture.pixels[..., :3] / 127.5 - 1.0
    return scale * normals[..., :2] / normals[..., 2:]


@pytest.mark.parametrize(("axis", "sign"), [(1, 1.0), (0, -1.0)])
def test_normals_lean_down_the_slope(axis, sign):
    """v goes up where rows go down. Central differences over 16 texels a wave: .974 of the slope;
    8 bits of the steepest: 1 %."""
    heights = np.round(255.0 * waves(axis)).astype(np.uint8)
    image = np.repeat(heights[..., None], 4, axis=-1)
    made, scale = normals_of_heights(Texture(image, is_srgb=False))
    found = slopes(made, scale)
    phase = 2.0 * np.pi * 4.0 * (np.arange(SIZE) + 0.5) / SIZE
    rises = 0.974 * 0.5 * 2.0 * np.pi * 4.0 * np.cos(phase)
    expected = -sign * (rises if axis == 1 else rises[:, None])
    along = 0 if axis == 1 else 1
    np.testing.assert_allclose(found[..., along], expected + 0 * heights, atol=0.03 * rises.max())
    np.testing.assert_allclose(found[..., 1 - along], 0.0, atol=0.01 * rises.max())


@pytest.mark.parametrize("metres", [1.0, 4.0])
def test_a_bump_map_is_as_high_on_a_mesh_of_any_size(tmp_path, metres):
    """A rectangle of 2 by 2 times `metres`, with one image on it: slopes fall with its size."""
    PIL.Image.fromarray(np.round(255.0 * waves(1)).astype(np.uint8)).save(tmp_path / "h.png")
    text = (
        '<scene version="3.0.0"><shape type="rectangle"><transform name="to_world">'
        f'<scale value="{metres}"/></transform><bsdf type="twosided"><bsdf type="bumpmap">'
        '<float name="scale" value=".1"/><texture type="bitmap"><string name="filename" '
        'value="h.png"/><boolean name="raw" value="true"/></texture><bsdf type="diffuse"/>'
        "</bsdf></bsdf></shape></scene>"
    )
    (tmp_path / "a.xml").write_text(text)
    made = load_mitsuba(tmp_path / "a.xml")
    (mesh,) = made.meshes
    found = slopes(mesh.material.normal_texture, mesh.material.normal_scale)
    steepest = 0.974 * 0.1 * 0.5 * 2.0 * np.pi * 4.0 / (2.0 * metres)
    assert np.abs(found[..., 0]).max() == pytest.approx(steepest, rel=0.03)
    assert not any("left out" in text for text in made.warnings)


def test_a_bump_map_without_an_image_is_told(tmp_path):
    (tmp_path / "a.xml").write_text(
        '<scene version="3.0.0"><shape type="rectangle"><bsdf type="bumpmap">'
        '<bsdf type="diffuse"/></bsdf></shape></scene>'
    )
    made = load_mitsuba(tmp_path / "a.xml")
    assert any("its bump map is left out, the surface is smooth" in t for t in made.warnings)
