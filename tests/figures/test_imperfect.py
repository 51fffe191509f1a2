"""Imperfect shadow maps: what blocks, holes that are filled, and the light of a lit wall."""

from __future__ import annotations

import numpy as np
import pytest

from airlight.figures import imperfect
from airlight.figures.clpv_6 import scores
from airlight.figures.panels import Request
from airlight.scene.builtin import cornell
from airlight.scene.builtin.solids import box
from airlight.scene.lights import SpotLight
from airlight.scene.material import Material
from airlight.scene.mesh import Mesh
from airlight.scene.scene import Scene


def test_a_screen_of_points_blocks_what_is_behind_it_and_holes_are_filled():
    rng = np.random.default_rng(1)
    # A square screen 2 m away, of fewer points than its texels are.
    screen = np.column_stack([rng.uniform(-1.0, 1.0, (400, 2)), np.full(400, 2.0)])
    seen = imperfect.depth_map(screen)
    assert np.isfinite(seen).all()
    inside = np.column_stack([rng.uniform(-0.8, 0.8, (200, 2)), np.full(200, 1.0)])
    inside[:, :2] *= 0.5
    assert imperfect.is_lit(seen, inside, 0.1).all()
    assert not imperfect.is_lit(seen, 4.0 * inside, 0.1).any()
    # Behind the light itself nothing is lit.
    assert not imperfect.is_lit(seen, inside * (1.0, 1.0, -1.0), 0.1).any()


def test_virtual_lights_have_the_power_that_a_wall_reflects(gpu):
    """A cone of light on a grey floor: intensity times solid angle times reflectance."""
    grey = Mesh(
        box((-5.0, -0.1, -5.0), (5.0, 0.0, 5.0)), Material(base_color=(0.5,) * 3, specular=0.0)
    )
    light = SpotLight((0.0, 2.0, 0.0), (0.0, -1.0, 0.0), (10.0,) * 3, 30.0, 30.0)
    lights = imperfect.virtual_lights(
        Request((48, 27)), Scene(meshes=(grey,), lights=(light,)), np.random.default_rng(2)
    )
    assert len(lights.power) == imperfect.LIGHTS
    flux = 10.0 * 2.0 * np.pi * (1.0 - np.cos(np.radians(30.0)))
    # The cone's rim is drawn by texels of the view, 256 across it.
    assert lights.power.sum(axis=0) == pytest.approx(0.5 * flux, rel=0.02)
    assert lights.position[:, 1] == pytest.approx(0.0, abs=1e-3)
    lit_m2 = np.pi * (2.0 * np.tan(np.radians(30.0))) ** 2
    assert lights.area.sum() == pytest.approx(lit_m2, rel=0.05)


@pytest.mark.needs("mitsuba")
def test_the_box_has_a_path_tracer_s_light_beyond_what_imperfect_shadows_take(gpu):
    from airlight.figures.truths import traced

    request = Request((96, 54), quick=True)
    truth = traced(request, cornell()).image.layers["one_bounce"]
    indirect = imperfect.indirect_of(Request((48, 27)), cornell())
    # Measured .97 at 96 x 54 and 64 samples; points apart by .2 m darken corners.
    assert scores(indirect, truth)["energy_ratio"] == pytest.approx(0.97, abs=0.12)
