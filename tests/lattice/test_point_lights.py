"""Thousands of point lights: put into cells in one dispatch, seen on surfaces."""

from __future__ import annotations

import numpy as np
import pytest

from airlight import Camera, Mesh, PointLights, Scene
from airlight.gpu.memory import Texture
from airlight.lattice.inject import fixed_point_scale, new_sums
from airlight.lattice.lobes import InjectionTarget
from airlight.lattice.placement import Placement
from airlight.lattice.point_lights import InjectPoints
from airlight.rendering import Renderer
from airlight.scene.shapes import quad

ROOM = Placement((-1.0, 0.0, 2.0), 0.5, (6, 4, 8))


@pytest.fixture
def injected(gpu, commands, owned):
    """injected(groups) -> (3, Z, Y, X, 4) W sr^-1."""

    def solve(groups):
        walls = owned(Texture(gpu, "walls", ROOM.count, "rgba8snorm", dimension="3d", written=True))
        points, sums = owned(InjectPoints(gpu)), owned(new_sums(gpu, ROOM))
        scale = fixed_point_scale(points.take(groups))
        points.encode(commands, InjectionTarget(ROOM, walls, sums, scale))
        commands.submit()
        return sums.read(np.int32).reshape(3, *ROOM.count[::-1], 4) / scale

    return solve


def cloud(count, seed=1):
    rng = np.random.default_rng(seed)
    low, high = ROOM.bounds
    return PointLights(rng.uniform(low, high, (count, 3)), rng.random((count, 3)))


def test_every_light_is_the_isotropic_light_of_its_cell(injected):
    group = cloud(5000)
    cells = np.floor((group.positions - ROOM.origin) / ROOM.cell).astype(int)
    expected = np.zeros((3, *ROOM.count[::-1]))
    for channel in range(3):
        x, y, z = cells.T
        np.add.at(expected[channel], (z, y, x), group.intensities[:, channel])
    made = injected([group])
    np.testing.assert_allclose(made[..., 0], expected, rtol=1e-4)
    assert not made[..., 1:].any()


def test_several_groups_add_up_and_lights_outside_do_not_count(injected):
    outside = PointLights([[50.0, 0.0, 0.0]], [[1.0, 1.0, 1.0]])
    both = injected([cloud(100), cloud(50, seed=2), outside])
    alone = injected([cloud(100)])[..., 0] + injected([cloud(50, seed=2)])[..., 0]
    np.testing.assert_allclose(both[..., 0], alone, atol=1e-4)


def test_no_lights_bring_no_light(injected):
    assert not injected([]).any()


def floor_scene(group):
    floor = Mesh(quad(), world_from_object=np.diag([8.0, 1.0, 8.0, 1.0]))
    return Scene(
        meshes=(floor,),
        camera=Camera((0.0, 7.0, 0.01), (0.0, 0.0, 0.0), fov_y_deg=30.0),
        light_groups=(group,),
    )


def test_a_cloud_of_lights_over_a_floor_against_its_sum(gpu):
    rng = np.random.default_rng(3)
    group = PointLights(
        rng.uniform((-1.5, 1.0, -1.5), (1.5, 2.5, 1.5), (2000, 3)), [[0.01, 0.02, 0.0]]
    )
    settings = {
        "bounces": False,
        "iterations": 64,
        "resolution": 24,
        "sky_lights": 0,
        "bounds": (-4, -0.2, -4, 4, 4, 4),
    }
    with Renderer(floor_scene(group), "lpv", (48, 48), settings=settings) as made:
        lit = made.frame()
        brighter = made.frame(light_groups=[PointLights(group.positions, [[0.04, 0.02, 0.0]])])
    seen = (lit.layers["indirect"] / np.maximum(lit.layers["albedo"], 1e-6)).mean(axis=(0, 1))
    reach = 7.0 * np.tan(np.radians(15.0))
    x, z = np.meshgrid(*[np.linspace(-reach, reach, 21)] * 2)
    towards = group.positions[:, None] - np.stack([x, 0 * x, z], -1).reshape(1, -1, 3)
    distance = np.linalg.norm(towards, axis=-1)
    expected = (towards[..., 1] / distance**3).mean(axis=1).sum() / np.pi
    # Two bands spread such light too soon: .824 of the sum, .79 to .86 by where among the cells the
    # floor lay while they did not end at it.
    assert seen[1] == pytest.approx(0.02 * expected, rel=0.18)
    assert seen[0] == pytest.approx(0.5 * seen[1], rel=1e-3)
    assert seen[2] == 0.0
    ratio = brighter.layers["indirect"][..., 0].sum() / lit.layers["indirect"][..., 0].sum()
    assert ratio == pytest.approx(4.0, rel=1e-3)
