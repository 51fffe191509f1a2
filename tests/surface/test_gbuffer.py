"""What the camera sees of a square in front of it, exactly."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest

from airlight.maths.transforms import clip_from_view_infinite, view_from_world
from airlight.scene import Material, Texture
from airlight.surface.gbuffer import GBuffer
from airlight.surface.mesh_pass import MeshPass

WIDTH, HEIGHT = 32, 24
NEAR_M = 0.01
UVS = np.array([[0, 1], [1, 1], [1, 0], [0, 0]], np.float32)


@pytest.fixture(autouse=True)
def ways(both_ways):
    """By the visibility buffer and as surfaces come."""
    both_ways("gbuffer")


def looked_at(gpu, commands, owned, scene, eye=(0, 0, 2.0), forward=(0, 0, -1)):
    """The G-buffer of a camera of 90 degrees."""
    made = owned(GBuffer(gpu, (WIDTH, HEIGHT)))
    clip = clip_from_view_infinite(np.pi / 2, WIDTH / HEIGHT, NEAR_M)
    made.encode(commands, scene, clip @ view_from_world(eye, forward, (0, 1, 0)))
    commands.submit()
    return made


def on_square(half_x, half_y, distance=2.0):
    """Which pixels see a square of these half sides straight ahead."""
    x = ((np.arange(WIDTH) + 0.5) / WIDTH * 2 - 1) * WIDTH / HEIGHT * distance
    y = (1 - (np.arange(HEIGHT) + 0.5) / HEIGHT * 2) * distance
    return (np.abs(x)[None, :] < half_x) & (np.abs(y)[:, None] < half_y)


def test_a_frontal_square_is_exact(gpu, commands, owned, on_device, square):
    painted = Material(
        base_color=(0.5, 0.25, 0.125),
        metallic=0.75,
        roughness=0.375,
        specular=0.5,
        emission=(4.0, 2.0, 1.0),
    )
    scene = on_device(square((0, 0, 0), (1.0, 0, 0), (0, 0.7, 0), painted))
    g = looked_at(gpu, commands, owned, scene)
    seen = on_square(1.0, 0.7)
    depth = g.depth.read()
    np.testing.assert_array_equal(depth > 0.0, seen)
    np.testing.assert_allclose(depth[seen], NEAR_M / 2.0, rtol=1e-6)
    assert (g.albedo.read()[seen] == np.array([0.5, 0.25, 0.125, 0.75], np.float16)).all()
    assert (g.emission.read()[seen] == np.array([4.0, 2.0, 1.0, 0.5], np.float16)).all()
    normal = g.normal.read()[seen].astype(np.float64)
    np.testing.assert_allclose(normal, np.tile([0, 0, 1, 0.375], (seen.sum(), 1)), atol=1e-3)
    for texture in (g.albedo, g.normal, g.emission):
        assert not texture.read()[~seen].any()


def test_the_back_of_a_two_sided_square_faces_the_camera(gpu, commands, owned, on_device, square):
    scene = on_device(square((0, 0, 0), (1, 0, 0), (0, 1, 0)))
    g = looked_at(gpu, commands, owned, scene, eye=(0, 0, -2), forward=(0, 0, 1))
    middle = g.normal.read()[HEIGHT // 2, WIDTH // 2, :3].astype(np.float64)
    np.testing.assert_allclose(middle, [0, 0, -1], atol=1e-3)


@pytest.mark.parametrize(("eye", "forward", "is_seen"), [(2, -1, True), (-2, 1, False)])
def test_a_one_sided_square_has_no_back(
    gpu, commands, owned, on_device, square, eye, forward, is_seen
):
    scene = on_device(square((0, 0, 0), (1, 0, 0), (0, 1, 0), Material(two_sided=False)))
    g = looked_at(gpu, commands, owned, scene, eye=(0, 0, eye), forward=(0, 0, forward))
    assert bool(g.depth.read().any()) is is_seen


@pytest.mark.parametrize("depth_first_px", [0.0, 1e9])
def test_the_nearer_square_hides_the_farther(
    gpu, commands, owned, on_device, square, monkeypatch, depth_first_px
):
    monkeypatch.setattr("airlight.surface.gbuffer.DEPTH_FIRST_PX", depth_first_px)
    near = square((0, 0, 0.5), (0.5, 0, 0), (0, 0.5, 0), Material(base_color=(1, 0, 0)))
    far = square((0, 0, 0), (4, 0, 0), (0, 4, 0), Material(base_color=(0, 0, 1)))
    for order in ((near, far), (far, near)):
        g = looked_at(gpu, commands, owned, on_device(*order))
        hidden = on_square(0.5, 0.5, 1.5)
        albedo = g.albedo.read()
        assert (albedo[hidden][:, 0] == 1.0).all()
        assert (albedo[~hidden][:, 2] == 1.0).all()


def test_an_image_lies_upright_and_its_alpha_cuts(gpu, commands, owned, on_device, square):
    pixels = np.zeros((2, 2, 4), np.uint8)
    pixels[0, 0] = (255, 0, 0, 255)  # red top left, green top right, blue bottom left
    pixels[0, 1] = (0, 255, 0, 255)
    pixels[1, 0] = (0, 0, 255, 255)
    pixels[1, 1] = (255, 255, 255, 0)  # and nothing bottom right
    image = Texture(pixels, is_srgb=False, wrap=("clamp", "clamp"))
    leaf = Material(base_color=(1, 1, 1), base_color_texture=image, alpha_cutoff=0.5)
    g = looked_at(
        gpu,
        commands,
        owned,
        on_device(square((0, 0, 0), (1.6, 0, 0), (0, 1.6, 0), leaf, uvs=UVS)),
    )
    albedo, depth = g.albedo.read()[..., :3].astype(float), g.depth.read()
    top, bottom, left, right = 4, HEIGHT - 5, WIDTH // 2 - 8, WIDTH // 2 + 7
    np.testing.assert_allclose(albedo[top, left], [1, 0, 0], atol=0.05)
    np.testing.assert_allclose(albedo[top, right], [0, 1, 0], atol=0.05)
    np.testing.assert_allclose(albedo[bottom, left], [0, 0, 1], atol=0.05)
    assert depth[bottom, right] == 0.0
    assert depth[top, left] > 0.0


def test_vertex_colours_multiply_the_base_colour(gpu, commands, owned, on_device, square):
    colors = np.tile(np.array([0.5, 1.0, 0.25, 1.0], np.float32), (4, 1))
    half = Material(base_color=(0.5, 0.5, 0.5))
    g = looked_at(
        gpu,
        commands,
        owned,
        on_device(square((0, 0, 0), (1, 0, 0), (0, 1, 0), half, colors=colors)),
    )
    middle = g.albedo.read()[HEIGHT // 2, WIDTH // 2, :3].astype(float)
    np.testing.assert_allclose(middle, [0.25, 0.5, 0.125], rtol=2e-3)


def test_a_normal_map_bends_the_normal_towards_its_red_and_green(
    gpu, commands, owned, on_device, square
):
    # a constant map of tangent-space normal (0.6, 0, 0.8), then (0, 0.6, 0.8): right, then up
    for rgb, expected in (((204, 128, 230), (0.6, 0, 0.8)), ((128, 204, 230), (0, 0.6, 0.8))):
        bump = Texture(np.full((2, 2, 4), (*rgb, 255), np.uint8), is_srgb=False)
        scene = on_device(
            square((0, 0, 0), (1, 0, 0), (0, 1, 0), Material(normal_texture=bump), uvs=UVS)
        )
        g = looked_at(gpu, commands, owned, scene)
        # everywhere, the diagonal between the two triangles too
        bent = g.normal.read()[on_square(1.0, 1.0)][:, :3].astype(float)
        np.testing.assert_allclose(bent, np.tile(expected, (len(bent), 1)), atol=0.01)


@pytest.mark.parametrize(
    ("tangent", "mirror", "expected"),
    [
        ((0, 1, 0, 1), 1.0, ((0, 0.6, 0.8), (-0.6, 0, 0.8))),
        ((0, 1, 0, -1), 1.0, ((0, 0.6, 0.8), (0.6, 0, 0.8))),
        ((0.5, 0, 2, 1), 1.0, ((0.6, 0, 0.8), (0, 0.6, 0.8))),  # as far as it lies in the surface
        ((1, 0, 0, 1), -1.0, ((-0.6, 0, 0.8), (0, 0.6, 0.8))),  # a mirror image of the square
        ((0, 0, 0, 1), 1.0, ((0.6, 0, 0.8), (0, 0.6, 0.8))),  # none: by texture coordinates
        ((0, 1, 0, 0), 1.0, ((0.6, 0, 0.8), (0, 0.6, 0.8))),
    ],
)
def test_a_normal_map_lies_by_tangents_where_there_are_any(
    gpu, commands, owned, on_device, square, tangent, mirror, expected
):
    flat = square((0, 0, 0), (1, 0, 0), (0, 1, 0), uvs=UVS)
    geometry = dataclasses.replace(flat.geometry, tangents=np.float32([tangent] * 4))
    place = np.diag([mirror, 1.0, 1.0, 1.0])
    # The same red and green as above.
    for rgb, bent in zip(((204, 128, 230), (128, 204, 230)), expected, strict=True):
        bump = Texture(np.full((2, 2, 4), (*rgb, 255), np.uint8), is_srgb=False)
        paint = Material(normal_texture=bump)
        scene = on_device(
            dataclasses.replace(flat, geometry=geometry, material=paint, world_from_object=place)
        )
        g = looked_at(gpu, commands, owned, scene)
        seen = g.normal.read()[on_square(1.0, 1.0)][:, :3].astype(float)
        np.testing.assert_allclose(seen, np.tile(bent, (len(seen), 1)), atol=0.01)


def test_from_behind_tangents_show_the_same_bumps_as_texture_coordinates(
    gpu, commands, owned, on_device, square
):
    bump = Texture(np.full((2, 2, 4), (204, 150, 230, 255), np.uint8), is_srgb=False)
    by_uvs = square((0, 0, 0), (1, 0, 0), (0, 1, 0), Material(normal_texture=bump), uvs=UVS)
    tangents = np.float32([(1, 0, 0, 1)] * 4)
    by_tangents = dataclasses.replace(
        by_uvs, geometry=dataclasses.replace(by_uvs.geometry, tangents=tangents)
    )
    seen = [
        looked_at(gpu, commands, owned, on_device(mesh), eye=(0, 0, -2), forward=(0, 0, 1))
        .normal.read()
        .astype(float)
        for mesh in (by_uvs, by_tangents)
    ]
    np.testing.assert_allclose(seen[1], seen[0], atol=0.01)


def test_an_image_is_not_blurred_along_the_edges_of_triangles(
    gpu, commands, owned, on_device, square
):
    pixels = np.full((8, 8, 4), 255, np.uint8)
    pixels[:, :4, :3] = 0
    stripes = Texture(pixels, is_srgb=False, wrap=("clamp", "clamp"))
    paint = Material(base_color=(1, 1, 1), base_color_texture=stripes)
    scene = on_device(square((0, 0, 0), (1, 0, 0), (0, 1, 0), paint, uvs=UVS))
    seen = on_square(1.0, 1.0)
    albedo = looked_at(gpu, commands, owned, scene).albedo.read()[seen][:, 0].astype(float)
    columns = np.nonzero(seen)[1]
    for column in np.unique(columns):
        same = albedo[columns == column]
        np.testing.assert_allclose(same, same[0], atol=0.02)


@pytest.mark.parametrize("name", ["base_color", "metallic_roughness", "normal", "emission"])
def test_a_placed_image_is_one_on_other_texture_coordinates(
    gpu, commands, owned, on_device, square, name
):
    """A map's scale and offset against vertices that have them already."""
    rng = np.random.default_rng(7)
    small = rng.integers(60, 255, (4, 4, 4)).astype(np.uint8)
    pixels = np.repeat(np.repeat(small, 8, axis=0), 8, axis=1)
    pixels[..., 3] = 255
    shared = {"base_color": (0.8, 0.7, 0.6), "emission": (2.0, 1.0, 3.0), "roughness": 0.9}
    scale, offset = (0.5, 0.25), (0.25, 0.5)
    placed = Texture(pixels, is_srgb=False, scale=scale, offset=offset)
    found = []
    for image, uvs in ((placed, UVS), (Texture(pixels, is_srgb=False), UVS * scale + offset)):
        paint = Material(**shared, **{f"{name}_texture": image})
        mesh = square((0, 0, 0), (1, 0, 0), (0, 1, 0), paint, uvs=uvs.astype(np.float32))
        g = looked_at(gpu, commands, owned, on_device(mesh))
        found.append([t.read().astype(float) for t in (g.albedo, g.normal, g.emission)])
    for one, other in zip(*found, strict=True):
        np.testing.assert_allclose(one, other, atol=0.03 * max(1.0, other.max()))


def test_images_stay_the_same_as_their_draws_are_recorded(gpu, commands, owned, on_device, square):
    """The second and third image of a view are replayed; a mesh that moves is where it is."""
    image = Texture(np.full((2, 2, 4), 200, np.uint8), is_srgb=False)
    meshes = [
        square((0, 0, 0), (1, 0, 0), (0, 1, 0), Material(base_color=(0, 0, 1))),
        square((0.5, 0, 0.5), (0.2, 0, 0), (0, 0.2, 0), Material(base_color=(0, 1, 0))),
        square(
            (-0.5, 0, 0.5),
            (0.2, 0, 0),
            (0, 0.2, 0),
            Material(base_color_texture=image, alpha_cutoff=0.5),
            uvs=UVS,
        ),
    ]
    scene, made = on_device(*meshes), owned(GBuffer(gpu, (WIDTH, HEIGHT)))
    clip = clip_from_view_infinite(np.pi / 2, WIDTH / HEIGHT, NEAR_M)
    clip = clip @ view_from_world((0, 0, 2.0), (0, 0, -1), (0, 1, 0))

    def images():
        for _ in range(4):
            made.encode(commands, scene, clip @ np.diag([0.5, 0.5, 0.5, 1.0]))  # looked away
            made.encode(commands, scene, clip)
            commands.submit()
            yield np.concatenate([made.albedo.read(), made.depth.read()[..., None]], axis=-1)

    first, *later = images()
    assert len(np.unique(first.reshape(-1, 5), axis=0)) == 4  # three squares and nothing
    for image in later:
        np.testing.assert_array_equal(image, first)
    up = np.eye(4)
    up[1, 3] = 0.5
    moved = [dataclasses.replace(m, world_from_object=up @ m.world_from_object) for m in meshes]
    scene.move(tuple(moved))
    fresh = looked_at(gpu, commands, owned, on_device(*moved))
    for image in images():
        np.testing.assert_array_equal(image[..., :4], fresh.albedo.read())


def test_what_is_seen_is_kept_until_something_moves(
    gpu, commands, owned, on_device, square, monkeypatch
):
    mesh = square((0, 0, 0), (1, 0, 0), (0, 1, 0), Material(base_color=(0, 0, 1)))
    scene, made = on_device(mesh), owned(GBuffer(gpu, (WIDTH, HEIGHT)))
    clip = clip_from_view_infinite(np.pi / 2, WIDTH / HEIGHT, NEAR_M)
    clip = clip @ view_from_world((0, 0, 2.0), (0, 0, -1), (0, 1, 0))
    drawn, render = [], commands.render
    monkeypatch.setattr(commands, "render", lambda *a, **k: drawn.append(a) or render(*a, **k))

    def passes(scene, clip):
        drawn.clear()
        made.encode(commands, scene, clip)
        commands.submit()
        return len(drawn)

    turned = clip @ np.diag([0.5, 1.0, 1.0, 1.0])
    assert [passes(scene, c) > 0 for c in (clip, clip, turned, clip, clip)] == [1, 0, 1, 1, 0]
    up = np.eye(4)
    up[1, 3] = 0.5
    scene.move((dataclasses.replace(mesh, world_from_object=up),))
    assert passes(scene, clip) > 0
    assert passes(scene, clip) == 0
    assert passes(on_device(mesh), clip) > 0
    made.resize((HEIGHT, WIDTH))
    assert passes(scene, clip) > 0


def test_what_failed_is_drawn_again(gpu, commands, owned, on_device, square, monkeypatch):
    scene = on_device(square((0, 0, 0), (1, 0, 0), (0, 1, 0), Material(base_color=(0, 0, 1))))
    made = owned(GBuffer(gpu, (WIDTH, HEIGHT)))
    clip = clip_from_view_infinite(np.pi / 2, WIDTH / HEIGHT, NEAR_M)
    clip = clip @ view_from_world((0, 0, 2.0), (0, 0, -1), (0, 1, 0))
    with monkeypatch.context() as patch, pytest.raises(RuntimeError, match="no more memory"):
        patch.setattr(scene, "solid", _fails)
        made.encode(commands, scene, clip)
    made.encode(commands, scene, clip)
    commands.submit()
    np.testing.assert_array_equal(made.depth.read() > 0.0, on_square(1.0, 1.0))


def test_views_interleaved_are_recorded(gpu, commands, owned, on_device, square, monkeypatch):
    squares = [square((x, 0, 0), (0.4, 0, 0), (0, 0.4, 0)) for x in (0.0, 90.0)]
    glowing = Texture(np.full((2, 2, 4), 255, np.uint8))
    squares += [
        dataclasses.replace(m, material=Material(emission_texture=glowing, emission=(1, 1, 1)))
        for m in squares
    ]
    scene, made = on_device(*squares), owned(GBuffer(gpu, (WIDTH, HEIGHT)))
    clip = clip_from_view_infinite(np.pi / 2, WIDTH / HEIGHT, NEAR_M)
    clips = [clip @ view_from_world((x, 0, 2.0), (0, 0, -1), (0, 1, 0)) for x in (0.0, 0.01)]
    encoded, encode = [], MeshPass._encode
    monkeypatch.setattr(MeshPass, "_encode", lambda *a: encoded.append(a) or encode(*a))
    counts = []
    for _ in range(4):
        encoded.clear()
        for clip in clips:
            made.encode(commands, scene, clip)
            commands.submit()
        counts.append(len(encoded))
    assert counts[0] == counts[1] >= 2
    assert counts[2:] == [0, 0]


def test_colours_that_come_later_are_seen(gpu, commands, owned, on_device, square):
    mesh = square((0, 0, 0), (1, 0, 0), (0, 1, 0), Material(base_color=(0.5, 0.5, 1.0)))
    scene, made = on_device(mesh), owned(GBuffer(gpu, (WIDTH, HEIGHT)))
    clip = clip_from_view_infinite(np.pi / 2, WIDTH / HEIGHT, NEAR_M)
    clip = clip @ view_from_world((0, 0, 2.0), (0, 0, -1), (0, 1, 0))
    for color in (None, 0.5, None):
        colors = None if color is None else np.full((4, 4), color, np.float32)
        geometry = dataclasses.replace(mesh.geometry, colors=colors)
        scene.move((dataclasses.replace(mesh, geometry=geometry),))
        made.encode(commands, scene, clip)
        commands.submit()
        seen = made.albedo.read()[HEIGHT // 2, WIDTH // 2, :3].astype(float)
        np.testing.assert_allclose(seen, np.array([0.5, 0.5, 1.0]) * (color or 1.0), atol=1e-3)


def _fails(clip_from_world):
    raise RuntimeError("no more memory")
