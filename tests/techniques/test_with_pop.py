import dataclasses

import numpy as np

from airlight.rendering import render

from .conftest import SIZE, SMALL


def test_smoke_shadows_the_floor_and_shines(smoke_over_floor):
    image = render(smoke_over_floor, "auto", SIZE, settings=SMALL, samples=1)
    clear = render(
        dataclasses.replace(smoke_over_floor, volumes=()), "auto", SIZE, settings=SMALL, samples=1
    )
    smoke = image.layers["transmittance"][..., 1] < 0.5
    assert smoke.any()
    assert image.layers["multiple_scatter"][smoke].mean() > 0.05
    floor = (image.layers["transmittance"][..., 1] > 0.99) & np.isfinite(image.layers["depth"])
    ratio = image.layers["direct"][floor] / np.maximum(clear.layers["direct"][floor], 1e-6)
    assert ratio.min() < 0.6, "the smoke's shadow lies on the floor"
    assert np.median(ratio) > 0.9, "elsewhere the sun is not attenuated"
