"""Unlit surfaces: cameras see their base colour after exposure, whatever lights them."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from airlight.maths.tone import tone_map
from airlight.rendering import Renderer, render
from airlight.scene import Camera, DirectionalLight, Environment, Material, Mesh, Scene
from airlight.scene.shapes import box, quad

SIZE = (32, 18)
SETTINGS = {"shadow_resolution": 256, "sky_lights": 16, "sky_resolution": 32, "surfels": 10_000}
LPV = {**SETTINGS, "resolution": 12, "map_resolution": 64, "ambient_occlusion": False}
COLOUR = (0.5, 0.25, 0.125)  # exact in half floats


def _scene(stops: float | None, *, alpha: float = 1.0) -> Scene:
    """A large unlit wall before a lit floor; the wall fills the middle of the image."""
    unlit = Material(base_color=COLOUR, is_unlit=True, is_blended=alpha < 1.0, alpha=alpha)
    turned = np.diag([1.5, 1.5, 0.1, 1.0])
    floor = np.diag([40.0, 1.0, 40.0, 1.0])
    floor[1, 3] = -1.0
    return Scene(
        meshes=(Mesh(box(), unlit, turned), Mesh(quad(), Material(), floor)),
        lights=(DirectionalLight((-0.3, -1.0, -0.4), (7.0, 6.0, 5.0)),),
        environment=Environment((0.4, 0.5, 0.6)),
        camera=Camera((0.0, 0.0, 3.0), (0.0, 0.0, 0.0), exposure_stops=stops),
    )


@pytest.mark.both_paths
@pytest.mark.parametrize("stops", [-3.0, 2.0])
def test_the_exposed_image_shows_the_base_colour(stops: float) -> None:
    image = render(_scene(stops), "direct", SIZE, samples=1, settings=SETTINGS)
    seen = tone_map(image.radiance[9, 16], image.exposure_stops, "none")
    np.testing.assert_allclose(seen, COLOUR, rtol=2e-3)


@pytest.mark.parametrize("samples", [1, 4])
def test_an_image_that_exposes_itself_leaves_them_out_of_the_metering(samples: int) -> None:
    scene = _scene(None)
    image = render(scene, "direct", SIZE, samples=samples, settings=SETTINGS)
    seen = tone_map(image.radiance[9, 16], image.exposure_stops, "none")
    np.testing.assert_allclose(seen, COLOUR, rtol=2e-3)
    # Metered is what is lit: as of the same image with a black wall in their place.
    black = Material(base_color=(0.0, 0.0, 0.0), specular=0.0)
    dark = replace(scene, meshes=(replace(scene.meshes[0], material=black), scene.meshes[1]))
    alone = render(dark, "direct", SIZE, samples=1, settings=SETTINGS)
    assert image.exposure_stops == pytest.approx(alone.exposure_stops, abs=0.01)
    assert abs(image.exposure_stops) > 0.5


def test_they_light_nothing_and_stand_in_the_light_as_any_surface() -> None:
    """Off the wall every pixel is that of a wall of the same colour, lit.

    CPU adapters draw the two walls on other paths, whose half floats differ: measured .0026.
    """
    scene = _scene(0.0)
    matt = replace(scene.meshes[0].material, is_unlit=False, specular=0.0)
    lit = replace(scene, meshes=(replace(scene.meshes[0], material=matt), scene.meshes[1]))
    with_unlit, without = (
        render(s, "lpv", SIZE, samples=1, settings=LPV).radiance for s in (scene, lit)
    )
    is_wall = np.abs(with_unlit - COLOUR).max(axis=-1) < 2e-3
    assert 0.1 < is_wall.mean() < 0.6
    np.testing.assert_allclose(with_unlit[~is_wall], without[~is_wall], rtol=5e-3)


def test_of_a_blended_one_its_share_is_seen() -> None:
    image = render(_scene(0.0, alpha=0.5), "direct", SIZE, samples=1, settings=SETTINGS)
    clear = render(_scene(0.0, alpha=0.0), "direct", SIZE, samples=1, settings=SETTINGS)
    # Front and back of the box, one behind the other, leave a quarter of what is behind.
    both = 0.75 * np.array(COLOUR) + 0.25 * clear.radiance[9, 16]
    np.testing.assert_allclose(image.radiance[9, 16], both, rtol=4e-3)


def test_an_exposure_for_all_frames_replaces_the_cameras() -> None:
    with Renderer(_scene(None), "direct", SIZE, settings=SETTINGS) as renderer:
        renderer.exposure_stops = -2.0
        image = renderer.frame()
    assert image is not None and image.exposure_stops == -2.0
    np.testing.assert_allclose(image.radiance[9, 16], 4.0 * np.array(COLOUR), rtol=2e-3)
