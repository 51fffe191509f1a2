"""Many volumes: a tree of their boxes draws what a look at each of them draws."""

from __future__ import annotations

import dataclasses
import functools

import numpy as np
import pytest

from airlight import Renderer
from airlight.gpu.tally import Count, Tally
from airlight.media import media_slots
from airlight.scene import Camera, DirectionalLight, Geometry, Material, Mesh, PointLight, Scene
from airlight.scene.volume import Volume

SIZE = (24, 16)
SMALL = {"resolution": 8, "shadow_resolution": 64, "lamp_resolution": 32, "sky_lights": 4}


def puff(rng: np.random.Generator, shape: str) -> Volume:
    turn, _ = np.linalg.qr(rng.normal(size=(3, 3)))
    to_world = np.eye(4)
    to_world[:3, :3] = turn * rng.uniform(0.15, 0.5, 3)
    to_world[:3, 3] = rng.uniform((-1.5, 0.4, -0.8), (1.5, 1.6, 0.8))
    grid = rng.uniform(0, 1.5, (5, 6, 7)).astype(np.float32) if shape == "grid" else None
    return Volume(
        (3.0, 3.2, 3.4),
        density=grid,
        shape=shape,
        albedo=(0.9, 0.8, 0.7),
        g=(rng.choice((0.0, 0.4)),) * 3,
        world_from_volume=to_world,
    )


def puffs(count: int, seed: int = 2) -> Scene:
    """Grids, boxes and balls over a floor under a sun and a lamp, all overlapping."""
    rng = np.random.default_rng(seed)
    corners = np.array([[-3, 0, -3], [-3, 0, 3], [3, 0, 3], [3, 0, -3]], np.float32)
    floor = Geometry(corners, np.array([[0, 1, 2], [0, 2, 3]], np.uint32))
    shapes = ("grid", "grid", "box", "sphere")
    return Scene(
        meshes=(Mesh(floor, Material(base_color=(0.4, 0.35, 0.3))),),
        volumes=tuple(puff(rng, shapes[i % 4]) for i in range(count)),
        lights=(DirectionalLight((0.5, -1, -0.4), (5, 5, 4)), PointLight((0, 1.8, 0.5), (3, 3, 3))),
        camera=Camera((0.5, 1.6, 4.0), (0, 0.9, 0), fov_y_deg=45),
    )


def drawn(monkeypatch, scene: Scene, technique: str, *, has_tree: bool):
    most = 8 if has_tree else 10_000
    monkeypatch.setattr(media_slots, "LISTED_WHOLE", most)
    settings = {k: v for k, v in SMALL.items() if technique != "single" or k != "resolution"}
    with Renderer(scene, technique, SIZE, settings=settings) as renderer:
        image = renderer.frame()
    assert image is not None
    return image


@pytest.mark.parametrize("technique", ["single", "lpv-scatter"])
def test_a_tree_changes_nothing(monkeypatch, technique: str) -> None:
    """Sums in another order: single precision; half floats of a few cells round otherwise."""
    scene = puffs(12)
    fast = drawn(monkeypatch, scene, technique, has_tree=True)
    whole = drawn(monkeypatch, scene, technique, has_tree=False)
    for name in ("direct", "indirect", "single_scatter", "multiple_scatter", "transmittance"):
        a, b = fast.layers[name], whole.layers[name]
        np.testing.assert_allclose(a, b, rtol=2e-3, atol=1e-3 * max(float(b.max()), 1e-6))


def test_transmittance_of_a_hundred_is_the_product_of_all(monkeypatch) -> None:
    """Of boxes alone it is a closed form: through each of them by itself, multiplied."""
    scene = dataclasses.replace(puffs(0), meshes=(), lights=())
    rng = np.random.default_rng(9)
    volumes = tuple(puff(rng, "box" if i % 2 else "sphere") for i in range(100))
    with Renderer(dataclasses.replace(scene, volumes=volumes), "single", SIZE) as renderer:
        together = renderer.frame().layers["transmittance"]
    alone = np.ones_like(together)
    for first in range(0, 100, 8):
        part = dataclasses.replace(scene, volumes=volumes[first : first + 8])
        with Renderer(part, "single", SIZE) as renderer:
            alone = alone * renderer.frame().layers["transmittance"]
    assert together.min() < 0.1
    np.testing.assert_allclose(together, alone, atol=2e-5)


def test_moved_volumes_are_where_they_are(monkeypatch) -> None:
    """The tree follows: a frame after a move is that of a renderer made for it."""
    scene = puffs(12)
    moved = []
    for i, volume in enumerate(scene.volumes):
        matrix = volume.world_from_volume.copy()
        matrix[:3, 3] += (0.3 * (-1) ** i, 0.2, 0.1)
        moved.append(dataclasses.replace(volume, world_from_volume=matrix))
    with Renderer(scene, "single", SIZE) as renderer:
        renderer.frame()
        after = renderer.frame(volumes=moved)
    with Renderer(dataclasses.replace(scene, volumes=tuple(moved)), "single", SIZE) as renderer:
        fresh = renderer.frame()
    np.testing.assert_array_equal(after.radiance, fresh.radiance)


def grids(count: int) -> Scene:
    """Density grids in a row, apart from each other and all alike in size."""
    scene, rng = puffs(0), np.random.default_rng(3)
    density = rng.uniform(0, 1.5, (12, 12, 12)).astype(np.float32)
    volumes = []
    for i in range(count):
        to_world = np.diag([0.1, 0.1, 0.1, 1.0])
        to_world[:3, 3] = (0.25 * i - 0.125 * count, 0.5, 0.0)
        volumes.append(Volume((3, 3, 3), density=density, world_from_volume=to_world))
    return dataclasses.replace(scene, volumes=tuple(volumes))


def work(renderer: Renderer, stage: str, **changes) -> Count:
    """The passes of a stage in a frame of `changes`: "air" finds columns towards lights."""
    tally = renderer.commands.tally = Tally()
    renderer.frame(**changes)
    return tally.stages.get(stage, Count())


@functools.cache
def works(count: int, technique: str, stage: str = "air") -> dict[str, Count]:
    """The same after each of some changes to so many grids."""
    scene = grids(count)
    sun, *rest = scene.lights
    turned = dataclasses.replace(sun, direction=(0.4, -1, -0.4))
    to_world = scene.volumes[0].world_from_volume.copy()
    to_world[1, 3] += 0.1
    moved = dataclasses.replace(scene.volumes[0], world_from_volume=to_world)
    settings = {k: v for k, v in SMALL.items() if technique != "single" or k != "resolution"}
    with Renderer(scene, technique, SIZE, settings=settings) as renderer:
        renderer.frame()
        return {
            "view": work(renderer, stage, camera=dataclasses.replace(scene.camera, fov_y_deg=40)),
            "weaker": work(
                renderer, stage, lights=(dataclasses.replace(sun, irradiance=(1,) * 3), *rest)
            ),
            "lit": work(renderer, stage, lights=(turned, *rest)),
            "moved": work(renderer, stage, volumes=(moved, *scene.volumes[1:])),
        }


def test_work_is_linear_in_the_number_of_volumes() -> None:
    """A new light finds the columns of all in as many passes; a move those of the moved one."""
    few, many = works(10, "single"), works(40, "single")
    assert many["lit"].invocations == pytest.approx(4 * few["lit"].invocations, rel=0.01)
    assert many["lit"].passes == few["lit"].passes
    assert few["moved"].invocations == many["moved"].invocations
    assert many["moved"].invocations == pytest.approx(many["lit"].invocations / 40, rel=0.01)
    # Columns know where lights are, neither how bright they are nor who looks.
    assert many["view"] == many["weaker"] == Count()


def test_lists_of_media_are_made_where_something_moved() -> None:
    """As many lists whatever the number of media, once for all tables; each looks at all media."""
    few, many = (works(count, "lpv-scatter", "path lists") for count in (10, 40))
    assert few["lit"].passes == many["lit"].passes == 1
    assert few["lit"].invocations == pytest.approx(many["lit"].invocations, rel=0.3)
    assert many["moved"].passes == 1
    assert many["view"] == many["weaker"] == Count()


def test_tables_of_media_share_columns() -> None:
    """A lattice of reduced media finds none of its own beside those of the image."""
    assert works(10, "lpv-scatter")["lit"].invocations == works(10, "single")["lit"].invocations


@pytest.mark.parametrize("technique", ["single", "lpv-scatter"])
def test_other_numbers_of_many_compile_nothing_again(technique: str) -> None:
    """Shaders are made for 16 of them; the tree of a scene ends where its media do."""
    made = []
    for count, seed in ((13, 2), (15, 3), (13, 2)):
        settings = {k: v for k, v in SMALL.items() if technique != "single" or k != "resolution"}
        with Renderer(puffs(count, seed), technique, SIZE, settings=settings) as renderer:
            image = renderer.frame()
            made.append((len(renderer.gpu.pipelines), image.radiance if image else None))
    assert [n for n, _ in made] == [made[0][0]] * 3
    np.testing.assert_array_equal(made[0][1], made[2][1])
    assert not np.array_equal(made[0][1], made[1][1])


def test_shaders_are_made_for_few_numbers() -> None:
    made = [media_slots.room_for(count) for count in range(257)]
    assert made[:9] == [1, 1, 2, 3, 4, 5, 6, 7, 8]
    assert sorted(set(made[9:])) == [12, 16, 24, 32, 48, 64, 96, 128, 192, 256]
    assert all(room >= count for count, room in enumerate(made))
