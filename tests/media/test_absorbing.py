"""Volumes that only absorb, for lattices that hold the light around them."""

import numpy as np

from airlight.media.reduced import absorbing_volumes
from airlight.scene.medium import Medium
from airlight.scene.scene import Scene
from airlight.scene.volume import Volume


def test_volumes_keep_their_absorption_and_the_medium_stays():
    density = np.ones((2, 2, 2), np.float32)
    smoke = Volume(
        (4.0, 2.0, 1.0),
        density,
        bounds=((0.0, 0.0, 0.0), (1.0, 1.0, 1.0)),
        albedo=(0.25, 0.5, 1.0),
        g=(0.8, 0.0, -0.5),
    )
    fog = Medium((0.1, 0.1, 0.1))
    seen = absorbing_volumes(Scene(medium=fog, volumes=(smoke,)))
    (ash,) = seen.volumes
    np.testing.assert_allclose(ash.sigma_t, (3.0, 1.0, 0.0), rtol=1e-12)
    assert ash.albedo == ash.g == (0.0, 0.0, 0.0)
    assert ash.density is smoke.density and seen.medium is fog
