"""Images of glass and of blended surfaces against Mitsuba, with our glass and with its own."""

from __future__ import annotations

import numpy as np
import pytest

from airlight.reference import mitsuba
from airlight.rendering import render
from airlight.scene import Camera, DirectionalLight, Material, Scene

SIZE = (64, 36)


@pytest.fixture
def shop_window(square) -> Scene:
    """Two panes of red glass and a half blue one between them, before a wall and over a floor."""
    white = Material(base_color=(0.7,) * 3, specular=0.0)
    red = Material(base_color=(1.0, 0.2, 0.2), transmission=0.9, roughness=0.3)
    blue = Material(base_color=(0.2, 0.4, 0.9), alpha=0.5, is_blended=True, specular=0.0)
    return Scene(
        meshes=(
            square((0, 0, 0), (4, 0, 0), (0, 0, -4), white),
            square((0, 2, -4), (4, 0, 0), (0, 2, 0), white),
            square((-1.2, 1.5, -1), (0.8, 0, 0), (0, 1, 0), red),
            square((1.0, 1.5, -0.5), (0.8, 0, 0), (0, 1, 0), blue),
            square((1.6, 1.2, 0.3), (0.8, 0, 0), (0, 0.8, 0), red),
        ),
        lights=(DirectionalLight((0.3, -1, -0.8), (3, 3, 3)),),
        camera=Camera((0, 2.2, 6), (0, 1.2, 0), fov_y_deg=40, exposure_stops=0.0),
    )


@pytest.mark.needs("mitsuba")
@pytest.mark.parametrize(
    "variant", ["scalar_rgb", pytest.param("auto", marks=pytest.mark.needs("libLLVM"))]
)
def test_direct_light_through_panes(gpu, shop_window: Scene, variant: str) -> None:
    ours = render(shop_window, "direct", SIZE, samples=8).radiance
    layers = mitsuba.render_layers(shop_window, ("direct",), size=SIZE, spp=64, variant=variant)
    theirs = layers["direct"].radiance
    # Noise is .3 % of the sum. Mitsuba's own glass mirrors by the exact Fresnel term, .005 off.
    np.testing.assert_allclose(ours.sum((0, 1)) / theirs.sum((0, 1)), 1.0, atol=0.012)
    # A pixel of a pane's edge or of its shadow's is one of few.
    assert np.median(np.abs(ours - theirs) / theirs.max()) < 0.01
