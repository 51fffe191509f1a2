"""What lighting asks of a device."""

from __future__ import annotations

import pytest

from airlight.gpu import device
from airlight.gpu.device import Gpu
from airlight.lighting.lighting import Lighting, Part

GRANTED = 16
"""Sampled textures that WebGPU grants every stage."""


@pytest.fixture(scope="module")
def least(gpu: Gpu) -> Gpu:
    """A device that has no more than those."""
    with pytest.MonkeyPatch.context() as patched:
        patched.setitem(device._LIMITS, "max-sampled-textures-per-shader-stage", GRANTED)
        return Gpu(gpu.info, gpu.paths)


@pytest.mark.parametrize("part", ["whole", "lights", "lattices"])
def test_no_more_textures_than_any_device_has(least: Gpu, part: Part) -> None:
    """Of the parts that all devices draw; "placed" is for software drivers."""
    made = Lighting(least, part=part)  # raises where a stage has too many
    assert sum("texture" in slot.layout for slot in made.slots) <= GRANTED
