"""Virtual point lights into cells: no flux is lost, all runs are the same to the bit."""

from __future__ import annotations

import math

import numpy as np
import pytest

from airlight.gpu.memory import Buffer
from airlight.lattice.inject import Inject, Resolve, fixed_point_scale, flux_bound, new_sums
from airlight.lattice.lobes import COSINE, COSINE_LOBE, SHAPED, SHAPED_LOBE, InjectionTarget
from airlight.lattice.placement import Placement
from airlight.maths.flat_surfaces import free_sharpness
from airlight.scene import DirectionalLight, Material, Mesh, PointLight, SpotLight
from airlight.scene.shapes import sphere
from airlight.surface.light_views import light_views
from airlight.surface.reflective import ReflectiveShadowMaps

SIDE = 64
ALBEDO = np.array([0.8, 0.5, 0.2])
PAINT = Material(base_color=tuple(ALBEDO), specular=0.0)
ROOM = Placement((-2.0, -2.0, -2.0), 0.25, (16, 16, 16))
SUN = DirectionalLight((0, -1, 0), (3, 2, 1))


@pytest.fixture
def injected(gpu, commands, owned, cells_texture):
    """injected(scene, light, placement) -> ((3, Z, Y, X, 4) W sr^-1, flux (3,) W of the maps)."""
    inject, resolve = Inject(gpu), Resolve(gpu)

    def solve(scene, light, placement=ROOM, *, is_shaped=False, walls=0, block=1):
        views = light_views([light], *scene.bounds, SIDE)
        maps = owned(ReflectiveShadowMaps(gpu, "maps", SIDE, len(views), block=block))
        maps.encode(commands, scene, [light], views)
        sums = owned(new_sums(gpu, placement))
        nbytes = 3 * placement.cells * 16
        zero, lattice = owned(Buffer(gpu, "zero", nbytes)), owned(Buffer(gpu, "cells", nbytes))
        scale = fixed_point_scale(flux_bound([light], *scene.bounds))
        shifts = cells_texture(placement, "rgba8snorm", walls)
        target = InjectionTarget(placement, shifts, sums, scale)
        inject.encode(commands, maps, target, SHAPED if is_shaped else COSINE)
        resolve.encode(commands, placement, sums, zero, lattice, scale)
        commands.submit()
        assert not sums.read(np.int32).any()  # ready for the next frame
        cells = lattice.read().reshape(3, *placement.count[::-1], 4)
        return cells.astype(np.float64), flux_of(maps, views)

    return solve


def flux_of(maps, views):
    total = np.zeros(3)
    units = maps.views.read()["flux_unit"]
    for layer, view in enumerate(views):
        density = units[layer] * maps.flux.read(layer)[..., :3].astype(np.float64)
        measure = np.full((SIDE, SIDE), view.texel[0] * view.texel[1])
        if view.is_perspective:
            tangent = (np.arange(SIDE) + 0.5 - SIDE / 2) * view.texel[0]
            measure *= (1.0 + tangent[:, None] ** 2 + tangent**2) ** -1.5
        total += (density * measure[..., None]).sum(axis=(0, 1))
    return total


LIGHTS = [
    SUN,
    DirectionalLight((0.4, -1, 0.2), (1, 1, 1)),
    PointLight((0.3, 1.0, 0.2), (2, 2, 2)),
    SpotLight((0, 1.5, 0), (0.1, -1, 0), (4, 4, 4)),
]


@pytest.mark.parametrize("light", LIGHTS)
def test_no_flux_is_lost(injected, on_device, square, light):
    scene = on_device(square((0, 0.1, 0), (1.2, 0, 0), (0, 0, -1.2), PAINT))
    cells, flux = injected(scene, light)
    assert flux[0] > 0.1
    np.testing.assert_allclose(4.0 * np.pi * cells[..., 0].sum(axis=(1, 2, 3)), flux, rtol=1e-4)


@pytest.mark.parametrize("light", LIGHTS)
def test_blocks_of_texels_have_the_flux_of_their_texels_before_the_same_surfaces(
    injected, on_device, square, light
):
    # Edges of a plate over a floor, and a wall beside it: blocks that show two surfaces or three.
    scene = on_device(
        square((0, -0.9, 0), (1.2, 0, 0), (0, 0, -1.2), PAINT),
        square((-0.3, 0.1, 0.1), (0.5, 0, 0.1), (0.1, 0, -0.5), PAINT),
        square((1.1, -0.2, 0), (0, 0.6, 0), (0, 0, 1.0), PAINT),
    )
    cells, flux = injected(scene, light)
    merged, _ = injected(scene, light, block=2)
    np.testing.assert_allclose(4.0 * np.pi * merged[..., 0].sum(axis=(1, 2, 3)), flux, rtol=1e-4)
    # Each surface keeps its own, by height, but for blocks at a slant, which reach across a cell.
    own, whole = (c[0, ..., 0].sum(axis=(0, 2)) for c in (merged, cells))
    assert np.abs(own - whole).max() < 0.03 * whole.sum()
    # A block's light is in one cell, where its texels' may be in two: a cell is 3 to 4 blocks wide.
    assert np.abs(merged - cells)[..., 0].sum() < 0.25 * cells[..., 0].sum()


def test_a_square_in_the_sun_has_the_flux_that_it_reflects(injected, on_device, square):
    scene = on_device(square((0, 0.1, 0), (1.2, 0, 0), (0, 0, -1.2), PAINT))
    cells, _ = injected(scene, SUN)
    power = 4.0 * np.pi * cells[..., 0].sum(axis=(1, 2, 3))
    np.testing.assert_allclose(power, ALBEDO * [3, 2, 1] * 2.4**2, rtol=0.04)


def test_lobes_point_along_the_normal(injected, on_device, square):
    scene = on_device(square((0, 0.1, 0), (1.2, 0, 0), (0, 0, -1.2), PAINT))
    cells, _ = injected(scene, SUN)
    sums = cells.sum(axis=(0, 1, 2, 3))
    np.testing.assert_allclose(sums[1:] / sums[0], [0.0, COSINE_LOBE, 0.0], atol=1e-3)


@pytest.mark.parametrize(("height_cells", "layer"), [(8.1, 8), (8.4, 8), (8.6, 9), (8.9, 9)])
def test_lights_move_half_a_cell_along_the_normal(injected, on_device, square, height_cells, layer):
    height = ROOM.origin[1] + ROOM.cell * height_cells
    cells, _ = injected(on_device(square((0, height, 0), (1.2, 0, 0), (0, 0, -1.2), PAINT)), SUN)
    assert np.nonzero(cells[0, ..., 0].sum(axis=(0, 2)))[0].tolist() == [layer]


def test_walls_that_were_rounded_to_a_face_are_lit_before_it(injected, on_device, square):
    # 0.4 cells above the face 8; its light belongs to the cell above, whatever the half step does.
    height = ROOM.origin[1] + ROOM.cell * 8.4
    walls = np.zeros((16, 16, 16, 4), np.int8)
    walls[:, 8, :, 1] = round(0.4 * 127)
    scene = on_device(square((0, height, 0), (1.2, 0, 0), (0, 0, -1.2), PAINT))
    from_above, _ = injected(scene, SUN, walls=walls)
    from_below, _ = injected(scene, DirectionalLight((0, 1, 0), (1, 1, 1)), walls=walls)
    assert np.nonzero(from_above[0, ..., 0].sum(axis=(0, 2)))[0].tolist() == [8]
    assert np.nonzero(from_below[0, ..., 0].sum(axis=(0, 2)))[0].tolist() == [7]


@pytest.mark.parametrize("is_shaped", [False, True])
def test_two_runs_are_the_same_to_the_bit(injected, on_device, square, is_shaped):
    scene = on_device(
        square((0, 0.1, 0), (1.2, 0, 0), (0, 0, -1.2), PAINT),
        square((1, 0.5, 0), (0.3, 0.5, 0), (0, 0.2, 0.7), PAINT),
    )
    first, _ = injected(scene, LIGHTS[2], is_shaped=is_shaped)
    second, _ = injected(scene, LIGHTS[2], is_shaped=is_shaped)
    assert first.tobytes() == second.tobytes()


@pytest.mark.parametrize("brightness", [1e-6, 1.0, 1e6])
def test_all_flux_in_one_cell_does_not_overflow(injected, on_device, square, brightness):
    big = Placement((-20.0, -20.0, -20.0), 10.0, (4, 4, 4))
    scene = on_device(square((5, 1, 5), (2, 0, 0), (0, 0, -2), Material(base_color=(1, 1, 1))))
    light = DirectionalLight((0, -1, 0), (brightness,) * 3)
    for is_shaped in (False, True):
        cells, flux = injected(scene, light, big, is_shaped=is_shaped)
        a = cells[0, 2, 2, 2, 0]
        assert np.count_nonzero(cells[0, ..., 0]) == 1
        if not is_shaped:
            assert 4.0 * math.pi * a == pytest.approx(flux[0], rel=1e-4)
            assert flux[0] == pytest.approx(16.0 * brightness, rel=0.1)
        assert cells[0, 2, 2, 2, 2] > a > 0.0


def test_what_lies_outside_the_lattice_is_left_out(injected, on_device, square):
    cells, _ = injected(on_device(square((0, 9, 0), (1, 0, 0), (0, 0, -1), PAINT)), SUN)
    assert not cells.any()


@pytest.mark.parametrize(
    ("light", "flux"),
    [
        (PointLight((0, 0, 0), (1, 5, 2)), 4.0 * math.pi * 5.0),
        (SpotLight((0, 0, 0), (0, -1, 0), (3, 1, 2), 89, 89), 2.0 * math.pi * 3.0),
        # a square of 2 m x 2 m that faces the sun lies in the box
        (DirectionalLight((0, -1, 0), (1, 2, 1)), 2.0 * 4.0),
    ],
)
def test_the_bound_holds_what_a_light_can_bring(light, flux):
    assert flux_bound([light], (-1, -1, -1), (1, 1, 1)) >= flux * (1.0 - 1e-12)


def test_the_scale_is_a_power_of_two_below_the_limit():
    for flux in (1e-20, 0.3, 7.0, 1e9):
        scale = fixed_point_scale(flux)
        assert math.log2(scale) == int(math.log2(scale))
        assert 2**28 < scale * flux * 2.7 / (4.0 * math.pi) <= 2**30


def test_light_of_a_flat_surface_enters_cells_before_its_plane(injected, on_device, square):
    # 15 degrees off the lattice's axes and three metres wide. A third of its light would be in
    # cells with middles less than .3 cells before its plane, or behind it, half a cell before it.
    turn = math.radians(15.0)
    along = np.array([math.cos(turn), math.sin(turn), 0.0])
    normal = np.array([-math.sin(turn), math.cos(turn), 0.0])
    scene = on_device(square((0, 0.1, 0), 1.5 * along, (0, 0, -1.5), PAINT))
    cells, _ = injected(scene, SUN, is_shaped=True)
    power = cells[0, ..., 0]
    z, y, x = np.indices(power.shape)
    middles = np.array(ROOM.origin) + ROOM.cell * (np.stack([x, y, z], -1) + 0.5)
    before = (middles - (0, 0.1, 0)) @ normal / ROOM.cell
    assert power[before < 0.3].sum() < 0.15 * power.sum()
    # No hop takes less than nothing of it: most of it has lobes as sharp as that allows.
    lobes = cells[0][power > 1e-3 * power.max()]
    sharpness = np.linalg.norm(lobes[:, 1:], axis=1) / lobes[:, 0]
    expected = free_sharpness(normal[None], SHAPED_LOBE)
    assert np.median(sharpness) == pytest.approx(expected[0], rel=0.01)


def test_light_of_a_slanted_square_at_the_border_of_a_lattice_is_all_there(
    injected, on_device, square
):
    # The highest cells are half a cell before it, a whole one is outside. What stays there has a
    # sharper lobe, whose power is less by what it takes back.
    along = np.array([0.94, 0.34, 0.0])
    low = Placement((-2.0, -3.5, -2.0), 0.25, (16, 16, 16))
    scene = on_device(square((0, 0.1, 0), 0.6 * along, (0, 0, -0.6), PAINT))
    within, border = (injected(scene, SUN, p, is_shaped=True)[0] for p in (ROOM, low))
    assert border[0, ..., 0].sum() > 0.97 * within[0, ..., 0].sum()


@pytest.mark.parametrize("grazing_deg", [20.0, 40.0])
def test_light_between_parallel_boards_stays_between_them(injected, on_device, square, grazing_deg):
    # Boards .7 cells apart, 15 degrees off the lattice's axes; the sun shines in between them. No
    # cell wholly on the other board's far side has any of it: .15 and .23 where nobody asks.
    turn, grazing = math.radians(15.0), math.radians(grazing_deg)
    along = np.array([math.cos(turn), math.sin(turn), 0.0])
    normal = np.array([-math.sin(turn), math.cos(turn), 0.0])
    black = Material(base_color=(0, 0, 0), specular=0.0)
    sides, middle = (along, (0, 0, -1.5)), np.array([-0.5, -0.2, 0.0])
    facing = square(middle + 0.7 * ROOM.cell * normal, *sides, black)
    scene = on_device(square(middle, *sides, PAINT), facing)
    sun = DirectionalLight(-math.cos(grazing) * along - math.sin(grazing) * normal, (1, 1, 1))
    cells, _ = injected(scene, sun, is_shaped=True)
    power = cells[0, ..., 0]
    z, y, x = np.indices(power.shape)
    middles = np.array(ROOM.origin) + ROOM.cell * (np.stack([x, y, z], -1) + 0.5)
    nearest = (middles - middle) @ normal / ROOM.cell - 0.5 * np.abs(normal).sum()
    assert power.sum() > 0.0
    assert power[nearest > 0.7].sum() < 0.02 * power.sum()


def test_light_of_a_small_ball_stays_close_to_it(injected, on_device):
    # Its radius is .4 cells; its light enters cells 1.1 from its middle, 1.5 if taken for planes.
    matrix = np.diag([0.2, 0.2, 0.2, 1.0])  # m
    scene = on_device(Mesh(sphere(), PAINT, matrix))
    cells, _ = injected(scene, SUN, is_shaped=True)
    power = cells[0, ..., 0]
    z, y, x = np.indices(power.shape)
    middles = np.array(ROOM.origin) + ROOM.cell * (np.stack([x, y, z], -1) + 0.5)
    away = np.linalg.norm(middles, axis=-1) / ROOM.cell
    assert (power * away).sum() / power.sum() < 1.2
