"""Direct light against closed forms: Lambert, shadows, emission, the sky, gloss."""

from __future__ import annotations

import itertools

import numpy as np
import pytest

from airlight.rendering import Renderer, render
from airlight.scene import (
    Camera,
    DirectionalLight,
    Environment,
    Material,
    Medium,
    Mesh,
    PointLight,
    Scene,
    SpotLight,
)
from airlight.scene.shapes import box

SIZE = (64, 48)
SMALL = {"resolution": 8, "sky_lights": 8, "sky_resolution": 8, "surfels": 10}
ALBEDO = np.array([0.5, 0.25, 0.125])
MATT = Material(base_color=tuple(ALBEDO), specular=0.0)
CAMERA = Camera(position=(0.0, 3.0, 6.0), target=(0.0, 0.0, 0.0), fov_y_deg=50.0)
OCCLUDER = (np.array([0.6, 1.0, -0.2]), 0.5)  # centre, half side; parallel to the floor

SUN = DirectionalLight((0.3, -1.0, 0.2), (3.0, 2.0, 1.0))
LIGHT = PointLight((0.5, 2.5, 0.3), (10.0, 8.0, 6.0))
NARROW = SpotLight((0.2, 3.0, 0.1), (0.1, -1.0, -0.1), (20.0, 20.0, 20.0), 20.0, 30.0)
WIDE = SpotLight((0.2, 2.0, 0.1), (0.1, -1.0, -0.1), (9.0, 9.0, 9.0), 40.0, 70.0)


def arriving(light, points):
    """Unshadowed: unit vectors to the light (..., 3), irradiance at normal incidence (..., 3)."""
    if isinstance(light, DirectionalLight):
        to = np.broadcast_to(-np.array(light.direction), points.shape)
        return to, np.broadcast_to(np.array(light.irradiance), points.shape)
    delta = np.array(light.position) - points
    distance = np.linalg.norm(delta, axis=-1, keepdims=True)
    to, strength = delta / distance, np.array(light.intensity) / distance**2
    if isinstance(light, SpotLight):
        cosine = -(to @ np.array(light.direction))
        inner, outer = np.cos(np.radians([light.inner_deg, light.outer_deg]))
        x = np.clip((cosine - outer) / (inner - outer), 0.0, 1.0)
        strength = strength * (x * x * (3.0 - 2.0 * x))[..., None]
    return to, strength


def occluder_reach(to_light, points):
    """How far from the occluder's centre, by its larger side, the path to the light passes."""
    centre, _ = OCCLUDER
    crossing = points + to_light * ((centre[1] - points[..., 1]) / to_light[..., 1])[..., None]
    return np.abs(crossing - centre)[..., [0, 2]].max(axis=-1)


@pytest.mark.parametrize("light", [SUN, LIGHT, NARROW, WIDE])
def test_a_floor_under_an_occluder(rendered, square, seen_points, light):
    centre, half = OCCLUDER
    floor = square((0, 0, 0), (4, 0, 0), (0, 0, -4), MATT)
    shade = square(centre, (half, 0, 0), (0, 0, -half), MATT)
    image = rendered(Scene(meshes=(floor, shade), lights=(light,), camera=CAMERA))
    points = seen_points(image, CAMERA)
    on_floor = np.isfinite(points).all(axis=-1) & (np.abs(points[..., 1]) < 1e-3)
    points, seen = points[on_floor], image.layers["direct"][on_floor].astype(np.float64)
    to, irradiance = arriving(light, points)
    expected = ALBEDO / np.pi * irradiance * to[:, 1:2]
    reach = occluder_reach(to, points)
    lit, dark = reach > half + 0.08, reach < half - 0.08
    assert lit.sum() > 400
    assert dark.sum() > 10
    np.testing.assert_allclose(seen[lit], expected[lit], rtol=3e-3, atol=2e-3 * expected.max())
    assert seen[dark].max() < 1e-4 * expected.max()
    # between them light only falls
    assert (seen <= expected * 1.003 + 2e-3 * expected.max()).all()


@pytest.mark.parametrize("local_light", [LIGHT, WIDE])
def test_nothing_leaks_out_of_a_closed_box_around_a_light(rendered, local_light):
    # All edges between the six maps of a lamp fall on walls that are wholly dark.
    at = np.eye(4)
    at[:3, :3] *= 0.4
    at[:3, 3] = local_light.position
    room = np.diag([8.0, 6.0, 8.0, 1.0])
    room[:3, 3] = (0.0, 2.0, 0.0)
    shell = Mesh(box(), Material(base_color=(0.0, 0.0, 0.0), specular=0.0), at)
    walls = Mesh(box(), Material(base_color=(0.8, 0.8, 0.8), specular=0.0, two_sided=True), room)
    for target in ((0.0, 2.0, -1.0), (1.0, 2.0, 0.0), (-1.0, 2.0, 1.0), (0.3, 0.0, -0.2)):
        eye = Camera(position=(0.0, 2.0, 3.9), target=target, fov_y_deg=80.0)
        image = rendered(Scene(meshes=(shell, walls), lights=(local_light,), camera=eye))
        assert image.layers["direct"].max() == 0.0


def test_lights_add_up(rendered, square):
    floor = square((0, 0, 0), (4, 0, 0), (0, 0, -4), MATT)

    def direct(*lights):
        scene = Scene(meshes=(floor,), lights=lights, camera=CAMERA)
        return rendered(scene).layers["direct"].astype(np.float64)

    lights = (LIGHT, SUN, NARROW, WIDE)
    apart = sum(direct(light) for light in lights)
    np.testing.assert_allclose(direct(*lights), apart, rtol=1e-4, atol=1e-5)


def test_a_surface_turned_away_is_dark(rendered, square):
    from_below = DirectionalLight((0, 1, 0), (5, 5, 5))
    floor = square((0, 0, 0), (4, 0, 0), (0, 0, -4), MATT)
    image = rendered(Scene(meshes=(floor,), lights=(from_below,), camera=CAMERA))
    assert image.radiance.max() < 1e-4


def test_emission_is_its_radiance_on_both_sides_where_two_sided(rendered, square):
    for normal, two_sided, is_seen in ((1, True, True), (-1, True, True), (-1, False, False)):
        glow = Material(
            base_color=(0, 0, 0), emission=(8.0, 4.0, 2.0), specular=0.0, two_sided=two_sided
        )
        panel = square((0, 0, 0), (normal, 0, 0), (0, 1, 0), glow)
        camera = Camera(position=(0, 0, 2), target=(0, 0, 0), fov_y_deg=30.0)
        image = rendered(Scene(meshes=(panel,), camera=camera))
        expected = [8.0, 4.0, 2.0] if is_seen else [0.0, 0.0, 0.0]
        np.testing.assert_allclose(image.layers["direct"][24, 32], expected, rtol=1e-6)


def rows_of_directions(height=64):
    """A latitude-longitude map whose colour is its direction: 0.5 + 0.5 (x, y, z)."""
    v, u = np.meshgrid(
        (np.arange(height) + 0.5) / height,
        (np.arange(2 * height) + 0.5) / (2 * height),
        indexing="ij",
    )
    # u = atan2(x, -z) / 2 pi, v = acos(y) / pi
    sine = np.sin(np.pi * v)
    x, y, z = sine * np.sin(2 * np.pi * u), np.cos(np.pi * v), -sine * np.cos(2 * np.pi * u)
    return (0.5 + 0.5 * np.stack([x, y, z], axis=-1)).astype(np.float32)


VIEWS = [(0, 0, -1), (1, 0.3, 0), (-1, -0.2, 0.8), (0.1, 1, 0)]


def test_the_background_is_the_map_the_right_way_round(gpu, camera_rays):
    pixels = rows_of_directions()
    with Renderer(Scene(environment=Environment()), "direct", SIZE, settings=SMALL) as renderer:
        for rotation_deg, target in itertools.product((0.0, 70.0), VIEWS):
            sky = Environment(map=pixels, rotation_deg=rotation_deg, scale=2.0)
            camera = Camera(position=(0, 0, 0), target=target, fov_y_deg=70.0)
            image = renderer.frame(camera=camera, environment=sky)
            x, y, z = np.moveaxis(camera_rays(camera, SIZE), -1, 0)
            c, s = np.cos(np.radians(rotation_deg)), np.sin(np.radians(rotation_deg))
            # the map turned counter-clockwise from above: what stood at +x now stands towards -z
            in_map = np.stack([c * x - s * z, y, s * x + c * z], axis=-1)
            np.testing.assert_allclose(image.radiance, 1.0 + in_map, atol=0.05)
            assert np.isinf(image.layers["depth"]).all()


def test_an_invisible_sky_lights_but_is_not_seen(rendered, square):
    floor = square((0, 0, 0), (2, 0, 0), (0, 0, -2), MATT)
    sky = Environment(radiance=(1, 1, 1), visible=False)
    image = rendered(Scene(meshes=(floor,), environment=sky, camera=CAMERA))
    is_floor = np.isfinite(image.layers["depth"])
    assert not image.radiance[~is_floor].any()
    middle = image.radiance[24, 32].astype(np.float64)
    # nothing stands between a lone floor and the upper half of the sky: radiance = albedo
    np.testing.assert_allclose(middle, ALBEDO, rtol=0.06)


def test_gloss_mirrors_the_sun_where_the_mirror_would(rendered, square, seen_points):
    mirror_like = Material(base_color=(0, 0, 0), roughness=0.2)
    floor = square((0, 0, 0), (4, 0, 0), (0, 0, -4), mirror_like)
    sun = DirectionalLight((0, -1, 2.0), (3, 3, 3))
    image = rendered(Scene(meshes=(floor,), lights=(sun,), camera=CAMERA))
    brightness = image.layers["direct"].sum(axis=-1)
    where = np.unravel_index(np.argmax(brightness), brightness.shape)
    # the mirrored direction from the eye to the sun: down by the sun's slope, at the floor
    hit = seen_points(image, CAMERA)[where]
    expected = np.array([0.0, 0.0, 6.0 - 3.0 * 2.0])
    assert np.linalg.norm(hit - expected) < 0.8  # the Fresnel term draws it a little farther


def test_a_metal_has_no_matt_part(rendered, square):
    metal = Material(base_color=(1, 1, 1), metallic=1.0, roughness=0.05)
    floor = square((0, 0, 0), (4, 0, 0), (0, 0, -4), metal)
    image = rendered(
        Scene(meshes=(floor,), lights=(DirectionalLight((0, -1, 0), (9, 9, 9)),), camera=CAMERA)
    )
    # the mirrored sun is straight above, nowhere near the camera
    assert image.layers["direct"].max() < 0.05


@pytest.mark.parametrize("technique", ["direct", "single"])
def test_rays_decide_where_shadow_maps_are_unsure(technique):
    """Maps of 64 and of 2048 texels: in stills the same edges, which the coarse one alone blurs."""
    fog = Medium(sigma_t=(0.1, 0.1, 0.1), albedo=(0.5, 0.5, 0.5), bounds=((-2, -1, -2), (2, 2, 2)))
    floor = Mesh(box(), MATT, np.diag((4.0, 0.05, 4.0, 1.0)))
    cube = Mesh(box(), MATT, np.diag((0.7, 0.7, 0.7, 1.0)))
    medium = fog if technique == "single" else None
    scene = Scene((floor, cube), (SUN,), camera=CAMERA, medium=medium)

    def direct(resolution, shadow_rays):
        settings = {**SMALL, "shadow_resolution": resolution, "shadow_rays": shadow_rays}
        return render(scene, technique, SIZE, samples=4, settings=settings).layers["direct"]

    fine = direct(2048, True)
    off = {traced: np.linalg.norm(direct(64, traced) - fine) for traced in (True, False)}
    assert off[True] < 0.1 * off[False], off
