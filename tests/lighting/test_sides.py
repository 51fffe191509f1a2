"""Surfaces that reflect on their front alone: their back is black or culled, and stops light."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from airlight.reference import mitsuba
from airlight.rendering import render
from airlight.scene import Camera, DirectionalLight, Environment, Material, Mesh, Scene
from airlight.scene.material import SIDES
from airlight.scene.shapes import quad

FLOOR = Material(base_color=(0.7, 0.7, 0.7), specular=0.0)
RED = Material(base_color=(0.8, 0.3, 0.2), specular=0.0)
SIZE = (48, 27)
LPV = {"resolution": 16, "shadow_resolution": 512, "sky_lights": 64, "surfels": 20_000}


def sheet_on_a_floor(side: float, sides: str) -> Scene:
    """A red sheet of 2 m by 3 m whose front faces +X, upright on a floor; the eye on `side`."""
    floor = np.diag([6.0, 1.0, 6.0, 1.0])
    upright = np.eye(4)
    upright[:3, :3] = np.array([[0, 1, 0], [-1, 0, 0], [0, 0, 1.0]]) @ np.diag([2.0, 1.0, 3.0])
    upright[:3, 3] = (0.0, 1.0, 0.0)
    return Scene(
        meshes=(
            Mesh(quad(), FLOOR, floor),
            Mesh(quad(), replace(RED, **SIDES[sides]), upright),
        ),
        camera=Camera(position=(5.0 * side, 2.0, 3.5), target=(0.0, 0.7, 0.0), fov_y_deg=40.0),
    )


def lit_from(scene: Scene, x: float) -> Scene:
    """Under a sun on the side of `x`; 0: a white sky."""
    if x == 0.0:
        return replace(scene, environment=Environment(radiance=(0.3, 0.3, 0.3)))
    return replace(scene, lights=(DirectionalLight((-x, -0.6, 0.2), (5.0, 5.0, 5.0)),))


@pytest.mark.both_paths
@pytest.mark.parametrize("technique", ["direct", "lpv"])
def test_a_black_back_reflects_nothing_and_a_culled_one_is_seen_through(rendered, technique):
    # The sun is on the eye's side, and so is the sheet's back.
    images = {
        sides: rendered(lit_from(sheet_on_a_floor(-1.0, sides), -0.7), technique) for sides in SIDES
    }
    on_sheet = (slice(18, 22), slice(28, 36))  # well inside the sheet of 64 x 48 pixels
    light = {sides: image.radiance[on_sheet] for sides, image in images.items()}
    depth = {sides: image.layers["depth"][on_sheet] for sides, image in images.items()}
    assert light["front"].max() == 0.0
    assert light["both"][..., 0].min() > 0.3
    np.testing.assert_array_equal(depth["front"], depth["both"])
    assert (depth["culled"] > depth["front"]).all()
    # All of them throw the same shadow: where it lies, no light comes from the sun.
    floor = images["culled"].layers["direct"]
    assert floor[on_sheet].max() < 0.05 * floor.max()


@pytest.mark.both_paths
def test_a_back_does_not_glow(rendered):
    local_light = Material(
        base_color=(0, 0, 0), specular=0.0, emission=(8.0, 4.0, 2.0), **SIDES["front"]
    )
    camera = Camera(position=(0, 2, 0), target=(0, 0, 0), up=(0, 0, 1), fov_y_deg=10.0)
    for sign, seen in ((1.0, (8.0, 4.0, 2.0)), (-1.0, (0.0, 0.0, 0.0))):
        turned = np.diag([1.0, sign, sign, 1.0])
        image = rendered(Scene(meshes=(Mesh(quad(), local_light, turned),), camera=camera))
        np.testing.assert_allclose(image.layers["direct"][24, 32], seen, rtol=1e-6)
        assert image.layers["depth"][24, 32] == pytest.approx(2.0, rel=1e-5)


@pytest.mark.needs("mitsuba")
@pytest.mark.parametrize("side", [1.0, -1.0])
@pytest.mark.parametrize("sun", [0.7, -0.7, 0.0])
def test_energy_is_mitsubas_from_both_sides(gpu, side, sun):
    # Measured: .998 to 1.004. Reflecting on both sides gives up to 1.25 here.
    scene = lit_from(sheet_on_a_floor(side, "front"), sun)
    truth = mitsuba.render(scene, size=SIZE, spp=64).radiance
    image = render(scene, size=SIZE, settings=LPV, samples=4).radiance
    assert image.sum() / truth.sum() == pytest.approx(1.0, abs=0.03)
