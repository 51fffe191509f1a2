"""Images of one renderer do not depend on those before: other media, sizes and views."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from airlight.gpu.device import Gpu
from airlight.lighting.view import View
from airlight.rendering import Renderer
from airlight.scene import (
    Camera,
    Environment,
    Material,
    Medium,
    Mesh,
    PointLight,
    Scene,
    Volume,
)

SIZE = (37, 26)
SETTINGS = {
    "resolution": 8,
    "iterations": 4,
    "surfels": 5000,
    "sky_lights": 8,
    "sky_resolution": 16,
}


@pytest.fixture
def corner(square: Callable[..., Mesh]) -> Scene:
    """A polished floor before two walls, under a sky, and a lamp."""
    floor = square((0, 0, 0), (3, 0, 0), (0, 0, -3), Material((0.5, 0.5, 0.5), roughness=0.2))
    back = square((0, 1, -3), (3, 0, 0), (0, 1, 0), Material((0.8, 0.2, 0.1), roughness=1.0))
    side = square((-3, 1, 0), (0, 0, 3), (0, 1, 0), Material((0.2, 0.7, 0.3), roughness=0.7))
    return Scene(
        meshes=(floor, back, side),
        lights=(PointLight((0.5, 1.2, -1.0), (8, 8, 8)),),
        environment=Environment((0.3, 0.4, 0.5)),
        camera=Camera((0.4, 1.1, 3.0), (-0.2, 0.5, -1.5), fov_y_deg=60),
    )


@pytest.mark.parametrize("changed", ["medium", "volumes"])
def test_another_medium_leaves_no_trace_of_the_one_before(corner: Scene, changed: str) -> None:
    """The sky's light comes through the medium: the camera stands, the medium gets thicker."""
    rng, bounds = np.random.default_rng(3), ((-2.0, 0.0, -2.5), (2.0, 2.0, 0.5))
    thin, thick = (rng.random((4, 5, 6)).astype(np.float32) ** power for power in (4.0, 0.3))
    puff = Volume((0.5, 0.7, 0.9), thin, bounds=bounds)
    foggy = dataclasses.replace(corner, medium=Medium((0.05, 0.1, 0.1)), volumes=(puff,))
    after: dict[str, Any] = {
        "medium": {"medium": Medium((0.4, 0.2, 0.3))},
        "volumes": {"volumes": (dataclasses.replace(puff, density=thick),)},
    }[changed]

    def drawn(*, before: int) -> list[Any]:
        with Renderer(foggy, "lpv-march", SIZE, settings=SETTINGS) as renderer:
            images = [renderer.frame() for _ in range(before)]
            renderer.scene = dataclasses.replace(renderer.scene, **after)
            images += [renderer.frame() for _ in range(3)]
        return images

    used, fresh = drawn(before=2), drawn(before=0)[0]
    assert not np.array_equal(used[1].radiance, used[2].radiance)
    for image in used[2:]:
        for name in ("direct", "indirect"):
            np.testing.assert_array_equal(image.layers[name], fresh.layers[name])


def test_another_size_and_back(corner: Scene) -> None:
    with Renderer(corner, "lpv", SIZE, settings=SETTINGS) as renderer:
        expected = [renderer.frame() for _ in range(2)][-1]
        renderer.resize((20, 17))
        for _ in range(2):
            renderer.frame()
        renderer.resize(SIZE)
        got = [renderer.frame() for _ in range(3)]
    for image in got:
        np.testing.assert_array_equal(image.radiance, expected.radiance)


def test_two_views_interleaved(gpu: Gpu, corner: Scene, owned: Callable[[Any], Any]) -> None:
    aside = dataclasses.replace(corner.camera, target=(-0.5, 0.2, -1.0))  # from the same eye
    with Renderer(corner, "lpv", SIZE, settings=SETTINGS) as renderer:
        technique, commands = renderer.technique, renderer.commands
        expected = []
        for camera in (corner.camera, aside):
            renderer.frame(camera=camera)
            expected.append(renderer.frame(camera=camera).layers["direct"])
        views = [owned(View(gpu, SIZE)) for _ in expected]
        for turns in ((0, 1), (1, 0), (0, 0), (1, 1), (0, 1)):
            for turn in turns:
                views[turn].aim((corner.camera, aside)[turn])
                technique.draw(commands, views[turn])
                commands.submit()
                got = technique.layers(views[turn])["direct"].read()[..., :3]
                np.testing.assert_array_equal(got, expected[turn])
