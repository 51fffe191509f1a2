"""Scenes as techniques take them."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from airlight.scene import AreaLight, Scene, Volume
from airlight.scene.shown import ShownScenes, drawn_alike

GREY = Volume(1.0, np.ones((4, 4, 4), np.float32))
DYED = replace(GREY, albedo_grid=np.random.default_rng(1).random((4, 4, 4, 3), dtype=np.float32))


def test_lights_have_meshes_and_volumes_one_colour() -> None:
    light = AreaLight((0.0, 2.0, 0.0), (1.0, 1.0, 1.0))
    shown = ShownScenes().of(Scene(volumes=(GREY, DYED), lights=(light,)))
    assert len(shown.meshes) == 1
    assert shown.volumes == (GREY, *DYED.parts)
    plain = Scene(volumes=(GREY,))
    assert ShownScenes().of(plain) is plain


def test_scenes_are_alike_with_as_many_parts() -> None:
    dyed = Scene(volumes=(DYED,))
    assert drawn_alike(dyed, replace(dyed, volumes=(replace(DYED, sigma_t=2.0),)))
    assert not drawn_alike(dyed, Scene(volumes=(GREY,)))
    # A grid and a sphere are not, whichever comes first.
    gridded = Scene(volumes=(replace(GREY, density=np.ones((2, 2, 2), np.float32)),))
    ball = Scene(volumes=(replace(GREY, density=None, shape="sphere"),))
    assert not drawn_alike(ball, gridded)
    assert not drawn_alike(gridded, ball)
    # Of another number of volumes the renderer itself says so.
    assert drawn_alike(dyed, Scene(volumes=(GREY, DYED)))
