"""Fog, a volume and surfaces in one frame, against a path tracer."""

from __future__ import annotations

import numpy as np
import pytest

from airlight.rendering import render
from airlight.scene import (
    Camera,
    DirectionalLight,
    Environment,
    Material,
    Medium,
    Mesh,
    Scene,
    Volume,
)
from airlight.scene.shapes import quad

SIZE = (96, 64)


@pytest.mark.slow
@pytest.mark.needs("mitsuba")
def test_fog_a_volume_and_a_floor_have_the_energy_of_a_path_tracer():
    from airlight import reference

    under = np.diag([6.0, 1.0, 6.0, 1.0])
    under[1, 3] = -1.0
    scene = Scene(
        meshes=(Mesh(quad(), Material(base_color=(0.6, 0.4, 0.3), specular=0.0), under),),
        lights=(DirectionalLight((-0.5, -0.8, -0.3), (5.0, 4.7, 4.0)),),
        environment=Environment((0.5, 0.6, 0.8), visible=False),
        medium=Medium((0.08,) * 3, (0.95,) * 3, (0.3,) * 3, bounds=((-3, -1, -3), (3, 2, 3))),
        volumes=(
            Volume(
                (4.0,) * 3,
                shape="sphere",
                bounds=((-0.7, -0.6, -0.7), (0.7, 0.8, 0.7)),
                albedo=(0.98,) * 3,
                g=(0.6,) * 3,
            ),
        ),
        camera=Camera((0.0, 0.6, 4.5), (0.0, -0.1, 0.0), fov_y_deg=45.0),
    )
    want = reference.render(scene, size=SIZE, spp=64).radiance[..., :3]
    image = render(scene, "auto", SIZE, samples=2)
    got, through = image.radiance[..., :3], image.layers["transmittance"][..., :3].mean(axis=-1)
    ball = through < 0.5 * through.max()
    assert got.sum() / want.sum() == pytest.approx(1.0, abs=0.15)
    assert got[ball].sum() / want[ball].sum() == pytest.approx(1.0, abs=0.15)
