"""What panels share: settings, clay, light, flicker, and the scenes made for figures."""

from __future__ import annotations

import numpy as np
import pytest

from airlight.figures import (
    clpv_1,
    clpv_5,
    clpv_6,
    clpv_9,
    clpv_10,
    clpv_11,
    clpv_12,
    clpv_table1,
    panels,
)
from airlight.lpv.settings import LpvSettings
from airlight.reference import flatland
from airlight.scene import Geometry, Material, Mesh, Scene, Texture
from airlight.scene.builtin import atrium_fog, wall_floor
from airlight.scene.image import Image
from airlight.scene.settings import make_settings


def test_quick_settings_are_settings():
    kept = panels.known("lpv", panels.QUICK)
    assert make_settings(LpvSettings, kept).resolution == 12
    assert panels.known("direct", {"iterations": 3, "resolution": 8}) == {"resolution": 8}


def test_clay_is_grey_and_keeps_what_is_cut_out():
    pixels = np.zeros((1, 2, 4), np.uint8)
    pixels[0, 1] = (9, 8, 7, 255)
    leaf = Material(base_color_texture=Texture(pixels), alpha_cutoff=0.5, metallic=1.0)
    stone = Material(base_color=(0.2, 0.4, 0.6), base_color_texture=Texture(pixels))
    geometry = Geometry(np.eye(3, dtype=np.float32), np.array([[0, 1, 2]], np.uint32))
    scene = panels.in_clay(Scene(meshes=tuple(Mesh(geometry, m) for m in (leaf, stone, leaf))))
    first, second, third = (mesh.material for mesh in scene.meshes)
    assert first is third
    assert first.metallic == 0.0
    assert first.base_color == second.base_color == (0.6, 0.6, 0.6)
    assert second.base_color_texture is None
    assert first.base_color_texture.pixels[0].tolist() == [[255] * 3 + [0], [255] * 4]


def test_the_haze_is_that_of_the_foggy_atrium():
    own, known = clpv_1.in_haze(wall_floor()).medium, atrium_fog().medium
    assert (own.sigma_t, own.albedo, own.g) == (known.sigma_t, known.albedo, known.g)


def test_scores_of_an_image_twice_too_bright():
    truth = np.full((4, 4, 3), 0.5, np.float32)
    told = clpv_6.scores(2.0 * truth, truth)
    assert told["energy_ratio"] == pytest.approx(2.0)
    assert told["relmse"] == pytest.approx(1.0, rel=1e-3)


def test_spacing_is_told_in_metres_and_the_last_value_is_the_measure():
    """The scene is 3 m long; a lattice has a cell of margin at both ends."""
    light = np.ones((2, 2, 3), np.float32)
    images = {
        n: Image(light, {"indirect": light * n}, stats={"lattice": [n, 4, 4], "iterations": 8})
        for n in (5, 8)
    }
    told = clpv_12._told(wall_floor(), images)
    assert [told[n]["spacing_m"] for n in ("5", "8")] == pytest.approx([1.0, 0.5])
    assert [told[n]["from_the_last"] for n in ("5", "8")] == pytest.approx([3.0 / 8.0, 0.0])


def test_stages_that_a_mode_lacks_cost_nothing():
    told = clpv_table1.stages_of([{"propagate": 2.0, "pack": 1.0}, {"inject": 4.0}])
    assert told["Propagation"] == (3.0, 0.0)
    assert told["Total"] == (3.0, 4.0)


def test_mean_light_is_luminance():
    assert panels.mean_light(np.full((2, 2, 3), 0.5, np.float32)) == pytest.approx(0.5)


def test_a_steady_drift_is_no_flicker_and_a_blink_is():
    drift = np.linspace(1.0, 2.0, 5)[:, None, None] * np.ones((5, 2, 3))
    assert clpv_10.flicker(drift) == pytest.approx(0.0, abs=1e-12)
    blink = np.array([1.0, 1.2, 1.0, 1.2, 1.0])[:, None, None] * np.ones((5, 2, 3))
    np.testing.assert_allclose(clpv_10.flicker(blink), 0.2 / blink.mean(), rtol=1e-6)


def test_the_wall_between_two_rooms_closes_them():
    without, walled = clpv_11.two_rooms(None), clpv_11.two_rooms(0.1)
    assert len(walled.meshes) == len(without.meshes) + 1
    low, high = walled.meshes[-1].world_bounds
    np.testing.assert_allclose(low, [-0.05, 0.0, -1.5], atol=1e-6)
    np.testing.assert_allclose(high, [0.05, 3.0, 1.5], atol=1e-6)
    (local_light,) = walled.lights
    assert local_light.position[0] < low[0] and walled.camera.position[0] > high[0]


def test_the_polished_floor_lies_on_the_box_s_own():
    floor = clpv_9.with_polished_floor(0.3).meshes[-1]
    assert (floor.material.metallic, floor.material.roughness) == (0.6, 0.3)
    low, high = floor.world_bounds
    assert low[1] == high[1] == pytest.approx(0.004)
    assert floor.geometry.normals[0].tolist() == [0.0, 1.0, 0.0]


def test_polar_plots_reach_towards_the_light_they_hold():
    """Light that goes along +x: the outline lies right of each cell's middle."""
    coefficients = np.zeros((2, 3, 3))
    coefficients[...] = flatland.basis(0.0, 2) * (2.0, 1.0, 1.0)
    cover = clpv_5._lobes(coefficients, 32, None)
    weights = cover[:32, :32]
    columns = (weights * np.arange(32)).sum() / weights.sum()
    rows = (weights * np.arange(32)[:, None]).sum() / weights.sum()
    assert columns > 18.0
    assert rows == pytest.approx(15.5)
    assert clpv_5.polar_image(coefficients, 10).shape == (20, 30, 3)
