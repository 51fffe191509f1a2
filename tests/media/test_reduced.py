"""Isotropic media for media that scatter forwards."""

import numpy as np

from airlight.media.reduced import reduced, reduced_scene
from airlight.scene.medium import Medium
from airlight.scene.scene import Scene
from airlight.scene.volume import Volume


def test_scattering_is_reduced_by_the_mean_cosine_and_absorption_kept():
    air = Medium((2.0, 1.0, 0.0), (0.9, 0.5, 1.0), (0.8, -0.5, 0.3))
    even = reduced(air)
    want = np.array(air.sigma_s) * (1 - np.array(air.g))
    np.testing.assert_allclose(even.sigma_s, want, rtol=1e-12)
    np.testing.assert_allclose(even.sigma_a, air.sigma_a, atol=1e-12)
    assert even.g == air.g


def test_isotropic_scenes_stay_themselves_and_volumes_are_taken_along():
    plain = Scene(medium=Medium((1.0, 1.0, 1.0)))
    assert reduced_scene(plain) is plain
    volume = Volume((1.0, 1.0, 1.0), shape="sphere", g=(0.5, 0.5, 0.5))
    mixed = reduced_scene(Scene(medium=plain.medium, volumes=(volume,)))
    assert mixed.volumes[0].sigma_t == (0.5, 0.5, 0.5)
    assert mixed.medium.sigma_t == (1.0, 1.0, 1.0)
