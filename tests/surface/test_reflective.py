"""Reflective shadow maps: the flux that surfaces reflect, against closed forms."""

from __future__ import annotations

import numpy as np
import pytest

from airlight.maths.reflection import bihemispherical_albedo
from airlight.maths.solid_angle import polygon_solid_angle
from airlight.scene import DirectionalLight, Material, PointLight, SpotLight
from airlight.surface.light_views import light_views
from airlight.surface.reflective import ReflectiveShadowMaps, flux_unit

SIDE = 128
ALBEDO = np.array([0.7, 0.4, 0.1])
RED = Material(base_color=tuple(ALBEDO), specular=0.0)


@pytest.fixture(autouse=True)
def ways(both_ways):
    """By the visibility buffer and as surfaces come."""
    both_ways("reflective")


def reflected_flux(gpu, commands, owned, scene, light):
    """(3,) W: the sum over texels of flux density times the texel's measure."""
    views = light_views([light], *scene.bounds, SIDE)
    maps = owned(ReflectiveShadowMaps(gpu, "maps", SIDE, len(views)))
    maps.encode(commands, scene, [light], views)
    commands.submit()
    total = np.zeros(3)
    for layer, view in enumerate(views):
        density = maps.flux.read(layer)[..., :3].astype(np.float64)
        measure = np.full((SIDE, SIDE), view.texel[0] * view.texel[1])
        if view.is_perspective:
            tangent = (np.arange(SIDE) + 0.5 - SIDE / 2) * view.texel[0]
            measure *= (1.0 + tangent[:, None] ** 2 + tangent**2) ** -1.5
        total += (density * measure[..., None]).sum(axis=(0, 1))
    return flux_unit(light) * total, maps


@pytest.mark.parametrize("direction", [(0, -1, 0), (0.5, -1, 0.3)])
def test_parallel_light_on_a_plane(gpu, commands, owned, on_device, square, direction):
    scene = on_device(square((0, 0, 0), (2, 0, 0), (0, 0, -1.5), RED))
    irradiance = np.array([3.0, 2.0, 1.0])
    light = DirectionalLight(direction, tuple(irradiance))
    total, _ = reflected_flux(gpu, commands, owned, scene, light)
    cosine = -light.direction[1]
    np.testing.assert_allclose(total, ALBEDO * irradiance * cosine * 12.0, rtol=0.02)


def test_a_point_light_on_a_plane(gpu, commands, owned, on_device, square):
    scene = on_device(square((0, 0, 0), (2, 0, 0), (0, 0, -1.5), RED))
    light = PointLight((0.5, 1.0, 0.2), (3, 2, 1))
    total, _ = reflected_flux(gpu, commands, owned, scene, light)
    corners = np.array([[-2, 0, -1.5], [2, 0, -1.5], [2, 0, 1.5], [-2, 0, 1.5]])
    omega = polygon_solid_angle(corners - light.position)
    np.testing.assert_allclose(total, ALBEDO * [3, 2, 1] * omega, rtol=0.02)


@pytest.mark.parametrize(("inner", "outer"), [(20.0, 30.0), (40.0, 70.0)])
def test_a_spot_light_on_a_plane(gpu, commands, owned, on_device, square, inner, outer):
    scene = on_device(square((0, 0, 0), (20, 0, 0), (0, 0, -20), RED))
    light = SpotLight((0, 2, 0), (0, -1, 0), (5, 5, 5), inner_deg=inner, outer_deg=outer)
    total, _ = reflected_flux(gpu, commands, owned, scene, light)
    # the integral of the smoothstep over the cap: 2 pi (1 - (cos inner + cos outer) / 2)
    mean = (np.cos(np.radians(inner)) + np.cos(np.radians(outer))) / 2.0
    np.testing.assert_allclose(total, ALBEDO * 5.0 * 2.0 * np.pi * (1.0 - mean), rtol=0.02)


@pytest.mark.parametrize("metallic", [0.0, 1.0])
@pytest.mark.parametrize("roughness", [0.2, 1.0])
def test_the_whole_brdf_reflects(gpu, commands, owned, on_device, square, metallic, roughness):
    gold = Material(base_color=tuple(ALBEDO), metallic=metallic, roughness=roughness)
    scene = on_device(square((0, 0, 0), (2, 0, 0), (0, 0, -1.5), gold))
    light = DirectionalLight((0, -1, 0), (1, 1, 1))
    total, _ = reflected_flux(gpu, commands, owned, scene, light)
    albedo = bihemispherical_albedo(ALBEDO, metallic, roughness, 1.0)
    np.testing.assert_allclose(total, albedo * 12.0, rtol=0.02)


@pytest.mark.parametrize("side", [1.0, -1.0])
def test_normals_face_the_light_on_either_side(gpu, commands, owned, on_device, square, side):
    scene = on_device(square((0, 0, 0), (2, 0, 0), (0, 0, -2), RED))
    light = DirectionalLight((0, -side, 0), (1, 1, 1))
    total, maps = reflected_flux(gpu, commands, owned, scene, light)
    middle = maps.normal.read(0)[SIDE // 2, SIDE // 2, :3]
    np.testing.assert_allclose(middle, [0.0, side, 0.0], atol=1e-3)
    assert total[0] > 0.0


def test_only_what_changed_is_redrawn(gpu, commands, owned, on_device, square):
    scene = on_device(square((0, 0, 0), (2, 0, 0), (0, 0, -2), RED))
    maps = owned(ReflectiveShadowMaps(gpu, "maps", 16, 1))

    def encode(irradiance):
        lights = [DirectionalLight((0, -1, 0), (irradiance, 0, 0))]
        return maps.encode(commands, scene, lights, light_views(lights, *scene.bounds, 16))

    assert encode(1.0)
    assert not encode(1.0)
    assert encode(2.0)
    scene.version += 1
    assert encode(2.0)
    commands.submit()


def test_what_failed_is_drawn_again(gpu, commands, owned, on_device, square, monkeypatch):
    scene = on_device(square((0, 0, 0), (2, 0, 0), (0, 0, -2), RED))
    maps = owned(ReflectiveShadowMaps(gpu, "maps", 16, 1))
    lights = [DirectionalLight((0, -1, 0), (1, 1, 1))]
    views = light_views(lights, *scene.bounds, 16)
    with monkeypatch.context() as patch, pytest.raises(RuntimeError, match="no more memory"):
        patch.setattr(scene, "visible", _fails)
        maps.encode(commands, scene, lights, views)
    assert maps.encode(commands, scene, lights, views)
    commands.submit()
    assert maps.flux.read(0)[8, 8, 0] > 0.5


def _fails(clip_from_world):
    raise RuntimeError("no more memory")


def test_flux_behind_glass_has_its_colour(gpu, commands, owned, on_device, square):
    """Glass that covers a floor: the floor's flux times what passes, and no more than that."""
    tint = np.array((1.0, 0.5, 0.1))
    glass = Material(base_color=tuple(tint), transmission=1.0, specular=0.0)
    floor = square((0, 0, 0), (2, 0, 0), (0, 0, -1.5), RED)
    light = DirectionalLight((0, -1, 0), (1, 1, 1))
    alone, _ = reflected_flux(gpu, commands, owned, on_device(floor), light)
    pane = square((0, 1, 0), (3, 0, 0), (0, 0, -3), glass)
    under, _ = reflected_flux(gpu, commands, owned, on_device(floor, pane), light)
    # Texels show the pane, which is black, by chance: as many as the mean of what it takes.
    np.testing.assert_allclose(under, alone * tint, rtol=0.02)
