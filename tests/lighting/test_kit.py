"""What solvers share is brought up to date where it changed, and only there."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from airlight.gpu.commands import Commands
from airlight.lighting.kit import Context, Kit, SurfaceSettings
from airlight.scene import Camera, DirectionalLight, Environment, Scene
from airlight.surface.geometry import GpuScene

SETTINGS = SurfaceSettings(
    resolution=8, shadow_resolution=32, sky_lights=8, sky_resolution=16, surfels=2000
)


def test_nothing_changes_in_a_static_scene(gpu: Any, owned: Any, square: Any) -> None:
    floor = square((0, 0, 0), (2, 0, 0), (0, 0, -2))
    sun = DirectionalLight((0.0, -1.0, 0.0), (2.0,) * 3)
    scene = Scene(
        meshes=(floor, square((0, 1, 0), (1, 0, 0), (0, 0, -1))),
        lights=(sun,),
        environment=Environment((0.5, 0.6, 0.7)),
        camera=Camera((0, 1, 3), (0, 0, 0)),
    )
    meshes = owned(GpuScene(gpu, scene))
    kit, commands = owned(Kit(Context(gpu, scene, meshes, (8, 8)), SETTINGS)), Commands(gpu)

    def versions(now: Scene) -> tuple[int, ...]:
        kit.encode(commands, now, *kit.bounds(now))
        commands.submit()
        return (
            kit.lights.parallel.version,
            kit.blockers.version,
            kit.sky.version,
        )

    first = versions(scene)
    assert versions(scene) == first
    turned = replace(scene, lights=(replace(sun, direction=(0.3, -1.0, 0.0)),))
    assert versions(turned) == (first[0] + 1, *first[1:])
    brighter = replace(turned, environment=Environment((1.0, 0.6, 0.7)))
    assert versions(brighter) == (first[0] + 1, first[1], first[2] + 1)
    lower = np.eye(4)
    lower[1, 3] = -0.5
    meshes.move((replace(floor, world_from_object=lower), scene.meshes[1]))
    moved = versions(brighter)
    assert moved[1] == first[1] + 1 and moved[2] == first[2] + 2


def test_no_light_is_black(gpu: Any, owned: Any, square: Any) -> None:
    scene = Scene(meshes=(square((0, 0, 0), (2, 0, 0), (0, 0, -2)),))
    kit = owned(Kit(Context(gpu, scene, owned(GpuScene(gpu, scene)), (8, 8)), SETTINGS))
    bound = kit.no_irradiance.bound
    assert not bound["lattice_red"].read().any()
    assert bound["lattice_red"].size == kit.lattices.texture_size
    assert not kit.no_irradiance.is_reflected


def test_the_sky_is_drawn_once_where_a_frame_follows_at_once(
    gpu: Any, owned: Any, square: Any
) -> None:
    """Its maps are begun with the kit; the frame lights its lattice from them, to the same bits."""
    floor = square((0, 0, 0), (2, 0, 0), (0, 0, -2))
    scene = Scene(
        meshes=(floor, square((0, 1, 0), (1, 0, 0), (0, 0, -1))),
        environment=Environment((0.5, 0.6, 0.7)),
    )
    meshes, commands = owned(GpuScene(gpu, scene)), Commands(gpu)
    cubes = []
    for begun in (None, commands):
        kit = owned(Kit(Context(gpu, scene, meshes, (8, 8), begun), SETTINGS))
        assert kit.sky.version == (begun is not None)
        kit.encode(commands, scene, *kit.bounds(scene))
        commands.submit()
        assert kit.sky.version == 1
        cubes.append(kit.lattices.cube.read())
    assert cubes[0].any()
    np.testing.assert_array_equal(*cubes)


def test_what_is_shared_is_submitted_before_solvers_compile_in_the_first_frame_alone(
    gpu: Any, owned: Any, square: Any, monkeypatch: Any
) -> None:
    scene = Scene(meshes=(square((0, 0, 0), (2, 0, 0), (0, 0, -2)),))
    meshes, commands = owned(GpuScene(gpu, scene)), Commands(gpu)
    kits = [
        owned(Kit(Context(gpu, scene, meshes, (8, 8), begun), SETTINGS))
        for begun in (commands, None)
    ]
    submitted: list[Kit] = []
    for kit in (kits[0], kits[0], kits[1]):
        with monkeypatch.context() as patch:
            patch.setattr(commands, "submit", lambda kit=kit: submitted.append(kit))
            kit.encode(commands, scene, *kit.bounds(scene))
        commands.submit()
    assert submitted == [kits[0]]
