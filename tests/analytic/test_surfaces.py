"""Light on surfaces: each kind of light on a Lambert floor, white furnaces, black floors."""

from __future__ import annotations

import math

import numpy as np
import pytest

from airlight.reference import quadrature
from airlight.scene import (
    Camera,
    DirectionalLight,
    Environment,
    Material,
    Mesh,
    PointLight,
    Scene,
    SpotLight,
)
from airlight.scene.shapes import sphere

ALBEDO = np.array([0.2, 0.5, 0.8])
ABOVE = Camera((0.3, 3.0, 0.2), (0.3, 0.0, 0.2), (0.0, 0.0, -1.0), 50.0)
LAMBERT = Material(base_color=tuple(ALBEDO), specular=0.0)
POSITION, AXIS = (0.7, 1.5, -0.4), (-0.28, -0.96, 0.0)
LIGHTS = {
    "directional": DirectionalLight((0.36, -0.8, 0.48), (3.0, 2.0, 1.0)),
    "point": PointLight(POSITION, (3.0, 2.0, 1.0)),
    "spot": SpotLight(POSITION, AXIS, (3.0, 2.0, 1.0), 20.0, 45.0),
}


def points_on_floor(rays):
    """Where the camera's rays meet y = 0."""
    return np.asarray(ABOVE.position) + rays * (-ABOVE.position[1] / rays[..., 1:2])


def irradiance_on_floor(light, p):
    """W m^-2 (H, W, 1) times the light's colour."""
    if isinstance(light, DirectionalLight):
        return np.full((*p.shape[:-1], 1), -light.direction[1])
    away = p - np.asarray(light.position)
    r = np.linalg.norm(away, axis=-1, keepdims=True)
    strength = -away[..., 1:2] / r**3
    if isinstance(light, SpotLight):
        cosine = (away / r) @ np.asarray(light.direction)
        strength = strength * quadrature.spot_falloff(cosine, 20.0, 45.0)[..., None]
    return strength


@pytest.mark.parametrize("kind", LIGHTS)
def test_a_lambert_floor_under_each_light(judged, square, camera_rays, error, kind):
    light = LIGHTS[kind]
    floor = square((0, 0, 0), (2.5, 0, 0), (0, 0, -2.5), LAMBERT)
    scene = Scene(meshes=(floor,), lights=(light,), camera=ABOVE)
    image = judged.image(scene)
    color = np.array(getattr(light, "intensity", None) or light.irradiance)
    p = points_on_floor(camera_rays(ABOVE, (24, 24)))
    truth = ALBEDO / math.pi * color * irradiance_on_floor(light, p)
    assert error(image, truth, "direct") < 5e-4  # measured 1.8e-4: half floats
    print(judged.name, "lights itself", lights_itself(image, truth))
    assert lights_itself(image, truth) < SELF_LIGHT


SELF_LIGHT = 0.2
"""Share of albedo x direct light that a lone floor gives itself, where 0 is right.

Light that leaves a floor sideways reaches the floor's other cells as light that runs along it,
which two bands cannot tell from light that falls on it. Measured 2026-11-21: lpv .08
to .18, lpv-scatter .13 to .17.
"""


def lights_itself(image, direct):
    share = image.layers["indirect"].mean(axis=(0, 1)) / direct.mean(axis=(0, 1)) / ALBEDO
    return float(share.max())


def test_a_floor_under_a_uniform_sky(judged, square, error):
    floor = square((0, 0, 0), (2.5, 0, 0), (0, 0, -2.5), LAMBERT)
    sky = Environment(radiance=(0.5, 1.0, 2.0))
    image = judged.image(Scene(meshes=(floor,), environment=sky, camera=ABOVE))
    truth = np.broadcast_to(ALBEDO * sky.radiance, image.radiance.shape)
    assert error(image, truth, "direct") < 5e-4  # measured 1.1e-4
    print(judged.name, "lights itself", lights_itself(image, truth))
    assert lights_itself(image, truth) < SELF_LIGHT


def test_what_stands_in_the_light_casts_a_shadow(judged, square, camera_rays):
    light = DirectionalLight((0.0, -1.0, 0.0), (3.0, 2.0, 1.0))
    black = Material(base_color=(0, 0, 0), specular=0.0)
    meshes = (
        square((0, 0, 0), (2.5, 0, 0), (0, 0, -2.5), LAMBERT),
        square((1.5, 1, 0), (1.3, 0, 0), (0, 0, -2.5), black),  # hides x > 0.2
    )
    camera = Camera((-0.5, 0.6, 0.0), (0.1, 0.0, 0.0), fov_y_deg=60.0)
    image = judged.image(Scene(meshes=meshes, lights=(light,), camera=camera))
    rays = camera_rays(camera, (24, 24))
    with np.errstate(divide="ignore"):
        t = -0.6 / rays[..., 1]
    x = camera.position[0] + t * rays[..., 0]
    seen = (t > 0) & (t < 3.0)
    direct = image.layers["direct"]
    assert np.all(direct[seen & (x > 0.25) & (x < 2)] < 1e-3)
    lit = direct[seen & (x < 0.15) & (x > -2)]
    assert len(lit) > 20
    np.testing.assert_allclose(lit, np.tile(ALBEDO / math.pi * [3, 2, 1], (len(lit), 1)), rtol=0.01)


def test_a_white_ball_cannot_be_seen_in_a_white_world(judged):
    ball = Mesh(sphere(32, 16), Material(base_color=(1, 1, 1), specular=0.0))
    camera = Camera((0.0, 0.3, 1.6), (0.0, 0.0, 0.0), fov_y_deg=45.0)
    scene = Scene(meshes=(ball,), environment=Environment(), camera=camera)
    image = judged.image(scene)
    # Sky light is known per cell, not per point, and the ball fills a lattice of 16 cells.
    # Measured 2026-11-23, the sphere's seam closed, so that the ball is a solid body whose own
    # cells hide some of the sky at its rim: direct mean .95, least .748; lattices .762 and .783.
    # (With the seam open it was a sheet: least .84.)
    assert abs(image.radiance.mean() - 1.0) < 0.08
    assert image.radiance.min() > 0.74
    assert image.radiance.max() < 1.5


LEAST_OF_CLOSED_ROOM = 0.95
LEAST_OF_ROUND_ROOM = 0.62
"""Share of the light that a closed room keeps; 1 is right, and these may only rise.

Measured on 16 cells: a box of walls, lpv .987, lpv-scatter .964 (2026-11-26); a
round room, lpv .64, lpv-scatter .64 (walls across the cells leak).
"""
MOST_OF_ROOM = 1.05


def closed_room(square, material, half_m=2.0):
    """Six squares that face inwards. (One closed mesh is a solid body to the lattice.)"""
    for axis in range(3):
        for side in (-half_m, half_m):
            centre, u, v = np.zeros((3, 3))
            centre[axis] = side
            u[(axis + 1) % 3] = v[(axis + 2) % 3] = half_m
            yield square(centre, *((v, u) if side > 0 else (u, v)), material)


def test_a_closed_glowing_room(judged, square):
    """Radiance L = e + albedo L, whatever the shape: e = 1/4, albedo 3/4 give 1 everywhere."""
    paint = Material(base_color=(0.75,) * 3, specular=0.0, emission=(0.25,) * 3)
    camera = Camera((0.9, 0.4, 0.7), (-1.0, -0.4, -0.8), fov_y_deg=80.0)
    image = judged.image(Scene(meshes=tuple(closed_room(square, paint)), camera=camera))
    # Its own light, and that of all walls reflected once. In corners walls shadow each other by a
    # texel of the samples' maps, of which six lights share 40: measured 8.4 % of one pixel in 576.
    np.testing.assert_allclose(image.layers["direct"], 0.25 * 1.75, rtol=0.09)
    assert image.layers["direct"].mean() == pytest.approx(0.25 * 1.75, rel=2e-3)
    print(judged.name, "glowing room", image.radiance.mean())
    if image.layers["indirect"].any():
        # Endless iteration of lpv-scatter has .935 here (.928 with 32 cells), and frames have that;
        # three multigrid cycles ended with .955, 1.02 times their own answer.
        least = 0.92 if judged.name == "lpv-scatter" else LEAST_OF_CLOSED_ROOM
        assert image.radiance.mean() > least
    assert image.radiance.mean() < MOST_OF_ROOM


def test_a_light_in_the_middle_of_a_round_room(judged, error):
    """An integrating sphere: every bounce is uniform, E = I/R^2, L = albedo E/(pi (1 - albedo))."""
    albedo, radius_m = 0.6, 2.0
    paint = Material(base_color=(albedo,) * 3, specular=0.0)
    room = Mesh(sphere(64, 32), paint, np.diag([2 * radius_m] * 3 + [1.0]))
    camera = Camera((0.9, 0.4, 0.7), (-1.0, -0.4, -0.8), fov_y_deg=80.0)
    local_light = PointLight((0.0, 0.0, 0.0), (5.0, 5.0, 5.0))
    image = judged.image(Scene(meshes=(room,), lights=(local_light,), camera=camera))
    direct = albedo / math.pi * 5.0 / radius_m**2
    # The ball's facets lie up to half a per cent inside it.
    assert error(image, direct, "direct") < 0.01
    share = image.radiance.mean() / (direct / (1.0 - albedo))
    print(judged.name, "round room", share)
    assert share < MOST_OF_ROOM
    if image.layers["indirect"].any():
        assert share > LEAST_OF_ROUND_ROOM


def test_black_surfaces_do_not_bounce(judged, square):
    black = Material(base_color=(0, 0, 0), specular=0.0, emission=(0.3, 0.2, 0.1))
    grey = Material(base_color=(0.0, 0.0, 0.0), specular=0.0)
    meshes = (
        square((0, 0, 0), (2.5, 0, 0), (0, 0, -2.5), black),
        square((0, 2, -2), (2.5, 0, 0), (0, 2, 0), grey),
    )
    scene = Scene(meshes=meshes, lights=tuple(LIGHTS.values()), camera=ABOVE)
    image = judged.image(scene)
    assert not image.layers["indirect"].any()
    np.testing.assert_allclose(image.radiance, image.layers["direct"])


def test_without_air_techniques_are_another_one(two_alike, square):
    paint = Material(base_color=tuple(ALBEDO), specular=0.0)
    meshes = (
        square((0, 0, 0), (2.5, 0, 0), (0, 0, -2.5), paint),
        square((0, 1, -2), (2.5, 0, 0), (0, 1, 0), paint),
    )
    sky = Environment(radiance=(0.5, 1.0, 2.0))
    scene = Scene(meshes=meshes, lights=tuple(LIGHTS.values()), environment=sky, camera=ABOVE)
    image, other = two_alike(scene)
    assert image.radiance.any() and set(other.layers) <= set(image.layers)
    np.testing.assert_array_equal(image.radiance, other.radiance)
    for layer in ("direct", "indirect"):
        np.testing.assert_array_equal(image.layers[layer], other.layers[layer])
