"""The gather in the air: what cells of a medium receive, by closed forms."""

from __future__ import annotations

import numpy as np
import pytest
from tests.gather.test_solver import LPV, X, Y, Z, rectangle

from airlight.maths.phase import henyey_greenstein
from airlight.rendering import Renderer, render
from airlight.scene import Camera, DirectionalLight, Material, Medium, Scene

SETTINGS = {name: value for name, value in LPV.items() if name != "iterations"}
PAINT = Material(base_color=(0.8, 0.8, 0.8), specular=0.0)
PAINT_BLACK = Material(base_color=(0.0, 0.0, 0.0), specular=0.0)
SIGMA = 1e-3


def corner_angle(a, b, h):
    """Solid angle, sr, of a rectangle of sides a and b seen from h above one of its corners."""
    return np.arctan2(a * b, h * np.sqrt(a * a + b * b + h * h))


def square_angle(x, z, h, half):
    """That of a square about the origin from h above (x, z) within it."""
    sides = [(half + i * x, half + k * z) for i in (-1, 1) for k in (-1, 1)]
    return sum(corner_angle(a, b, h) for a, b in sides)


@pytest.mark.parametrize("seed_view", [0.0, 0.4])
def test_thin_air_over_a_lit_square_scatters_what_closed_forms_say(seed_view):
    """Air so thin that all it scatters twice is what the floor sends: sigma times its solid angle.

    A lattice has 8 cells and two bands, to which the floor sends too little upwards.
    """
    floor = rectangle(-2 * X - 2 * Z, 4 * X, 4 * Z, PAINT)
    air = Medium((SIGMA,) * 3, (1.0,) * 3, bounds=((-2.0, 0.0, -2.0), (2.0, 3.0, 2.0)))
    # Level views half a metre to two above the floor.
    camera = Camera((seed_view, 1.2, 4.0), (seed_view, 1.2, 0.0), fov_y_deg=10.0)
    sun = DirectionalLight((0, -1, 0), (np.pi,) * 3)
    scene = Scene((floor,), (sun,), camera=camera, medium=air)
    settings = {**SETTINGS, "gather_air": 16, "march_resolution": "full"}
    image = render(scene, "lpv-scatter", (12, 8), samples=16, settings=settings)
    found = image.layers["multiple_scatter"].mean()
    z = (np.arange(64) + 0.5) / 64 * 4.0 - 2.0
    # The view is narrow: its middle ray stands for it (0.8 of 3 m of height are seen).
    truth = 4.0 * SIGMA * 0.8 * square_angle(seed_view, z, 1.2, 2.0).mean() / (4.0 * np.pi)
    # 256 rays a cell and many cells: 1 %; half-empty cells at the borders take the rest.
    assert found / truth == pytest.approx(1.0, abs=0.05)


def test_area_lights_shine_on_what_rays_of_cells_meet_in_the_first_frame():
    """The first frame of a renderer is its second one: nothing in it waits for shadow maps."""
    floor = rectangle(-2 * X - 2 * Z, 4 * X, 4 * Z, PAINT)
    glow = Material(base_color=(0.0,) * 3, emission=(20.0,) * 3, specular=0.0, two_sided=False)
    panel = rectangle(3.5 * Y - 0.2 * X - 0.2 * Z, 0.4 * X, 0.4 * Z, glow)
    air = Medium((SIGMA,) * 3, (1.0,) * 3, bounds=((-2.0, 0.0, -2.0), (2.0, 3.0, 2.0)))
    scene = Scene((floor, panel), (), camera=Camera((0, 1.2, 4), (0, 1.2, 0)), medium=air)
    settings = {**SETTINGS, "gather": "always"}
    with Renderer(scene, "lpv-scatter", (12, 8), settings=settings) as renderer:
        frames = [renderer.frame(samples=1).layers["multiple_scatter"] for _ in range(2)]
    assert frames[1].mean() > 0.0
    np.testing.assert_array_equal(frames[0], frames[1])


def test_air_that_scatters_anisotropically_shows_what_its_phase_function_says():
    """The same floor, seen from above and from below a thin slab: HG of the angle of its light."""
    floor = rectangle(-2 * X - 2 * Z, 4 * X, 4 * Z, PAINT)
    sun = DirectionalLight((0, -1, 0), (np.pi,) * 3)
    found = {}
    for g in (0.0, 0.7, -0.5):
        box = ((-2.0, 1.0, -2.0), (2.0, 1.5, 2.0))
        air = Medium((SIGMA,) * 3, (1.0,) * 3, (g,) * 3, bounds=box)
        # A level view through the slab, and one from high above that looks down at the floor.
        for name, eye in (("level", (0.0, 1.25, 4.0)), ("down", (0.0, 6.0, 0.01))):
            target = (0.0, 1.25, 0.0)
            camera = Camera(eye, target, fov_y_deg=4.0)
            scene = Scene((floor,), (sun,), camera=camera, medium=air)
            cells = {"resolution": 12, "gather_air": 32}
            settings = {**SETTINGS, **cells, "march_resolution": "full"}
            image = render(scene, "lpv-scatter", (8, 6), samples=8, settings=settings)
            found[name, g] = image.layers["multiple_scatter"].mean()
    # Of the level view at g .7 it is .563, .531, .526, .517 with 8, 12, 16, 24 cells.
    # Everywhere the floor sends .8: the mean of the phase function over the square, as it is seen
    # from places along the view, 1.25 m above it.
    u = (np.arange(160) + 0.5) / 160 * 4.0 - 2.0
    x, z = np.meshgrid(u, u, indexing="ij")
    along = {"level": (np.arange(16) + 0.5) / 4.0 - 2.0, "down": np.zeros(1)}
    towards = {"level": (0.0, 0.0, 1.0), "down": (0.0, 1.0, 0.0)}

    def scattered(name, g):
        sums = 0.0
        for at in along[name]:
            path = np.stack([-x, np.full_like(x, 1.25), at - z], axis=-1)
            reach = np.linalg.norm(path, axis=-1)
            cosine = (path / reach[..., None]) @ np.array(towards[name])
            sums += (henyey_greenstein(cosine, g) * 1.25 / reach**3).sum()
        return sums

    for name, g in found:
        ratio = found[name, g] / found[name, 0.0]
        expected = scattered(name, g) / scattered(name, 0.0)
        # 256 rays of each of twelve cells along the view, which stand for places near them.
        assert ratio == pytest.approx(expected, rel=0.05), (name, g)


def test_air_beside_a_beam_has_what_its_phase_function_scatters_out_of_it():
    """Thin air under a roof with a hole: its light is scattered twice, each time by HG.

    A black floor lies below, a beam of a square metre falls onto it. Reduced media, which send the
    share 1 - g of the first scattering to all sides alike, had .59, .35 and 1.06 of g = 0.
    """
    roof = [
        rectangle(Y + x * X - 3 * Z, w * X, 6 * Z, PAINT_BLACK) for x, w in ((-3, 2.5), (0.5, 4.5))
    ]
    roof += [rectangle(Y - 0.5 * X + z * Z, X, 2.5 * Z, PAINT_BLACK) for z in (-3.0, 0.5)]
    roof.append(rectangle(-3 * X - 3 * Y - 3 * Z, 8 * X, 6 * Z, PAINT_BLACK))
    sun = DirectionalLight((0, -1, 0), (1e3,) * 3)
    camera = Camera((2.0, -1.5, 4.0), (2.0, -1.5, 0.0), fov_y_deg=4.0)
    settings = {**SETTINGS, "resolution": 16, "gather_air": 16, "march_resolution": "full"}
    settings["bounds"] = (-3.0, -3.2, -3.0, 5.0, 1.3, 3.0)
    # The beam in cubes of a tenth of a metre, and the view, which is narrow, in as many steps.
    u = (np.arange(10) + 0.5) / 10 - 0.5
    beam = np.stack(np.meshgrid(u, np.arange(-2.95, 0.5, 0.1), u, indexing="ij"), -1).reshape(-1, 3)
    seen = [np.array((2.0, -1.5, z)) for z in (np.arange(16) + 0.5) / 4.0 - 2.0]

    def scattered(g):
        total = 0.0
        for at in seen:
            path = at - beam
            reach = np.linalg.norm(path, axis=-1)
            first = henyey_greenstein(-path[:, 1] / reach, g)
            total += (first * henyey_greenstein(path[:, 2] / reach, g) / reach**2).sum()
        return total

    found = {}
    for g in (0.0, 0.35, 0.5, -0.5):
        air = Medium((SIGMA,) * 3, (1.0,) * 3, (g,) * 3, bounds=((-2, -3, -2), (4, 0.5, 2)))
        scene = Scene(tuple(roof), (sun,), camera=camera, medium=air)
        image = render(scene, "lpv-scatter", (8, 6), samples=8, settings=settings)
        found[g] = image.layers["multiple_scatter"].mean()
    for g, light in found.items():
        expected = scattered(g) / scattered(0.0)
        # Measured .81, .52 and .39 of .74, .49 and .41: cells are half as wide as the beam.
        assert light / found[0.0] == pytest.approx(expected, rel=0.12), g


def test_a_sheet_alone_shades_all_air_below_it():
    """Shadow maps end with the surfaces; air goes on beyond, and was lit there."""
    sheet = rectangle(Y - 3 * X - 3 * Z, 6 * X, 6 * Z, PAINT_BLACK)
    air = Medium((0.02,) * 3, (1.0,) * 3, bounds=((-2.0, -3.0, -2.0), (2.0, 0.5, 2.0)))
    camera = Camera((0.0, -1.5, 4.0), (0.0, -1.5, 0.0), fov_y_deg=40.0)
    scene = Scene((sheet,), (DirectionalLight((0, -1, 0), (1e3,) * 3),), camera=camera, medium=air)
    settings = {**SETTINGS, "bounds": (-3.0, -3.2, -3.0, 3.0, 1.3, 3.0), "gather": "off"}
    image = render(scene, "lpv-scatter", (12, 8), samples=1, settings=settings)
    assert image.radiance.max() == 0.0
