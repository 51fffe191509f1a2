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
def open_air(cells_texture):
    """open_air(placement, floor) -> the textures of blockers where there are none but a floor below
    cells of row `floor`.
    """

    def make(placement, floor=None):
        a, b = np.full((2, *placement.count[::-1], 4), 255, np.uint8)
        if floor is not None:
            a[:, floor, :, 2] = a[:, floor - 1, :, 3] = b[:, floor, :, 3] = 0
        return {
            "lattice_visibility_a": cells_texture(placement, "rgba8unorm", a),
            "lattice_visibility_b": cells_texture(placement, "rgba8unorm", b),
            "lattice_walls": cells_texture(placement, "rgba8snorm"),
        }

    return make


@pytest.fixture
def cubes(gpu, commands, owned, open_air):
    """cubes(scene, environment) -> (6, Z, Y, X, 3) irradiance on +x -x +y -y +z -z."""

    def solve(scene, environment, lights=128, floor=None):
        sky = owned(Sky(gpu, environment, lights, 64))
        skylight = owned(Skylight(gpu, ROOM, lights))
        assert sky.encode(commands, scene, environment, ROOM)
        assert not sky.encode(commands, scene, environment, ROOM)
        sky.light(commands, skylight, open_air(ROOM, floor))
        commands.submit()
        cube = skylight.cube.read()[..., :3].astype(np.float64)
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
    made = cubes(on_device(square((0, 0, 0), (2, 0, 0), (0, 0, -2))), Environment(), floor=4)
    above, below = made[:, 4, 4, 4, 0], made[:, 4, 3, 4, 0]
    np.testing.assert_allclose(above[2], np.pi, rtol=PARTITION_ERROR)
    np.testing.assert_allclose(below[3], np.pi, rtol=PARTITION_ERROR)
    # 8 degrees past the floor's edge give pi sin^2 of it
    most = np.pi * (np.sin(np.radians(8.0)) ** 2 + PARTITION_ERROR)
    assert above[3] < most
    assert below[2] < most


def test_a_part_of_the_sky_casts_shadows_as_soft_as_it_is_wide(cubes, on_device, square):
    rows, lid_y = 128, 1.9
    pixels = np.zeros((rows, 2 * rows, 3), np.float32)
    radius = np.radians(12.0)
    pixels[: round(rows * radius / np.pi)] = 1.0
    lid = square((-1.0, lid_y, 0.0), (0.0, 0.0, 2.0), (1.0, 0.0, 0.0))  # over x < 0, facing up
    made = cubes(on_device(lid), Environment(map=pixels), lights=1)
    lit = made[2, N // 2, 0, :, 0]
    below = lid_y - (ROOM.origin[1] + 0.5 * ROOM.cell)
    x = ROOM.origin[0] + (np.arange(N) + 0.5) * ROOM.cell
    u = np.clip(x / (below * np.tan(radius)), -1.0, 1.0)
    # the share of a disc past a straight edge
    share = 0.5 + (np.arcsin(u) + u * np.sqrt(1.0 - u**2)) / np.pi
    # 16 taps of an edge blurred by the map's texels; the first cell is past the lid's other edge
    np.testing.assert_allclose((lit / lit.max())[1:], share[1:], atol=0.1)
    assert 0.5 < lit[N // 2] / lit.max() < 0.9


def test_no_sky_needs_no_maps(gpu, commands, owned, open_air, on_device, square):
    sky, skylight = owned(Sky(gpu, None, 128, 64)), owned(Skylight(gpu, ROOM, 128))
    assert not sky.encode(commands, on_device(speck(square)), None, ROOM)
    assert sky.lights == []
    sky.light(commands, skylight, open_air(ROOM))
    assert not skylight.cube.read()[..., :3].any()


def test_a_lattice_that_moves_keeps_what_it_knows(gpu, commands, owned, open_air, on_device):
    scene, sky_of = on_device(box(1.5)), Environment()
    sky = owned(Sky(gpu, sky_of, 128, 64))
    largest = owned(Skylight(gpu, ROOM, 128, size=(N, 2 * N, N)))
    walls = open_air(Placement(ROOM.origin, ROOM.cell, (N, 2 * N, N)))
    sky.encode(commands, scene, sky_of, ROOM)
    finer = Placement((-1.0, -1.0, -1.0), 0.25, (N, N, N), first_row=N)
    moving = owned(Skylight(gpu, finer, 128, owner=largest))
    sky.light(commands, moving, walls)
    moving.placement = Placement((-0.5, -1.25, -1.0), 0.25, (N, N, N), first_row=N)
    sky.light(commands, moving, walls, is_same_light=True)
    commands.submit()
    kept = moving.cube.read()
    again = owned(Skylight(gpu, moving.placement, 128, owner=largest))
    sky.light(commands, again, walls)
    commands.submit()
    np.testing.assert_array_equal(kept, again.cube.read())
    assert kept[:, N:, :, :3].max() > 1.0 and kept[:, N:, :, :3].min() < 0.1
