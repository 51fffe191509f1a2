"""Images of media: a white furnace, several media, turned ones."""

from __future__ import annotations

import dataclasses

import numpy as np

from airlight.gpu.device import Gpu
from airlight.maths.transforms import F64
from airlight.rendering import render
from airlight.scene.camera import Camera
from airlight.scene.environment import Environment
from airlight.scene.medium import Medium
from airlight.scene.scene import Scene
from airlight.scene.volume import Volume
from airlight.techniques.settings import PopTechniqueSettings

SIZE = (32, 24)
SETTINGS = PopTechniqueSettings(ordinates=32, grid=10, solver_steps=24, march="full")
BALL = Volume((2.0, 6.0, 12.0), shape="sphere", g=(0.0, 0.5, 0.9))
WHITE = Environment((1.0, 1.0, 1.0))
CAMERA = Camera((0.4, 0.8, 3.0), (0.0, 0.0, 0.0), fov_y_deg=50)


def images(gpu: Gpu, scene: Scene, settings: PopTechniqueSettings = SETTINGS) -> tuple[F64, F64]:
    """(scattered, transmittance), (H, W, 3)."""
    given = dataclasses.asdict(settings)
    image = render(scene, "pop", SIZE, settings=given, samples=1)
    layers = [image.layers[name].astype(np.float64) for name in ("scattered", "transmittance")]
    return layers[0], layers[1]


def test_a_white_furnace_hides_the_medium(gpu):
    """Radiance 1 all around and no absorption: every pixel is 1, within 5%."""
    scene = Scene(volumes=(BALL,), environment=WHITE, camera=CAMERA)
    scattered, through = images(gpu, scene)
    assert through.min() < 0.02
    np.testing.assert_allclose(scattered + through, 1.0, atol=0.05)


def test_absorption_darkens_and_no_light_is_black(gpu):
    sooty = dataclasses.replace(BALL, albedo=(0.8, 0.8, 0.8))
    scene = Scene(volumes=(sooty,), environment=WHITE, camera=CAMERA)
    scattered, through = images(gpu, scene)
    middle = (scattered + through)[12, 16]
    assert np.all((middle > 0.05) & (middle < 0.7))
    dark, _ = images(gpu, dataclasses.replace(scene, environment=None))
    assert dark.max() == 0.0


def test_where_a_volume_stands_does_not_matter(gpu):
    """The same ball, its box turned and moved with the camera: the same image."""
    scene = Scene(volumes=(BALL,), environment=WHITE, camera=CAMERA)
    straight, _ = images(gpu, scene)
    turn = np.array([[0.0, 0, 1, 5], [0, 1, 0, -2], [-1, 0, 0, 7], [0, 0, 0, 1.0]])

    def moved(p: tuple[float, float, float]) -> tuple[float, float, float]:
        x, y, z = turn[:3, :3] @ np.array(p) + turn[:3, 3]
        return (float(x), float(y), float(z))

    camera = Camera(moved(CAMERA.position), moved(CAMERA.target), fov_y_deg=50)
    ball = dataclasses.replace(BALL, world_from_volume=turn)
    turned, _ = images(gpu, Scene(volumes=(ball,), environment=WHITE, camera=camera))
    np.testing.assert_allclose(turned, straight, atol=0.03)


def test_fog_and_a_volume_are_solved_apart(gpu):
    small = dataclasses.replace(BALL, bounds=((-0.5,) * 3, (0.5,) * 3))
    fog = Medium((0.3,) * 3, bounds=((-1.0,) * 3, (1.0,) * 3))
    scene = Scene(medium=fog, volumes=(small,), environment=WHITE, camera=CAMERA)
    scattered, through = images(gpu, scene)
    np.testing.assert_allclose(scattered + through, 1.0, atol=0.06)
