"""Mitsuba, our tracer and quadrature, which share no code, give one answer within their noise."""

from __future__ import annotations

import math

import numpy as np
import pytest

from airlight.reference import mitsuba, quadrature
from airlight.reference.mitsuba_child import SCALAR_VARIANT, choose_variant
from airlight.reference.tracer import Beam, BoxMedium, trace
from airlight.scene import (
    Camera,
    DirectionalLight,
    Environment,
    Geometry,
    Material,
    Medium,
    Mesh,
    Scene,
)

pytestmark = pytest.mark.needs("mitsuba", "numba")

CUBE = ((0.0, 0.0, 0.0), (1.0, 1.0, 1.0))
TRAVEL = (0.0, 0.0, 1.0)
DISTANCE_M, HALF_WIDTH_M = 200.0, 1.0
SIDE, ASLANT = (1.0, 0.0, 0.0), (0.0, 0.6, 0.8)


def intensity(image, variance):
    """W sr^-1 and its standard error from a small, distant image of the cube."""
    pixel_area = (2.0 * HALF_WIDTH_M / image.shape[0]) ** 2
    total = image[..., 0].sum(dtype=np.float64) * pixel_area
    return total, math.sqrt(variance[..., 0].sum(dtype=np.float64)) * pixel_area


def cube_seen_along(view, sigma_s, g):
    """The cube, sunlit along +z; the eye far away, light travelling along `view` reaches it."""
    eye = 0.5 + DISTANCE_M * np.array(view)
    return Scene(
        lights=(DirectionalLight(TRAVEL, (1.0, 1.0, 1.0)),),
        environment=Environment(radiance=(0.0, 0.0, 0.0)),
        camera=Camera(
            position=tuple(eye),
            target=(0.5, 0.5, 0.5),
            fov_y_deg=2.0 * math.degrees(math.atan(HALF_WIDTH_M / DISTANCE_M)),
        ),
        medium=Medium((sigma_s,) * 3, (1.0,) * 3, (g,) * 3, CUBE),
    )


@pytest.mark.parametrize(
    ("sigma_s", "g", "view"),
    [
        (0.05, 0.0, SIDE),
        (4.0, 0.0, SIDE),
        (4.0, 0.7, ASLANT),
        pytest.param(0.05, 0.0, ASLANT, marks=pytest.mark.slow),
        pytest.param(4.0, 0.0, ASLANT, marks=pytest.mark.slow),
        pytest.param(4.0, 0.7, SIDE, marks=pytest.mark.slow),
    ],
)
def test_a_cube_of_air_is_as_bright_in_all_of_them(sigma_s, g, view):
    light = trace(BoxMedium(sigma_s, 1.0, g), Beam(TRAVEL), photons=200_000, views=[view])
    is_compiled = choose_variant() != SCALAR_VARIANT
    names = ("all", "single_scatter", "multiple_scatter") if is_compiled else ("all",)
    scene = cube_seen_along(view, sigma_s, g)
    images = mitsuba.render_layers(scene, names, size=(64, 64), spp=64)
    total = light.brightness.sum(axis=0)[0]
    error = math.hypot(*light.brightness_error[:, 0])
    seen, noise = intensity(images["all"].radiance, images["all"].layers["variance"])
    # The eye is near enough to add up to a thousandth of its own.
    assert abs(seen - total) < 4.0 * math.hypot(error, noise) + 2e-3 * total
    once = quadrature.box_single_scatter_intensity(TRAVEL, view, 1.0, sigma_s, 1.0, g, CUBE)
    assert abs(light.brightness[0, 0] - once) < 4.0 * light.brightness_error[0, 0]
    if is_compiled:
        single = images["single_scatter"]
        seen, noise = intensity(single.radiance, single.layers["variance"])
        assert abs(seen - once) < 4.0 * noise + 2e-3 * once


def quad(corners, **material):
    positions = np.array(corners, np.float32)
    geometry = Geometry(positions, np.array([[0, 1, 2], [0, 2, 3]], np.uint32))
    return Mesh(geometry, Material(specular=0.0, **material))


def test_a_floor_lit_by_a_wall_is_the_form_factor():
    wall = [(0, 0, 0), (2, 0, 0), (2, 1.5, 0), (0, 1.5, 0)]  # shines towards +z
    floor = [(-3, 0, 5), (5, 0, 5), (5, 0, -1), (-3, 0, -1)]
    eye, fov_y_deg, size = np.array([1.0, 6.0, 1.6]), 28.0, 32
    scene = Scene(
        meshes=(
            quad(wall, base_color=(0, 0, 0), emission=(2.0, 2.0, 2.0)),
            quad(floor, base_color=(0.5, 0.5, 0.5)),
        ),
        environment=Environment(radiance=(0.0, 0.0, 0.0)),
        camera=Camera(tuple(eye), (1.0, 0.0, 1.6), (0.0, 0.0, -1.0), fov_y_deg),
    )
    image = mitsuba.render(scene, size=(size, size), spp=256)
    half = 6.0 * math.tan(math.radians(0.5 * fov_y_deg))
    assert half < 1.6, "the wall must be out of sight"
    across = half * ((np.arange(size) + 0.5) / size * 2.0 - 1.0)
    x, z = np.meshgrid(1.0 + across, 1.6 + across)
    points = np.stack([x, 0.0 * x, z], axis=-1)
    up = np.broadcast_to([0.0, 1.0, 0.0], points.shape)
    want = 0.5 / math.pi * quadrature.polygon_irradiance(points, up, wall, 2.0)
    deviation = in_blocks(image.radiance[..., 0] - want)
    noise = np.sqrt(in_blocks(image.layers["variance"][..., 0]))
    # Blocks, since a pixel's variance comes from four batches; a pixel is an average and `want`
    # its middle, hence the half per cent.
    assert np.all(np.abs(deviation) < 4.0 * noise + 5e-3 * in_blocks(want))
    assert abs(deviation.sum()) < 4.0 * np.sqrt(np.sum(noise**2)) + 2e-3 * want.sum()


def in_blocks(a, side=8):
    """Sums over blocks of side x side pixels."""
    h, w = a.shape
    return a.reshape(h // side, side, w // side, side).sum(axis=(1, 3), dtype=np.float64)
