"""The paper's geometry volume: what a wall that views see blocks and reflects."""

from __future__ import annotations

import numpy as np
import pytest

from airlight.lattice.blockers import Blockers
from airlight.lattice.placement import Placement
from airlight.lpv.geometry_volume import GeometryVolume
from airlight.scene import DirectionalLight, Material, PointLight, Scene
from airlight.surface.geometry import GpuScene
from airlight.surface.light_views import light_views
from airlight.surface.surfel_views import SurfelViews

N = 6
ROOM = Placement((0.0, 0.0, 0.0), 0.5, (N, N, N))
GREY = Material(base_color=(0.5, 0.5, 0.5), two_sided=True)
SIDE = 128


@pytest.fixture
def shares(gpu, commands, owned, square):
    """shares(lights, x) -> (closed, reflected) (6, Z, Y, X) of a wall in the plane x, facing +x."""

    def solve(lights, x=1.5, *, accumulates=False, then=None):
        scene = Scene(meshes=(square((x, 1.5, 1.5), (0, 1.6, 0), (0, 0, 1.6), GREY),))
        meshes = owned(GpuScene(gpu, scene))
        blockers = owned(Blockers(gpu, scene, meshes, ROOM, 1))
        volume = owned(GeometryVolume(gpu, blockers, accumulates=accumulates))
        low, high = np.zeros(3), np.full(3, 3.0)
        for seen in (lights, then or lights):
            views = light_views(seen, low, high, SIDE)
            maps = owned(SurfelViews(gpu, SIDE, len(views), 1))
            maps.encode(commands, meshes, views)
            before = blockers.version
            assert volume.encode(commands, meshes, maps, views, is_drawn=True)
            assert blockers.version == before + 1
            assert not volume.encode(commands, meshes, maps, views, is_drawn=False)
            assert blockers.version == before + 1
        commands.submit()
        words = blockers.faces.read(np.uint32).reshape(N, N, N, 8)
        leaving = np.moveaxis(words[..., :6], -1, 0)
        return (leaving >> 24) / 255.0, (leaving & 255) / 255.0

    return solve


def sun(x, y=0.0, z=0.0):
    return DirectionalLight((x, y, z), (1, 1, 1))


INNER = slice(1, -1)


@pytest.mark.parametrize(
    "lights",
    [[sun(-1.0)], [sun(-1.0, -0.7, 0.3)], [PointLight((2.8, 1.4, 1.6), (1, 1, 1))]],
)
def test_a_seen_wall_is_three_quarters_closed_from_its_side(shares, lights):
    # two bands of a clamped cosine hold 1/4 + 1/2 of it
    closed, reflected = shares(lights)
    from_front = closed[1, INNER, INNER, 3]
    np.testing.assert_allclose(from_front.mean(), 0.75, atol=0.03)
    np.testing.assert_allclose(reflected[1, INNER, INNER, 3], 0.5 * from_front, atol=0.02)
    # from behind it is open, along it 1/4 closed: two bands cannot do better
    assert not closed[0, INNER, INNER, 2].any()
    np.testing.assert_allclose(closed[2, INNER, INNER, 3].mean(), 0.125, atol=0.02)
    assert not closed[..., 5].any()


def test_a_wall_seen_twice_does_not_block_twice(shares):
    once, _ = shares([sun(-1.0)])
    twice, _ = shares([sun(-1.0), sun(-1.0, 0.4)])
    np.testing.assert_allclose(
        twice[1, INNER, INNER, 3].mean(), once[1, INNER, INNER, 3].mean(), atol=0.03
    )


def test_what_no_view_sees_does_not_block_unless_it_is_kept(shares):
    away = [sun(0.0, 1.0)]
    assert not shares(away)[0][1].any()
    assert shares([sun(-1.0)], accumulates=True, then=away)[0][1, INNER, INNER, 3].mean() > 0.7
    assert not shares([sun(-1.0)], accumulates=False, then=away)[0][1].any()


def test_memory_is_given_back(gpu, owned, square):
    scene = Scene(meshes=(square((1, 1, 1), (0, 1, 0), (0, 0, 1), GREY),))
    blockers = owned(Blockers(gpu, scene, owned(GpuScene(gpu, scene)), ROOM, 1))
    before = gpu.allocated_bytes
    scope = gpu.scope()
    made = GeometryVolume(scope, blockers, accumulates=True)
    assert gpu.allocated_bytes > before
    scope.release()
    assert gpu.allocated_bytes == before
    del made  # it was there all the time
