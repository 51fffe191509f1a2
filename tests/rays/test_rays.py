"""Rays on the device find what the truth finds, which tests each ray against all triangles."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from airlight.maths import rays as truth
from airlight.scene import Geometry, Material, Mesh, Scene, Texture

RNG = np.random.default_rng(17)

pytestmark = pytest.mark.both_paths

NEAR = 2e-5
"""Of the scene's reach: float32 distances to triangles seen at a grazing angle, measured 4e-6."""
EDGE = 1e-5
"""Of a triangle: rays that pass its edge so near may hit it in float32 alone."""


def soup(count: int, size: float = 0.3, scale: float = 1.0) -> np.ndarray:
    """Random triangles (count, 3, 3) within a cube of side 2."""
    middle = RNG.uniform(-1.0, 1.0, (count, 1, 3))
    return (scale * (middle + size * RNG.normal(size=(count, 3, 3)))).astype(np.float32)


def geometry(corners: np.ndarray) -> Geometry:
    """A geometry whose triangles share no vertices."""
    indices = np.arange(3 * len(corners), dtype=np.uint32).reshape(-1, 3)
    return Geometry(corners.reshape(-1, 3), indices)


def directions(count: int) -> np.ndarray:
    return RNG.normal(size=(count, 3)).astype(np.float32)


def placed(corners: np.ndarray, matrix: np.ndarray) -> np.ndarray:
    return np.asarray(corners @ matrix[:3, :3].T + matrix[:3, 3])


def turned(mirror: bool = False) -> np.ndarray:
    """A random affine transform, neither uniform nor at right angles."""
    matrix = np.eye(4)
    q, _ = np.linalg.qr(RNG.normal(size=(3, 3)))
    matrix[:3, :3] = q @ np.diag(RNG.uniform(0.3, 2.0, 3)) + 0.1 * RNG.normal(size=(3, 3))
    if (np.linalg.det(matrix[:3, :3]) < 0.0) != mirror:
        matrix[:3, 0] *= -1.0
    matrix[:3, 3] = RNG.uniform(-1.0, 1.0, 3)
    return matrix


def world(scene: Scene) -> np.ndarray:
    """All triangles of a scene in the world (T, 3, 3), float64."""
    parts = [
        placed(m.geometry.positions[m.geometry.indices].astype(np.float64), m.world_from_object)
        for m in scene.meshes
    ]
    return np.concatenate(parts) if parts else np.zeros((0, 3, 3))


def same_place(found: Any, expected: truth.RayHits) -> np.ndarray:
    """Where both hit, and at the same distance."""
    is_hit = found.is_hit & (expected.triangle >= 0)
    is_hit[is_hit] = np.abs(found.t[is_hit] - expected.t[is_hit]) < 1e-5
    return is_hit


def assert_true(
    found: Any, scene: Scene, o: np.ndarray, d: np.ndarray, reach: float
) -> truth.RayHits:
    """Hits and distances are the truth's, which is given back, but for rays along edges."""
    expected = truth.nearest_hit(o, d, world(scene))
    length = np.linalg.norm(d, axis=1)
    with np.errstate(invalid="ignore"):
        error = np.abs(found.t - expected.t) * length
    wrong = ~((found.t == expected.t) | (error < NEAR * reach))
    # Along an edge both may be right: there the truth's triangle, or the device's, is hardly hit.
    shares = np.concatenate([found.bary, 1.0 - found.bary.sum(axis=1, keepdims=True)], axis=1)
    mine = shares.min(axis=1) < EDGE
    shares = np.concatenate([expected.bary, 1.0 - expected.bary.sum(axis=1)[:, None]], axis=1)
    theirs = shares.min(axis=1) < EDGE
    assert not (wrong & ~mine & ~theirs).any()
    assert wrong.mean() < 1e-3
    np.testing.assert_array_equal(found.is_any, found.is_hit)
    at = np.asarray(o + found.t[:, None] * d)[found.is_hit]
    np.testing.assert_allclose(found.position[found.is_hit], at, atol=NEAR * reach)
    return expected


@pytest.mark.parametrize("count", [1, 2, 5, 40, 700])
@pytest.mark.parametrize("has_moved", [False, True], ids=["still", "moved"])
def test_random_triangles(rays: Any, count: int, has_moved: bool) -> None:
    scene = Scene((Mesh(geometry(soup(count))),))
    o, d = RNG.uniform(-2.0, 2.0, (4000, 3)).astype(np.float32), directions(4000)
    found = rays(scene, has_moved).send(o, d)
    assert found.is_hit.any()
    assert_true(found, scene, o, d, 6.0)


@pytest.mark.parametrize("scale", [1e-6, 1e-3, 1e4, 1e7])
def test_any_size(rays: Any, scale: float) -> None:
    scene = Scene((Mesh(geometry(soup(60, scale=scale))),))
    o = (scale * RNG.uniform(-2.0, 2.0, (4000, 3))).astype(np.float32)
    d = directions(4000)
    assert_true(rays(scene).send(o, d), scene, o, d, 6.0 * scale)


def test_far_from_the_origin(rays: Any) -> None:
    middle = np.array([3e4, -2e4, 1e4])
    scene = Scene((Mesh(geometry((soup(60) + middle).astype(np.float32))),))
    o = (middle + RNG.uniform(-2.0, 2.0, (2000, 3))).astype(np.float32)
    d = directions(2000)
    found, expected = rays(scene).send(o, d), truth.nearest_hit(o, d, world(scene))
    same = found.is_hit == (expected.triangle >= 0)
    assert same.mean() > 0.999


def test_no_meshes(rays: Any) -> None:
    found = rays(Scene(())).send(np.zeros((100, 3)), directions(100))
    assert not found.is_hit.any() and not found.is_any.any()


def test_triangles_without_area(rays: Any) -> None:
    corners = soup(50)
    corners[::3, 2] = corners[::3, 1]
    corners[::5, 2] = 0.5 * (corners[::5, 0] + corners[::5, 1])
    corners[7] = corners[7, 0]
    o, d = RNG.uniform(-2.0, 2.0, (4000, 3)).astype(np.float32), directions(4000)
    found = rays(Scene((Mesh(geometry(corners)),))).send(o, d)
    sides = corners[:, 1:] - corners[:, :1]
    whole = np.linalg.norm(np.cross(sides[:, 0], sides[:, 1]), axis=1) > 1e-6
    assert_true(found, Scene((Mesh(geometry(corners[whole])),)), o, d, 6.0)


def test_many_at_one_place(rays: Any) -> None:
    """Where no cut is better than another, the hierarchy is no deeper than it may be."""
    scene = Scene((Mesh(geometry(np.repeat(soup(1), 3000, axis=0))),))
    o, d = RNG.uniform(-2.0, 2.0, (500, 3)).astype(np.float32), directions(500)
    assert_true(rays(scene).send(o, d), scene, o, d, 6.0)


def test_between_t_min_and_t_max(rays: Any) -> None:
    scene = Scene((Mesh(geometry(soup(80))),))
    o, d = RNG.uniform(-2.0, 2.0, (4000, 3)).astype(np.float32), directions(4000)
    found = rays(scene).send(o, d, 0.2, 0.7)
    expected = truth.nearest_hit(o, d, world(scene), 0.2, 0.7)
    wrong = ~np.isclose(found.t, expected.t, rtol=1e-4)
    assert expected.t[np.isfinite(expected.t)].min() < 0.25
    assert wrong.mean() < 1e-3
    np.testing.assert_array_equal(found.is_any, found.is_hit)


def instances(count: int = 24) -> Scene:
    """Three geometries and two materials, placed at random, every other one mirrored."""
    shapes = [geometry(soup(n, 0.1)) for n in (1, 12, 150)]
    looks = [Material("a"), Material("b")]
    return Scene(
        tuple(
            Mesh(shapes[k % 3], looks[k % 2], turned(mirror=bool(k % 2)), f"m{k}")
            for k in range(count)
        )
    )


def meshes_of(scene: Scene, triangles: np.ndarray) -> np.ndarray:
    """The mesh of each of `world`'s triangles."""
    counts = [len(m.geometry.indices) for m in scene.meshes]
    return np.searchsorted(np.cumsum(counts), triangles, side="right")


moved_or_not = pytest.mark.parametrize("has_moved", [False, True], ids=["still", "moved"])


@moved_or_not
def test_instances(rays: Any, has_moved: bool) -> None:
    scene = instances()
    o, d = RNG.uniform(-3.0, 3.0, (4000, 3)).astype(np.float32), directions(4000)
    sent = rays(scene, has_moved)
    assert sent.scene.constants["RAYS_MEET_INSTANCES"] == has_moved
    found = sent.send(o, d)
    expected = assert_true(found, scene, o, d, 8.0)
    mesh = meshes_of(scene, expected.triangle)
    is_sure = same_place(found, expected)
    told = np.array(sent.meshes.order)[found.instance[is_sure]]
    assert (told == mesh[is_sure]).mean() > 0.999
    materials = np.array(sent.meshes.material_rows)[found.instance[is_sure]]
    np.testing.assert_array_equal(found.material[is_sure], materials)


@moved_or_not
def test_normals(rays: Any, has_moved: bool) -> None:
    scene = instances()
    o, d = RNG.uniform(-3.0, 3.0, (3000, 3)).astype(np.float32), directions(3000)
    found, expected = rays(scene, has_moved).send(o, d), truth.nearest_hit(o, d, world(scene))
    same = same_place(found, expected)
    p = world(scene)[expected.triangle[same]]
    n = np.cross(p[:, 1] - p[:, 0], p[:, 2] - p[:, 0])
    # A mirrored mesh keeps its front.
    sides = np.array([np.linalg.det(m.world_from_object[:3, :3]) for m in scene.meshes])
    n *= np.sign(sides[meshes_of(scene, expected.triangle[same])])[:, None]
    n /= np.linalg.norm(n, axis=1, keepdims=True)
    off = np.linalg.norm(found.geometric_normal[same] - n, axis=1)
    assert np.median(off) < 1e-6 and np.quantile(off, 0.99) < 1e-4
    # Corners that share no vertices have their triangle's normal, in 2 x 10 bits; instances with
    # a stretched transform magnify its rounding.
    off = np.linalg.norm(found.shading_normal[same] - n, axis=1)
    assert np.quantile(off, 0.99) < (0.012 if has_moved else 0.0042)


def test_shading_normals_and_uv(rays: Any) -> None:
    corners = soup(40, 0.5)
    made = geometry(corners)
    uvs = RNG.uniform(-3.0, 3.0, (120, 2)).astype(np.float32)
    normals = RNG.normal(size=(120, 3))
    normals = (normals / np.linalg.norm(normals, axis=1, keepdims=True)).astype(np.float32)
    made = Geometry(made.positions, made.indices, normals, uvs)
    o, d = RNG.uniform(-2.0, 2.0, (3000, 3)).astype(np.float32), directions(3000)
    scene = Scene((Mesh(made),))
    found, expected = rays(scene).send(o, d), truth.nearest_hit(o, d, world(scene))
    same = same_place(found, expected)
    shares = np.concatenate([1.0 - expected.bary.sum(axis=1)[:, None], expected.bary], axis=1)
    corner = 3 * expected.triangle[same, None] + np.arange(3)
    uv = np.einsum("nk,nkc->nc", shares[same], uvs[corner])
    off = np.linalg.norm(found.uv[same] - uv, axis=1)
    assert np.quantile(off, 0.99) < 6.0 * 2.0**-11  # edges are half floats
    n = np.einsum("nk,nkc->nc", shares[same], normals[corner])
    n /= np.linalg.norm(n, axis=1, keepdims=True)
    off = np.linalg.norm(found.shading_normal[same] - n, axis=1)
    assert np.median(off) < 0.003  # 2 x 10 bits, more where normals of corners cancel


def box(matrix: np.ndarray, parts: int) -> Scene:
    """A closed box of `parts` x `parts` squares a side, one mesh."""
    line = np.linspace(-1.0, 1.0, parts + 1)
    u, v = np.meshgrid(line, line, indexing="ij")
    corners, indices = [], []
    cell = np.arange(parts)[:, None] * (parts + 1) + np.arange(parts)
    a = cell.ravel()
    b, c, e = a + parts + 1, a + parts + 2, a + 1
    for axis in range(3):
        for side in (-1.0, 1.0):
            p = np.stack([np.full(u.size, side), u.ravel(), v.ravel()], axis=1)
            first = sum(len(x) for x in corners)
            corners.append(np.roll(p, axis, axis=1))
            indices += [first + np.stack([a, b, c], 1), first + np.stack([a, c, e], 1)]
    positions = placed(np.concatenate(corners), matrix).astype(np.float32)
    return Scene((Mesh(Geometry(positions, np.concatenate(indices).astype(np.uint32))),))


@pytest.mark.parametrize("parts", [1, pytest.param(3, marks=pytest.mark.slow), 16])
@pytest.mark.parametrize("is_turned", [False, True])
@moved_or_not
def test_closed_boxes_do_not_leak(rays: Any, parts: int, is_turned: bool, has_moved: bool) -> None:
    matrix = turned() if is_turned else np.eye(4)
    count = 100_000
    inside = placed(RNG.uniform(-0.98, 0.98, (count, 3)), matrix)
    d = directions(count)
    # Half of the rays go exactly for an edge or a corner.
    scene = box(matrix, parts)
    p, corners = scene.meshes[0].geometry.positions, scene.meshes[0].geometry.indices
    edge = p[corners[RNG.integers(0, len(corners), count // 2)]]
    share = RNG.random((count // 2, 1)) * (RNG.random((count // 2, 1)) < 0.8)
    d[::2] = edge[:, 0] * (1.0 - share) + edge[:, 1] * share - inside[::2]
    found = rays(scene, has_moved).send(inside, d)
    assert found.is_hit.all() and found.is_any.all()
    reach = np.abs(p).max()
    at = placed(found.position, np.linalg.inv(matrix))
    np.testing.assert_allclose(np.abs(at).max(axis=1), 1.0, atol=20.0 * NEAR * reach)


def test_moved_vertices(rays: Any) -> None:
    """Fitted while that is good enough, and rebuilt after."""
    corners = soup(300, 0.05)
    made = geometry(corners)
    scene = Scene((Mesh(made, world_from_object=turned()), Mesh(made)))
    sent = rays(scene, True)
    o, d = RNG.uniform(-2.0, 2.0, (4000, 3)).astype(np.float32), directions(4000)
    trees = []
    for shift in (0.02, 2.0):
        moved = geometry((corners + shift * RNG.normal(size=(300, 1, 3))).astype(np.float32))
        scene = replace(scene, meshes=tuple(replace(mesh, geometry=moved) for mesh in scene.meshes))
        trees.append(next(iter(sent.scene.trees.values())).tree)
        sent.move(scene)
        assert_true(sent.send(o, d), scene, o, d, 12.0)
    trees.append(next(iter(sent.scene.trees.values())).tree)
    assert trees[0] is trees[1] and trees[1] is not trees[2]


def test_moved_instances(rays: Any) -> None:
    """Some of them and back again: the frames between leave no trace."""
    scene = instances()
    sent = rays(scene)
    o, d = RNG.uniform(-3.0, 3.0, (3000, 3)).astype(np.float32), directions(3000)
    before = sent.send(o, d)
    moved = [replace(m, world_from_object=turned()) for m in scene.meshes[::2]]
    between = list(scene.meshes)
    between[::2] = moved
    shown = replace(scene, meshes=tuple(between))
    sent.move(shown)
    found = sent.send(o, d)
    assert (found.t != before.t).any()
    assert_true(found, shown, o, d, 8.0)
    sent.move(scene)
    np.testing.assert_array_equal(sent.send(o, d).t, before.t)


def test_moved_and_deformed(rays: Any) -> None:
    scene = instances(6)
    sent = rays(scene)
    o, d = RNG.uniform(-3.0, 3.0, (2000, 3)).astype(np.float32), directions(2000)
    sent.send(o, d)
    shapes = {id(m.geometry): m.geometry for m in scene.meshes}
    bent = {key: Geometry(g.positions * np.float32(1.5), g.indices) for key, g in shapes.items()}
    shown = replace(
        scene, meshes=tuple(replace(m, geometry=bent[id(m.geometry)]) for m in scene.meshes)
    )
    sent.move(shown)
    assert_true(sent.send(o, d), shown, o, d, 12.0)


@pytest.mark.parametrize("wrap", ["repeat", "mirror", "clamp"])
@moved_or_not
def test_holes(rays: Any, square: Any, wrap: Any, has_moved: bool) -> None:
    """Rays go through where the filtered alpha is below the cutoff."""
    pixels = np.full((6, 10, 4), 255, np.uint8)
    pixels[..., 3] = RNG.integers(0, 256, (6, 10))
    texture = Texture(pixels, wrap=(wrap, wrap), scale=(2.0, 1.5), offset=(0.3, -0.4))
    look = Material(base_color_texture=texture, alpha=0.9, alpha_cutoff=0.4)
    uvs = np.array([[0, 0], [1, 0], [1, 1], [0, 1]], np.float32)
    front = square((0, 0, 0), (1, 0, 0), (0, 1, 0), look, uvs=uvs)
    back = square((0, 0, -1), (2, 0, 0), (0, 2, 0))
    gone = square((0, 0, 0.5), (2, 0, 0), (0, 2, 0), Material(alpha=0.3, alpha_cutoff=0.5))
    scene = Scene((front, back, gone))
    o = np.concatenate([RNG.uniform(-0.99, 0.99, (4000, 2)), np.ones((4000, 1))], axis=1)
    found = rays(scene, has_moved).send(o, np.tile([0.0, 0.0, -1.0], (4000, 1)))
    uv = 0.5 * (o[:, :2] + 1.0) * texture.scale + texture.offset
    alpha = 0.9 / 255.0 * _filtered(pixels[..., 3].astype(np.float64), uv, wrap)
    is_sure = np.abs(alpha - 0.4) > 2e-3  # coordinates on edges are half floats
    expected = np.where(alpha >= 0.4, 1.0, 2.0)
    np.testing.assert_allclose(found.t[is_sure], expected[is_sure], atol=1e-6)
    assert found.is_any.all()


def _filtered(texels: np.ndarray, uv: np.ndarray, wrap: str) -> np.ndarray:
    """A bilinear sampler."""
    sides = np.array(texels.shape[::-1])
    at = uv * sides - 0.5
    corner = np.floor(at).astype(int)
    share = at - corner
    total = np.zeros(len(uv))
    for step in np.ndindex(2, 2):
        cell = corner + step
        if wrap == "repeat":
            cell = cell % sides
        elif wrap == "mirror":
            cell = cell % (2 * sides)
            cell = np.minimum(cell, 2 * sides - 1 - cell)
        cell = np.clip(cell, 0, sides - 1)
        weight = np.where(step, share, 1.0 - share).prod(axis=1)
        total += weight * texels[cell[:, 1], cell[:, 0]]
    return total


def _veil(alpha: int) -> Texture:
    pixels = np.full((2, 2, 4), 255, np.uint8)
    pixels[..., 3] = alpha
    return Texture(pixels)


_CUT_GLASS = Material(base_color=(0.9, 0.6, 0.3), transmission=0.5, alpha_cutoff=0.5)


@pytest.mark.parametrize("has_moved", [False, True])
@pytest.mark.parametrize(
    ("look", "met"),
    [
        (Material(alpha=0.3, is_blended=True), 0.3),
        (Material(base_color=(0.9, 0.6, 0.3), transmission=0.5), 1.0 - 0.5 * 0.96 * 0.6),
        (Material(transmission=1.0, metallic=1.0), 1.0),
        (Material(alpha=0.5, base_color_texture=_veil(153), is_blended=True), 0.3),
        # Of a cut-out alpha says where it is, not how much of it.
        (replace(_CUT_GLASS, base_color_texture=_veil(153)), 1.0 - 0.5 * 0.96 * 0.6),
        (replace(_CUT_GLASS, base_color_texture=_veil(102)), 0.0),
    ],
)
def test_translucent_surfaces_are_met_by_chance(
    rays: Any, square: Any, look: Material, met: float, has_moved: bool
) -> None:
    front = square((0, 0, 0), (1, 0, 0), (0, 1, 0), look)
    back = square((0, 0, -1), (2, 0, 0), (0, 2, 0))
    count = 6000
    o = np.concatenate([RNG.uniform(-0.99, 0.99, (count, 2)), np.ones((count, 1))], axis=1)
    found = rays(Scene((front, back)), has_moved).send(o, np.tile([0.0, 0.0, -1.0], (count, 1)))
    # Four standard deviations of a count by lot.
    assert (found.t < 1.5).mean() == pytest.approx(
        met, abs=4 * np.sqrt(met * (1 - met) / count) + 1e-9
    )
    assert found.is_any.all()
