"""What rays met is lit as pixels are: a floor under a point light, and what lies behind nothing."""

from __future__ import annotations

import numpy as np

from airlight.gpu.commands import Commands
from airlight.gpu.device import Gpu
from airlight.lighting.hits import HitLighting, HitsInLight
from airlight.lighting.kit import Context, Kit, SurfaceSettings
from airlight.lighting.lighting import RadianceLayers
from airlight.scene import Environment, Material, Mesh, PointLight, Scene
from airlight.scene.mesh import Geometry
from airlight.surface.geometry import GpuScene
from airlight.surface.hits import Hits

SIZE = (16, 8)
ALBEDO = np.array([0.25, 0.5, 0.75])


def test_hits_are_lit_as_a_lambert_floor_is(gpu: Gpu, commands: Commands) -> None:
    corners = np.array([[-3, 0, -3], [3, 0, -3], [3, 0, 3], [-3, 0, 3]], np.float32)
    floor = Mesh(Geometry(corners, np.array([[0, 2, 1], [0, 3, 2]], np.uint32)), Material())
    light = PointLight((0.0, 2.0, 0.0), (5.0, 4.0, 3.0))
    scene = Scene((floor,), (light,), Environment((0.3, 0.2, 0.1)))
    settings = SurfaceSettings(resolution=4, sky_lights=0, lamp_resolution=128)
    kit = Kit(Context(gpu, scene, GpuScene(gpu, scene), SIZE), settings)
    kit.encode(commands, scene, *kit.bounds(scene))
    # Hits on the floor in the left half; rays that left the scene in the right one.
    hits, layers = Hits(gpu, SIZE), RadianceLayers(gpu, SIZE)
    x, z = np.meshgrid(np.linspace(-2, 2, SIZE[0]), np.linspace(-2, 2, SIZE[1]))
    places = np.stack([x, np.zeros_like(x), z, np.ones_like(x)], axis=-1).astype(np.float32)
    places[:, 8:] = (0.6, 0.8, 0.0, 0.0)
    hits.positions.write(places)
    hits.normal.write(np.tile(np.float16([0, 1, 0, 1]), (*SIZE[::-1], 1)))
    hits.albedo.write(np.tile(np.float16([*ALBEDO, 0]), (*SIZE[::-1], 1)))
    what = HitsInLight(hits, layers, kit.sky_irradiance)
    HitLighting(kit).encode(commands, what, kit.no_irradiance)
    commands.submit()
    direct, indirect = layers.direct.read(), layers.indirect.read()
    away = places[:, :8, :3] - light.position
    squared = (away**2).sum(axis=-1)
    cosine = 2.0 / np.sqrt(squared)
    truth = (cosine / squared)[..., None] * light.intensity * ALBEDO / np.pi
    np.testing.assert_allclose(direct[:, :8, :3], truth, rtol=2e-3)
    np.testing.assert_allclose(direct[:, 8:], np.tile([0.3, 0.2, 0.1, 0.0], (8, 8, 1)), rtol=2e-3)
    assert not indirect[..., :3].any()
