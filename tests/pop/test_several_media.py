"""Several media that shade and light one another: as one of their sum does; a path tracer."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest

from airlight.gpu.device import Gpu
from airlight.maths.transforms import F64
from airlight.pop import several_media as together
from airlight.scene import Camera, Scene, Volume
from airlight.scene.lights import DirectionalLight, Light, PointLight
from airlight.techniques.settings import PopTechniqueSettings

from .test_media import images

CAMERA = Camera((0.6, 1.2, 4.5), (0.0, 0.0, 0.0), fov_y_deg=36.0)
SETTINGS = PopTechniqueSettings(ordinates=1, grid=8, solver_steps=24, march="full")
SUN = DirectionalLight((-0.6, -0.64, -0.48), (3.0, 3.0, 3.0))
ALONG = DirectionalLight((1.0, 0.0, 0.0), (3.0, 3.0, 3.0))
LIGHT = PointLight((0.3, 1.2, 0.4), (3.0, 3.0, 3.0))
Bounds = tuple[tuple[float, float, float], tuple[float, float, float]]
WHOLE: Bounds = ((-1.0, -0.5, -0.5), (1.0, 0.5, 0.5))


def box(bounds: Bounds, sigma: float, g: float, albedo: float = 1.0) -> Volume:
    """An even box of air."""
    return Volume(
        (sigma,) * 3,
        shape="box",
        bounds=bounds,
        g=(g,) * 3,
        albedo=(albedo,) * 3,
        source=str(bounds),
    )


def scattered(gpu: Gpu, volumes: tuple[Volume, ...], light: Light) -> F64:
    """(H, W, 3), W m^-2 sr^-1."""
    scene = Scene(volumes=volumes, lights=(light,), environment=None, camera=CAMERA)
    return images(gpu, scene, SETTINGS)[0]


@pytest.mark.parametrize("light", [SUN, LIGHT], ids=["sun", "lamp"])
def test_two_of_half_the_density_are_one(gpu: Gpu, light: Light) -> None:
    """In the same place: every path of light meets as much of both as of one."""
    one = scattered(gpu, (box(WHOLE, 4.0, 0.6, 0.9),), light)
    two = scattered(gpu, (box(WHOLE, 2.0, 0.6, 0.9),) * 2, light)
    assert one.max() > 0.05
    assert np.linalg.norm(two - one) < 0.02 * np.linalg.norm(one)


@pytest.mark.parametrize("g", [0.0, 0.6])
def test_a_box_cut_in_two_is_the_box(gpu: Gpu, g: float) -> None:
    """Light goes across the cut, in beams and after it was scattered."""
    one = scattered(gpu, (box(WHOLE, 4.0, g),), ALONG)
    low, high = WHOLE
    halves = ((low, (0.0, 0.5, 0.5)), ((0.0, -0.5, -0.5), high))
    two = scattered(gpu, tuple(box(half, 4.0, g) for half in halves), ALONG)
    assert two.sum() == pytest.approx(one.sum(), rel=0.1)
    assert np.linalg.norm(two - one) < 0.25 * np.linalg.norm(one)


@pytest.mark.parametrize(
    ("g", "traced"), [(0.0, (0.02109, 0.00377)), (0.7, (0.01638, 0.00380))], ids=["even", "forward"]
)
def test_one_behind_another_is_in_its_shadow_and_in_its_light(
    gpu: Gpu, g: float, traced: tuple[float, float]
) -> None:
    """Two boxes of 1 m with .5 m between them, the sun along both: light of each half image.

    Mitsuba 3, 192 samples of 48 x 32 pixels. Without shadow the second is 3 to 6 times too bright.
    """
    assert together.ROUNDS >= 1
    boxes = (((-1.25, -0.5, -0.5), (-0.25, 0.5, 0.5)), ((0.25, -0.5, -0.5), (1.25, 0.5, 0.5)))
    scene = Scene(
        volumes=tuple(box(b, 2.0, g) for b in boxes),
        lights=(ALONG,),
        environment=None,
        camera=CAMERA,
    )
    got = images(gpu, scene, dataclasses.replace(SETTINGS, grid=12))[0].mean(axis=-1)
    height, width = got.shape
    share = np.array([got[:, : width // 2].sum(), got[:, width // 2 :].sum()]) / height**2
    np.testing.assert_allclose(share, traced, rtol=0.15)
