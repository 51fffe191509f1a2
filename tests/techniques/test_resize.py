"""A renderer that changed its size draws what one made at that size draws."""

from __future__ import annotations

import numpy as np
import pytest

from airlight.errors import SettingsError
from airlight.rendering import Renderer
from airlight.scene import Camera, DirectionalLight, Medium, Mesh, Scene, Volume
from airlight.scene.shapes import box

SIZE, OTHER = (24, 14), (36, 20)
SMALL = {"resolution": 8, "shadow_resolution": 64, "sky_lights": 0, "surfels": 2000}
POP = {"ordinates": 8, "grid": 8, "solver_steps": 12, "virtual_lights": 8}


def hazy(with_volume: bool = False) -> Scene:
    smoke = Volume((2.0, 2.0, 2.0), shape="sphere", bounds=((-0.9, 0.6, -0.4), (0.0, 1.5, 0.5)))
    return Scene(
        meshes=(Mesh(box()),),
        lights=(DirectionalLight((0.3, -1.0, -0.2), (3.0, 3.0, 2.5)),),
        medium=Medium((0.1, 0.1, 0.1), bounds=((-2, -2, -2), (2, 2, 2))),
        volumes=(smoke,) if with_volume else (),
        camera=Camera((1.0, 1.2, 2.2), (0.0, 0.0, 0.0)),
    )


@pytest.mark.parametrize("technique", ["single", "pop"])
def test_resized_is_as_if_made_so(technique):
    scene = hazy(with_volume=technique == "single")
    settings = {**SMALL, **POP} if technique == "pop" else SMALL
    with Renderer(scene, technique, OTHER, settings=settings) as made:
        wanted = made.frame()
    with Renderer(scene, technique, SIZE, settings=settings) as resized:
        resized.frame(samples=2)
        resized.resize(OTHER)
        got = resized.frame()
        assert resized.frame(samples=2).radiance.shape == (OTHER[1], OTHER[0], 3)
    assert got.radiance.shape == (OTHER[1], OTHER[0], 3)
    for name, layer in wanted.layers.items():
        assert np.allclose(got.layers[name], layer, rtol=1e-4, atol=1e-5), name


def test_an_impossible_size_is_refused_and_nothing_lost():
    with Renderer(hazy(), "direct", SIZE, settings=SMALL) as renderer:
        with pytest.raises(SettingsError, match="0x5 is impossible"):
            renderer.resize((0, 5))
        assert renderer.frame().radiance.shape == (SIZE[1], SIZE[0], 3)
