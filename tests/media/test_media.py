"""Media as a solver: what they add to the fields, and the layers they draw."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from airlight.fields import Fields, Frame
from airlight.gpu.commands import Commands
from airlight.lighting.kit import Context, Kit, SurfaceSettings
from airlight.media.media import Media
from airlight.media.settings import MediaSettings
from airlight.scene import Camera, DirectionalLight, Environment, Medium, Scene
from airlight.surface.geometry import GpuScene

SETTINGS = SurfaceSettings(resolution=8, shadow_resolution=32, sky_lights=8, sky_resolution=16)
SKY = Environment((0.5, 0.6, 0.7))


def solved(gpu: Any, owned: Any, scene: Scene, **given: Any) -> tuple[Kit, Media, Fields]:
    """A kit, its media, and the fields after one frame."""
    kit = owned(Kit(Context(gpu, scene, owned(GpuScene(gpu, scene)), (8, 8)), SETTINGS))
    media: Media = owned(Media(kit, given.pop("settings", MediaSettings()), **given))
    commands = Commands(gpu)
    kit.encode(commands, scene, *kit.bounds(scene))
    fields = media.solve(commands, Frame(scene, *kit.bounds(scene)), Fields(kit.sky_irradiance))
    commands.submit()
    return kit, media, fields


def foggy(square: Any) -> Scene:
    """A floor under a sun and a sky, in fog that takes half of what goes up 2 m."""
    return Scene(
        meshes=(square((0, 0, 0), (2, 0, 0), (0, 0, -2)),),
        environment=SKY,
        lights=(DirectionalLight((0.0, -1.0, 0.0), (2.0,) * 3),),
        medium=Medium((0.35,) * 3, bounds=((-2, 0, -2), (2, 2, 2))),
        camera=Camera((0, 1, 3), (0, 0, 0)),
    )


def test_the_sky_comes_through_media_to_surfaces_and_into_them(
    gpu: Any, owned: Any, square: Any
) -> None:
    kit, _, fields = solved(gpu, owned, foggy(square))
    assert fields.sky_scatter is not None and fields.half_space is None
    assert fields.sky.cube is not kit.sky_irradiance.cube
    x, y, z = (n // 2 for n in kit.placement.count)
    clear, dim = (
        cube.read()[..., :3].reshape(6, *kit.placement.count[::-1], 3)[2, z, y - 1, x]
        for cube in (kit.sky_irradiance.cube, fields.sky.cube)
    )
    assert np.all((dim > 0.2 * clear) & (dim < 0.9 * clear))


def test_without_shafts_the_sky_still_lights_surfaces_through_media(
    gpu: Any, owned: Any, square: Any
) -> None:
    kit, _, fields = solved(gpu, owned, foggy(square), settings=MediaSettings(shafts="off"))
    assert fields.sky_scatter is None
    assert fields.sky.cube is not kit.sky_irradiance.cube


def test_nothing_is_added_where_there_is_no_medium(gpu: Any, owned: Any, square: Any) -> None:
    scene = replace(foggy(square), medium=None)
    kit, media, fields = solved(gpu, owned, scene)
    assert fields.sky_scatter is None and fields.sky.cube is kit.sky_irradiance.cube
    assert media.on_device.count == 0


def test_an_endless_medium_has_light_of_its_own_far_off(gpu: Any, owned: Any, square: Any) -> None:
    endless = Medium((0.35,) * 3, endless=True, top=3.0)
    _, _, fields = solved(gpu, owned, replace(foggy(square), medium=endless), has_multiple=True)
    assert fields.half_space is not None
    assert fields.half_space.top == 3.0
