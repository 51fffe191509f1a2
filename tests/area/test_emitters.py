"""What is found to be a light with extent, how it is grouped, and what its samples carry."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from airlight.area.emitters import Emitters
from airlight.area.grouping import BUDGET
from airlight.area.pieces import parts_and_bodies
from airlight.area.shapes import Kind
from airlight.maths.light_sizes import rectangle_angle
from airlight.scene import AreaLight, Camera, Material, Mesh, PointLight, Scene, SpotLight, Texture
from airlight.scene.light_shapes import LightMeshes
from airlight.scene.lights import LightSample
from airlight.scene.shapes import box, quad, sphere

GLOW = Material(emission=(3.0, 2.0, 1.0), two_sided=False)


def at(x: float, y: float = 0.0, z: float = 0.0, scale: float = 1.0) -> np.ndarray:
    placed = np.diag((scale, scale, scale, 1.0))
    placed[:3, 3] = (x, y, z)
    return placed


def emitters(*meshes: Mesh, lights=(), samples: int = 16, most: int = 32) -> Emitters:
    scene = Scene(meshes=meshes, lights=tuple(lights), camera=Camera((0, 0, 50), (0, 0, 0)))
    found = Emitters(scene, samples=samples, most=most)
    found.of(scene)
    return found


def power(found: Emitters) -> np.ndarray:
    """W, of all samples."""
    return np.sum([s.light.power for e in found.list for s in e.samples], axis=0)


def test_a_panel_is_one_polygon_with_its_power() -> None:
    found = emitters(Mesh(quad(), GLOW, at(1.0, scale=2.0)))
    (panel,) = found.list
    assert panel.shape.kind == Kind.POLYGON
    assert panel.shape.corners is not None
    assert len(panel.shape.corners) == 4
    np.testing.assert_allclose(panel.shape.radiance, GLOW.emission)
    np.testing.assert_allclose(panel.shape.normal, (0, 1, 0), atol=1e-9)
    np.testing.assert_allclose(power(found), np.pi * 4.0 * np.array(GLOW.emission))
    # Sixteen squares: four places along each side.
    places = np.array([s.light.position for s in panel.samples])
    assert len(places) == 16
    for axis in (0, 2):
        assert len(np.unique(np.round(places[:, axis], 6))) == 4


def test_half_of_a_panels_samples_know_all_of_it() -> None:
    (panel,) = emitters(Mesh(quad(), GLOW)).list
    places = np.array([s.light.position for s in panel.samples])[:8, [0, 2]]
    # As on a chessboard: two in each row, in each column and in each quarter.
    for axis in (0, 1):
        _, counts = np.unique(np.round(places[:, axis], 6), return_counts=True)
        assert (counts == 2).all()
    assert (np.unique(places > 0.0, axis=0, return_counts=True)[1] == 2).all()


def test_both_sides_of_a_sheet_are_lights_and_the_outside_of_a_body() -> None:
    both = replace(GLOW, two_sided=True)
    sheet = emitters(Mesh(quad(), both))
    assert sorted(e.shape.normal[1] for e in sheet.list) == [-1.0, 1.0]
    ball = emitters(Mesh(sphere(), both))
    (found,) = ball.list
    assert found.shape.kind == Kind.SPHERE
    assert found.shape.radius == pytest.approx(0.5, rel=5e-3)
    cube = emitters(Mesh(box(), both))
    outwards = [e.shape.normal @ e.shape.centre for e in cube.list]
    assert len(outwards) == 6
    assert min(outwards) > 0.4


def test_an_eye_within_a_body_sees_its_inside() -> None:
    body = Mesh(box(), replace(GLOW, two_sided=True), at(0.0, scale=10.0))
    scene = Scene(meshes=(body,), camera=Camera((0, 0, 1), (0, 0, 0)))
    found = Emitters(scene, samples=16, most=32)
    found.of(scene)
    assert max(e.shape.normal @ e.shape.centre for e in found.list) < -4.0


def test_many_lights_are_fewer_with_the_same_power() -> None:
    windows = [
        Mesh(quad(), GLOW, at(2.0 * (k % 50), 0.0, 2.0 * (k // 50), 0.5)) for k in range(500)
    ]
    found = emitters(*windows)
    assert found.count == 32
    assert found.sample_count <= BUDGET * 16
    np.testing.assert_allclose(power(found), np.pi * 0.25 * 500 * np.array(GLOW.emission))


def test_a_string_of_bulbs_keeps_its_power_and_sends_to_all_sides() -> None:
    ball = sphere(8, 4)
    bulbs = [Mesh(ball, GLOW, at(0.5 * k, 0.1 * (k % 3), 0.0, 0.1)) for k in range(100)]
    found = emitters(*bulbs)
    areas = 100.0 * 0.01 * _area(ball)
    np.testing.assert_allclose(power(found), np.pi * areas * np.array(GLOW.emission), rtol=1e-6)
    assert any(s.is_cube for e in found.list for s in e.samples)


def _area(geometry) -> float:
    a, b, c = (geometry.positions[geometry.indices[:, k]].astype(float) for k in range(3))
    return float(0.5 * np.linalg.norm(np.cross(b - a, c - a), axis=1).sum())


def test_a_texture_says_where_the_light_is() -> None:
    pixels = np.zeros((8, 8, 4), np.uint8)
    pixels[:, 6:] = 255
    screen = Material(emission=(1, 1, 1), emission_texture=Texture(pixels), two_sided=False)
    found = emitters(Mesh(quad(), screen))
    places = np.array([s.light.position for e in found.list for s in e.samples])
    assert places[:, 0].min() > 0.2
    # A quarter of the square glows; pieces on its edge belong to it as far as they are in it.
    assert power(found)[0] == pytest.approx(np.pi * 0.25, rel=0.05)


def test_lattices_and_media_see_points_of_the_same_power() -> None:
    lights = [AreaLight((0, 2, 0), 5.0, size=(1.0, 2.0)), PointLight((3, 1, 0), 2.0)]
    scene = Scene(meshes=(Mesh(quad(), GLOW),), lights=tuple(lights))
    found = Emitters(scene, samples=16, most=32)
    seen = found.of(scene)
    assert seen.lights[0] is lights[1]
    assert found.plain == 1
    total = np.sum([x.power for x in seen.lights if isinstance(x, LightSample)], axis=0)
    expected = np.pi * (np.array(GLOW.emission) + 10.0)
    np.testing.assert_allclose(total, expected, rtol=1e-6)


def test_points_and_spots_with_a_radius_are_spheres() -> None:
    spot = SpotLight((0, 3, 0), (0, -1, 0), 8.0, radius=0.2)
    found = emitters(lights=[PointLight((1, 1, 0), 2.0, radius=0.1), spot])
    ball, cone = found.list
    assert (ball.shape.kind, cone.shape.kind) == (Kind.SPHERE, Kind.SPHERE)
    assert cone.spot is spot
    np.testing.assert_allclose(ball.shape.radiance, 2.0 / (np.pi * 0.01), rtol=1e-6)
    np.testing.assert_allclose(power(found)[0] > 0.0, True)


def test_lights_move_and_dim_from_frame_to_frame() -> None:
    light = AreaLight((0, 2, 0), 5.0)
    scene = Scene(lights=(light,))
    found = Emitters(scene, samples=4, most=32)
    found.of(scene)
    before, version = found.list[0], found.version
    found.of(replace(scene, lights=(replace(light, position=(1, 2, 0), radiance=0.0),)))
    assert found.version > version
    np.testing.assert_allclose(
        found.list[0].shape.centre - before.shape.centre, (1, 0, 0), atol=1e-12
    )
    assert found.list[0].shape.radiance.max() == 0.0
    np.testing.assert_allclose(
        np.subtract(found.list[0].samples[2].light.position, before.samples[2].light.position),
        (1, 0, 0),
        atol=1e-12,
    )
    # As it was before: a frame depends on nothing else.
    found.of(scene)
    np.testing.assert_array_equal(found.list[0].shape.corners, before.shape.corners)


def test_samples_of_a_still_differ_and_stay_on_the_light() -> None:
    found = emitters(lights=[AreaLight((0, 2, 0), 5.0, size=(1.0, 1.0))])
    first, later = found.jittered(0)[0], found.jittered(3)[0]
    a, b = (np.array([s.light.position for s in e.samples]) for e in (first, later))
    assert np.abs(a - b).max() > 0.01
    assert np.abs(b[:, [0, 2]]).max() <= 0.5
    np.testing.assert_allclose(b[:, 1], 2.0)


def test_parts_end_at_folds() -> None:
    assert len(np.unique(parts_and_bodies(box())[0])) == 6
    assert len(np.unique(parts_and_bodies(sphere(16, 8))[0])) == 1


def test_visible_lights_have_surfaces() -> None:
    lights = (AreaLight((0, 2, 0), 5.0), AreaLight((0, 3, 0), 1.0, "disk", visible=False))
    made = LightMeshes()
    scene = Scene(lights=lights)
    shown = made.of(scene)
    assert len(shown.meshes) == 1
    assert made.of(scene).meshes is shown.meshes
    assert shown.meshes[0].material.emission == (5.0, 5.0, 5.0)


def test_what_is_among_bulbs_shadows_them_and_no_bulb_itself() -> None:
    """A sample stands in one bulb, of however many, and what is outside of that hides it."""
    ball = sphere(16, 8)
    bulbs = [Mesh(ball, GLOW, at(0.5 * k, 0.3 * (k % 3), 0.0, 0.1)) for k in range(60)]
    found = emitters(*bulbs)
    seen = found.of(Scene(meshes=tuple(bulbs)))
    reach = np.array([x.near for x in seen.lights if isinstance(x, LightSample)])
    assert reach.max() <= 0.2
    assert max(s.near for e in found.list for s in e.samples) <= 0.2
    (alone,) = emitters(bulbs[0]).of(Scene(meshes=(bulbs[0],))).lights
    radius = 0.1 * np.abs(ball.positions).max(axis=0)
    np.testing.assert_allclose(alone.near, radius, rtol=1e-6)


@pytest.mark.parametrize("two_sided", [False, True])
def test_a_light_cut_into_meshes_is_the_same_light(two_sided) -> None:
    """Every other triangle of a ball, and a panel in two triangles, whatever their transforms."""
    material = replace(GLOW, two_sided=two_sided)
    for whole in (sphere(16, 8), quad()):
        halves = [replace(whole, indices=whole.indices[first::2]) for first in (0, 1)]
        one = emitters(Mesh(whole, material, at(1.0, 2.0, 0.5, 0.3)))
        mirrored = replace(
            halves[1],
            positions=halves[1].positions * (-1, 1, 1),
            indices=halves[1].indices[:, ::-1],
        )
        turned = at(1.0, 2.0, 0.5, 0.3) @ np.diag((-1.0, 1.0, 1.0, 1.0))
        cut = emitters(
            Mesh(halves[0], material, at(1.0, 2.0, 0.5, 0.3)), Mesh(mirrored, material, turned)
        )
        assert len(cut.list) == len(one.list)
        assert {e.shape.kind for e in cut.list} == {e.shape.kind for e in one.list}
        np.testing.assert_allclose(power(cut), power(one), rtol=1e-5)


def test_lights_of_other_colours_stay_apart_where_they_meet() -> None:
    other = replace(GLOW, emission=(1.0, 2.0, 3.0))
    found = emitters(Mesh(quad(), GLOW), Mesh(quad(), other, at(1.0)))
    assert len(found.list) == 2


def test_tiles_that_meet_and_glow_differently_later_are_samples() -> None:
    tiles = tuple(Mesh(quad(), GLOW, at(x)) for x in (0.0, 1.0))
    scene = Scene(meshes=tiles, camera=Camera((0, 0, 50), (0, 0, 0)))
    found = Emitters(scene, samples=16, most=32)
    found.of(scene)
    assert [e.shape.kind for e in found.list] == [Kind.POLYGON]
    dark = replace(tiles[1], material=replace(GLOW, emission=(0.0, 0.0, 0.0)))
    found.of(replace(scene, meshes=(tiles[0], dark)))
    (tile,) = found.list
    assert tile.shape.kind == Kind.SAMPLES
    sent = np.array([s.light.power[0] for s in tile.samples])
    where = np.array([s.light.position[0] for s in tile.samples])
    assert sent[where > 0.5].sum() == pytest.approx(0.0, abs=1e-9)
    assert sent.sum() == pytest.approx(np.pi * GLOW.emission[0], rel=1e-6)


def test_the_inside_of_a_glowing_ball_is_all_around() -> None:
    """Solid angles of what stands for it in media, from its middle and off it, as bright as it."""
    ball = Mesh(sphere(48, 24), replace(GLOW, two_sided=True), at(0.0, scale=4.0))
    scene = Scene(meshes=(ball,), camera=Camera((0.1, 0, 0), (0, 0, -1)))
    seen = Emitters(scene, samples=16, most=32).of(scene).lights
    for point in np.array([(0.0, 0.0, 0.0), (0.5, -0.3, 0.4)]):
        total = 0.0
        for light in seen:
            normal, tangent = np.array(light.direction), np.array(light.tangent)
            away = point - np.array(light.position)
            axes = np.stack([tangent, np.cross(normal, tangent), normal])
            angle = float(rectangle_angle((axes @ away)[None], np.array(light.size))[0])
            radiance = light.intensity[0] / (4.0 * light.size[0] * light.size[1])
            total += angle * radiance / GLOW.emission[0]
        # Measured: 1.00 to 1.02 of all around; four rectangles on the ball gave .5.
        assert total == pytest.approx(4.0 * np.pi, rel=0.06)
