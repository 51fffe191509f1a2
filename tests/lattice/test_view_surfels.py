"""What views see of a wall blocks as its area says: coloured, once, and from the side they see."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest

from airlight.lattice.blockers import Blockers
from airlight.lattice.placement import Placement
from airlight.lattice.view_surfels import ViewSurfels
from airlight.scene import DirectionalLight, Material, PointLight, Scene
from airlight.surface.geometry import GpuScene
from airlight.surface.light_views import light_views
from airlight.surface.surfel_views import SurfelViews

N = 6
ROOM = Placement((0.0, 0.0, 0.0), 0.5, (N, N, N))
PAINT = Material(base_color=(0.8, 0.4, 0.2), specular=0.0, two_sided=True)
SIDE = 128
INNER = slice(1, -1)


@pytest.fixture
def shares(gpu, commands, owned, square):
    """shares(lights, x in metres ...) -> closed (6, Z, Y, X), reflected (6, Z, Y, X, 3), walls.

    Walls face +x; x may be (x, half side).
    """

    def solve(lights, *walls, peels=1, accumulates=False, has_meshes=False, then=None):
        sides = [x if isinstance(x, tuple) else (x, 1.6) for x in walls]
        meshes = tuple(square((x, 1.5, 1.5), (0, h, 0), (0, 0, h), PAINT) for x, h in sides)
        scene = Scene(meshes=meshes)
        on_device = owned(GpuScene(gpu, scene))
        blockers = owned(Blockers(gpu, scene, on_device, ROOM, 20_000))
        made = owned(ViewSurfels(gpu, blockers, accumulates=accumulates, has_meshes=has_meshes))
        low, high = np.zeros(3), np.full(3, 3.0)
        for seen in (lights, then or lights):
            views = light_views(seen, low, high, SIDE)
            if views:
                # The first view is the camera's, a buffer of its own.
                views = [dataclasses.replace(views[0], light=-1), *views]
            maps = owned(SurfelViews(gpu, SIDE, len(views), peels))
            maps.encode(commands, on_device, views)
            made.encode(commands, on_device, maps, views, is_drawn=True)
        commands.submit()
        words = blockers.faces.read(np.uint32).reshape(N, N, N, 8)
        leaving = np.moveaxis(words[..., :6], -1, 0)
        rgb = np.stack([leaving >> shift & 255 for shift in (0, 8, 16)], axis=-1) / 255.0
        shifts = np.maximum(blockers.walls.read()[..., :3] / 127.0, -1.0)
        return (leaving >> 24) / 255.0, rgb, shifts

    return solve


def sun(x, y=0.0, z=0.0):
    return DirectionalLight((x, y, z), (1, 1, 1))


@pytest.mark.parametrize(
    "lights", [[sun(-1.0)], [sun(-1.0, -0.7, 0.3)], [PointLight((2.8, 1.4, 1.6), (1, 1, 1))]]
)
def test_a_seen_wall_is_closed_and_coloured_from_the_side_that_is_seen(shares, lights):
    closed, reflected, walls = shares(lights, 1.6)
    front = np.s_[INNER, INNER, 3]
    np.testing.assert_allclose(closed[1][front], 1.0, atol=0.01)
    np.testing.assert_allclose(
        reflected[1][front], np.broadcast_to(PAINT.base_color, (4, 4, 3)), atol=0.015
    )
    # Open from behind and along it, which spherical harmonics cannot be.
    assert not closed[0].any()
    assert not closed[2:].any()
    # 1.6 m is a fifth of a cell beyond the face at 1.5 m.
    np.testing.assert_allclose(walls[front][..., 0], 0.2, atol=0.02)


def test_a_small_square_covers_its_area(shares):
    # Times 1.5, which closes walls between two layers of corners (lattice/face_visibility.wgsl).
    closed, _, _ = shares([sun(-1.0, 0.2)], (1.5, 0.2))
    covered = (0.4 / ROOM.cell) ** 2
    assert closed[1].sum() == pytest.approx(1.5 * covered, rel=0.04)


def test_several_buffers_that_see_a_wall_close_it_once(shares):
    once = shares([sun(-1.0, 0.2)], (1.5, 0.2))
    for more in ([sun(-1.0, 0.2), sun(-1.0, 0.4)], [sun(-1.0, 0.2)] * 3):
        again = shares(more, (1.5, 0.2))
        assert again[0][1].sum() == pytest.approx(once[0][1].sum(), rel=0.1)
        np.testing.assert_allclose(again[1].max(), once[1].max(), atol=0.03)


def test_the_faces_of_a_lights_cube_are_one_buffer(shares):
    # Half of the square lies in one face of the cube, half in the next.
    closed, _, _ = shares([PointLight((1.75, 1.25, 1.5), (1, 1, 1))], (1.5, 0.2))
    assert closed[1].sum() == pytest.approx(1.5 * (0.4 / ROOM.cell) ** 2, rel=0.05)


def test_layers_behind_each_other_are_peeled(shares):
    one, two = (shares([sun(-1.0)], 2.5, 1.0, peels=count)[0] for count in (1, 2))
    assert one[1, INNER, INNER, 5].min() > 0.98
    assert not one[1, ..., 2].any()
    assert two[1, INNER, INNER, 2].min() > 0.98


def test_what_no_view_sees_is_open_unless_kept_or_known_of_meshes(shares):
    away = [sun(0.0, 1.0)]
    wall = np.s_[1, INNER, INNER, 3]
    assert not shares(away, 1.5)[0].any()
    assert not shares([sun(-1.0)], 1.5, then=away)[0].any()
    assert shares([sun(-1.0)], 1.5, then=away, accumulates=True)[0][wall].min() > 0.98
    closed, reflected, _ = shares(away, 1.5, has_meshes=True)
    assert closed[wall].min() > 0.98
    np.testing.assert_allclose(reflected[wall].mean(axis=(0, 1)), PAINT.base_color, atol=0.01)
