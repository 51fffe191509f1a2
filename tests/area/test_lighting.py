"""Direct light of emitters in images, against closed forms and quadrature."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from airlight.errors import SceneError
from airlight.maths import area_light
from airlight.maths.sampling import orthonormal_frame
from airlight.rendering import Renderer, render
from airlight.scene import (
    AreaLight,
    Camera,
    Material,
    Medium,
    Mesh,
    PointLight,
    Scene,
    SpotLight,
)
from airlight.scene.shapes import quad, sphere

SIZE = (32, 24)
SMALL = {"resolution": 8, "surfels": 100, "lamp_resolution": 128}
CAMERA = Camera((0.0, 5.0, 4.0), (0.0, 0.0, 0.0), fov_y_deg=35.0)
MATT = Material(base_color=(0.6, 0.4, 0.2), specular=0.0)
FLOOR = Mesh(quad(), MATT, np.diag((20.0, 1.0, 20.0, 1.0)))


def drawn(*lights, material=MATT, meshes=(), technique="direct", **settings):
    floor = Mesh(quad(), material, np.diag((20.0, 1.0, 20.0, 1.0)))
    scene = Scene(meshes=(floor, *meshes), lights=tuple(lights), camera=CAMERA)
    return render(scene, technique, SIZE, samples=1, settings={**SMALL, **settings})


def floor_points(image, camera_rays):
    rays = camera_rays(CAMERA, SIZE)
    return np.array(CAMERA.position) + rays * image.layers["depth"][..., None]


def from_floor(points: np.ndarray) -> np.ndarray:
    """Coordinates with +z along the floor's normal: (x, z, y), mirrored, which no formula minds."""
    return points[..., [0, 2, 1]]


RECTANGLE = AreaLight(
    (0.3, 1.2, -0.4), 5.0, direction=(0.2, -1.0, 0.1), size=(1.5, 0.8), visible=False
)
DISK = AreaLight(
    (0.3, 1.2, -0.4), 5.0, "disk", direction=(0.2, -1.0, 0.1), radius=0.6, visible=False
)
BALL = AreaLight((0.3, 0.9, -0.4), 5.0, "sphere", radius=0.5, visible=False)


def expected_irradiance(light: AreaLight, point: np.ndarray) -> float:
    centre = np.array(light.position) - point
    if light.shape == "sphere":
        return area_light.sphere_irradiance(from_floor(centre), light.radius)
    normal = np.array(light.direction)
    if light.shape == "disk":
        return area_light.polygon_irradiance(
            from_floor(area_light.rim(centre, normal, light.radius))
        )
    up = np.array(light.up) - np.dot(light.up, normal) * normal
    up /= np.linalg.norm(up)
    width, height = light.size
    side, up = 0.5 * width * np.cross(up, normal), 0.5 * height * up
    corners = centre + np.array([-side - up, side - up, side + up, up - side])
    return area_light.polygon_irradiance(from_floor(corners))


@pytest.mark.parametrize("light", [RECTANGLE, DISK, BALL], ids=lambda light: light.shape)
def test_the_floor_under_a_light_is_the_view_factor(light, camera_rays) -> None:
    image = drawn(light)
    points = floor_points(image, camera_rays)
    irradiance = np.array([[expected_irradiance(light, p) for p in row] for row in points])
    expected = irradiance[..., None] * 5.0 * np.array(MATT.base_color) / np.pi
    # Spheres are meshes of 64 x 32: 0.2 % of their area is missing.
    np.testing.assert_allclose(image.layers["direct"], expected, rtol=5e-3, atol=1e-4)


def test_gloss_is_the_transformed_cosine(camera_rays) -> None:
    shiny = Material(base_color=(0.9, 0.6, 0.3), metallic=1.0, roughness=0.4)
    image = drawn(RECTANGLE, material=shiny)
    points = floor_points(image, camera_rays)
    f0, alpha = np.array(shiny.base_color), shiny.roughness**2
    light = RECTANGLE
    normal = np.array(light.direction)
    up = np.array(light.up) - np.dot(light.up, normal) * normal
    up /= np.linalg.norm(up)
    side, up = 0.75 * np.cross(up, normal), 0.4 * up
    for row, column in ((8, 10), (12, 16), (16, 20), (20, 8)):
        p = points[row, column]
        corners = (
            np.array(light.position) - p + np.array([-side - up, side - up, side + up, up - side])
        )
        view = np.array(CAMERA.position) - p
        view = from_floor(view / np.linalg.norm(view))
        share = area_light.specular_share(from_floor(corners), view, alpha)
        _, albedos = area_light.specular_cosine(float(view[2]), alpha)
        expected = 5.0 * share * (f0 * albedos[0] + albedos[1])
        np.testing.assert_allclose(
            image.layers["direct"][row, column], expected, rtol=0.02, atol=2e-3
        )


def test_the_back_is_dark_unless_it_glows_too() -> None:
    up = AreaLight((0, 1, 0), 5.0, direction=(0, 1, 0), visible=False)
    assert drawn(up).layers["direct"].max() == 0.0
    both = AreaLight((0, 1, 0), 5.0, direction=(0, 1, 0), two_sided=True, visible=False)
    down = AreaLight((0, 1, 0), 5.0, visible=False)
    # The same square from below, its corners in another order.
    np.testing.assert_allclose(
        drawn(both).layers["direct"], drawn(down).layers["direct"], rtol=1e-4, atol=1e-6
    )


def test_what_is_seen_casts_shadows_and_glows() -> None:
    low = AreaLight((0, 0.3, 0), 5.0, direction=(0, 1, 0), size=(2.0, 2.0))
    local_light = AreaLight((0, 4, 0), 5.0, size=(0.2, 0.2), visible=False)
    image = drawn(low, local_light)
    assert image.layers["direct"].max() == pytest.approx(5.0, rel=0.3)
    # Under the sheet the lamp is hidden.
    dark = image.layers["direct"][..., 0] < 1e-3
    assert 5 < dark.sum() < 200


@pytest.mark.parametrize("samples", [16, 64])
def test_soft_shadows_against_quadrature(samples: int, camera_rays) -> None:
    light = AreaLight((0, 3, 0), 4.0, size=(1.0, 1.0), visible=False)
    blind = Mesh(
        quad(), MATT, np.array([[1.6, 0, 0, 0.9], [0, 1, 0, 1.0], [0, 0, 1.6, 0], [0, 0, 0, 1]])
    )
    image = drawn(light, meshes=(blind,), area_samples=samples, lamp_resolution=512)
    points = floor_points(image, camera_rays)
    at = (np.arange(24) + 0.5) / 24 - 0.5
    x, z = (v.ravel() for v in np.meshgrid(at, at))
    on = np.stack([x, 0 * x + 3.0, z], axis=1)
    seen_floor = points[..., 1] < 0.01
    expected = np.zeros(SIZE[::-1])
    for row, column in zip(*np.nonzero(seen_floor), strict=True):
        path = on - points[row, column]
        through = points[row, column] + path / 3.0
        is_hit = (np.abs(through[:, 0] - 0.9) < 0.8) & (np.abs(through[:, 2]) < 0.8)
        squared = (path**2).sum(axis=1)
        expected[row, column] = (~is_hit * 9.0 / squared**2).mean()
    found = image.layers["direct"][..., 0] / (4.0 * MATT.base_color[0] / np.pi)
    difference = (found - expected)[seen_floor]
    # Sixteen samples make steps of a sixteenth in penumbrae, 64 of a 64th; measured .026, .015.
    relative = np.linalg.norm(difference) / np.linalg.norm(expected[seen_floor])
    assert relative < (0.05 if samples == 16 else 0.03)
    assert found[seen_floor].sum() == pytest.approx(expected[seen_floor].sum(), rel=0.02)


def test_samples_that_all_agree_are_half_as_many_in_frames(monkeypatch) -> None:
    # Over the floor a ball: most of the floor sees all of the light, some nothing.
    ball = Mesh(
        sphere(),
        MATT,
        np.array([[0.5, 0, 0, 0.3], [0, 0.5, 0, 0.6], [0, 0, 0.5, -0.4], [0, 0, 0, 1]]),
    )
    half = drawn(RECTANGLE, meshes=(ball,)).layers["direct"]
    monkeypatch.setattr("airlight.area.lighting.MANY", 1000)
    whole = drawn(RECTANGLE, meshes=(ball,)).layers["direct"]
    off = np.abs(half - whole).max(axis=2)
    # Where half of them disagree all are asked; rims of the penumbra are a few samples.
    differ = off > 1e-6 * whole.max()  # sums in another order are off by roundings
    assert 0 < differ.sum() < 0.1 * off.size
    assert np.linalg.norm(half - whole) < 0.02 * np.linalg.norm(whole)


def test_a_small_radius_changes_nothing_but_the_edge_of_shadows() -> None:
    for point, ball in (
        (PointLight((0, 2, 0), 3.0), PointLight((0, 2, 0), 3.0, radius=0.02)),
        (
            SpotLight((0, 2, 0), (0.2, -1, 0), 3.0, 20, 40),
            SpotLight((0, 2, 0), (0.2, -1, 0), 3.0, 20, 40, radius=0.02),
        ),
    ):
        hard, soft = drawn(point).layers["direct"], drawn(ball).layers["direct"]
        np.testing.assert_allclose(soft, hard, rtol=0.02, atol=0.01 * hard.max())


def test_bounces_and_stills(camera_rays) -> None:
    scene = Scene(meshes=(FLOOR,), lights=(RECTANGLE,), camera=CAMERA)
    still = render(scene, "lpv", SIZE, samples=4, settings=SMALL)
    once = render(scene, "direct", SIZE, samples=1, settings=SMALL)
    ratio = still.layers["direct"].sum() / once.layers["direct"].sum()
    assert ratio == pytest.approx(1.0, abs=0.01)


def test_a_frame_is_axes_at_right_angles() -> None:
    from airlight.area.emitters import Sample
    from airlight.area.table import frame, sample_views
    from airlight.scene.lights import LightSample

    light = LightSample((1, 2, 3), (0.0, 0.6, 0.8), (1, 1, 1))
    sample = Sample(light, 0.0, is_cube=False)
    axes = frame(sample)
    np.testing.assert_allclose(axes @ axes.T, np.eye(3), atol=1e-12)
    np.testing.assert_allclose(axes @ light.direction, np.full(3, 3**-0.5), atol=1e-12)
    # Every direction of the hemisphere lies in the view of the axis that it is nearest to.
    rng = np.random.default_rng(1)
    away = rng.normal(size=(500, 3))
    away /= np.linalg.norm(away, axis=1, keepdims=True)
    away = away[away @ np.array(light.direction) > 0.01]
    views = sample_views(sample, 1e-3, 20.0, 64)
    for direction in away:
        view = views[int((axes @ direction).argmax())]
        clip = view.clip_from_world @ np.append(np.array(light.position) + direction, 1.0)
        assert np.abs(clip[:2] / clip[3]).max() <= 1.0 + 1e-9
        assert 0.0 <= clip[2] / clip[3] <= 1.0
    side, up = orthonormal_frame(np.array(light.direction))
    assert abs(side @ up) < 1e-12


# What the floor alone, and a lamp under a low roof, tell lattices about gaps and walls.
ROOF = Mesh(
    quad(), MATT, np.diag((20.0, -1.0, -20.0, 1.0)) + np.eye(4)[1][:, None] * (0, 0, 0, 6.0)
)
MOVES = {
    "grows": (AreaLight((0, 1, 0), 5.0), AreaLight((0.4, 1.3, 0.2), 2.0, size=(2.0, 0.5))),
    "tilts": (
        AreaLight((0, 5.97, 0), 5.0, size=(9, 9)),
        AreaLight((0, 2, 0), 5.0, direction=(0.5, -1, 0.3), size=(9, 9)),
    ),
    "leaves": (AreaLight((0, 1, 0), 5.0, "disk"), AreaLight((0, 25, 0), 900.0, "disk", radius=2)),
    "ball": (AreaLight((1, 1, 0), 5.0, "sphere"), AreaLight((0, 3, 1), 9.0, "sphere", radius=0.2)),
}


@pytest.mark.parametrize("roof", [False, True])
@pytest.mark.parametrize("name", MOVES)
def test_a_light_that_moves_grows_and_dims_is_as_if_made_so(name, roof) -> None:
    first, then = MOVES[name]
    scene = Scene(meshes=(FLOOR, ROOF) if roof else (FLOOR,), lights=(first,), camera=CAMERA)
    with Renderer(scene, "lpv", SIZE, settings=SMALL) as renderer:
        renderer.frame()
        moved = renderer.frame(lights=[then])
        again = renderer.frame(lights=[first])
    fresh = render(replace(scene, lights=(then,)), "lpv", SIZE, samples=1, settings=SMALL)
    np.testing.assert_allclose(moved.radiance, fresh.radiance, rtol=1e-4, atol=1e-5)
    before = render(scene, "lpv", SIZE, samples=1, settings=SMALL)
    np.testing.assert_allclose(again.radiance, before.radiance, rtol=1e-4, atol=1e-5)


def test_a_mesh_keeps_its_material_but_for_its_emission() -> None:
    scene = Scene(meshes=(FLOOR,), lights=(PointLight((0, 1, 0), 1.0),), camera=CAMERA)
    with Renderer(scene, "direct", SIZE, settings=SMALL) as renderer:
        renderer.frame()
        with pytest.raises(SceneError, match="another material"):
            renderer.frame(meshes=[replace(FLOOR, material=Material(base_color=0.1))])


def test_every_technique_scatters_a_lights_light_in_fog() -> None:
    fog = Medium((0.3,) * 3, (0.9,) * 3, (0.0,) * 3, ((-3, 0, -3), (3, 3, 3)))
    light = AreaLight((0, 1.5, 0), 9.0, size=(0.5, 0.5))
    scene = Scene(meshes=(FLOOR,), lights=(light,), medium=fog, camera=CAMERA)
    found = {}
    for name, layer in (("single", "single_scatter"), ("pop", "scattered")):
        image = render(scene, name, SIZE, samples=1, settings={"resolution": 8, "surfels": 100})
        found[name] = float(image.layers[layer].mean())
    # What was scattered once, and what was any number of times, on a coarse grid.
    assert found["single"] > 0.0
    assert 0.9 < found["pop"] / found["single"] < 2.5


def test_gaps_do_not_open_where_the_maps_of_a_sample_meet(camera_rays) -> None:
    # A seam runs down a wall that nothing shadows: it has the closed form to the last pixel.
    turn = np.radians(17.0)
    axes = np.array([[np.cos(turn), 0, np.sin(turn)], [0, 1, 0], [-np.sin(turn), 0, np.cos(turn)]])
    matrix = np.eye(4)
    matrix[:3, :3] = axes @ np.array([[5, 0, 0], [0, 0, -5], [0, 5, 0]])
    camera, size = Camera(tuple(axes @ (0.3, 0.0, 3.0)), (0.0, 0.0, 0.0), fov_y_deg=40.0), (96, 72)
    light = AreaLight(
        tuple(axes @ (0.5, 2.2, 0.6)), 5.0, direction=(0, -1, 0), size=(0.2, 0.2), visible=False
    )
    scene = Scene(meshes=(Mesh(quad(), MATT, matrix),), lights=(light,), camera=camera)
    image = render(scene, "direct", size, samples=1, settings=SMALL)
    depth = image.layers["depth"][..., None]
    points = np.array(camera.position) + camera_rays(camera, size) * depth
    square = 0.1 * np.array([(-1, 0, -1), (1, 0, -1), (1, 0, 1), (-1, 0, 1)])
    corners = np.array(light.position) + square
    expected = [[area_light.polygon_irradiance((corners - p) @ axes) for p in r] for r in points]
    found = image.layers["direct"] / np.array(MATT.base_color) * np.pi / 5.0
    np.testing.assert_allclose(found[..., 0], expected, rtol=5e-3, atol=1e-4)


def test_a_coat_mirrors_what_stands_before_a_light_without_a_pattern() -> None:
    # 16 samples a light, or 64: seen at a grazing angle, each is smeared across the plane of view.
    coat = Material(base_color=(0.02, 0.02, 0.02), roughness=0.15)
    floor = Mesh(quad(), coat, np.diag((20.0, 1.0, 20.0, 1.0)))
    post = Mesh(
        quad(),
        Material(base_color=(0.0, 0.0, 0.0), specular=0.0),
        np.array([[0.3, 0, 0, 0], [0, 0, -0.3, 0.5], [0, 0.3, 0, 0.6], [0, 0, 0, 1.0]]),
    )
    light = AreaLight((0, 0.6, 0), 5.0, direction=(0, 0, 1), up=(0, 1, 0), size=(1, 1))
    camera = Camera((0.0, 0.7, 3.0), (0.0, 0.0, 1.0), fov_y_deg=35.0)
    scene = Scene(meshes=(floor, post), lights=(replace(light, visible=False),), camera=camera)
    few, many = (
        render(scene, "direct", (64, 48), samples=1, settings={**SMALL, "area_samples": n})
        for n in (16, 64)
    )
    truth = many.layers["direct"]
    off = np.sqrt(((few.layers["direct"] - truth) ** 2).sum() / (truth**2).sum())
    assert off < 0.08, off
