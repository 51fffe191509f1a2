"""Cells that the sky's light reaches through a changed medium are computed, the rest stay."""

from __future__ import annotations

import dataclasses
from typing import Any

import numpy as np
import pytest

from airlight.gpu.device import Gpu
from airlight.media.media import Media
from airlight.rendering import Renderer
from airlight.scatter.solver import ScatterSolver
from airlight.scene import Camera, Environment, Scene
from airlight.scene.emission import Emission
from airlight.scene.volume import Volume

SIZE = (12, 8)
SETTINGS = {
    "bounds": (-4.0, 0.0, -2.0, 4.0, 2.0, 2.0),
    "resolution": 16,
    "cascades": 1,
    "sky_lights": 12,
    "sky_resolution": 32,
    "surfels": 2000,
}
SINGLE = {name: SETTINGS[name] for name in ("bounds", "resolution", "sky_lights", "sky_resolution")}
BALL = np.full((4, 4, 4), 0.5, np.float32)


def placed(x: float) -> np.ndarray:
    to_world = np.diag([0.2, 0.2, 0.2, 1.0])
    to_world[:3, 3] = x, 0.4, 0.0
    return to_world


@pytest.fixture(scope="module")
def two(gpu: Gpu, square: Any) -> Scene:
    """Two small grids over a floor, apart, under a sky; seven metres lie between their ends."""
    sky = np.ones((8, 16, 3), np.float32)
    volume = Volume(8.0, albedo=0.9, g=0.5, density=BALL, world_from_volume=placed(-3.0))
    return Scene(
        meshes=(square((0, 0, 0), (4, 0, 0), (0, 0, -2)),),
        volumes=(volume, dataclasses.replace(volume, world_from_volume=placed(3.0))),
        environment=Environment(map=sky),
        camera=Camera((0, 1, 6), (0, 0.5, 0)),
    )


def fields(renderer: Renderer) -> dict[str, np.ndarray]:
    """What cells have of the sky: (z, y, x, ...) each."""
    media = renderer.technique.find(Media)
    scatter = renderer.technique.find(ScatterSolver)
    assert media and media.sky and scatter
    injection = scatter.largest.injection
    nx, ny, nz = injection.placement.count
    buffers = {"once": injection._sky_single, "forward": injection.forward.sky}
    found = {n: b.read().reshape(3, nz, ny, nx, 4) for n, b in buffers.items()}
    found = {n: np.moveaxis(x, 0, -1) for n, x in found.items()}
    if injection._fluences:
        found["fluence"] = injection._fluences[1].read().reshape(nz, ny, nx, 12)
    return {**found, "marched": media.sky.red.read(), "mean": media.sky.mean.read()}


def listed(renderer: Renderer, count: tuple[int, int, int]) -> np.ndarray:
    """(z, y, x): whether a cell was in the list of what media scatter."""
    scatter = renderer.technique.find(ScatterSolver)
    assert scatter
    words = scatter.largest.injection._stale.listed.read(np.uint32)
    cells = np.zeros(count[0] * count[1] * count[2], bool)
    cells[words[1 : 1 + words[0]]] = True
    return cells.reshape(count[2], count[1], count[0])


def changed(scene: Scene, **to: Any) -> tuple[Volume, ...]:
    return (dataclasses.replace(scene.volumes[0], **to), *scene.volumes[1:])


@pytest.mark.parametrize(
    "change",
    [
        {"world_from_volume": placed(-2.7)},
        {"density": BALL * np.float32(0.5)},
        {"albedo": 0.5},
    ],
    ids=["moved", "thinner", "darker"],
)
def test_cells_that_no_light_reaches_through_it_stay(two: Scene, change: dict[str, Any]) -> None:
    volumes = changed(two, **change)
    with Renderer(two, "lpv-scatter", SIZE, settings=SETTINGS) as renderer:
        renderer.frame()
        before = fields(renderer)
        image = renderer.frame(volumes=volumes)
        after = fields(renderer)
        scatter = renderer.technique.find(ScatterSolver)
        assert scatter
        stale = listed(renderer, scatter.largest.placement.count)
    # Some were computed, fewer than half, and all whose light is another.
    assert 0.005 < stale.mean() < 0.5
    for name, was in before.items():
        differs = (was != after[name]).reshape(*stale.shape, -1).any(axis=-1)
        assert differs.any() or (name in ("marched", "mean") and "albedo" in change)
        assert not (differs & ~stale).any(), name
    # To the bit what a scene has that was so from the beginning.
    there = dataclasses.replace(two, volumes=volumes)
    with Renderer(there, "lpv-scatter", SIZE, settings=SETTINGS) as fresh:
        again = fresh.frame()
        for name, now in fields(fresh).items():
            np.testing.assert_array_equal(after[name], now, name)
    assert image is not None and again is not None
    np.testing.assert_array_equal(image.radiance, again.radiance)


def test_another_sky_or_floor_is_light_for_all_cells(two: Scene) -> None:
    dim = Environment(map=np.full((8, 16, 3), 0.5, np.float32))
    with Renderer(two, "lpv-scatter", SIZE, settings=SETTINGS) as renderer:
        renderer.frame()
        renderer.frame(volumes=changed(two, world_from_volume=placed(-2.7)), environment=dim)
        now = fields(renderer)
    there = dataclasses.replace(
        two, volumes=changed(two, world_from_volume=placed(-2.7)), environment=dim
    )
    with Renderer(there, "lpv-scatter", SIZE, settings=SETTINGS) as fresh:
        fresh.frame()
        for name, field in fields(fresh).items():
            np.testing.assert_array_equal(now[name], field, name)


def test_emission_that_flickers_for_long_changes_no_light_of_the_sky(two: Scene) -> None:
    """Not even after more versions of the media than are remembered."""

    def burning(k: int) -> tuple[Volume, ...]:
        grid = BALL.copy()
        grid[0, 0, 0] *= 0.05 * k
        return changed(two, emission=Emission((1.0, 0.5, 0.2), grid))

    there = dataclasses.replace(two, volumes=burning(0))
    with Renderer(there, "single", SIZE, settings=SINGLE) as renderer:
        renderer.frame(read=False)
        media = renderer.technique.find(Media)
        assert media and media.sky
        version, of_media = media.sky.version, media.sky.media.version
        for k in range(1, 12):
            renderer.frame(volumes=burning(k), read=False)
            assert media.sky.version == version
        assert media.sky.media.version == of_media + 11


def test_cells_that_a_medium_enters_in_the_shade_are_new(gpu: Gpu, square: Any) -> None:
    """A roof shades half of the cells below its edge; smoke enters the half that is in the shade.

    The mean fluence over what scatters in them falls, though no light comes through the smoke.
    """
    above = np.zeros((64, 128, 3), np.float32)
    above[:2] = 10.0
    smoke = Volume(8.0, albedo=0.9, density=BALL, world_from_volume=placed(-0.6))
    thin = Volume(0.2, albedo=0.9, shape="box", bounds=((-4, 0, -2), (4, 2, 2)))
    scene = Scene(
        meshes=(square((-1.7143, 1.3, 0), (2, 0, 0), (0, 0, -2)),),
        volumes=(smoke, thin),
        environment=Environment(map=above),
        camera=Camera((0, 1, 6), (0, 0.5, 0)),
    )
    moved = (dataclasses.replace(smoke, world_from_volume=placed(-0.03)), thin)
    # Texels of the sky's maps as wide as a tenth of a cell.
    settings = {**SETTINGS, "sky_resolution": 256}
    with Renderer(scene, "lpv-scatter", SIZE, settings=settings) as renderer:
        renderer.frame(read=False)
        before = fields(renderer)["fluence"]
        renderer.frame(volumes=moved, read=False)
        after = fields(renderer)["fluence"]
    there = dataclasses.replace(scene, volumes=moved)
    with Renderer(there, "lpv-scatter", SIZE, settings=settings) as fresh:
        fresh.frame(read=False)
        wanted = fields(fresh)["fluence"]
    assert (before != wanted).any()
    np.testing.assert_array_equal(after, wanted)
