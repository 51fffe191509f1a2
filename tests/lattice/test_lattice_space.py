"""The wall-aligned lattice warp: walls come to lie on cell faces, and back."""

from __future__ import annotations

import numpy as np
import pytest

from airlight.gpu.memory import Buffer, buffer_of
from airlight.gpu.slots import storage, texture, uniform
from airlight.lattice.placement import LatticeParams, Placement

AXES = ((0.6, 0.0, -0.8), (0.0, 1.0, 0.0), (0.8, 0.0, 0.6))
ROOM = Placement((-1.0, 2.0, 0.5), 0.25, (12, 10, 8))
RNG = np.random.default_rng(8)
SLOTS = (
    uniform("lattice", LatticeParams),
    texture("lattice_walls", "3d"),
    storage("given", "vec4f"),
    storage("cells", "vec4f"),
    storage("results", "vec4f", "read_write"),
)
MAIN = """
//! use lattice_space
@compute @workgroup_size(WX, WY, WZ) fn main(@builtin(global_invocation_id) id: vec3u) {
    if (id.x < arrayLength(&given)) {
        let p = given[id.x].xyz;
        let c = vec3u(cells[id.x].xyz);
        results[id.x] = vec4f(CALL, 0.0);
    }
}
"""


@pytest.fixture
def run(gpu, commands, kernel, owned, cells_texture):
    """run(call, walls, points, cells) -> (n, 3)."""

    def evaluate(call, walls, points, cells=None):
        made = kernel(MAIN.replace("CALL", call), SLOTS)
        rows = np.zeros((2, len(points), 4), np.float32)
        rows[0, :, :3] = points
        rows[1, :, :3] = 0 if cells is None else cells
        given, index = (owned(buffer_of(gpu, "rows", r)) for r in rows)
        results = owned(Buffer(gpu, "results", rows[0].nbytes))
        made.dispatch(
            commands,
            (len(points),),
            lattice=ROOM.params(),
            given=given,
            cells=index,
            lattice_walls=cells_texture(ROOM, "rgba8snorm", walls),
            results=results,
        )
        commands.submit()
        return results.read().reshape(-1, 4)[:, :3].astype(np.float64)

    return evaluate


def plane_walls():
    """Walls through the whole lattice on every third face of each axis: texels, and shifts."""
    shifts = [np.zeros(n) for n in ROOM.count]
    texels = np.zeros((*ROOM.count[::-1], 4), np.int8)
    for axis, along in enumerate(shifts):
        along[1::3] = np.round(RNG.uniform(-0.45, 0.45, len(along[1::3])) * 127) / 127
        shape = [1, 1, 1]
        shape[2 - axis] = -1
        texels[..., axis] = np.round(along * 127).reshape(shape)
    return texels, shifts


def to_world(place):
    return np.array(ROOM.origin) + ROOM.cell * np.asarray(place)


def test_without_walls_space_is_straight(run):
    place = RNG.uniform(-1.0, 13.0, size=(100, 3))
    np.testing.assert_allclose(
        run("warped_coordinates(lattice, p)", 0, to_world(place)), place, atol=1e-4
    )


def test_walls_come_to_lie_on_faces(run):
    texels, shifts = plane_walls()
    faces, points = [], []
    for axis in range(3):
        for face in np.nonzero(shifts[axis])[0]:
            place = np.array(ROOM.count) * RNG.uniform(0.1, 0.9, 3)
            place[axis] = face + shifts[axis][face]
            faces.append((axis, face))
            points.append(place)
    warped = run("warped_coordinates(lattice, p)", texels, to_world(points))
    for (axis, face), place in zip(faces, warped, strict=True):
        assert place[axis] == pytest.approx(face, abs=1e-4)


def test_bending_keeps_the_order_of_places(run):
    texels, _ = plane_walls()
    along = np.linspace(0.01, 11.99, 400)
    for axis in range(3):
        place = np.full((400, 3), 3.3)
        place[:, axis] = along * ROOM.count[axis] / 12.0
        warped = run("warped_coordinates(lattice, p)", texels, to_world(place))[:, axis]
        assert (np.diff(warped) > 0.0).all()


def test_unbending_is_the_inverse(run):
    texels, _ = plane_walls()
    cells = np.floor(RNG.uniform(0, ROOM.count, size=(300, 3)))
    inside = RNG.uniform(0.02, 0.98, size=(300, 3))
    world = run("unwarped_point(lattice, c, p)", texels, inside, cells)
    warped = run("warped_coordinates(lattice, p)", texels, world)
    np.testing.assert_allclose(warped, cells + inside, atol=1e-4)


@pytest.mark.parametrize("is_known_before", [False, True])
def test_a_point_of_a_corner_is_looked_up_before_both_walls(run, is_known_before):
    # Walls a third of a cell behind faces 5 across x and y. The one across y is known everywhere,
    # the other only before that, or only behind it: once a point is before a wall, it stays there.
    texels = np.zeros((*ROOM.count[::-1], 4), np.int8)
    texels[:, 5, :, 1] = -42
    texels[:, slice(5, None) if is_known_before else slice(5), 5, 0] = -42
    place = np.array([[4.8, 4.8, 4.0]])
    warped = run("warped_lookup(lattice, p, vec3f(0.0, 0.0, 1.0))", texels, to_world(place))
    assert (warped[0, :2] > 5.0).all()
