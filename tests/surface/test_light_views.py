"""Where world points fall in what lights see, by formulas of their own."""

from __future__ import annotations

import numpy as np
import pytest

from airlight.scene import DirectionalLight, PointLight, SpotLight
from airlight.surface.light_views import light_views, view_count, widened

LOW, HIGH = np.array([-2.0, 0.0, -3.0]), np.array([4.0, 2.5, 1.0])
DIRECTIONS = [(0, -1, 0), (1, 0, 0), (0.3, -0.62, 0.72), (0, 1, 0), (-0.2, -0.9, -0.1)]
POINTS = np.random.default_rng(3).uniform(LOW, HIGH, size=(200, 3))


def seen(view, points):
    """(u, v, depth) in [0, 1] where inside, and w."""
    clip = np.concatenate([points, np.ones((len(points), 1))], axis=1) @ view.clip_from_world.T
    ndc = clip[:, :3] / clip[:, 3:]
    return np.stack([0.5 + 0.5 * ndc[:, 0], 0.5 - 0.5 * ndc[:, 1], ndc[:, 2]], axis=1), clip[:, 3]


def sun(direction):
    return DirectionalLight(direction, (1, 1, 1))


@pytest.mark.parametrize("direction", DIRECTIONS)
def test_parallel_light_moves_only_the_depth_along_its_direction(direction):
    (view,) = light_views([sun(direction)], LOW, HIGH, 64)
    d = np.asarray(direction) / np.linalg.norm(direction)
    before, _ = seen(view, POINTS)
    after, _ = seen(view, POINTS + 0.5 * d)
    np.testing.assert_allclose(after[:, :2], before[:, :2], atol=1e-12)
    step = after[:, 2] - before[:, 2]
    np.testing.assert_allclose(step, step[0], rtol=1e-9)
    assert step[0] > 0.0


@pytest.mark.parametrize("direction", DIRECTIONS)
def test_parallel_light_sees_the_whole_box(direction):
    (view,) = light_views([sun(direction)], LOW, HIGH, 64)
    corners = np.array(np.meshgrid(*zip(LOW, HIGH, strict=True))).reshape(3, 8).T
    uvd, _ = seen(view, corners)
    assert (uvd >= 0.0).all()
    assert (uvd <= 1.0).all()


@pytest.mark.parametrize("direction", DIRECTIONS)
def test_a_texel_of_parallel_light_is_as_large_as_it_says(direction):
    (view,) = light_views([sun(direction)], LOW, HIGH, 64)
    d = np.asarray(direction) / np.linalg.norm(direction)
    across = np.cross(d, [0.1, 0.2, 0.9])
    across /= np.linalg.norm(across)
    up = np.cross(d, across)
    centre = (LOW + HIGH) / 2.0
    uvd, _ = seen(view, np.array([centre, centre + across, centre + up]))
    # the determinant of metres -> texels is one over the texel's area
    texels = (uvd[1:, :2] - uvd[0, :2]) * 64
    assert abs(np.linalg.det(texels)) == pytest.approx(1.0 / (view.texel[0] * view.texel[1]))


def test_the_texels_of_parallel_light_cover_the_box_and_little_more():
    (view,) = light_views([sun((0, -1, 0))], LOW, HIGH, 128)
    area = view.texel[0] * view.texel[1] * 128**2
    assert 24.0 < area < 24.0 * 1.06  # 6 m x 4 m seen from above


def test_parallel_texels_stay_where_they_are_in_the_world():
    for extra in (0.0, 1e-4, 0.013):
        (view,) = light_views([sun((0.3, -0.62, 0.72))], LOW, HIGH + extra, 64)
        uvd, _ = seen(view, np.zeros((1, 3)))
        texel = uvd[0, :2] * 64
        np.testing.assert_allclose(texel, np.round(texel), atol=1e-6)


def test_a_spot_sees_its_cone_by_the_tangent_of_the_angle():
    spot = SpotLight((1.0, 2.0, 0.5), (0.2, -1.0, 0.4), (1, 1, 1), inner_deg=20, outer_deg=30)
    (view,) = light_views([spot], LOW, HIGH, 64)
    axis = np.array(spot.direction)
    side = np.cross(axis, [1.0, 0.0, 0.0])
    side /= np.linalg.norm(side)
    angles = np.radians([0.0, 10.0, 20.0, 29.9])
    rays = np.cos(angles)[:, None] * axis + np.sin(angles)[:, None] * side
    uvd, w = seen(view, np.array(spot.position) + 1.7 * rays)
    # half the image is what the spot's half angle, and a little more, reaches
    radius = np.linalg.norm(uvd[:, :2] - 0.5, axis=1)
    half_width_m = view.texel[0] * 64 / 2.0
    np.testing.assert_allclose(radius, 0.5 * np.tan(angles) / half_width_m, atol=1e-9)
    assert np.tan(np.radians(30.0)) < half_width_m < 1.05 * np.tan(np.radians(30.0))
    np.testing.assert_allclose(w, 1.7 * np.cos(angles), rtol=1e-9)


def test_perspective_depth_is_conventional_and_reaches_the_whole_box():
    (view,) = light_views([SpotLight((0, 2, 0), (0, -1, 0), (1, 1, 1))], LOW, HIGH, 64)
    distances = np.linspace(0.02, 2.0, 50)
    uvd, _ = seen(view, np.array([0, 2, 0]) - distances[:, None] * np.array([0, 1, 0]))
    assert (np.diff(uvd[:, 2]) > 0.0).all()
    assert uvd[0, 2] > 0.0
    assert uvd[-1, 2] < 1.0


def test_cube_faces_cover_every_direction_once():
    local_light = PointLight((0.5, 1.0, -1.0), (1, 1, 1))
    views = light_views([local_light], LOW, HIGH, 16)
    assert len(views) == view_count(local_light) == 6
    rays = np.random.default_rng(1).normal(size=(500, 3))
    rays /= np.linalg.norm(rays, axis=1, keepdims=True)
    inside = []
    for view in views:
        uvd, w = seen(view, np.array(local_light.position) + rays)
        inside.append((w > 0) & (uvd[:, :2] > 0).all(axis=1) & (uvd[:, :2] < 1).all(axis=1))
    # faces in the order +x -x +y -y +z -z, each where its axis is the longest
    axis = np.argmax(np.abs(rays), axis=1)
    expected = 2 * axis + (rays[np.arange(500), axis] < 0.0)
    np.testing.assert_array_equal(np.array(inside), np.arange(6)[:, None] == expected)


def test_the_solid_angles_of_a_cube_sum_to_the_sphere():
    views = light_views([PointLight((0, 0, 0), (1, 1, 1))], LOW, HIGH, 64)
    total = 0.0
    for view in views:
        tangent = (np.arange(64) + 0.5 - 32.0) * view.texel[0]
        squared = 1.0 + tangent[:, None] ** 2 + tangent**2
        total += float((view.texel[0] * view.texel[1] * squared**-1.5).sum())
    assert total == pytest.approx(4.0 * np.pi, rel=1e-3)


@pytest.mark.parametrize(("outer_deg", "count"), [(30.0, 1), (50.0, 1), (80.0, 6)])
def test_wide_spots_see_as_points_do(outer_deg, count):
    spot = SpotLight((0, 1, 0), (0, -1, 0), (1, 1, 1), inner_deg=10, outer_deg=outer_deg)
    assert view_count(spot) == len(light_views([spot], LOW, HIGH, 8)) == count


def test_views_come_in_the_order_of_their_lights():
    lights = [sun((0, -1, 0)), PointLight((0, 1, 0), (1, 1, 1)), sun((1, 0, 0))]
    views = light_views(lights, LOW, HIGH, 8)
    assert [view.light for view in views] == [0, *[1] * 6, 2]
    assert [view.is_perspective for view in views] == [False, *[True] * 6, False]


@pytest.mark.parametrize(
    "light", [sun((0.3, -0.6, 0.7)), SpotLight((0, 1, 0), (0, -1, 0), (1, 1, 1))]
)
def test_fields_hold_the_inverse(light):
    (view,) = light_views([light], LOW, HIGH, 8)
    product = np.asarray(view.fields["world_from_clip"]) @ view.clip_from_world
    np.testing.assert_allclose(product, np.eye(4), atol=1e-9)


def test_a_widened_view_shows_the_same_in_the_middle_of_its_map():
    (view,) = light_views([sun((0.3, -0.62, 0.72))], LOW, HIGH, 64)
    wide = widened(view, 2.0)
    narrow_uvd, _ = seen(view, POINTS)
    uvd, _ = seen(wide, POINTS)
    np.testing.assert_allclose(uvd[:, :2] - 0.5, 0.5 * (narrow_uvd[:, :2] - 0.5), atol=1e-12)
    np.testing.assert_allclose(uvd[:, 2], narrow_uvd[:, 2], atol=1e-12)
    assert wide.texel == (2.0 * view.texel[0], 2.0 * view.texel[1])
