"""The sky's light in cells: a furnace in the open, darkness in a closed box."""

from __future__ import annotations

import numpy as np
import pytest

from airlight.lattice.placement import Placement
from airlight.lattice.skylight import Skylight
from airlight.lighting.sky import Sky
from airlight.scene import Environment, Material, Mesh, shapes

N = 8
ROOM = Placement((-2.0, -2.0, -2.0), 0.5, (N, N, N))
PARTITION_ERROR = 0.03
"""What 128 directional lights make of a constant sky's irradiance, relative."""


@pytest.fixture
def cubes(gpu, commands, owned, cells_texture):
    """cubes(scene, environment) -> (6, Z, Y, X, 3) irradiance on +x -x +y -y +z -z."""

    def solve(scene, environment):
        sky = owned(Sky(gpu, environment, ROOM, 128, 64))
        assert sky.encode(commands, scene, environment, cells_texture(ROOM, "rgba8snorm"))
        assert not sky.encode(commands, scene, environment, cells_texture(ROOM, "rgba8snorm"))
        commands.submit()
        cube = sky.skylight.cube.read()[..., :3].astype(np.float64)
        return cube.reshape(6, N, N, N, 3)

    return solve


def speck(square):
    return square((1.9, 1.9, 1.9), (1e-4, 0, 0), (0, 0, 1e-4))


def box(size):
    matrix = np.diag([size, size, size, 1.0])
    return Mesh(shapes.box(), Material(), matrix)


def test_an_open_cell_in_a_constant_sky_is_a_furnace(cubes, on_device, square):
    radiance = np.array([2.0, 1.0, 0.5])
    made = cubes(on_device(speck(square)), Environment(radiance=tuple(radiance)))
    np.testing.assert_allclose(
        made, np.broadcast_to(np.pi * radiance, made.shape), rtol=PARTITION_ERROR
    )


def test_half_a_sky_lights_what_faces_it(cubes, on_device, square):
    pixels = np.zeros((32, 64, 3), np.float32)
    pixels[:16] = 1.0  # the upper half
    made = cubes(on_device(speck(square)), Environment(map=pixels))
    expected = np.pi * np.array([0.5, 0.5, 1.0, 0.0, 0.5, 0.5])
    np.testing.assert_allclose(made[:, 4, 4, 4, 0], expected, atol=PARTITION_ERROR * np.pi)


def test_a_closed_box_is_dark_inside(cubes, on_device):
    made = cubes(on_device(box(3.0)), Environment())
    inside = slice(2, 6)  # from -1 m to 1 m
    assert made[:, inside, inside, inside].max() < 1e-3
    assert made[:, 0, 0, 0].max() > 1.0


def test_a_floor_darkens_what_is_on_its_other_side(cubes, on_device, square):
    made = cubes(on_device(square((0, 0, 0), (2, 0, 0), (0, 0, -2))), Environment())
    above, below = made[:, 4, 4, 4, 0], made[:, 4, 3, 4, 0]
    np.testing.assert_allclose(above[2], np.pi, rtol=PARTITION_ERROR)
    np.testing.assert_allclose(below[3], np.pi, rtol=PARTITION_ERROR)
    # 8 degrees past the floor's edge give sin^2 of it
    assert above[3] < 0.1
    assert below[2] < 0.1


def test_no_sky_needs_no_maps(gpu, commands, owned, cells_texture, on_device, square):
    sky = owned(Sky(gpu, None, ROOM, 128, 64))
    walls = cells_texture(ROOM, "rgba8snorm")
    assert not sky.encode(commands, on_device(speck(square)), None, walls)
    assert sky.lights == []
    assert not sky.skylight.cube.read()[..., :3].any()


def test_a_lattice_that_moves_keeps_what_it_knows(gpu, commands, owned, cells_texture, on_device):
    scene, sky_of = on_device(box(1.5)), Environment()
    sky = owned(Sky(gpu, sky_of, ROOM, 128, 64, (N, 2 * N, N)))
    walls = cells_texture(Placement(ROOM.origin, ROOM.cell, (N, 2 * N, N)), "rgba8snorm")
    sky.encode(commands, scene, sky_of, walls)
    finer = Placement((-1.0, -1.0, -1.0), 0.25, (N, N, N), first_row=N)
    moving = owned(Skylight(gpu, finer, 128, beside=sky.skylight))
    sky.light(commands, moving, walls)
    moving.placement = Placement((-0.5, -1.25, -1.0), 0.25, (N, N, N), first_row=N)
    sky.light(commands, moving, walls, is_same_light=True)
    commands.submit()
    kept = moving.cube.read()
    again = owned(Skylight(gpu, moving.placement, 128, beside=sky.skylight))
    sky.light(commands, again, walls)
    commands.submit()
    np.testing.assert_array_equal(kept, again.cube.read())
    assert kept[:, N:, :, :3].max() > 1.0 and kept[:, N:, :, :3].min() < 0.1
