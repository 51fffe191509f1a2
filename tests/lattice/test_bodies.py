"""Which side of a mesh blocks: the outside of closed bodies, cut, flipped or mirrored ones too."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from airlight.lattice.bodies import winding_number
from airlight.lattice.rooms import Rooms, sides
from airlight.lattice.surfels import follow, sealed, surfels, turned
from airlight.rendering import Renderer
from airlight.scene import Camera, Environment, Geometry, Material, Scene, shapes
from airlight.scene.mesh import Mesh

NOWHERE = np.zeros((0, 3))
BOTH = Material(two_sided=True)


def box(size=1.0, centre=(0.0, 0.0, 0.0), mirror=False, material=BOTH) -> Mesh:
    matrix = np.diag([-size if mirror else size, size, size, 1.0])
    matrix[:3, 3] = centre
    return Mesh(shapes.box(), material=material, world_from_object=matrix)


def flipped(mesh: Mesh) -> Mesh:
    g = mesh.geometry
    return replace(mesh, geometry=Geometry(g.positions, np.ascontiguousarray(g.indices[:, ::-1])))


def halves(mesh: Mesh, seed=0) -> list[Mesh]:
    """The mesh as two, each of about half of its triangles."""
    g = mesh.geometry
    is_first = np.random.default_rng(seed).permutation(len(g.indices)) % 2 == 0
    return [
        replace(mesh, geometry=Geometry(g.positions, g.indices[p])) for p in (is_first, ~is_first)
    ]


def test_closed_bodies_block_with_their_outside_whichever_way_triangles_face():
    body = box()
    assert sides([body, flipped(body), box(mirror=True)], NOWHERE) == [1, -1, 1]


def test_one_sided_materials_block_as_their_triangles_face():
    body = flipped(box(material=Material(two_sided=False)))
    assert sides([body], NOWHERE) == [0]


@pytest.mark.parametrize("seed", range(4))
def test_halves_of_a_body_block_with_the_body_s_outside(seed):
    one, two = box(), flipped(box(2.0, (5.0, 0.0, 0.0)))
    mirrored = box(1.5, (0.0, 7.0, 0.0), mirror=True)
    parts = [*halves(one, seed), *halves(two, seed), *halves(mirrored, seed)]
    assert sides(parts, NOWHERE) == [1, 1, -1, -1, 1, 1]


def test_halves_of_bodies_that_touch_block_like_the_bodies():
    # Edges where the boxes touch run there four times.
    parts = [half for x in range(3) for half in halves(box(centre=(float(x), 0.0, 0.0)), x)]
    assert sides(parts, NOWHERE) == [1] * 6


def test_sheets_and_what_lacks_a_part_block_both_ways():
    sheet = Mesh(shapes.quad(), material=BOTH)
    one, _ = halves(box(centre=(3.0, 0.0, 0.0)))
    body = halves(box(centre=(9.0, 0.0, 0.0)))
    assert sides([sheet, one, *body], NOWHERE) == [0, 0, 1, 1]


def test_a_body_around_the_eye_is_a_room_also_in_parts():
    eye = np.array([[0.1, 0.2, 0.1]])
    other = box(centre=(4.0, 0.0, 0.0))
    assert sides([box(), other], eye) == [0, 1]
    assert sides([*halves(box()), other], eye) == [0, 0, 1]
    assert winding_number(halves(box()), eye[0]) == pytest.approx(1.0)
    assert winding_number([*halves(box())], np.array([2.0, 0.0, 0.0])) == pytest.approx(
        0.0, abs=1e-9
    )


def test_surfels_of_a_flipped_body_face_out_and_follow_it():
    mesh = flipped(box())
    made = surfels((mesh,), [0], 400, sides([mesh], NOWHERE))
    assert not made["is_two_sided"].any()
    outward = np.einsum("nk,nk->n", made["area_normal"], made["position"])
    assert (outward > 0.0).all()
    grown = replace(mesh, geometry=Geometry(2.0 * mesh.geometry.positions, mesh.geometry.indices))
    moved = follow(made, [0], (mesh,), (grown,))
    np.testing.assert_allclose(moved["area_normal"], 4.0 * made["area_normal"], rtol=1e-5)


def test_surfels_turn_with_the_sides_that_block():
    meshes = (flipped(box()), box(centre=(4.0, 0.0, 0.0)))
    made = [surfels(meshes, [1, 0], 400, each) for each in ([-1, 1], [0, 1], [0, 0])]
    for before, now in ((0, 1), (1, 2), (2, 0)):
        given = ([-1, 1], [0, 1], [0, 0])
        assert (turned(made[before], [1, 0], meshes, given[before], given[now]) == made[now]).all()


def test_a_body_is_a_room_while_the_eye_is_in_it():
    meshes = tuple(halves(box(2.0)))
    rooms = Rooms(meshes, NOWHERE)
    assert rooms.sides == [1, 1]
    # In, on within, out through a wall by a hair, and in again.
    for x, holds in ((0.0, True), (0.9, True), (0.999, True), (1.001, False), (0.99, True)):
        rooms.update(meshes, np.array([[x, 0.1, -0.2]]))
        assert rooms.sides == ([0, 0] if holds else [1, 1]), x
    moved = tuple(replace(m, world_from_object=shifted(m, 3.0)) for m in meshes)
    assert rooms.update(moved, np.array([[0.99, 0.1, -0.2]]))
    assert rooms.sides == [1, 1]
    # One that was around the eye at first stays a room.
    assert not Rooms(meshes, np.zeros((1, 3))).update(meshes, np.array([[9.0, 0.0, 0.0]]))


def test_another_room_changes_nothing_where_both_sides_block_already(monkeypatch):
    """Of a body that faces in, both sides do; and each body is asked for each point once."""
    inward, asked = (flipped(box(2.0, material=Material(two_sided=False))),), []
    rooms = Rooms(inward, NOWHERE)
    assert (rooms.sides, rooms.walls) == ([0], frozenset())
    around = rooms._around
    monkeypatch.setattr(rooms, "_around", lambda *given: asked.append(1) or around(*given))
    assert not rooms.update(inward, np.array([[0.1, 0.2, 0.1]]))
    assert len(asked) == 1
    # With a light outside it becomes a wall.
    assert rooms.update(inward, np.array([[0.1, 0.2, 0.1], [9.0, 0.0, 0.0]]))
    assert (rooms.sides, rooms.walls) == ([0], frozenset({0}))


def test_the_opaque_walls_of_rooms_are_sealed():
    """Both halves, with the eye in and a light out; not one of glass; none with both in or out."""
    halved = halves(box(2.0))
    glass = replace(halved[1], material=Material(transmission=0.9))
    for meshes, light, sealing in (
        (halved, 5.0, [1, 1]),
        (halved, np.inf, [1, 1]),
        ((halved[0], glass), 5.0, [1, 0]),
        (halved, 0.3, [0, 0]),
    ):
        meshes = tuple(meshes)
        rooms = Rooms(meshes, np.array([[0.0, 0.1, -0.2], [light, 0.1, -0.2]]))
        made = sealed(surfels(meshes, [1, 0], 100, rooms.sides), [1, 0], meshes, rooms.walls)
        of = [set(made["is_sealing"][made["instance"] == i].tolist()) for i in (1, 0)]
        assert of == [{flag} for flag in sealing]


def shifted(mesh, by):
    matrix = mesh.world_from_object.copy()
    matrix[0, 3] += by
    return matrix


def test_an_eye_that_moves_within_reach_asks_no_triangle(monkeypatch):
    meshes, rng = (box(2.0),), np.random.default_rng(2)
    rooms, asked = Rooms(meshes, NOWHERE), []
    monkeypatch.setattr(
        "airlight.lattice.rooms.winding_number",
        lambda body, point: asked.append(point) or winding_number(body, point),
    )
    for step in rng.uniform(-0.3, 0.3, (50, 3)):
        rooms.update(meshes, step[None])
        assert rooms.sides == [0]
    assert len(asked) == 1


def test_a_camera_that_enters_a_box_later_sees_what_one_does_that_began_inside(gpu):
    grey = Material(base_color=(0.7, 0.7, 0.7))
    outside = Camera((0.0, 0.0, 9.0), (0.0, 0.0, 0.0))
    inside = Camera((0.5, 0.2, 1.0), (0.0, 0.0, -2.0))
    scene = Scene(meshes=(box(4.0, material=grey),), environment=Environment(), camera=outside)
    settings = {"resolution": 12, "gather": "off", "sky_lights": 16, "sky_resolution": 32}
    with Renderer(scene, "lpv", (32, 18), settings=settings) as renderer:
        renderer.frame(read=False)
        later = renderer.frame(camera=inside).radiance
    with Renderer(replace(scene, camera=inside), "lpv", (32, 18), settings=settings) as renderer:
        began = renderer.frame().radiance
    # To the bit: for a solid that it is taken for from outside, .01 of the sky came in.
    np.testing.assert_array_equal(later, began)
