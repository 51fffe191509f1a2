"""Light that closed opaque walls part from the eye is left out of every layer, and no other."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from airlight.lattice.bodies import is_sealed
from airlight.lattice.rooms import Rooms
from airlight.lighting.hidden import Hidden
from airlight.rendering import Renderer
from airlight.scene import (
    Camera,
    DirectionalLight,
    Environment,
    Geometry,
    Material,
    Mesh,
    PointLight,
    Scene,
    shapes,
)
from airlight.scene.lights import LightSample

OUTSIDE, INSIDE = (3.0, 0.2, 0.1), (0.1, 0.2, -0.1)
PAINT = Material()
SUN = DirectionalLight((0.0, -1.0, 0.0), (2.0, 2.0, 2.0))


def box(material=PAINT, size=2.0, missing=0) -> Mesh:
    matrix = np.diag([size, size, size, 1.0])
    g = shapes.box()
    return Mesh(Geometry(g.positions, g.indices[missing:]), material, matrix)


def bulb(position) -> PointLight:
    return PointLight(position, (1.0, 1.0, 1.0))


def shown(scene: Scene) -> Scene:
    return Hidden(Rooms(scene.meshes, np.zeros((0, 3)))).without(scene, scene.meshes)


def seen(scene: Scene) -> list[bool]:
    """Whether each light, and the sky, still gives light."""
    now = shown(scene)
    sky = [] if now.environment is None else [now.environment.scale > 0.0]
    return [any(light.row().color) for light in now.lights] + sky


def test_what_a_closed_box_parts_from_the_eye_is_dark():
    lights = (bulb(INSIDE), SUN, bulb(OUTSIDE))
    scene = Scene((box(),), lights, Environment())
    eye = Camera((4.0, 0.0, 0.0), (0.0, 0.0, 0.0))
    assert seen(replace(scene, camera=eye)) == [False, True, True, True]
    eye = replace(eye, position=(0.5, 0.1, 0.2))
    assert seen(replace(scene, camera=eye)) == [True, False, False, False]


@pytest.mark.parametrize(
    "mesh",
    [
        box(Material(transmission=0.5)),
        box(Material(alpha_cutoff=0.5)),
        box(Material(two_sided=False)),
        box(Material(emission=(1.0, 1.0, 1.0))),
        box(missing=1),
    ],
    ids=["glass", "holes", "culled", "glows", "open"],
)
def test_what_is_seen_through_hides_nothing(mesh):
    eye = Camera((4.0, 0.0, 0.0), (0.0, 0.0, 0.0))
    scene = Scene((mesh,), (bulb(INSIDE),), camera=eye)
    assert shown(scene) is scene


def test_what_reaches_through_the_wall_is_not_hidden():
    light = bulb((0.9, 0.0, 0.0))
    scene = Scene((box(),), (light,), camera=Camera((4.0, 0.0, 0.0), (0.0, 0.0, 0.0)))
    assert seen(scene) == [False]
    # What stands for parts of lights with extent may have some on either side.
    sample = LightSample((0.9, 0.0, 0.0), (1.0, 0.0, 0.0), (1.0, 1.0, 1.0), extent=0.01)
    assert seen(replace(scene, lights=(sample,))) == [True]
    # nor of a lens that does
    near = replace(scene.camera, position=(1.2, 0.0, 0.0), aperture_m=0.5)
    assert seen(replace(scene, camera=near)) == [True]
    # nor what lies in the wall itself
    on_wall = bulb((1.0, 0.0, 0.0))
    assert seen(replace(scene, lights=(on_wall,))) == [True]


def test_an_edge_that_runs_twice_one_way_is_no_seal():
    whole = box()
    assert is_sealed([whole])
    g = whole.geometry
    double = np.concatenate([g.indices, g.indices[:1]])
    assert not is_sealed([replace(whole, geometry=Geometry(g.positions, double))])


def test_a_renderer_s_eye_and_light_go_in_and_out():
    """The image is that of a renderer made there; dark where the wall is between them."""
    paint = Material(base_color=(0.7, 0.7, 0.7), specular=0.0)
    out, into = Camera((2.5, 0.3, 1.0), (0.0, 0.0, 0.0)), Camera((0.5, 0.1, 0.6), (0.0, 0.0, 0.0))
    scene = Scene((box(paint),), (bulb(INSIDE),), camera=out)
    settings = {"resolution": 8, "surfels": 2000, "lamp_resolution": 64}
    with Renderer(scene, "lpv", (16, 9), settings=settings) as renderer:
        assert renderer.frame().radiance.max() == 0.0
        lit = renderer.frame(camera=into).radiance
        assert lit.mean() > 0.1
        assert renderer.frame(lights=(bulb(OUTSIDE),)).radiance.max() == 0.0
        assert renderer.frame(camera=out).radiance.mean() > 0.01
        again = renderer.frame(lights=(bulb(INSIDE),), camera=into).radiance
        np.testing.assert_array_equal(lit, again)


def test_what_is_hidden_is_the_same_object_in_each_frame():
    """So that a camera alone that moves is no light that changes."""
    scene = Scene(
        (box(),), (bulb(INSIDE), bulb(OUTSIDE)), camera=Camera((4.0, 0.0, 0.0), (0, 0, 0))
    )
    hidden = Hidden(Rooms(scene.meshes, np.zeros((0, 3))))
    first = hidden.without(scene, scene.meshes)
    moved = replace(scene, camera=replace(scene.camera, position=(4.0, 0.5, 0.0)))
    assert hidden.without(moved, scene.meshes).lights is first.lights


def test_a_lid_that_opens_shows_what_was_hidden():
    """And shut again it hides it: whatever was asked before."""
    g = shapes.box()
    matrix = np.diag([2.0, 2.0, 2.0, 1.0])
    chest, lid = (
        Mesh(Geometry(g.positions, part), PAINT, matrix) for part in (g.indices[2:], g.indices[:2])
    )
    eye = Camera((4.0, 3.0, 2.0), (0.0, 0.0, 0.0))
    scene = Scene((chest, lid), (bulb(INSIDE),), camera=eye)
    hidden = Hidden(Rooms(scene.meshes, np.zeros((0, 3))))
    up = matrix.copy()
    up[:3, 3] = 0.3
    opened = (chest, replace(lid, world_from_object=up))
    for meshes, flags in (
        (scene.meshes, (True, False)),
        (opened, (False, False)),
        (scene.meshes, (True, False)),
    ):
        assert hidden.flags(replace(scene, meshes=meshes), meshes) == flags
