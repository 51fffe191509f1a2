"""Bare models stand on a ground; rooms, floors and scenes with a sky of their own do not."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from airlight.maths.colour import luminance
from airlight.rendering import render
from airlight.scene import Environment, Material, Mesh, Scene
from airlight.scene.io import load, with_defaults
from airlight.scene.io.ground import NAME, with_ground, without_ground
from airlight.scene.io.toml_text import scene_text
from airlight.scene.shapes import box, quad, sphere
from airlight.scene.sun_sky import Sky, with_sky


def placed(geometry, at, size) -> Mesh:
    matrix = np.diag((*size, 1.0))
    matrix[:3, 3] = at
    return Mesh(geometry=geometry, world_from_object=matrix, material=Material((0.7, 0.3, 0.2)))


def ball() -> Scene:
    return with_defaults(Scene(meshes=(placed(sphere(), (3.0, 5.0, 1.0), (2.0, 2.0, 2.0)),)))


def test_a_ball_stands_on_a_ground_that_touches_it():
    scene = with_ground(ball())
    ground = scene.meshes[-1]
    assert ground.name == NAME
    low, high = ground.world_bounds
    assert low[1] == pytest.approx(4.0, abs=1e-3)
    assert low[1] < 4.0
    assert (low[[0, 2]] + high[[0, 2]]) / 2.0 == pytest.approx((3.0, 1.0), abs=0.01)
    assert high[0] - low[0] > 10.0
    assert scene.camera == ball().camera
    assert len(without_ground(scene).meshes) == 1


def test_beyond_its_edge_the_backdrop_is_as_bright():
    scene = with_ground(ball())
    material = scene.meshes[-1].material
    # What the map's upper half and the light give it, summed texel by texel here.
    upper = scene.environment.map[: len(scene.environment.map) // 2]
    rows = len(upper)
    v = (np.arange(rows) + 0.5) / (2 * rows) * np.pi
    weights = np.cos(v) * np.sin(v) * (np.pi / (2 * rows)) * (2.0 * np.pi / (4 * rows))
    received = (upper * weights[:, None, None]).sum(axis=(0, 1))
    received += np.array(scene.lights[0].irradiance) * -scene.lights[0].direction[1]
    below = scene.environment.map[-4:].reshape(-1, 3).mean(axis=0)
    assert below == pytest.approx(np.array(material.base_color) / np.pi * received, rel=0.01)
    # A mirrored share would brighten it towards its far edge, and tell it from the backdrop.
    assert material.specular == 0.0


@pytest.mark.parametrize("name", ["floor", "room", "plane", "own sky", "no sky"])
def test_no_ground_under(name):
    walls = placed(box(), (0.0, 1.3, 0.0), (6.0, 2.6, 5.0))
    turned = replace(
        walls.geometry,
        indices=walls.geometry.indices[:, ::-1].copy(),
        normals=-walls.geometry.normals,
    )
    on_floor = (
        placed(box(), (0.0, 0.5, 0.0), (1.0, 1.0, 1.0)),
        placed(quad(), (0.0, 0.0, 0.0), (6.0, 1.0, 6.0)),
    )
    scene = {
        "floor": with_defaults(Scene(meshes=on_floor)),
        "room": with_defaults(Scene(meshes=(replace(walls, geometry=turned),))),
        "plane": with_defaults(Scene(meshes=on_floor[1:])),
        "own sky": replace(ball(), environment=Environment()),
        "no sky": replace(ball(), environment=None),
    }[name]
    assert with_ground(scene) is scene


def test_a_computed_sky_gives_it_its_albedo():
    scene = with_ground(with_sky(ball(), Sky(ground=0.4)))
    assert scene.meshes[-1].material.base_color == pytest.approx((0.4, 0.4, 0.4))


def test_it_carries_a_shadow_and_has_no_edge(gpu):
    """Beside the ball the ground is darker where the light does not reach it; at its far edge
    ground and backdrop meet within 2 %: left is the sky's cut into lights, and the ball's shade."""
    scene = with_ground(ball())
    image = render(scene, technique="lpv", size=(96, 54), samples=2).radiance
    grey = luminance(image)
    lit, dark = np.quantile(grey[41:], 0.9), np.quantile(grey[41:], 0.02)
    assert dark < 0.5 * lit
    # The edge lies in the upper half of the left edge of the image, far from ball and shadow.
    left = grey[:27, :4].mean(axis=1)
    assert np.abs(np.diff(left)).max() < 0.02 * left.mean()


def test_load_puts_it_where_it_is_asked_to_and_scene_files_keep_it(tmp_path):
    obj = tmp_path / "one.obj"
    obj.write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n")
    assert len(load(obj).meshes) == 1
    scene = load(obj, ground=True)
    assert len(scene.meshes) == 2
    again = tmp_path / "again.toml"
    again.write_text(scene_text(scene, scene, str(obj), tmp_path, model={"ground": True}))
    back = load(again)
    assert len(back.meshes) == 2
    assert np.allclose(back.meshes[1].world_bounds, scene.meshes[1].world_bounds)


@pytest.mark.parametrize("glow", ["", "Ke 0 1 0"])
def test_a_scene_file_of_a_bare_model_shows_the_same(tmp_path, glow):
    """Light, backdrop, exposure, camera and ground; surfaces that emit change nothing of them."""
    obj, again = tmp_path / "one.obj", tmp_path / "again.toml"
    (tmp_path / "one.mtl").write_text(f"newmtl a\nKd .5 .5 .5\n{glow}\n")
    obj.write_text(
        "mtllib one.mtl\nusemtl a\nv 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\n"
        "f 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n"
    )
    scene = load(obj, ground=True)
    text = scene_text(scene, scene, str(obj), tmp_path, model={"ground": True})
    assert 'file = "builtin:studio"' in text and "#" not in text
    again.write_text(text)
    back = load(again)
    assert back.camera == scene.camera and back.camera.exposure_stops is not None
    assert back.lights == scene.lights
    np.testing.assert_array_equal(back.environment.map, scene.environment.map)
    ground, same = scene.meshes[-1], back.meshes[-1]
    assert (same.material.base_color, same.material.specular) == (ground.material.base_color, 0.0)
    # And what was read is written again as it was.
    assert scene_text(back, back, str(again), tmp_path) == text


def test_a_grid_stands_on_one_where_it_is_asked_to(tmp_path):
    grid = tmp_path / "smoke.npy"
    np.save(grid, np.ones((4, 4, 4), np.float32))
    assert load(grid, ground=None).meshes == ()
    scene = load(grid, ground=True)
    ((low, high),) = [mesh.world_bounds for mesh in scene.meshes]
    bottom = scene.volumes[0].bounds[0][1]
    assert high[1] == pytest.approx(bottom, abs=1e-3) and high[1] < bottom
    assert high[0] - low[0] > 5.0 * (scene.volumes[0].bounds[1][0] - scene.volumes[0].bounds[0][0])
    assert scene.camera.position[1] > high[1]  # from below it would hide the grid
    again = tmp_path / "again.toml"
    again.write_text(scene_text(scene, scene, str(grid), tmp_path, model={"ground": True}))
    assert np.allclose(load(again).meshes[0].world_bounds, (low, high))
