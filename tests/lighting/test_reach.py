"""How far lattices reach into a medium: an eye that leaves what they hold gets others."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from airlight.lighting.reach import Reach, reach_of
from airlight.rendering import Renderer
from airlight.scene import Camera, DirectionalLight, Environment, Medium, Mesh, Scene
from airlight.scene.material import Material
from airlight.scene.placing import camera_at
from airlight.scene.shapes import box

NEAR = Camera((4.0, 2.0, 6.0), (0.0, 0.5, 0.0), fov_y_deg=45.0)
THIN = Medium((0.03,) * 3)
PLATE = Scene(
    (Mesh(box(), Material(base_color=(0.6, 0.5, 0.4), specular=0.0)),),
    (DirectionalLight((0.4, -1.0, 0.3), (6.0, 5.5, 5.0)),),
    environment=Environment((0.3, 0.4, 0.5)),
    medium=THIN,
    camera=NEAR,
)
SETTINGS = {
    "resolution": 12,
    "shadow_resolution": 256,
    "sky_lights": 16,
    "sky_resolution": 32,
    "surfels": 10_000,
    "map_resolution": 32,
    "iterations": 16,
    "gather": "off",
}
BOUNDS = ((-20.0,) * 3, (20.0,) * 3)


def seen(scene: Scene, eye: tuple[float, float, float]) -> Scene:
    """The scene with its camera at `eye`."""
    return replace(scene, camera=camera_at(scene.camera, eye))


def reach(scene: Scene) -> Reach:
    found = reach_of(scene)
    assert found is not None
    return found


def test_no_reach_without_a_medium_that_ends():
    assert reach_of(replace(PLATE, medium=None)) is None
    assert reach_of(replace(PLATE, medium=Medium((0.0,) * 3))) is None


def test_an_eye_in_what_is_reached_is_not_beyond_it():
    for eye in ((4.0, 2.0, 6.0), (1.0, 1.0, 3.0), (4.02, 2.0, 6.02), (-0.5, 0.0, 0.5)):
        assert reach(PLATE).beyond(seen(PLATE, eye)) is None, eye


@pytest.mark.parametrize("eye", [(9.0, 2.0, 6.0), (-7.0, 30.0, 1.0), (4.0, 2.0, -200.0)])
def test_an_eye_beyond_gets_one_that_sees_as_much_and_lasts(eye):
    far = reach(PLATE).beyond(seen(PLATE, eye))
    assert far is not None
    low, high = reach(seen(PLATE, far)).for_eye(far)
    first, last = reach(PLATE).for_eye(eye)
    spare = 0.03 * float(np.max(last - first))
    # All of what `eye` sees but for the side on which the scene's own eye was.
    held_low, held_high = reach(PLATE).for_eye(NEAR.position)
    assert (np.minimum(low, held_low) <= first + spare).all()
    assert (np.maximum(high, held_high) >= last - spare).all()
    # A little further on it is the same.
    assert reach(PLATE).beyond(seen(PLATE, tuple(np.multiply(eye, 1.01)))) == far
    # What is made for it holds what the eye sees.
    assert reach(seen(PLATE, far)).beyond(seen(PLATE, eye)) is None


def test_a_medium_with_bounds_is_reached_as_far_as_it_is_seen():
    thin = replace(PLATE, medium=replace(THIN, bounds=BOUNDS))
    dense = replace(PLATE, medium=Medium((3.0,) * 3, bounds=BOUNDS))
    eye = (4.0, 2.0, 18.0)
    assert reach(thin).beyond(seen(thin, eye)) is None
    assert reach(dense).beyond(seen(dense, eye)) is not None
    # A medium that grows thinner shows more of itself to the same eye.
    assert reach(dense).beyond(thin) is not None


@pytest.mark.parametrize("eye", [(12.0, 6.0, 20.0), (4.0, 2.0, -12.0)])
def test_frames_of_a_camera_that_goes_away_are_those_of_one_that_was_there(eye):
    far = seen(PLATE, eye)
    size = (24, 14)
    with Renderer(PLATE, size=size, settings=SETTINGS) as renderer:
        renderer.frame()
        went = renderer.frame(camera=far.camera)
        back = renderer.frame(camera=NEAR)
    with Renderer(far, size=size, settings=SETTINGS) as renderer:
        was = renderer.frame()
    with Renderer(PLATE, size=size, settings=SETTINGS) as renderer:
        stayed = renderer.frame()
    # Cells are others, but not more than twice as large: 16 % to 30 % were lost beyond lattices.
    assert went.radiance.sum() == pytest.approx(was.radiance.sum(), rel=0.02)
    np.testing.assert_array_equal(back.radiance, stayed.radiance)
