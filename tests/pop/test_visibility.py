"""Surfaces shade media: which maps tell it, and which cells lie in the dark."""

from __future__ import annotations

import numpy as np
import pytest

from airlight.gpu.device import Gpu
from airlight.maths.ordinates import joined, parallel, uniform_sky
from airlight.maths.transforms import F64
from airlight.pop.light.visibility import shadow_rows
from airlight.pop.media import PopMedia
from airlight.rendering import Renderer
from airlight.scene import Camera, DirectionalLight, Environment, Mesh, PointLight, Scene, Volume
from airlight.scene.lights import Light
from airlight.scene.material import Material
from airlight.scene.shapes import box

SUN, LIGHT = DirectionalLight((0, -1, 0), (1, 1, 1)), PointLight((-0.5, 1.8, 0.0), (1, 1, 1))
SETTINGS = {
    "ordinates": 16,
    "grid": 8,
    "solver_steps": 4,
    "resolution": 8,
    "surfels": 1000,
    "virtual_lights": 0,
}


def plate(x: float, width: float) -> Mesh:
    """2 m deep, 1.5 m above the middle."""
    matrix = np.diag([width, 0.1, 4.0, 1.0])
    matrix[:3, 3] = x, 1.5, 0.0
    return Mesh(box(), Material(base_color=(0.5, 0.5, 0.5)), matrix)


def shares(scene: Scene) -> tuple[F64, F64]:
    """(ordinate, z, y, x) of what reaches the cells, and directions of travel."""
    with Renderer(scene, "pop", (16, 16), settings=SETTINGS) as renderer:
        renderer.frame(samples=1)
        (solver,) = renderer.technique.find(PopMedia).solvers
        count, (x, y, z) = solver.transport.light.table.count, solver.medium.placement.count
        stored = solver.transport.light.passed.read()[: 2 * count * x * y * z]
        rows = solver.transport.light.table.rows.read().reshape(-1, 16)[:count]
    return stored.reshape(2, count, z, y, x)[1].astype(np.float64), rows[:, :3]


def lit(gpu: Gpu, *lights: Light, meshes: tuple[Mesh, ...], sky: Environment | None = None) -> F64:
    scene = Scene(
        meshes=meshes,
        lights=lights,
        environment=sky,
        camera=Camera((0, 0, 4), (0, 0, 0)),
        volumes=(Volume((1.0,) * 3, shape="box"),),
    )
    return shares(scene)[0]


def test_a_plate_shades_what_is_under_it(gpu):
    sun, local_light = lit(gpu, SUN, LIGHT, meshes=(plate(-1.0, 2.0),))
    assert sun[..., :3].max() < 0.05  # x < 0
    assert sun[..., 5:].min() > 0.95
    # The lamp hangs above the plate's middle: only what lies flat enough beyond its edge is lit.
    assert local_light[:, :, :4].max() < 0.05
    aside = lit(gpu, PointLight((0.6, 2.4, 0.0), (1, 1, 1)), meshes=(plate(-1.0, 2.0),))[0]
    assert aside[:, :, 4:].min() > 0.95
    assert aside[:, -1, 0].max() < 0.05


def test_without_surfaces_nothing_is_shaded(gpu):
    assert lit(gpu, SUN, meshes=())[0].min() == 1.0


def test_a_wide_plate_keeps_the_upper_sky_out(gpu):
    scene = Scene(
        meshes=(plate(0.0, 40.0), plate(0.0, 40.0)),
        environment=Environment((1, 1, 1)),
        camera=Camera((0, 0, 4), (0, 0, 0)),
        volumes=(Volume((1.0,) * 3, shape="box"),),
    )
    share, travel = shares(scene)
    along_plate = np.abs(travel[:, 0]) > 0.8  # the plate is 40 m wide, but 4 m deep
    down = (travel[:, 1] < -0.5) | (along_plate & (travel[:, 1] < -0.2))
    assert share[down][:, :, -3:].mean() < 0.1
    assert share[travel[:, 1] > 0.3].mean() > 0.95


def test_every_light_of_the_sky_belongs_to_one_ordinate():
    parallel_lights = parallel([(0, -1, 0), (1, 0, 0)], np.ones((2, 3)))
    sky = uniform_sky(6)
    toward = np.random.default_rng(3).standard_normal((40, 3))
    sky_lights = [
        DirectionalLight(tuple(d), (e,) * 3)
        for d, e in zip(toward, np.random.default_rng(4).random(40), strict=True)
    ]
    lights = (SUN, LIGHT, DirectionalLight((1, 0, 0), (1, 1, 1)))
    rows, parts = shadow_rows(joined([parallel_lights, sky]), lights, sky_lights)
    assert list(rows["light"]) == [1, 3, 0, 0, 0, 0, 0, 0, 2]
    assert rows["count"].sum() == len(parts) == 40
    assert sorted(parts["layer"]) == list(range(40))
    for n, row in enumerate(rows[2:8]):
        mine = parts[row["first"] : row["first"] + row["count"]]
        assert mine["weight"].sum() == pytest.approx(1.0)
        nearest = np.argmax(
            sky.direction @ np.array([sky_lights[k].direction for k in mine["layer"]]).T, axis=0
        )
        assert (nearest == n).all()


def test_an_ordinate_without_a_light_takes_the_nearest():
    rows, parts = shadow_rows(uniform_sky(5), (), [DirectionalLight((0, -1, 0), (1, 1, 1))])
    assert list(rows["count"]) == [1] * 5
    assert list(parts["layer"]) == [0] * 5
    rows, _ = shadow_rows(uniform_sky(5), (), [])
    assert rows["count"].sum() == 0
