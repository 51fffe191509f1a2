"""Reflective shadow maps through air: what Beer and Lambert leave of the flux."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from airlight.gpu.commands import Commands
from airlight.gpu.device import Gpu
from airlight.lighting.lights import Lights
from airlight.media.attenuated_maps import AttenuatedMaps, AttenuatedSkyMaps
from airlight.media.gpu_media import GpuMedia
from airlight.scene import DirectionalLight, Material, Mesh, PointLight, Scene, Volume
from airlight.surface.geometry import GpuScene
from airlight.surface.light_views import light_views
from airlight.surface.reflective import ReflectiveShadowMaps


def test_flux_is_attenuated_by_media(
    gpu: Gpu, square: Callable[..., Mesh], owned: Callable[[Any], Any]
) -> None:
    """A slab of 1 m, optical depth .5 along y, between a sun from above and the floor."""
    light = PointLight((0.0, -9.0, 0.0), (1.0, 1.0, 1.0))
    sun = DirectionalLight((0.0, -1.0, 0.0), (3.0, 3.0, 3.0))
    slab = Volume((0.5, 1.0, 2.0), shape="box", bounds=((-9, 1, -9), (9, 2, 9)))
    floor = square((0, 0, 0), (0, 0, 2), (2, 0, 0), Material(base_color=(0.5,) * 3))
    scene = Scene(meshes=(floor,), lights=(light, sun), volumes=(slab,))
    low, high = (np.array(x) for x in scene.bounds)
    meshes, commands = owned(GpuScene(gpu, scene)), Commands(gpu)
    lights = owned(Lights(gpu, scene.lights, None, (16, 16)))
    lights.encode(commands, meshes, scene.lights, None, low, high)
    maps = owned(ReflectiveShadowMaps(gpu, "directional", 16, 1))
    maps.encode(commands, meshes, [sun], light_views([sun], low, high, 16))
    air = owned(GpuMedia(gpu, scene, light_count=2))
    air.update(commands, scene, low, high)
    attenuated = owned(AttenuatedMaps(gpu, maps, air, [1]))
    attenuated.attenuate(commands, lights.table)
    sky = owned(AttenuatedSkyMaps(gpu, maps, air))
    sky.attenuate(commands)
    commands.submit()
    np.testing.assert_allclose(sky.flux.read(), attenuated.flux.read(), rtol=2e-3)
    before, after = (
        m.flux.read()[..., :3].astype(float).reshape(-1, 3) for m in (maps, attenuated)
    )
    lit = before[:, 0] > 0.0
    assert lit.any()
    np.testing.assert_allclose(
        after[lit] / before[lit],
        np.broadcast_to(np.exp([-0.5, -1.0, -2.0]), after[lit].shape),
        rtol=3e-3,
    )
    assert after[~lit].max(initial=0.0) == 0.0
