"""A point sampling of surfaces: no area is lost, every point lies on its triangle."""

from __future__ import annotations

import numpy as np
import pytest

from airlight.lattice.bodies import _unmatched_edges, outer_side
from airlight.lattice.surfels import mean_reflectances, surfels
from airlight.scene import Geometry, Material, Mesh, Texture, shapes

UVS = np.array([[0, 1], [1, 1], [1, 0], [0, 0]], np.float32)


def placed(geometry, linear, centre=(0, 0, 0), material=None):
    matrix = np.eye(4)
    matrix[:3, :3], matrix[:3, 3] = linear, centre
    return Mesh(geometry, material or Material(), matrix)


def world_area(mesh):
    p = mesh.geometry.positions @ mesh.world_from_object[:3, :3].T
    a, b, c = (p[mesh.geometry.indices[:, k]] for k in range(3))
    return 0.5 * np.linalg.norm(np.cross(b - a, c - a), axis=1).sum()


def area_vectors(mesh, made):
    """World area vectors: the cofactor matrix takes object's to world's."""
    linear = mesh.world_from_object[:3, :3]
    cofactor = np.linalg.det(linear) * np.linalg.inv(linear).T
    return made["area_normal"].astype(np.float64) @ cofactor.T


@pytest.mark.parametrize(
    "linear",
    [np.eye(3), np.diag([3.0, 0.5, 1.5]), np.array([[1, 0.4, 0], [0, 1.2, 0.3], [0.2, 0, 0.9]])],
)
def test_areas_sum_to_the_meshs(linear):
    mesh = placed(shapes.sphere(), linear)
    made = surfels((mesh,), [0], 5000)
    sizes = np.linalg.norm(area_vectors(mesh, made), axis=1)
    assert sizes.sum() == pytest.approx(world_area(mesh), rel=1e-4)
    np.testing.assert_allclose(sizes, sizes[0], rtol=1e-3)
    # a closed surface has no area vector
    whole = area_vectors(mesh, made).sum(axis=0)
    np.testing.assert_allclose(whole, 0.0, atol=0.01 * world_area(mesh))


def test_surfels_are_shared_out_by_area_and_no_mesh_goes_without():
    large, small = placed(shapes.quad(), 3 * np.eye(3)), placed(shapes.quad(), np.eye(3))
    speck = placed(shapes.quad(), 1e-4 * np.eye(3))
    made = surfels((large, small, speck), [2, 0, 1], 1000)
    counts = np.bincount(made["instance"])
    # instances stand in the order given: speck, large, small
    assert counts.tolist() == [1, 900, 100]


def test_points_lie_on_the_surface_and_are_spread():
    made = surfels((placed(shapes.quad(), np.eye(3)),), [0], 4096)
    x, y, z = made["position"].T
    np.testing.assert_allclose(y, 0.0, atol=1e-7)
    counts, _, _ = np.histogram2d(x, z, bins=8, range=[[-0.5, 0.5]] * 2)
    assert counts.sum() == 4096
    assert counts.min() > 40
    assert counts.max() < 90
    np.testing.assert_allclose(
        made["area_normal"].sum(axis=0, dtype=np.float64), [0, 1, 0], atol=1e-5
    )


@pytest.mark.parametrize("two_sided", [True, False])
def test_sides_are_the_materials(two_sided):
    mesh = placed(shapes.quad(), np.eye(3), material=Material(two_sided=two_sided))
    assert set(surfels((mesh,), [0], 10)["is_two_sided"]) == {int(two_sided)}


def test_what_is_cut_away_has_no_area():
    pixels = np.full((4, 4, 4), 255, np.uint8)
    pixels[:, 0, 3] = 0  # a quarter is not there
    leaf = Material(base_color_texture=Texture(pixels), alpha_cutoff=0.5)
    made = surfels((placed(shapes.quad(), np.eye(3), material=leaf),), [0], 4000)
    assert made["area_normal"][:, 1].sum() == pytest.approx(0.75, abs=0.01)


def test_edges_of_what_is_cut_away_lie_between_texels():
    pixels = np.full((1, 2, 4), 255, np.uint8)
    pixels[:, 0, 3] = 0  # between 1/4 and 3/4 of a width alpha rises evenly: .8 is reached at .65
    leaf = Material(base_color_texture=Texture(pixels), alpha_cutoff=0.8)
    made = surfels((placed(shapes.quad(), np.eye(3), material=leaf),), [0], 4000)
    whole = surfels((placed(shapes.quad(), np.eye(3)),), [0], 4000)
    # Beyond the last texel it falls to the first one's 0 again, which repeats: .2 is cut there.
    share = made["area_normal"][:, 1].sum() / whole["area_normal"][:, 1].sum()
    assert share == pytest.approx(0.2, abs=0.02)


def test_colour_is_linear_and_takes_the_factor():
    pixels = np.full((2, 2, 4), (188, 0, 255, 255), np.uint8)  # sRGB 188 is linear 0.503
    paint = Material(base_color=(0.5, 1.0, 0.25), base_color_texture=Texture(pixels), specular=0.0)
    made = surfels((placed(shapes.quad(), np.eye(3), material=paint),), [0], 4)
    np.testing.assert_allclose(made["reflectance"][0], [0.2515, 0.0, 0.25], atol=2e-3)


def test_the_mean_reflectance_of_an_instance_is_that_of_its_texture():
    """A board half black and half white, in the mean of a colour; and a plain one."""
    pixels = np.zeros((4, 4, 4), np.uint8)
    pixels[:, :2], pixels[..., 3] = 255, 255
    half = Material(base_color=(0.9, 0.6, 0.3), base_color_texture=Texture(pixels), specular=0.0)
    plain = Material(base_color=(0.2, 0.2, 0.2), specular=0.0)
    meshes = (Mesh(shapes.quad(), half), Mesh(shapes.quad(), plain))
    made = surfels(meshes, [1, 0], 4000)
    np.testing.assert_allclose(mean_reflectances(made, 3), [0.2, 0.3, 0.0], atol=0.01)


def test_no_meshes_still_make_a_buffer():
    assert len(surfels((), [], 10)) == 1


@pytest.mark.parametrize("kind", ["closed", "without a cap", "tangle"])
def test_edges_without_a_partner_are_counted(kind):
    rng = np.random.default_rng(0)
    box = np.unique(shapes.box().positions, axis=0, return_inverse=True)[1].reshape(-1)
    triangles = {
        "closed": box[shapes.box().indices],
        "without a cap": box[shapes.box().indices[2:]],
        "tangle": rng.integers(0, 30, (400, 3)),
    }[kind]
    edges = [
        (a, b) for row in triangles.tolist() for a, b in zip(row, row[1:] + row[:1], strict=True)
    ]
    known = set(edges)
    expected = sum(a != b and (b, a) not in known for a, b in edges)
    assert _unmatched_edges(triangles.astype(np.int64)) == expected
    assert (expected == 0) == (kind == "closed")


def test_a_closed_body_has_an_outer_side():
    box = shapes.box()
    turned = Geometry(box.positions, np.ascontiguousarray(box.indices[:, ::-1]))
    open_box = Geometry(box.positions, np.ascontiguousarray(box.indices[2:]))
    assert [outer_side(g) for g in (box, turned, open_box)] == [1, -1, 0]
