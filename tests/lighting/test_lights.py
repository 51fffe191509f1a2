"""All lights of a scene on the device, brought up to date as they change."""

from __future__ import annotations

import numpy as np
import pytest

from airlight.lighting.lights import Lights
from airlight.scene import DirectionalLight, Environment, PointLight, Scene
from airlight.surface.geometry import GpuScene

SUN, LIGHT = DirectionalLight((0, -1, 0), (1, 2, 3)), PointLight((0, 2, 0), (4, 5, 6))


@pytest.fixture
def meshes(gpu, owned, square):
    return owned(GpuScene(gpu, Scene(meshes=(square((0, 0, 0), (1, 0, 0), (0, 0, -1)),))))


def table_of(lights):
    return lights.table.read()[:2]


def test_the_table_follows_the_lights(gpu, commands, owned, meshes):
    made = owned(Lights(gpu, (SUN, LIGHT), None, (16, 8)))
    for moved in (LIGHT, PointLight((1, 3, 0), (7, 5, 6))):
        made.encode(commands, meshes, (SUN, moved), None, *meshes.bounds)
        commands.submit()
        table = table_of(made)
        assert table["position"][1].tolist() == list(moved.position)
        assert table["color"].tolist() == [[1, 2, 3], list(moved.intensity)]
    assert (made.parallel.layers, made.local.layers) == (1, 6)


@pytest.mark.parametrize("has_media", [False, True])
def test_many_lights_share_what_the_device_can_bind(gpu, owned, has_media):
    """Hierarchies over maps, of 8 bytes a texel, are one binding; what is asked for is the most."""
    lights = (LIGHT,) * 20
    made = owned(Lights(gpu, lights, None, (16, 4096), has_media=has_media))
    texels = made.local.layers * made.local.resolution**2
    most = min(1 << 27, gpu.limits["max-storage-buffer-binding-size"] // 8)
    assert made.local.layers == 120
    assert texels <= (most if has_media else 1 << 27) < 4 * texels
    assert made.parallel.resolution == 16


def test_a_scene_without_lights_still_binds(gpu, commands, owned, meshes):
    made = owned(Lights(gpu, (), None, (16, 8)))
    made.encode(commands, meshes, (), None, *meshes.bounds)
    assert made.count == 0
    assert all(value is not None for value in made.bound.values())


def test_a_changed_environment_gives_the_old_ones_memory_back(gpu, commands, meshes):
    skies = [Environment(map=np.full((8, 16, 3), value, np.float32)) for value in (1.0, 2.0)]
    before = gpu.allocated_bytes
    scope = gpu.scope()
    made = Lights(scope, (), skies[0], (16, 8))
    during = gpu.allocated_bytes
    made.encode(commands, meshes, (), skies[1], *meshes.bounds)
    assert gpu.allocated_bytes == during
    assert made.background.texture.read()[0, 0, 0] == 2.0
    scope.release()
    assert gpu.allocated_bytes == before
