"""What lattices cover: surfaces, what the settings say, and the medium that is filled."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import airlight
from airlight.errors import SettingsError
from airlight.gpu.device import Gpu
from airlight.lattice.nested import Box, nested
from airlight.lattice.placement import STRAIGHT, fitted
from airlight.lighting.lattice_box import (
    MEDIUM_BEYOND,
    lattice_box,
    lattice_extent,
    medium_around,
)
from airlight.maths.transforms import box_along
from airlight.scene import Camera, Environment, Medium, Mesh, Scene
from airlight.scene.animation import Animation
from airlight.scene.animation.curve import Curve
from airlight.scene.animation.tracks import CameraTrack
from airlight.scene.material import Material
from airlight.scene.medium import medium_box
from airlight.scene.placing import moved_camera
from airlight.scene.shapes import box

FOG = Medium((0.3, 0.3, 0.3))
OUTSIDE = Camera((1.0, 0.5, 1.4), (0.0, 0.0, 0.0))
SMALL = {"resolution": 12, "sky_lights": 16, "sky_resolution": 32, "surfels": 10_000}
CUBE = Scene((Mesh(box(), Material()),), camera=OUTSIDE)


@pytest.mark.parametrize(
    ("bounds", "message"),
    [
        ((0.0, 1.0), "setting bounds has 2 numbers. Give x0,y0,z0,x1,y1,z1"),
        (
            (0.0, 0.0, 0.0, 1.0, 0.0, 1.0),
            "setting bounds is empty: [0.0, 0.0, 0.0] to [1.0, 0.0, 1.0]",
        ),
    ],
)
def test_bad_bounds_are_refused(bounds, message):
    with pytest.raises(SettingsError) as caught:
        lattice_box(Scene(), bounds)
    assert str(caught.value) == message


def test_bounds_of_the_settings_have_the_last_word():
    given = (-9.0, -9.0, -9.0, -8.0, -8.0, -8.0)
    assert lattice_box(replace(CUBE, medium=FOG), given, in_medium=True) == (given[:3], given[3:])


def test_surfaces_alone_where_the_lattice_holds_no_light_in_the_medium():
    np.testing.assert_allclose(lattice_box(replace(CUBE, medium=FOG)), [[-0.5] * 3, [0.5] * 3])


def test_fog_without_bounds_is_covered_up_to_a_camera_outside():
    low, high = lattice_box(replace(CUBE, medium=FOG), in_medium=True)
    np.testing.assert_allclose(low, -0.5)  # a hair beyond the walls is none
    np.testing.assert_allclose(high, [1.0, 0.5, 1.4], atol=0.01)


def test_a_camera_inside_changes_nothing():
    inside = replace(CUBE, medium=FOG, camera=Camera((0.1, 0.1, 0.1), (0.0, 0.0, 0.0)))
    np.testing.assert_array_equal(lattice_box(inside, in_medium=True), inside.bounds)


def test_explicit_bounds_of_the_same_box_are_the_same():
    filled = medium_box(FOG, *CUBE.bounds, OUTSIDE.position)
    explicit = replace(CUBE, medium=replace(FOG, bounds=filled))
    np.testing.assert_allclose(
        lattice_box(explicit, in_medium=True),
        lattice_box(replace(CUBE, medium=FOG), in_medium=True),
    )


def test_fog_for_miles_does_not_take_all_cells():
    wide = replace(FOG, bounds=((-1000.0,) * 3, (1000.0,) * 3))
    low, high = lattice_box(replace(CUBE, medium=wide), in_medium=True)
    np.testing.assert_allclose([low, high], [[-0.5 - MEDIUM_BEYOND] * 3, [0.5 + MEDIUM_BEYOND] * 3])


def around(scene: Scene, bounds: tuple[float, ...] = (), turn_rad: float = 0.0) -> Box | None:
    """What is covered beside the lattice of the scene's surfaces, of 16 cells a side."""
    c, s = np.cos(turn_rad), np.sin(turn_rad)
    axes = ((c, 0.0, -s), (0.0, 1.0, 0.0), (s, 0.0, c))
    low, high, resolution = lattice_extent(scene, (), 16, in_medium=True, axes=axes)
    whole = fitted(low, high, resolution, axes)
    return medium_around(scene, bounds, nested(low, high, resolution, whole=whole))


@pytest.mark.parametrize("turn_rad", [0.0, 0.3, 0.6])
def test_fog_up_to_the_camera_needs_no_lattice_more(turn_rad):
    """In lattices that are turned with the walls neither."""
    for eye in (OUTSIDE, Camera((0.1, 0.1, 0.1), (0.0, 0.0, 0.0))):
        assert around(replace(CUBE, medium=FOG, camera=eye), turn_rad=turn_rad) is None


def test_fog_around_the_surfaces_lattice_is_covered_as_far_as_it_is_seen():
    wide = replace(FOG, bounds=((-9.0, -8.0, -7.0), (1000.0, 8.0, 7.0)))
    scene = replace(CUBE, medium=wide)
    # As far as ten optical depths from the surfaces and from the eye.
    far = OUTSIDE.position[0] + 10.0 / 0.3
    np.testing.assert_allclose(around(scene), [[-9.0, -8.0, -7.0], [far, 8.0, 7.0]])
    # An eye beside the fog looks into it where it is near.
    beside = replace(scene, camera=Camera((300.0, 20.0, 0.0), (0.0, 0.0, 0.0)))
    assert around(beside)[1][0] == pytest.approx(300.0 + 10.0 / 0.3)
    assert around(scene, (-1, -1, -1, 1, 1, 1)) is None


def test_the_fog_is_covered_wherever_the_camera_goes():
    path = Curve((0.0, 1.0), ((0.0, 0.0, 0.4), (0.0, 1.2, 0.4)))
    moving = replace(
        CUBE,
        medium=FOG,
        camera=Camera((0.0, 0.0, 0.4)),
        animation=Animation((CameraTrack({"position": path}),)),
    )
    _, high = lattice_box(moving, in_medium=True)
    assert high[1] == pytest.approx(1.2, abs=0.01)


def test_images_with_and_without_bounds_are_the_same(gpu: Gpu):
    open_fog = replace(CUBE, medium=FOG, environment=Environment((1.0, 1.0, 1.0)))
    filled = medium_box(FOG, *CUBE.bounds, OUTSIDE.position)
    explicit = replace(open_fog, medium=replace(FOG, bounds=filled))
    images = [
        airlight.render(scene, technique, size=(24, 16), settings=SMALL, samples=1)
        for technique in ("single", "lpv-scatter")
        for scene in (open_fog, explicit)
    ]
    for first, second in (images[:2], images[2:]):
        np.testing.assert_allclose(second.radiance, first.radiance, rtol=2e-3, atol=1e-4)


def test_what_the_fog_before_an_object_scatters_many_times_is_there(gpu: Gpu, tmp_path: Path):
    """As the README's own room.toml: fog without bounds, seen from outside the model.

    Mitsuba 3.9.1, 64x36, 256 samples: mean of all 2.633, of the scattered light 2.453.
    """
    file = tmp_path / "room.toml"
    file.write_text(ROOM, encoding="utf-8")
    scene = airlight.load(file)
    settings = {"resolution": 24, "shadow_resolution": 512, "sky_lights": 32, "surfels": 20_000}
    image = airlight.render(scene, "lpv-scatter", size=(64, 36), settings=settings, samples=4)
    scattered = image.layers["single_scatter"] + image.layers["multiple_scatter"]
    assert image.radiance.mean() == pytest.approx(2.633, rel=0.06)
    assert scattered.mean() == pytest.approx(2.453, rel=0.06)


ROOM = """
[camera]
position = [3.5745, 3.1747, 6.499]
target = [0.0, 0.9, 0.0]
fov_y_deg = 40.0
[[mesh]]
shape = "box"
scale = [4, 0.2, 4]
base_color = 0.6
translate = [0, -0.1, 0]
[[mesh]]
shape = "box"
scale = [1, 2, 1]
translate = [-0.8, 1, -0.5]
base_color = [0.8, 0.5, 0.3]
[[mesh]]
shape = "sphere"
translate = [0.8, 0.5, 0.6]
base_color = [0.3, 0.5, 0.8]
[[light]]
type = "directional"
direction = [0.3, -0.62, 0.72]
irradiance = [30, 27, 22]
[environment]
radiance = [0.5, 0.7, 1.0]
[medium]
sigma_s = 0.3
"""


def test_a_turned_lattice_covers_the_box_of_the_world_that_a_medium_fills():
    """Fog without bounds fills the corners beside a room aslant; the sun lights them."""
    c, s = np.cos(0.6), np.sin(0.6)
    axes = ((c, 0.0, -s), (0.0, 1.0, 0.0), (s, 0.0, c))
    low, high = lattice_box(replace(CUBE, medium=FOG), in_medium=True, axes=axes)
    eye = np.array(CUBE.camera.position)
    least, most = medium_box(FOG, [-0.5] * 3, [0.5] * 3, eye)
    wanted = box_along(np.array(axes), least, most)
    # As far as MEDIUM_BEYOND times the surfaces' longest side beyond them; the camera is nearer.
    np.testing.assert_allclose((low, high), wanted, atol=0.02)


def test_a_turned_lattice_is_the_straight_one_and_whole_cells_around_it():
    c, s = np.cos(0.6), np.sin(0.6)
    axes = ((c, 0.0, -s), (0.0, 1.0, 0.0), (s, 0.0, c))
    turn, straight = np.array(axes), replace(CUBE, medium=FOG)
    # The straight scene through the inverse of what turns the world to the axes.
    matrix = np.eye(4)
    matrix[:3, :3] = turn.T
    turned = replace(
        straight,
        meshes=tuple(replace(m, world_from_object=matrix) for m in straight.meshes),
        camera=moved_camera(straight.camera, matrix),
    )
    upright = fitted(*lattice_box(straight, in_medium=True), 32)
    low, high, resolution = lattice_extent(turned, (), 32, in_medium=True, axes=axes)
    found = fitted(low, high, resolution, axes)
    assert resolution > 32
    assert found.cell == pytest.approx(upright.cell, rel=1e-9)
    steps = (np.array(upright.origin) - found.origin) / found.cell
    np.testing.assert_allclose(steps, np.round(steps), atol=1e-6)
    # It covers the box of the world that the medium fills, to a hundredth of a cell.
    least, most = lattice_box(turned, in_medium=True, axes=axes)
    slack = 0.01 * found.cell
    assert (np.array(found.origin) <= least + slack).all()
    assert (np.array(found.origin) + found.cell * np.array(found.count) >= most - slack).all()
    # Without a medium, and along the world's axes, nothing is added.
    assert lattice_extent(CUBE, (), 32, in_medium=True, axes=axes)[2] == 32
    assert lattice_extent(turned, (), 32, in_medium=True, axes=STRAIGHT)[2] == 32
