"""Glossy pixels drawn apart look as those drawn with all others."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from airlight.gpu.device import Gpu
from airlight.lighting import surfaces
from airlight.lighting.glossy_pixels import can_list
from airlight.rendering import Renderer
from airlight.scene import Camera, Environment, Material, Mesh, PointLight, Scene

SIZE = (43, 29)


@pytest.fixture
def polished(square: Callable[..., Mesh]) -> Scene:
    """A polished floor with a coloured wall behind it and a rough one beside it, under a sky."""
    floor = square((0, 0, 0), (3, 0, 0), (0, 0, -3), Material((0.5, 0.5, 0.5), roughness=0.15))
    back = square((0, 1, -3), (3, 0, 0), (0, 1, 0), Material((0.8, 0.2, 0.1), roughness=1.0))
    side = square((-3, 1, 0), (0, 0, 3), (0, 1, 0), Material((0.2, 0.7, 0.3), roughness=0.4))
    return Scene(
        meshes=(floor, back, side),
        lights=(PointLight((0.5, 1.2, -1.0), (8, 8, 8)),),
        environment=Environment((0.3, 0.4, 0.5)),
        camera=Camera((0.4, 1.1, 3.0), (-0.2, 0.5, -1.5), fov_y_deg=60),
    )


@pytest.mark.parametrize("more", [{}, {"cascades": 2}])
def test_apart_or_with_the_rest(
    gpu: Gpu, polished: Scene, monkeypatch: pytest.MonkeyPatch, more: dict[str, int]
) -> None:
    settings = {
        "resolution": 8,
        "iterations": 4,
        "surfels": 5000,
        "sky_lights": 8,
        "sky_resolution": 16,
        **more,
    }
    seen = {}
    for is_apart in (True, False):
        monkeypatch.setattr(surfaces, "can_list", lambda *_, _is_apart=is_apart: _is_apart)
        with Renderer(polished, "lpv", SIZE, settings=settings) as renderer:
            seen[is_apart] = renderer.frame().layers
            has_list = renderer.technique.surfaces.glossy is not None
            assert has_list == (is_apart and gpu.paths.listed_gloss)
    for name in ("direct", "indirect"):
        np.testing.assert_allclose(seen[True][name], seen[False][name], rtol=2e-5, atol=1e-6)
    with Renderer(polished, "lpv", SIZE, settings={**settings, "glossy_rays": False}) as renderer:
        plain = renderer.frame().layers["indirect"]
    assert np.abs(plain - seen[True]["indirect"]).max() > 0.05 * plain.max()


def test_images_may_be_too_large_for_a_list(gpu: Gpu) -> None:
    assert can_list(gpu, (1920, 1080))
    assert not can_list(gpu, (1 << 16, 1 << 16))


def test_another_size_is_another_list(gpu: Gpu, polished: Scene) -> None:
    settings = {"resolution": 8, "iterations": 4, "surfels": 5000}
    with Renderer(polished, "lpv", (16, 12), settings=settings) as renderer:
        renderer.frame()
        renderer.resize(SIZE)
        resized = renderer.frame()
    with Renderer(polished, "lpv", SIZE, settings=settings) as renderer:
        np.testing.assert_array_equal(renderer.frame().radiance, resized.radiance)
