"""Which side of a mesh blocks: the outside of closed bodies, cut, flipped or mirrored ones too."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from airlight.lattice.bodies import sides, winding_number
from airlight.lattice.surfels import follow, surfels
from airlight.scene import Geometry, Material, shapes
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
    made = surfels((mesh,), [0], 400)
    assert not made["is_two_sided"].any()
    outward = np.einsum("nk,nk->n", made["area_normal"], made["position"])
    assert (outward > 0.0).all()
    grown = replace(mesh, geometry=Geometry(2.0 * mesh.geometry.positions, mesh.geometry.indices))
    moved = follow(made, [0], (mesh,), (grown,))
    np.testing.assert_allclose(moved["area_normal"], 4.0 * made["area_normal"], rtol=1e-5)
