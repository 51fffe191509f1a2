"""Fog that reaches far beyond all surfaces: a lattice more has its light, others stay right."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from airlight.rendering import Renderer, render
from airlight.scatter.solver import ScatterSolver
from airlight.scene import (
    Camera,
    DirectionalLight,
    Environment,
    Material,
    Medium,
    Mesh,
    PointLight,
    Scene,
)
from airlight.scene.shapes import box

SIZE = (24, 18)
SETTINGS = {
    "resolution": 16,
    "shadow_resolution": 128,
    "lamp_resolution": 128,
    "sky_lights": 32,
    "sky_resolution": 32,
    "surfels": 10_000,
}
SUN = DirectionalLight((0.0, -1.0, 0.0), (3.0, 3.0, 3.0))
SKY = Environment((0.5, 0.6, 0.8))


def fog(per_m: float, half: float) -> Medium:
    """White, in a cube about the origin."""
    return Medium((per_m,) * 3, (1.0,) * 3, (0.0,) * 3, ((-half,) * 3, (half,) * 3))


def cube(side: float, at: tuple[float, float, float], grey: float = 0.0) -> Mesh:
    place = np.diag([side, side, side, 1.0])
    place[:3, 3] = at
    return Mesh(box(), Material(base_color=(grey,) * 3, specular=0.0), place)


def drawn(scene: Scene, layer: str, technique: str = "lpv-scatter") -> np.ndarray:
    return np.asarray(render(scene, technique, SIZE, settings=SETTINGS, samples=1).layers[layer])


@pytest.mark.slow
@pytest.mark.parametrize("technique", ["auto", "lpv-scatter"])
@pytest.mark.parametrize("light", ["sun", "sky"])
def test_fog_scatters_more_than_once_as_it_does_without_surfaces(technique, light):
    """About a black cube of 5 cm, whose lattices reach as far as 10 cm."""
    camera = Camera((0.0, 0.0, 1.5), (0.0, 0.0, 0.0), fov_y_deg=20.0)
    bare = Scene((), (SUN,) * (light == "sun"), environment=SKY if light == "sky" else None,
                 camera=camera, medium=fog(0.3, 2.0))  # fmt: skip
    corner = replace(bare, meshes=(cube(0.05, (1.9, -1.9, 1.9)),))
    for layer in ("single_scatter", "multiple_scatter"):
        alone = drawn(bare, layer, technique)
        assert alone.min() > 0.01
        np.testing.assert_allclose(drawn(corner, layer, technique), alone, rtol=0.02)


def test_the_skys_maps_shade_nothing_beyond_their_ends():
    """Below a small cube, whose maps are as large as its lattices."""
    camera = Camera((0.0, -0.8, 1.9), (0.0, -0.8, 0.0), fov_y_deg=40.0)
    bare = Scene((), (), environment=SKY, camera=camera, medium=fog(0.3, 2.0))
    above = replace(bare, meshes=(cube(0.1, (0.0, 0.6, 0.0)),))
    for layer in ("single_scatter", "multiple_scatter"):
        np.testing.assert_allclose(drawn(above, layer), drawn(bare, layer), rtol=0.012)


def test_much_light_in_dense_fog_is_not_cut_off():
    """A cube of a metre in 200 m: what comes into the fog is ten thousand times what it meets."""
    camera = Camera((0.0, 60.0, 90.0), (0.0, 60.0, 0.0), fov_y_deg=20.0)
    bare = Scene((), (SUN,), camera=camera, medium=fog(0.1, 100.0))
    small = replace(bare, meshes=(cube(1.0, (0.0, 0.5, 0.0)),))
    # Lattices of other places: the outer one ends at ten optical depths.
    ratio = drawn(small, "multiple_scatter").mean() / drawn(bare, "multiple_scatter").mean()
    assert ratio == pytest.approx(1.0, abs=0.1)


def test_a_closed_room_does_not_know_how_far_the_fog_goes_outside():
    scene = Scene(
        (cube(4.0, (0.0, 0.0, 0.0), 0.7),),
        (PointLight((0.0, 1.0, 0.0), (5.0,) * 3),),
        camera=Camera((0.0, 0.0, 1.8), (0.0, 0.0, -2.0), fov_y_deg=60.0),
        # As far as the lattice of the room goes.
        medium=fog(0.02, 10.0),
    )
    wide = replace(scene, medium=fog(0.02, 200.0))
    for layer in ("indirect", "multiple_scatter"):
        np.testing.assert_allclose(drawn(wide, layer).mean(), drawn(scene, layer).mean(), rtol=0.02)


def test_fog_that_ends_within_the_lattices_of_surfaces_is_known_to_end():
    """A shallow wide layer, whose outer lattice has a few cells of its height."""
    layer = Medium((0.05,) * 3, bounds=((-500.0, 0.0, -500.0), (500.0, 6.0, 500.0)))
    scene = Scene((cube(10.0, (0.0, 5.0, 0.0)),), (SUN,), camera=Camera((20.0, 3.0, 20.0)),
                  medium=layer)  # fmt: skip
    with Renderer(scene, "lpv-scatter", SIZE, settings=SETTINGS) as renderer:
        solver = renderer.technique.find(ScatterSolver)
        assert len(solver.cascades) > 1
        assert all(part.cells.is_varied for part in solver.cascades)
