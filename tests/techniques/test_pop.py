import numpy as np

from airlight.rendering import render
from airlight.techniques import pop

from .conftest import SIZE, SMALL


def test_a_ball_of_smoke_scatters_less_than_it_receives(smoke_over_floor):
    assert pop.Pop.Settings is pop.PopTechniqueSettings
    image = render(smoke_over_floor, "pop", SIZE, settings=SMALL, samples=1)
    scattered = image.layers["scattered"]
    smoke = image.layers["transmittance"][..., 1] < 0.3
    assert smoke.any()
    # A body of albedo 1 under irradiance E cannot look brighter than E/pi on the whole.
    assert 0.02 < scattered[smoke].mean() < 3.0 / np.pi
    assert float(scattered[image.layers["transmittance"][..., 1] > 0.999].max()) < 0.01
