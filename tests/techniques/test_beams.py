"""Light that volumes of ordinates only scatter forwards, on the surfaces of stills; who has it."""

from __future__ import annotations

import numpy as np
import pytest

from airlight.reference.tracer import Beam, BoxMedium, trace
from airlight.rendering import Renderer, render
from airlight.scatter.forward_beams import ForwardSolver
from airlight.scene import Camera, DirectionalLight, Material, Mesh, Scene, Volume
from airlight.scene.shapes import quad

SETTINGS = {
    "resolution": 18,
    "bounds": (-1.0, -0.25, -1.0, 1.0, 1.25, 1.0),
    "shadow_resolution": 128,
    "sky_lights": 0,
    "surfels": 4000,
    "ordinates": 4,
    "gather_rays": 16,
    "follow_walls": False,
}


def smoke_on_a_floor(g: float, albedo: float = 0.9) -> Scene:
    """A cube of a metre in directional light from above, on a floor that is nearly black."""
    black = Material(base_color=(0.02,) * 3, specular=0.0)
    floor = Mesh(quad(), black, np.diag([6.0, 1.0, 6.0, 1.0]))
    smoke = Volume(
        (2.0,) * 3,
        np.ones((8, 8, 8), np.float32),
        bounds=((-0.5, 0.0, -0.5), (0.5, 1.0, 0.5)),
        albedo=(albedo,) * 3,
        g=(g,) * 3,
    )
    camera = Camera((0.0, 3.0, 0.0), (0.0, 0.0, 0.0), (0.0, 0.0, -1.0), 2.0 * 9.46)
    light = DirectionalLight((0, -1, 0), (1, 1, 1))
    return Scene((floor,), (light,), camera=camera, volumes=(smoke,))


@pytest.mark.parametrize("technique", ["auto", "pop"])
@pytest.mark.parametrize("g", [0.0, pytest.param(0.6, marks=pytest.mark.slow), 0.85])
def test_a_floor_under_lit_smoke_gathers_what_a_tracer_counts(technique, g):
    """What the cube sends onto the floor under it, forwards alone or not.

    Measured 1.10, 1.13, 1.02 for g 0, .6, .85; without beams, and with what smoke sends towards the
    eye in place of the reduced medium's light, 1.10, .16, .03.
    """
    layers = render(smoke_on_a_floor(g), technique, (24, 24), samples=4, settings=SETTINGS).layers
    found = (layers["indirect"] / layers["transmittance"] * np.pi / 0.02).mean()
    box = BoxMedium(sigma_t=2.0, albedo=0.9, g=g)
    truth = trace(box, Beam((0, 0, 1)), photons=100_000).exits[1:, 5].sum()
    assert found == pytest.approx(truth, rel=0.16)


@pytest.mark.parametrize("scheme", ["delta-beam", "split"])
def test_schemes_of_hops_have_no_beams(scheme):
    settings = {**SETTINGS, "scheme": scheme, "iterations": 4}
    scene = smoke_on_a_floor(0.6)
    with Renderer(scene, "pop", (8, 8), settings=settings) as renderer:
        image = renderer.frame()
        has_beams = renderer.technique.find(ForwardSolver) is not None
    assert has_beams == (scheme == "delta-beam") == bool(image.layers["indirect"].any())
