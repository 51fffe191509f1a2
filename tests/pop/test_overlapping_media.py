"""Several media at once, through one another: a uniform sky hides them, Monte Carlo agrees."""

from __future__ import annotations

import numpy as np
import pytest

from airlight.gpu.device import Gpu
from airlight.maths.transforms import F64
from airlight.rendering import Renderer
from airlight.scene import Camera, Environment, Scene, Volume
from airlight.scene.lights import DirectionalLight
from airlight.techniques.settings import PopTechniqueSettings

from .test_media import images

CAMERA = Camera((0.6, 1.2, 4.5), (0.0, 0.0, 0.0), fov_y_deg=36.0)
LEFT = ((-1.25, -0.5, -0.5), (0.25, 0.5, 0.5))
RIGHT = ((-0.25, -0.5, -0.75), (1.25, 0.75, 0.5))
WHITE = Environment((1.0, 1.0, 1.0))
SUN = DirectionalLight((-0.6, -0.64, -0.48), (3.0, 3.0, 3.0))
SIZE = (48, 32)


def test_an_uniform_sky_hides_two_that_overlap(gpu: Gpu) -> None:
    """Different in every channel, and white: scattered light is what is missing of the sky."""
    media = (
        Volume((1.0, 1.6, 2.4), shape="box", bounds=LEFT, g=(0.0, 0.5, 0.8)),
        Volume((3.0, 1.5, 0.8), shape="box", bounds=RIGHT, g=(0.7, 0.3, 0.0)),
    )
    scene = Scene(volumes=media, environment=WHITE, camera=CAMERA)
    settings = PopTechniqueSettings(ordinates=32, grid=8, solver_steps=24, march="full")
    scattered, through = images(gpu, scene, settings)
    assert through.min() < 0.1
    np.testing.assert_allclose(scattered + through, 1.0, atol=0.06)


def summed(depth: float) -> Volume:
    """Both boxes as one grid: density 1 and 2, where they overlap 3."""
    at = (np.arange(24) + 0.5) / 8.0 - 1.5
    z, y, x = np.meshgrid(at, at, at, indexing="ij")
    points = np.stack([x, y, z], axis=-1)
    total: F64 = np.zeros(x.shape)
    for box, density in ((LEFT, 1.0), (RIGHT, 2.0)):
        low, high = np.array(box)
        total += density * np.all((points > low) & (points < high), axis=-1)
    bounds = ((-1.5,) * 3, (1.5,) * 3)
    return Volume((depth,) * 3, total.astype(np.float32), bounds=bounds, source="both")


@pytest.mark.slow
@pytest.mark.parametrize("lit", ["sky", "sun"])
@pytest.mark.needs("mitsuba")
def test_two_that_overlap_scatter_as_one_of_their_sum(lit: str) -> None:
    """Beside a path tracer's image of one grid. Energy measured: sun .98."""
    from airlight.reference import mitsuba

    light = {"environment": WHITE} if lit == "sky" else {"lights": (SUN,), "environment": None}
    one = Scene(volumes=(summed(1.0),), camera=CAMERA, **light)
    truth = mitsuba.render_layers(one, ("all",), size=SIZE, spp=96, seed=0, timeout_s=600.0)["all"]
    two = (
        Volume((1.0,) * 3, shape="box", bounds=LEFT, source="left"),
        Volume((2.0,) * 3, shape="box", bounds=RIGHT, source="right"),
    )
    scene = Scene(volumes=two, camera=CAMERA, **light)
    with Renderer(scene, "pop", SIZE, settings={"march": "full", "grid": 16}) as renderer:
        image = renderer.frame(samples=4)
    assert image is not None
    scattered = image.layers["scattered"].astype(np.float64)
    want = truth.radiance - (image.radiance - scattered)
    seen = image.layers["transmittance"].mean(axis=-1) < 0.97
    assert scattered[seen].sum() / want[seen].sum() == pytest.approx(1.0, abs=0.06)
    assert np.linalg.norm((scattered - want)[seen]) < 0.2 * np.linalg.norm(want[seen])
