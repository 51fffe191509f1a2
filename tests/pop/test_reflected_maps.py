"""Maps for virtual lights: what of the light reaches surfaces, and when they are redrawn."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from airlight.gpu.commands import Commands
from airlight.gpu.device import Gpu
from airlight.lighting.kit import Context, Kit, SurfaceSettings
from airlight.media.reduced import ChangedMedia
from airlight.pop.settings import PopSettings
from airlight.pop.virtual.maps import ReflectedMaps, forward_scaled, reflected_maps
from airlight.scene import DirectionalLight, Environment, Material, Medium, Mesh, Scene, Volume
from airlight.scene.shapes import quad
from airlight.surface.geometry import GpuScene

SUN = DirectionalLight((0.0, -1.0, 0.0), (2.0,) * 3)
SMOKE = Volume((1.0,) * 3, shape="box", bounds=((-5, 1, -5), (5, 2, 5)))
SCENE = Scene(
    meshes=(Mesh(quad(), Material(base_color=(0.5,) * 3)),),
    lights=(SUN,),
    environment=Environment(radiance=(1.0,) * 3),
    volumes=(SMOKE,),
)
Drawn = Callable[..., ReflectedMaps]


@pytest.fixture
def drawn(gpu: Gpu) -> Drawn:
    """The maps of SCENE with other parts, the same ones for the same settings."""
    kits: dict[PopSettings, tuple[Kit, ReflectedMaps]] = {}
    meshes, commands = GpuScene(gpu, SCENE), Commands(gpu)
    small = SurfaceSettings(resolution=8, shadow_resolution=32, surfels=100, sky_lights=2)

    def draw(settings: PopSettings, **changed: object) -> ReflectedMaps:
        scene = replace(SCENE, **changed)
        if settings not in kits:
            kit = Kit(Context(gpu, scene, meshes, (8, 8)), small)
            assert reflected_maps(kit, replace(settings, virtual_lights=0)) is None
            maps = reflected_maps(kit, settings)
            assert maps is not None
            kits[settings] = kit, maps
        kit, maps = kits[settings]
        bounds = [np.array(x) for x in scene.bounds]
        kit.encode(commands, scene, *bounds)
        maps.encode(commands, scene, *bounds)
        commands.submit()
        return maps

    return draw


def test_versions_follow_light_media_and_sky(drawn: Drawn) -> None:
    few = PopSettings(virtual_lights=4)
    first = drawn(few).reflected.version
    assert drawn(few).reflected.version == first
    turned = drawn(few, lights=(DirectionalLight((0.2, -1.0, 0.0), (2.0,) * 3),)).reflected.version
    thinner = drawn(few, volumes=(replace(SMOKE, sigma_t=(0.5,) * 3),)).reflected.version
    other_sky = Environment(radiance=(2.0,) * 3)
    assert first < turned < thinner < drawn(few, environment=other_sky).reflected.version


def flux(maps: ReflectedMaps, group: int) -> list[float]:
    """Of all texels of each layer of some of the maps."""
    of = maps.reflected.maps[group]
    read = (of.flux.read(layer) for layer in range(of.layers))
    return [float(texels[..., :3].astype(np.float64).sum()) for texels in read]


@pytest.mark.parametrize("scheme", ["delta-beam", "paper"])
def test_light_scattered_forwards_reaches_the_floor(drawn: Drawn, scheme: str) -> None:
    """A metre of smoke, 1 per m, is all that lies over the floor: f = g^(3/2)."""
    settings = PopSettings(virtual_lights=4, scheme=scheme)
    clear = drawn(settings, volumes=(replace(SMOKE, sigma_t=(0.0,) * 3),))
    sunlit, skylit = (flux(clear, group) for group in (0, -1))
    hazy = drawn(settings, volumes=(replace(SMOKE, g=(0.81,) * 3, albedo=(0.5,) * 3),))
    left = math.exp(-1.0) if scheme == "paper" else math.exp(-(1.0 - 0.5 * 0.729))
    assert flux(hazy, 0) == pytest.approx([left * power for power in sunlit], rel=3e-3)
    # Two lights stand for the sky: one from above, aslant, and one on the floor's underside.
    above, below = sorted(np.divide(flux(hazy, -1), skylit))
    assert 0.0 < above < left
    assert below == pytest.approx(1.0, rel=1e-3)


def test_media_that_scatter_to_all_sides_attenuate_as_they_do() -> None:
    air = Medium((0.3,) * 3, g=(0.25,) * 3, albedo=(0.8, 0.5, 0.0))
    forward = ChangedMedia(forward_scaled)
    scaled = forward.of(replace(SCENE, medium=air))
    assert scaled.volumes[0].sigma_t == SMOKE.sigma_t
    assert scaled.medium is not None
    assert scaled.medium.sigma_t == pytest.approx((0.3 * 0.9, 0.3 * 0.9375, 0.3))
    assert forward.of(SCENE).volumes[0] is scaled.volumes[0]
