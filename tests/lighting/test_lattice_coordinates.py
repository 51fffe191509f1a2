"""Places that are kept light an image as those looked up with the light do."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from airlight.gpu.device import Gpu
from airlight.lighting import surfaces
from airlight.lighting.lattice_coordinates import _CoordinatesPass
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


@pytest.mark.parametrize("is_glossy", [True, False])
def test_kept_or_looked_up_with_the_light(
    gpu: Gpu, corner: Scene, monkeypatch: pytest.MonkeyPatch, is_glossy: bool
) -> None:
    settings = {**SETTINGS, "glossy_rays": is_glossy}
    with Renderer(corner, "lpv", SIZE, settings=settings) as renderer:
        first = renderer.frame().layers
        kept = renderer.frame().layers
        assert (renderer.technique.surfaces._coordinates is not None) == gpu.takes_cpu_paths
    monkeypatch.setattr(surfaces, "can_cache", lambda _: False)
    with Renderer(corner, "lpv", SIZE, settings=settings) as renderer:
        looked_up = renderer.frame().layers
        assert renderer.technique.surfaces._coordinates is None
    for name in ("direct", "indirect"):
        np.testing.assert_array_equal(first[name], looked_up[name])
        np.testing.assert_array_equal(kept[name], looked_up[name])


def test_what_they_depend_on_recomputes_them(
    gpu: Gpu, corner: Scene, monkeypatch: pytest.MonkeyPatch
) -> None:
    made: list[int] = []
    draw = _CoordinatesPass.draw

    def counted(self: Any, *args: Any, **values: Any) -> None:
        made.append(1)
        draw(self, *args, **values)

    monkeypatch.setattr(_CoordinatesPass, "draw", counted)
    camera = dataclasses.replace(corner.camera, position=(0.6, 1.0, 2.8))
    moved = np.eye(4)
    moved[:3, 3] = (0.0, -0.2, 0.3)
    nearer = dataclasses.replace(corner.meshes[1], world_from_object=moved)
    changes: list[tuple[dict[str, Any], bool]] = [
        ({}, False),
        ({"lights": (PointLight((-0.5, 1.3, -0.5), (4, 8, 8)),)}, False),
        ({"camera": camera}, True),
        ({"camera": dataclasses.replace(camera, target=(-0.5, 0.2, -1.0))}, True),
        ({"environment": Environment((0.6, 0.2, 0.1))}, True),
        ({"meshes": (corner.meshes[0], nearer, corner.meshes[2])}, True),
    ]
    with Renderer(corner, "lpv", SIZE, settings=SETTINGS) as renderer:
        renderer.frame()
        renderer.frame()
        for change, is_new in changes:
            made.clear()
            seen = renderer.frame(**change)
            assert not made
            kept = renderer.frame()
            assert len(made) == (is_new and gpu.takes_cpu_paths)
            np.testing.assert_array_equal(seen.radiance, kept.radiance)
        now = renderer.scene
    with Renderer(corner, "lpv", SIZE, settings=SETTINGS) as renderer:
        fresh = renderer.frame(**{n: getattr(now, n) for c, _ in changes for n in c})
    assert seen is not None and fresh is not None
    np.testing.assert_array_equal(seen.layers["indirect"], fresh.layers["indirect"])
    np.testing.assert_array_equal(seen.layers["direct"], fresh.layers["direct"])


def test_an_image_that_was_not_drawn_is_not_kept(
    gpu: Gpu, corner: Scene, monkeypatch: pytest.MonkeyPatch
) -> None:
    if not gpu.takes_cpu_paths:
        pytest.skip("places are kept on CPU adapters")

    def failing(*_: Any, **__: Any) -> None:
        raise KeyboardInterrupt

    with Renderer(corner, "lpv", SIZE, settings=SETTINGS) as renderer:
        expected = renderer.frame()
        with monkeypatch.context() as patched:
            patched.setattr(_CoordinatesPass, "draw", failing)
            with pytest.raises(KeyboardInterrupt):
                renderer.frame()
        after = renderer.frame()
        kept = renderer.frame()
    assert expected and after and kept
    np.testing.assert_array_equal(after.radiance, expected.radiance)
    np.testing.assert_array_equal(kept.radiance, expected.radiance)


@pytest.mark.parametrize("changed", ["medium", "volumes"])
def test_in_fog_they_are_made_again_with_the_air(gpu: Gpu, corner: Scene, changed: str) -> None:
    """The sky's light comes through the air: the camera stands, the air gets thicker."""
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
            places = renderer.technique.surfaces._coordinates
            assert (places is not None and places._cached is not None) == gpu.takes_cpu_paths
        return images

    used, fresh = drawn(before=2), drawn(before=0)[0]
    assert not np.array_equal(used[1].radiance, used[2].radiance)
    for image in used[2:]:
        for name in ("direct", "indirect"):
            np.testing.assert_array_equal(image.layers[name], fresh.layers[name])


def test_blockers_that_lights_see_recompute_them(gpu: Gpu, corner: Scene) -> None:
    """With another light other surfels are seen, and walls are bent otherwise."""
    settings = {
        **SETTINGS,
        "surfel_source": "views",
        "surfel_resolution": 32,
        "keep_surfels": False,
    }
    away = {"lights": (PointLight((-2.5, 0.1, -2.9), (4, 8, 8)),)}
    with Renderer(corner, "lpv", SIZE, settings=settings) as renderer:
        images = [*(renderer.frame() for _ in "12"), *(renderer.frame(**away) for _ in "123")]
        assert (renderer.technique.surfaces._coordinates is not None) == gpu.takes_cpu_paths
    with Renderer(corner, "lpv", SIZE, settings=settings) as renderer:
        fresh = renderer.frame(**away)
    for image in images[2:]:
        np.testing.assert_array_equal(image.radiance, fresh.radiance)


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
