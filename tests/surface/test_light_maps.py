"""Maps of all lights: which layer is whose, and when they are drawn."""

from __future__ import annotations

import dataclasses

import numpy as np

from airlight.gpu.commands import Commands
from airlight.scene import DirectionalLight, PointLight, Scene, SpotLight
from airlight.surface.geometry import GpuScene
from airlight.surface.light_maps import SMALLEST_LOCAL, LightMaps

SUN = DirectionalLight((0.0, -1.0, 0.0), (2.0,) * 3)
LIGHT = PointLight((0.0, 2.0, 0.0), (3.0,) * 3)
SPOT = SpotLight((0.0, 2.0, 0.0), (0.0, -1.0, 0.0), (3.0,) * 3, 20.0, 30.0)


def test_layers_know_the_rows_of_their_lights(gpu, owned):
    maps = owned(LightMaps(gpu, (LIGHT, SUN, SPOT, SUN), 32))
    parallel, local = maps.groups
    assert maps.owners == [[1, 3], [0] * 6 + [2]]
    assert (parallel.layers, parallel.resolution) == (2, 32)
    assert (local.layers, local.resolution) == (7, 16)
    assert owned(LightMaps(gpu, (), 8)).groups[1].resolution == SMALLEST_LOCAL


def test_only_what_changed_is_drawn(gpu, owned, square):
    floor = square((0, 0, 0), (2, 0, 0), (0, 0, -2))
    meshes, commands = owned(GpuScene(gpu, Scene(meshes=(floor,)))), Commands(gpu)
    maps, low, high = owned(LightMaps(gpu, (SUN, SPOT), 16)), np.full(3, -2.0), np.full(3, 2.0)

    def drawn(*lights):
        is_drawn = maps.encode(commands, meshes, lights, low, high)
        commands.submit()
        return is_drawn, maps.version

    first, versions = drawn(SUN, SPOT)
    assert first
    assert drawn(SUN, SPOT) == (False, versions)
    brighter = dataclasses.replace(SPOT, intensity=(6.0,) * 3)
    assert drawn(SUN, brighter) == (True, (versions[0], versions[1] + 1))
    assert maps.groups[1].flux.read()[..., :3].max() > 0.0
