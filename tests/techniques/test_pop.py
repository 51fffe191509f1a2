import dataclasses

import numpy as np

from airlight.rendering import render
from airlight.scene import Environment, Material, Mesh
from airlight.scene.shapes import quad

from .conftest import SIZE, SMALL


def test_a_ball_of_smoke_scatters_less_than_it_receives(smoke_over_floor):
    image = render(smoke_over_floor, "pop", SIZE, settings=SMALL, samples=1)
    scattered = image.layers["scattered"]
    smoke = image.layers["transmittance"][..., 1] < 0.3
    assert smoke.any()
    # A body of albedo 1 under irradiance E cannot look brighter than E/pi on the whole.
    assert 0.02 < scattered[smoke].mean() < 3.0 / np.pi
    assert float(scattered[image.layers["transmittance"][..., 1] > 0.999].max()) < 0.01


def test_media_alone_see_the_sky_without_its_lattice(smoke_over_floor):
    """No surface asks what the sky's lights see; a black one far away must change nothing."""
    sky = np.full((8, 16, 3), 0.2, np.float32)
    sky[:3] = (1.0, 2.0, 4.0)
    alone = dataclasses.replace(smoke_over_floor, meshes=(), environment=Environment(map=sky))
    speck = np.diag([1e-3, 1e-3, 1e-3, 1.0])
    speck[:3, 3] = (0.0, -3.0, 0.0)
    black = Mesh(quad(), Material(base_color=(0.0, 0.0, 0.0), specular=0.0), speck)
    settings = {**SMALL, "sky_lights": 8, "ambient_occlusion": False}
    got = render(alone, "pop", SIZE, settings=settings, samples=1)
    beside = render(
        dataclasses.replace(alone, meshes=(black,)), "pop", SIZE, settings=settings, samples=1
    )
    assert got.radiance.mean() > 0.1
    np.testing.assert_allclose(got.radiance, beside.radiance, rtol=0.01, atol=1e-3)
