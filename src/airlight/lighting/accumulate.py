"""The mean of jittered images, for anti-aliased stills."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ..gpu.commands import Commands
from ..gpu.compute import ComputePass
from ..gpu.device import Gpu
from ..gpu.layout import Struct, f32, vec2u
from ..gpu.memory import Buffer, Texture
from ..gpu.slots import storage, texture, uniform


class AccumulateParams(Struct):
    """The image's size and the new image's weight."""

    size = vec2u("px")
    weight = f32("of the new image; 1 restarts")


class _Add(ComputePass):
    slots = (
        uniform("params", AccumulateParams),
        texture("image", "2d", "unfilterable-float"),
        storage("mean", "vec4f", "read_write"),
    )
    workgroup = (32, 8, 1)
    file = "accumulate.wgsl"


class Accumulator:
    """Running means of several textures."""

    def __init__(self, gpu: Gpu, size: tuple[int, int], names: tuple[str, ...]) -> None:
        self.size = size
        self._add = _Add(gpu)
        self._means = {name: Buffer(gpu, f"mean {name}", size[0] * size[1] * 16) for name in names}

    def encode(self, commands: Commands, images: dict[str, Texture], index: int) -> None:
        """Add the image number `index` to the means of all names; 0 restarts them."""
        # The running mean m += (x - m)/(k + 1): no sum grows with the samples.
        params = AccumulateParams(size=self.size, weight=1.0 / (index + 1))
        for name, mean in self._means.items():
            self._add.dispatch(commands, self.size, params=params, image=images[name], mean=mean)

    def read(self, name: str) -> NDArray[np.float32]:
        """(H, W, 4): the mean so far."""
        width, height = self.size
        return self._means[name].read().reshape(height, width, 4)
