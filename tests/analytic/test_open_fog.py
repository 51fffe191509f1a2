"""An open plain in endless fog beside the path tracer: the whole image and its layers."""

from __future__ import annotations

import numpy as np
import pytest

from airlight.reference.mitsuba import render_layers
from airlight.rendering import Renderer
from airlight.scene import Camera, DirectionalLight, Environment, Material, Medium, Mesh, Scene
from airlight.scene.shapes import box

SIZE = (96, 54)
BLOCKS = ((-6, -6, 4, 6), (4, -9, 5, 4), (9, -2, 3, 8), (-10, 4, 3, 3), (0, -1, 2, 2))
"""x, z, width and height, metres."""


@pytest.fixture
def plain(square) -> Scene:
    """A floor of 60 m with five blocks on it, the sun low, a blue sky, fog up to 10 m."""
    stone = Material(base_color=(0.6, 0.5, 0.4), specular=0.0)
    ground = Material(base_color=(0.35, 0.33, 0.28), specular=0.0)
    meshes = [square((0, 0, 0), (30, 0, 0), (0, 0, -30), ground)]
    for x, z, width, height in BLOCKS:
        place = np.diag([width, height, width, 1.0])
        place[:3, 3] = (x, 0.5 * height, z)
        meshes.append(Mesh(box(), stone, place))
    return Scene(
        meshes=tuple(meshes),
        lights=(DirectionalLight((-0.5, -0.45, 0.55), (20.0, 18.0, 15.0)),),
        environment=Environment(radiance=(0.5, 0.7, 1.0)),
        camera=Camera((0, 2.2, 18), (0, 2.6, 0), fov_y_deg=55.0),
        medium=Medium(0.03, 0.95, endless=True),
    )


@pytest.mark.slow
@pytest.mark.needs("mitsuba")
def test_energies_beside_the_path_tracer(gpu, plain):
    """Measured: whole .99, direct 1.005, single 1.00, multiple .94, of which 0.002 noise."""
    names = ("all", "direct", "single_scatter", "multiple_scatter")
    truth = render_layers(plain, names, size=SIZE, spp=64)
    full = {"shaft_resolution": "full", "march_resolution": "full"}
    with Renderer(plain, "lpv-scatter", SIZE, settings=full) as renderer:
        image = renderer.frame()
    ours = {**image.layers, "all": image.radiance}
    ratio = {n: float(ours[n].mean() / truth[n].radiance.mean()) for n in names}
    assert ratio["all"] == pytest.approx(1.0, abs=0.08)
    assert ratio["direct"] == pytest.approx(1.0, abs=0.02)
    assert ratio["single_scatter"] == pytest.approx(1.0, abs=0.02)
    assert ratio["multiple_scatter"] == pytest.approx(1.0, abs=0.1)


@pytest.mark.slow
@pytest.mark.parametrize(("along_z", "g"), [(-0.8, 0.7), (0.8, 0.7), (-0.8, 0.9), (0.8, 0.9)])
@pytest.mark.needs("mitsuba")
def test_the_half_space_that_scatters_forwards(gpu, along_z, g):
    """The sun behind the eye and before it. Measured 1.03, .94, 1.11, .94; noise .03 at most."""
    black = Material(base_color=(0.0, 0.0, 0.0), specular=0.0)
    scene = Scene(
        meshes=(Mesh(box(), black),),
        lights=(DirectionalLight((0.0, -0.6, along_z), (3.0, 2.0, 1.0)),),
        camera=Camera((0, 2, 20), (0, 4, -10), fov_y_deg=50.0),
        medium=Medium(0.1, 0.9, g, endless=True, top=10.0),
    )
    name, size = "multiple_scatter", (48, 27)
    truth = render_layers(scene, (name,), size=size, spp=64)[name].radiance
    settings = {"shaft_resolution": "full", "march_resolution": "full", "resolution": 8}
    with Renderer(scene, "lpv-scatter", size, settings=settings) as renderer:
        ours = renderer.frame().layers[name]
    assert float(ours.mean() / truth.mean()) == pytest.approx(1.0, abs=0.15)
