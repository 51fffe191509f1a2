"""Reading a solved lattice: the WGSL against its NumPy twin, and against closed forms."""

from __future__ import annotations

import numpy as np
import pytest

from airlight.gpu.memory import Buffer, buffer_of, linear_sampler
from airlight.gpu.slots import sampler, storage, texture, uniform
from airlight.lattice.lobes import SHAPED_LOBE
from airlight.lattice.lookup import LatticeStates, LatticeTextures, own_shares, texture_scale
from airlight.lattice.placement import LatticeParams, Placement
from airlight.maths.lattice6 import (
    LOOKUP_SCALE,
    paper_surface_irradiance,
    surface_irradiance,
)

ROOM = Placement((-1.0, 2.0, 0.5), 0.25, (6, 8, 10))
SHAPE = ROOM.count[::-1]
RNG = np.random.default_rng(6)
SLOTS = (
    uniform("lattice", LatticeParams),
    texture("lattice_red", "3d"),
    texture("lattice_green", "3d"),
    texture("lattice_blue", "3d"),
    texture("lattice_visibility_a", "3d"),
    texture("lattice_visibility_b", "3d"),
    texture("lattice_walls", "3d"),
    texture("lattice_planes", "3d"),
    sampler("linear_clamp"),
    storage("points", "vec4f"),
    storage("normals", "vec4f"),
    storage("results", "vec4f", "read_write"),
)
MAIN = """
//! use surface_coordinates
@compute @workgroup_size(WX, WY, WZ) fn main(@builtin(global_invocation_id) id: vec3u) {
    if (id.x < arrayLength(&points)) {
        let p = points[id.x].xyz;
        let n = normals[id.x].xyz;
        let uvw = lattice_coordinates(lattice, p, n);
        results[id.x] = vec4f(lattice_irradiance_at(lattice, uvw, n), lattice_weight(lattice, p));
    }
}
"""


@pytest.fixture
def looked_up(gpu, commands, kernel, owned, cells_texture):
    """looked_up(cells (3, Z, Y, X, 4), points, normals) -> irradiance (n, 3), weight (n,)."""

    def evaluate(
        cells, points, normals, *, is_paper=False, visibility_a=255, visibility_b=255, walls=0
    ):
        textures = owned(LatticeTextures(gpu, ROOM))
        power = 4.0 * np.pi * float(np.abs(cells).max()) * 100.0
        scale = texture_scale(power)
        given = owned(buffer_of(gpu, "cells", np.ascontiguousarray(cells, np.float32)))
        zero = owned(Buffer(gpu, "zero", given.nbytes))
        textures.encode(commands, LatticeStates(given, zero), scale, is_shaped=False)
        rows = np.zeros((2, len(points), 4), np.float32)
        rows[0, :, :3], rows[1, :, :3] = points, normals
        p, n = (owned(buffer_of(gpu, "rows", r)) for r in rows)
        results = owned(Buffer(gpu, "results", rows[0].nbytes))
        kernel(MAIN, SLOTS).dispatch(
            commands,
            (len(points),),
            lattice=ROOM.params(scale, is_paper=is_paper),
            **textures.bound,
            lattice_visibility_a=cells_texture(ROOM, "rgba8unorm", visibility_a),
            lattice_visibility_b=cells_texture(ROOM, "rgba8unorm", visibility_b),
            lattice_walls=cells_texture(ROOM, "rgba8snorm", walls),
            lattice_planes=cells_texture(ROOM, "rgba16float"),
            linear_clamp=linear_sampler(gpu),
            points=p,
            normals=n,
            results=results,
        )
        commands.submit()
        read = results.read().reshape(-1, 4).astype(np.float64)
        return read[:, :3], read[:, 3]

    return evaluate


def constant(state):
    """The same (3, 4) state in every cell."""
    return np.broadcast_to(np.asarray(state)[:, None, None, None, :], (3, *SHAPE, 4))


def places(count, margin=1.5):
    low, high = ROOM.bounds
    return RNG.uniform(low + margin * ROOM.cell, high - margin * ROOM.cell, size=(count, 3))


def unit_vectors(count):
    v = RNG.normal(size=(count, 3))
    return v / np.linalg.norm(v, axis=1, keepdims=True)


def test_an_isotropic_lattice_lights_every_side_alike(looked_up):
    state = np.zeros((3, 4))
    state[:, 0] = (1.0, 2.0, 4.0)
    irradiance, weight = looked_up(constant(state), places(50), unit_vectors(50))
    expected = LOOKUP_SCALE * np.pi * state[:, 0] / ROOM.cell**2
    np.testing.assert_allclose(irradiance, np.tile(expected, (50, 1)), rtol=2e-3)
    np.testing.assert_array_equal(weight, 1.0)


@pytest.mark.parametrize(
    ("is_paper", "twin"), [(False, surface_irradiance), (True, paper_surface_irradiance)]
)
def test_directed_light_reads_as_its_numpy_twin(looked_up, is_paper, twin):
    states = RNG.normal(size=(3, 4))
    states[:, 0] = (1.0, 0.5, 2.0)
    normals = unit_vectors(60)
    irradiance, _ = looked_up(constant(states), places(60), normals, is_paper=is_paper)
    expected = np.stack([twin(np.tile(s, (60, 1)), normals, ROOM.cell) for s in states], axis=1)
    np.testing.assert_allclose(irradiance, expected, rtol=5e-3, atol=2e-3 * expected.max())


def test_a_point_between_cells_gets_a_mean_of_them(looked_up):
    cells = np.zeros((3, *SHAPE, 4))
    cells[..., 0] = np.arange(SHAPE[2])[None, None, None, :] + 1.0
    # on a face that looks up, half a cell below a row of centres
    place = np.array([[2.5, 4.0, 5.5], [2.75, 4.0, 5.5], [3.0, 4.0, 5.5], [3.5, 4.0, 5.5]])
    points = np.array(ROOM.origin) + ROOM.cell * place
    irradiance, _ = looked_up(cells, points, np.tile([0.0, 1.0, 0.0], (4, 1)))
    value = irradiance[:, 0] * ROOM.cell**2 / (LOOKUP_SCALE * np.pi)
    assert value[0] == pytest.approx(3.0, rel=5e-3)
    assert value[3] == pytest.approx(4.0, rel=5e-3)
    assert 3.0 <= value[1] <= value[2] <= 4.0
    assert value[2] == pytest.approx(3.5, rel=0.02)


def test_light_behind_a_closed_face_is_not_mixed_in(looked_up):
    cells = np.zeros((3, *SHAPE, 4))
    cells[:, :, :, 3:, 0] = 1.0  # light only beyond the face between cells 2 and 3
    visibility_a = np.full((*SHAPE, 4), 255, np.uint8)
    visibility_a[:, :, 2, 1] = 0  # no light comes into cell 2 along -x
    place = np.array([[2.9, 4.0, 5.5]])
    points = np.array(ROOM.origin) + ROOM.cell * place
    up = np.array([[0.0, 1.0, 0.0]])
    shut, _ = looked_up(cells, points, up, visibility_a=visibility_a)
    free, _ = looked_up(cells, points, up)
    assert shut.max() < 1e-6
    assert free.min() > 1.0


def test_a_soffit_in_a_partly_open_face_sees_both_sides(looked_up):
    cells = np.zeros((3, *SHAPE, 4))
    cells[:, :, :, 3:, 0] = 1.0  # light only beyond the face between cells 2 and 3
    visibility_a = np.full((*SHAPE, 4), 255, np.uint8)
    visibility_a[:, :, 2, 1] = visibility_a[:, :, 3, 0] = 60  # nearly closed
    place = np.array([[2.7, 4.0, 5.5], [2.999, 4.0, 5.5], [3.001, 4.0, 5.5], [3.3, 4.0, 5.5]])
    points = np.array(ROOM.origin) + ROOM.cell * place
    down = np.tile([0.0, -1.0, 0.0], (4, 1))
    irradiance, _ = looked_up(cells, points, down, visibility_a=visibility_a)
    soffit = irradiance[:, 0] * ROOM.cell**2 / (LOOKUP_SCALE * np.pi)
    np.testing.assert_allclose(soffit, [0.0, 0.5, 0.5, 1.0], atol=0.06)


def test_a_point_before_a_wall_looks_on_its_own_side(looked_up):
    # A wall on the face between cells 2 and 3: light only on its far side, or only on its near.
    for lit, expected in ((slice(3, None), 0.0), (slice(0, 3), 1.0)):
        cells = np.zeros((3, *SHAPE, 4))
        cells[:, :, :, lit, 0] = 1.0
        for inset in (0.0, 0.2, 0.4):
            points = np.array(ROOM.origin) + ROOM.cell * np.array([[3.0 - inset, 4.5, 5.5]])
            irradiance, _ = looked_up(cells, points, np.array([[-1.0, 0.0, 0.0]]))
            value = irradiance[0, 0] * ROOM.cell**2 / (LOOKUP_SCALE * np.pi)
            assert value == pytest.approx(expected, abs=5e-3)


def test_an_underside_does_not_look_below_the_floor_that_it_faces(looked_up):
    cells = np.zeros((3, *SHAPE, 4))
    cells[:, :, 3:, :, 0] = 1.0  # light only above the floor between cells 2 and 3
    walls = np.zeros((*SHAPE, 4), np.int8)
    walls[:, 3, :, 3] = 1 << 3  # leaving cell 3 along -y
    heights = np.array([0.2, 0.45, 0.9])
    place = np.stack([np.full(3, 2.5), 3.0 + heights, np.full(3, 5.5)], axis=-1)
    points = np.array(ROOM.origin) + ROOM.cell * place
    down = np.tile([0.0, -1.0, 0.0], (3, 1))
    stopped, _ = looked_up(cells, points, down, walls=walls)
    value = stopped * ROOM.cell**2 / (LOOKUP_SCALE * np.pi)
    np.testing.assert_allclose(value, 1.0, atol=5e-3)
    free, _ = looked_up(cells, points, down)
    assert free[:2].max() < 1e-6  # where nothing is known of a floor


@pytest.mark.parametrize("tilt", [0.0, -0.3, 0.3])
def test_the_foot_of_a_wall_does_not_look_below_the_floor(looked_up, tilt):
    cells = np.zeros((3, *SHAPE, 4))
    cells[:, :, 3:, :, 0] = 1.0  # light only above the floor between cells 2 and 3
    walls = np.zeros((*SHAPE, 4), np.int8)
    walls[:, 3, :, 3] = 1 << 3  # leaving cell 3 along -y
    heights = np.array([-0.1, 0.0, 0.02, 0.1])
    place = np.stack([np.full(4, 2.0), 3.0 + heights, np.full(4, 5.5)], axis=-1)
    points = np.array(ROOM.origin) + ROOM.cell * place
    out = np.tile([np.sqrt(1.0 - tilt * tilt), tilt, 0.0], (4, 1))
    read, _ = looked_up(cells, points, out, walls=walls)
    above, _ = looked_up(np.ones_like(cells) * [1.0, 0.0, 0.0, 0.0], points, out)
    assert (read > 0.6 * above).all()  # what is beneath the floor is mixed in: its faces are open


def test_light_fades_out_over_the_outermost_cell(looked_up):
    low, high = ROOM.bounds
    middle = 0.5 * (low + high)
    steps = np.array([-2.0, -0.5, 0.0, 0.5, 2.0])[:, None] * ROOM.cell
    points = np.where([True, False, False], low + steps, middle)
    state = np.zeros((3, 4))
    _, weight = looked_up(constant(state + 1.0), points, np.tile([0.0, 1.0, 0.0], (5, 1)))
    np.testing.assert_allclose(weight, [0.0, 0.0, 0.5, 1.0, 1.0], atol=1e-5)


def test_all_flux_in_one_cell_fits_half_floats():
    for flux in (1e-9, 1.0, 1e9):
        assert 400.0 < texture_scale(flux) * flux / (4.0 * np.pi) <= 1000.0


def test_a_flat_surface_does_not_light_itself():
    # the lobe that surfaces of the cell itself see: a - (2/3) b.n = 0 for b = lobe a n
    even, direct = own_shares()
    assert even - 2.0 / 3.0 * direct * SHAPED_LOBE == pytest.approx(0.0, abs=1e-12)
