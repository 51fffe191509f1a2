"""A picture and what it carries."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest

from airlight.errors import OutputError
from airlight.scene.image import Image

BLACK = np.zeros((4, 6, 3), np.float32)


def test_a_picture_without_layers_is_enough():
    image = Image(BLACK)
    assert (dict(image.layers), image.exposure_stops, dict(image.stats)) == ({}, 0.0, {})


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
