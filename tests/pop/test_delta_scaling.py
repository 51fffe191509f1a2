"""Lobes sharper than ordinates: scaled alike, and what is behind them is seen."""

from __future__ import annotations

import numpy as np
import pytest

from airlight.pop.delta_scaling import SHARPEST, delta_scaled, delta_scaling
from airlight.rendering import Renderer
from airlight.scene import Camera, Environment, Medium, Scene, Volume

SLAB = Volume((3.0,) * 3, shape="box", bounds=((-2.0, -2.0, -0.25), (2.0, 2.0, 0.25)))


def test_transport_and_absorption_stay():
    sharp = Medium((4.0, 2.0, 1.0), albedo=(1.0, 0.9, 0.5), g=(0.999, 0.98, 0.5))
    dulled = delta_scaled(sharp)
    assert dulled.g == (SHARPEST, SHARPEST, 0.5)
    transport = [np.array(m.sigma_s) * (1.0 - np.array(m.g)) for m in (sharp, dulled)]
    np.testing.assert_allclose(transport[1], transport[0])
    np.testing.assert_allclose(dulled.sigma_a, sharp.sigma_a, atol=1e-12)


def test_what_did_not_change_is_the_same_object():
    lobes = delta_scaling()
    blunt, sharp = Volume((1.0,) * 3, shape="box"), Volume((1.0,) * 3, shape="box", g=0.99)
    scene = Scene(volumes=(blunt,))
    assert lobes.of(scene) is scene
    both = Scene(volumes=(blunt, sharp))
    first, second = lobes.of(both).volumes, lobes.of(both).volumes
    assert first[0] is blunt
    assert first[1] is second[1] is not sharp


@pytest.mark.parametrize(("g", "most"), [(0.99, 0.03), (0.999, 0.0015)])
def test_the_dark_below_a_bright_sky_stays_dark_behind_a_sharp_medium(gpu, g, most):
    light = np.zeros((32, 64, 3), np.float32)
    light[:16] = 1.0
    slab = Volume(SLAB.sigma_t, shape="box", bounds=SLAB.bounds, g=(g,) * 3)
    camera = Camera((0.0, 1.0, 2.0), (0.0, 0.0, 0.0), fov_y_deg=8.0)
    scene = Scene(volumes=(slab,), environment=Environment(map=light), camera=camera)
    # A path tracer: .0097 and .0009; .074 and .076 by lobes as they are.
    with Renderer(scene, "pop", (8, 8)) as made:
        image = made.frame()
    assert 0.0 < image.radiance.mean() < most
