"""Maps for virtual lights are redrawn where what they show changed, and only there."""

from __future__ import annotations

import numpy as np

from airlight.gpu.commands import Commands
from airlight.gpu.device import Gpu
from airlight.lighting.kit import Context, Kit, SurfaceSettings
from airlight.media.gpu_media import GpuMedia
from airlight.pop.settings import PopSettings
from airlight.pop.virtual.maps import reflected_maps
from airlight.scene import DirectionalLight, Material, Mesh, Scene, Volume
from airlight.scene.shapes import quad
from airlight.surface.geometry import GpuScene


def test_versions_follow_light_and_air(gpu: Gpu) -> None:
    floor = Mesh(quad(), Material(base_color=(0.5,) * 3))
    sun = DirectionalLight((0.0, -1.0, 0.0), (2.0,) * 3)
    smoke = Volume((1.0,) * 3, shape="box", bounds=((-1, 1, -1), (1, 2, 1)))
    scene = Scene(meshes=(floor,), lights=(sun,), volumes=(smoke,))
    meshes, commands = GpuScene(gpu, scene), Commands(gpu)
    small = SurfaceSettings(resolution=8, shadow_resolution=32, surfels=100, sky_lights=0)
    kit = Kit(Context(gpu, scene, meshes, (8, 8)), small)
    air = GpuMedia(gpu, scene, light_count=1)
    none = PopSettings()
    assert reflected_maps(kit, air, none) is None
    maps = reflected_maps(kit, air, PopSettings(virtual_lights=4))
    assert maps is not None
    low, high = (np.array(x) for x in scene.bounds)

    def version(light: DirectionalLight) -> int:
        kit.lights.encode(commands, meshes, (light,), None, low, high)
        lit = Scene(meshes=(floor,), lights=(light,), volumes=(smoke,))
        air.update(commands, lit, low, high)
        maps.encode(commands, lit, low, high)
        commands.submit()
        return maps.reflected.version

    first = version(sun)
    assert version(sun) == first
    assert version(DirectionalLight((0.2, -1.0, 0.0), (2.0,) * 3)) > first
