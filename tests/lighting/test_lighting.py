"""What lighting asks of a device."""

from __future__ import annotations

import pytest

from airlight.gpu.device import Gpu, open_gpu
from airlight.lighting.kernel import LatticeLight, LightKinds
from airlight.lighting.lighting import Lighting
from airlight.lighting.slots import Part

GRANTED = 16
"""Sampled textures that WebGPU grants every stage."""


@pytest.fixture(scope="module")
def least(gpu: Gpu) -> Gpu:
    """A device that has no more than those."""
    return open_gpu(gpu.info.name, gpu.paths.name, "default")


@pytest.mark.parametrize("part", ["lights", "lattices", "rest"])
def test_no_more_textures_than_any_device_has(least: Gpu, part: Part) -> None:
    """Of the parts that all devices draw: "whole" is in two where it does not fit."""
    made = Lighting(least, part, LightKinds(), LatticeLight())  # raises where a stage has too many
    assert sum("texture" in slot.layout for slot in made.slots) <= GRANTED
