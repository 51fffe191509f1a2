"""Air: transmittance, single scattering, and that it makes no light."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from airlight.reference import quadrature
from airlight.scene import (
    Camera,
    DirectionalLight,
    Environment,
    Material,
    Medium,
    PointLight,
    Scene,
    SpotLight,
    Volume,
)

SIZE = (24, 24)
SIGMA = np.array([0.2, 0.7, 1.5])
CUBE = ((-1.0, -1.0, -1.0), (1.0, 1.0, 1.0))
OUTSIDE = Camera((0.4, 0.5, 4.0), (0.0, 0.1, 0.0), fov_y_deg=35.0)
WHITE = (1.0, 1.0, 1.0)
PX = 16


def test_a_slab_has_the_transmittance_of_beer_and_lambert(judged, square, camera_rays, error):
    glow = Material(base_color=(0, 0, 0), specular=0.0, emission=(1.0, 2.0, 3.0))
    local_light = square((0, 0, -1.5), (3, 0, 0), (0, 3, 0), glow)
    slab = Medium(tuple(SIGMA), (0, 0, 0), bounds=((-4, -4, -0.5), (4, 4, 0.7)))
    camera = Camera((0.2, 0.1, 3.0), (0.0, 0.0, 0.0), fov_y_deg=50.0)
    image = judged.air_image(Scene(meshes=(local_light,), camera=camera, medium=slab))
    cosine = np.abs(camera_rays(camera, SIZE)[..., 2:])
    through = np.exp(-SIGMA * 1.2 / cosine)
    # Measured 2e-4; pop, which marches, .0063.
    assert error(image, through * [1.0, 2.0, 3.0]) < 0.01
    assert error(image, through, "transmittance") < 0.01


def test_black_air_only_takes_away(judged, square, camera_rays, error):
    """Albedo 0: light on a floor, less what the air takes on the paths there and back."""
    albedo = np.array([0.2, 0.5, 0.8])
    paint = Material(base_color=tuple(albedo), specular=0.0)
    floor = square((0, -0.5, 0), (2.5, 0, 0), (0, 0, -2.5), paint)
    air = Medium(tuple(SIGMA), (0, 0, 0), bounds=((-9, -0.8, -9), (9, 0.7, 9)))
    camera = Camera((0.3, 3.0, 0.2), (0.3, -0.5, 0.2), (0.0, 0.0, -1.0), 50.0)
    sun = DirectionalLight((0.36, -0.8, 0.48), (3.0, 2.0, 1.0))
    scene = Scene(meshes=(floor,), lights=(sun,), camera=camera, medium=air)
    image = judged.air_image(scene)
    cosine = np.abs(camera_rays(camera, SIZE)[..., 1:2])
    through = np.exp(-SIGMA * 1.2 * (1.0 / cosine + 1.0 / 0.8))
    truth = albedo / math.pi * 0.8 * np.array([3.0, 2.0, 1.0]) * through
    assert error(image, truth, "direct") < 0.01
    for layer in ("single_scatter", "multiple_scatter", "scattered"):
        assert not image.layers.get(layer, np.zeros(1)).any()


def scatters_often(image):
    """Whether light scattered more than once is drawn."""
    return any(
        image.layers.get(layer, np.zeros(1)).any() for layer in ("multiple_scatter", "scattered")
    )


LIGHTS = {  # out of sight, since pixels beside a lamp are no samples of their centres
    "point": PointLight((0.9, 0.85, 0.5), (3.0, 2.0, 1.0)),
    "spot": SpotLight((0.8, 0.9, -0.3), (-0.6, -0.8, 0.0), (3.0, 2.0, 1.0), 20.0, 35.0),
    "directional": DirectionalLight((0.36, -0.8, 0.48), (3.0, 2.0, 1.0)),
}


@pytest.mark.parametrize("g", [0.0, 0.6])
@pytest.mark.parametrize("kind", LIGHTS)
def test_light_scattered_once_is_the_quadrature(judged, camera_rays, error, kind, g):
    light, albedo = LIGHTS[kind], 0.9
    air = Medium(tuple(SIGMA), (albedo,) * 3, (g,) * 3, CUBE)
    camera = Camera((0.3, 0.2, 0.9), (0.0, 0.1, -1.0), fov_y_deg=60.0)
    scene = Scene(lights=(light,), camera=camera, medium=air)
    image = judged.air_image(scene, needs=["single_scatter"])
    rays = camera_rays(camera, SIZE)
    eye = np.asarray(camera.position)
    _, length = quadrature.box_path(eye, rays, CUBE)

    def truth(sigma, color):
        if isinstance(light, DirectionalLight):
            return quadrature.directional_single_scatter(
                eye, rays, light.direction, color, sigma, albedo, g, CUBE
            )
        cone = {}
        if isinstance(light, SpotLight):
            cone = {"axis": light.direction, "cone_deg": (20.0, 35.0)}
        return quadrature.point_single_scatter(
            eye, rays, length, light.position, color, sigma, albedo, g, **cone
        )

    want = np.stack([truth(s, c) for s, c in zip(SIGMA, (3.0, 2.0, 1.0), strict=True)], axis=-1)
    # Measured 3e-6, spot .005 (the cone's edge); at half resolution (auto) up to .26 in 24 pixels.
    assert error(image, want, "single_scatter") < (0.01 if judged.is_sharp else 0.3)


AROUND = (-1.0, -1.0, -1.0, 1.0, 1.0, 1.0)
"""The lattice, said aloud: see test_the_lattice_holds_air_without_surfaces."""


def test_a_homogeneous_medium_is_a_grid_of_one_density(judged, error):
    if judged.name == "auto":
        pytest.skip("auto gives a homogeneous medium and grids to different techniques")
    sun = DirectionalLight((0.36, -0.8, 0.48), (3.0, 2.0, 1.0))
    shared = {"sigma_t": tuple(SIGMA), "albedo": (0.9,) * 3, "g": (0.3,) * 3, "bounds": CUBE}
    grid = Volume(density=np.ones((5, 6, 7), np.float32), **shared)
    scene = Scene(lights=(sun,), camera=OUTSIDE, medium=Medium(**shared))
    even = judged.air_image(scene, bounds=AROUND)
    scene = Scene(lights=(sun,), camera=OUTSIDE, volumes=(grid,))
    varied = judged.air_image(scene, bounds=AROUND)
    # Measured 1e-6, single scattering below .01 (jittered .18), multiple .067 (lpv-scatter takes
    # half hops in varying air).
    limits = {
        "transmittance": 1e-3,
        "single_scatter": 0.01,
        "multiple_scatter": 0.1,
        "scattered": 1e-3,
    }
    for layer, limit in limits.items():
        if layer in even.layers and even.layers[layer].any():
            truth = even.layers[layer]
            assert error(varied, truth, layer) < limit
            assert abs(varied.layers[layer].mean() / truth.mean() - 1.0) < 0.08


GROWS = {"lpv-scatter": 1.15, "auto": 1.15}
"""Share of light from everywhere that comes out again, at most; 1 is right. The converged lattice
is too bright in thin air. Measured 2026-11-21: pop .999, lpv-scatter 1.13 for g 0, 1.04 for .7."""


@pytest.mark.parametrize("g", [0.0, 0.7])
def test_white_air_cannot_be_seen_in_a_white_world(judged, g):
    air = Medium((1.0,) * 3, WHITE, (g,) * 3, CUBE)
    scene = Scene(environment=Environment(), camera=OUTSIDE, medium=air)
    image = judged.air_image(scene, bounds=AROUND)
    centre = image.radiance[8:16, 8:16].mean()
    assert centre < GROWS.get(judged.name, 1.05)
    if scatters_often(image):
        assert centre > 0.95


@pytest.mark.parametrize("g", [0.0, 0.7])
def test_a_cube_of_air_sends_out_what_it_gets(judged, g):
    """White air in parallel light: what was not transmitted leaves again, to all sides.

    Measured 2026-11-21: pop .99 (g 0) and .97 (.7); lpv-scatter 1.08 and .92.
    """
    half = 0.5
    air = Medium((1.5,) * 3, WHITE, (g,) * 3, ((-half,) * 3, (half,) * 3))
    scene = Scene(lights=(DirectionalLight((0.0, 0.0, 1.0), WHITE),), medium=air)
    around = (-half, -half, -half, half, half, half)
    image = judged.air_image(replace(scene, camera=OUTSIDE), (4, 4), bounds=around)
    assert image.radiance.any()
    sent = power_out(judged, scene, 0.9, bounds=around) / (1.0 - math.exp(-1.5))
    assert sent < 1.1
    if scatters_often(image):
        assert sent > 0.9


def test_the_lattice_holds_air_without_surfaces(judged):
    sun = DirectionalLight((0.0, 0.0, 1.0), WHITE)
    air = Medium((1.5,) * 3, WHITE, bounds=CUBE)
    image = judged.air_image(
        Scene(lights=(sun,), camera=OUTSIDE, medium=air), needs=["multiple_scatter"]
    )
    if judged.name in ("lpv-scatter", "auto") and not scatters_often(image):
        pytest.xfail("the lattice is placed without regard to the medium's bounds")
    assert judged.name == "single" or scatters_often(image)


def power_out(judged, scene, radius_m, views=12, **settings):
    """W in the red channel that a scene within `radius_m` of the origin sends to all sides."""
    index = np.arange(views) + 0.5
    z, turn = 1.0 - 2.0 * index / views, index * math.pi * (3.0 - math.sqrt(5.0))
    r = np.sqrt(1.0 - z * z)
    directions = np.stack([r * np.cos(turn), r * np.sin(turn), z], axis=-1)
    away_m = 50.0 * radius_m
    fov = 2.0 * math.degrees(math.atan(1.0 / 50.0))
    cameras = [Camera(tuple(away_m * w), (0.0, 0.0, 0.0), fov_y_deg=fov) for w in directions]
    images = judged.images(scene, cameras, (PX, PX), 32, **settings)
    pixel_m2 = (2.0 * radius_m / PX) ** 2
    return 4.0 * math.pi * np.mean([i.radiance[..., 0].sum() * pixel_m2 for i in images])
