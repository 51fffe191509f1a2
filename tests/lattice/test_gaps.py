"""How many lattices are nested without being asked for: gaps between surfaces, and scenes."""

from __future__ import annotations

import numpy as np
import pytest

import airlight
from airlight.lattice.facing import wall_axes
from airlight.lattice.gaps import MOST, narrow_gap, nested_count
from airlight.lattice.placement import STRAIGHT
from airlight.lighting.cascades import cascades_nest
from airlight.lpv.settings import LpvSettings
from airlight.rendering import Renderer
from airlight.scene import Camera, DirectionalLight, Geometry, Mesh, Scene, shapes

SMALL = {"map_resolution": 64, "shadow_resolution": 64, "surfels": 20_000, "iterations": 8}


def box(low, high, turn=None):
    """A closed box between two corners, turned about the origin."""
    low, high = np.array(low, float), np.array(high, float)
    unit = shapes.box()
    linear = np.eye(3) if turn is None else turn
    matrix = np.eye(4)
    matrix[:3, :3] = linear * (0.5 * (high - low) / np.abs(unit.positions).max())
    matrix[:3, 3] = linear @ (0.5 * (low + high))
    return Mesh(unit, world_from_object=matrix)


def about_y(degrees):
    a = np.radians(degrees)
    return np.array([[np.cos(a), 0, np.sin(a)], [0, 1, 0], [-np.sin(a), 0, np.cos(a)]])


def corridor(turn=None, width=2.0):
    """Two thick walls `width` apart: what is inside them is no gap."""
    half = 0.5 * width
    return (
        box((-half - 1.0, 0, -5), (-half, 3, 5), turn),
        box((half, 0, -5), (half + 1.0, 3, 5), turn),
    )


def yard(ground=40.0, height=3.0):
    """A roof on two walls `height` above a ground of 2 * `ground` metres."""
    return (
        box((-ground, -0.5, -ground), (ground, 0.0, ground)),
        box((-6, height, -6), (6, height + 2, 6)),
        box((-6, 0, -6), (-5, height, 6)),
        box((5, 0, -6), (6, height, 6)),
    )


def lit(meshes, position=(0.0, 1.7, -4.0)):
    sun = DirectionalLight((0.3, -1.0, 0.4), (10.0, 10.0, 10.0))
    return Scene(meshes=meshes, lights=(sun,), camera=Camera(position, (0.0, 1.5, 5.0)))


@pytest.mark.parametrize("degrees", [0.0, 30.0])
def test_a_gap_is_as_wide_as_the_way_between_walls_and_not_through_them(degrees):
    meshes = corridor(about_y(degrees))
    assert narrow_gap(meshes, wall_axes(meshes)) == pytest.approx(2.0, abs=1e-4)


def test_how_surfaces_are_cut_and_where_they_are_changes_little():
    whole = yard()
    gap = narrow_gap(whole, STRAIGHT)
    assert gap == pytest.approx(3.0, abs=0.01)
    cut = tuple(
        Mesh(Geometry(m.geometry.positions, part), world_from_object=m.world_from_object)
        for m in whole
        for part in (m.geometry.indices[::2], m.geometry.indices[1::2])
    )
    assert narrow_gap(cut, STRAIGHT) == pytest.approx(gap, rel=0.02)
    far = [m.world_from_object.copy() for m in whole]
    for matrix in far:
        matrix[:3, 3] += (900.0, 40.0, -700.0)
    moved = tuple(Mesh(m.geometry, world_from_object=p) for m, p in zip(whole, far, strict=True))
    assert narrow_gap(moved, STRAIGHT) == pytest.approx(gap, rel=0.02)


def test_small_things_close_together_do_not_count():
    # A hundred plates a hand apart have ten times the walls' area, and a fifteenth of their air.
    plates = tuple(box((-0.8, 1.0 + 0.02 * k, -1), (0.8, 1.005 + 0.02 * k, 1)) for k in range(100))
    assert narrow_gap((*corridor(), *plates), STRAIGHT) > 0.5


def test_surfaces_that_face_nothing_have_no_gap():
    assert narrow_gap((), STRAIGHT) == np.inf
    assert narrow_gap((box((-1, -1, -1), (1, 1, 1)),), STRAIGHT) == np.inf


def test_gaps_of_less_than_two_cells_get_four():
    gaps = (np.inf, 2.0, 1.99, 1.0, 0.99)
    assert [nested_count(gap, 1.0, 2.0) for gap in gaps] == [1, 1, 3, 3, 4]
    assert nested_count(0.01, 1.0, 2.0) == MOST
    assert nested_count(1.0, 1.0, 4.0) == 2


@pytest.mark.parametrize("name", ["cornell", "room", "atrium", "wall-floor", "cloud"])
def test_rooms_keep_one_lattice(name):
    assert len(cascades_nest(airlight.load(f"builtin:{name}"), LpvSettings()).levels) == 1


def test_a_large_ground_nests_lattices_and_settings_have_the_last_word():
    scene = lit(yard())
    nest = cascades_nest(scene, LpvSettings())
    assert nest.levels[0].cell <= 0.75 < 1.5 < nest.levels[-1].cell
    for count in (1, 2):
        asked = cascades_nest(scene, LpvSettings(cascades=count))
        assert len(asked.levels) == count
    assert len(cascades_nest(lit(yard(ground=8.0)), LpvSettings()).levels) == 1


@pytest.mark.parametrize("technique", ["lpv", "auto"])
def test_the_number_is_the_scenes_and_not_the_cameras(gpu, technique):
    scene = lit(yard())
    with Renderer(scene, technique, (32, 18), settings=SMALL) as renderer:
        count = len(renderer.stats()["cascades"])
        for position in ((0.0, 1.7, -4.0), (0.0, 30.0, -39.0), (38.0, 1.0, 38.0)):
            image = renderer.frame(camera=Camera(position, (0.0, 1.0, 0.0)))
            assert np.isfinite(image.radiance).all() and image.radiance.mean() > 0.0
            assert len(renderer.stats()["cascades"]) == count
    assert count == 3
