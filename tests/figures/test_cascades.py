"""Cascades in colours: who lights what."""

from __future__ import annotations

import numpy as np

from airlight.figures import cascades
from airlight.figures.panels import Request
from airlight.scene.builtin import room


def test_points_of_pixels_lie_where_the_camera_sees_them(camera_rays):
    camera, depth = room().camera, np.full((6, 10), 2.0, np.float32)
    points = cascades.surface_points(camera, depth)
    expected = np.array(camera.position) + 2.0 * camera_rays(camera, (10, 6))
    np.testing.assert_allclose(points, expected, atol=1e-6)


def test_every_surface_is_lit_by_some_cascade(gpu):
    request = Request((32, 18), quick=True, adapter=gpu.info.name)
    panels, numbers = cascades.cascades_coloured(request, room(), 2)
    assert next(label for label, _ in panels) == "the image"
    assert len(numbers) == 2 and numbers[0]["cell_m"] < numbers[1]["cell_m"]
    assert sum(n["share_of_pixels"] for n in numbers) > 0.95  # but for the window
    assert numbers[0]["share_of_pixels"] > 0.0
    image = panels[2][1]
    assert image is not None and image.shape == (18, 32, 3)


def test_a_cascade_alone_has_its_colour():
    class Grey:
        radiance = np.ones((2, 2, 3), np.float32)

    given = np.zeros((3, 2, 2))
    given[1] = 1.0
    tint = cascades.coloured(Grey(), given)
    np.testing.assert_allclose(tint[0, 0], 1.5 * cascades.COLOURS[1], rtol=1e-6)
