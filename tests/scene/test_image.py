"""An image and what it carries."""

from __future__ import annotations

import dataclasses
import io

import numpy as np
import PIL.Image
import pytest

from airlight.errors import OutputError, SceneError, SettingsError
from airlight.scene.image import Image

BLACK = np.zeros((4, 6, 3), np.float32)


def test_an_image_without_layers_is_enough():
    image = Image(BLACK)
    assert (dict(image.layers), image.exposure_stops, dict(image.stats)) == ({}, 0.0, {})


def test_pixels_that_are_no_numbers_are_counted():
    radiance = np.ones((3, 4, 3), np.float32)
    assert Image(radiance).doubts == ()
    radiance[0, 0] = np.nan
    radiance[2, 1, 2] = np.inf
    (doubt,) = Image(radiance).doubts
    assert doubt.startswith("2 of 12 pixels are NaN or infinite")


def test_it_does_not_change():
    with pytest.raises(dataclasses.FrozenInstanceError):
        Image(BLACK).radiance = BLACK  # type: ignore[misc]


@pytest.mark.parametrize("ending", ["png", "exr", "hdr", "jpg"])
def test_it_is_saved_by_its_ending(tmp_path, ending):
    path = tmp_path / f"out.{ending}"
    Image(BLACK, {"depth": BLACK[..., 0]}).save(str(path))
    assert path.stat().st_size > 0
    assert [p.name for p in tmp_path.iterdir()] == [path.name]


def test_an_unknown_ending_leaves_nothing_behind(tmp_path):
    with pytest.raises(OutputError):
        Image(BLACK).save(tmp_path / "out.xyz")
    assert not list(tmp_path.iterdir())


def test_it_shows_itself_as_it_is_saved(tmp_path):
    ramp = np.broadcast_to(np.linspace(0.0, 2.0, 6, dtype=np.float32)[None, :, None], (4, 6, 3))
    image = Image(ramp, {"direct": 0.5 * ramp, "depth": ramp[..., 0]}, exposure_stops=-1.0)
    image.save(tmp_path / "a.png")
    saved = np.asarray(PIL.Image.open(tmp_path / "a.png"))
    np.testing.assert_array_equal(image.display(), saved)
    in_notebook = PIL.Image.open(io.BytesIO(image._repr_png_()))
    np.testing.assert_array_equal(np.asarray(in_notebook), saved)
    np.testing.assert_array_equal(image.display("direct"), Image(0.25 * ramp).display())


@pytest.mark.parametrize(
    ("layer", "remedy"), [("dirct", "Did you mean 'direct'?"), ("depth", "Known: direct.")]
)
def test_what_is_no_colour_is_not_shown(layer, remedy):
    image = Image(BLACK, {"direct": BLACK, "depth": BLACK[..., 0]})
    with pytest.raises(SettingsError) as caught:
        image.display(layer)
    assert str(caught.value) == f"the image has no colour layer '{layer}'. {remedy}"


def test_a_table_of_colours_is_named_by_a_path():
    with pytest.raises(SceneError, match="a table of colours must be a path, not 3"):
        Image(np.ones((2, 2, 3), np.float32)).graded(3)
