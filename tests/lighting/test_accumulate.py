"""The mean of several images."""

from __future__ import annotations

import numpy as np
import pytest

from airlight.gpu.memory import Texture
from airlight.lighting.accumulate import Accumulator

RNG = np.random.default_rng(1)


@pytest.mark.parametrize("count", [1, 2, 5])
def test_the_mean_of_all_images_and_of_no_older_ones(gpu, commands, owned, count):
    mean = owned(Accumulator(gpu, (7, 5), ("direct", "indirect")))
    images = RNG.random((2, count, 5, 7, 4)).astype(np.float32)
    for _ in range(2):  # index 0 restarts
        for index in range(count):
            textures = {}
            for name, image in zip(("direct", "indirect"), images[:, index], strict=True):
                textures[name] = owned(Texture(gpu, name, (7, 5), "rgba32float"))
                textures[name].write(image)
            mean.encode(commands, textures, index)
            commands.submit()
    for name, expected in zip(("direct", "indirect"), images.mean(axis=1), strict=True):
        np.testing.assert_allclose(mean.read(name), expected, rtol=1e-5, atol=1e-6)
