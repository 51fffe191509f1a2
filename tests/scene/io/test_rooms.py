"""Which shapes are rooms to look at from inside, and to hang a lamp in."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import pytest
import trimesh

from airlight.scene import Geometry, Mesh, Scene
from airlight.scene.io import with_defaults
from airlight.scene.io.framing import find_room
from airlight.scene.io.probe import Probe
from airlight.scene.lights import PointLight

Parts = Sequence[trimesh.Trimesh]


def cylinder(radius: float, height: float, y: float = 0.0) -> trimesh.Trimesh:
    made = trimesh.creation.cylinder(radius=radius, height=height, sections=48)
    made.apply_transform(trimesh.transformations.rotation_matrix(np.pi / 2, [1, 0, 0]))
    made.apply_translation([0, y, 0])
    return made


def block(size: Sequence[float], at: Sequence[float] = (0, 0, 0)) -> trimesh.Trimesh:
    made = trimesh.creation.box(extents=size)
    made.apply_translation(at)
    return made


def turned(mesh: trimesh.Trimesh) -> trimesh.Trimesh:
    """Inside out."""
    return trimesh.Trimesh(mesh.vertices, mesh.faces[:, ::-1], process=False)


def terrain() -> trimesh.Trimesh:
    side = 30
    x, z = np.meshgrid(*[np.linspace(-50, 50, side)] * 2)
    points = np.stack([x, 5 * np.sin(x / 9) * np.cos(z / 7), z], axis=-1).reshape(-1, 3)
    first = np.arange((side - 1) * side).reshape(-1, side)[:, :-1].ravel()
    upper = np.stack([first, first + side, first + 1], axis=1)
    lower = np.stack([first + 1, first + side, first + side + 1], axis=1)
    return trimesh.Trimesh(points, np.concatenate([upper, lower]), process=False)


def shell(radius: float, height: float, wall: float) -> Parts:
    return (cylinder(radius, height), turned(cylinder(radius - wall, height - 2 * wall)))


WALLS = (
    block([4, 0.2, 6], (0, -1.6, 0)),
    block([4, 0.2, 6], (0, 1.6, 0)),
    block([0.2, 3.4, 6], (-2.1, 0, 0)),
    block([0.2, 3.4, 6], (2.1, 0, 0)),
    block([4.4, 3.4, 0.2], (0, 0, -3.1)),
)
WINDOW = (
    block([1.2, 3.4, 0.2], (-1.5, 0, 3.1)),
    block([1.2, 3.4, 0.2], (1.5, 0, 3.1)),
    block([2, 1.2, 0.2], (0, -1, 3.1)),
    block([2, 0.6, 0.2], (0, 1.3, 3.1)),
)
BED = block([1, 0.8, 2], (0.5, -1.1, 0))

ROOMS: dict[str, Parts] = {
    "a box turned inwards": (turned(block([4, 3, 6])),),
    "the same with a bed": (turned(block([4, 3, 6])), BED),
    "a closed house": (block([4.4, 3.4, 6.4]), turned(block([4, 3, 6])), BED),
    "a house with a window": (*WALLS, *WINDOW, BED),
    "a box that is open in front": WALLS,
}
THINGS: dict[str, Parts] = {
    "a cylinder": (cylinder(0.15, 0.1),),
    "one turned inside out": (turned(cylinder(0.15, 0.1)),),
    "a cake of layers": [cylinder(0.15, 0.04, 0.04 * k) for k in range(4)],
    "a cake with cream": [
        *(cylinder(0.15, 0.04, 0.05 * k) for k in range(4)),
        *(cylinder(0.155, 0.012, 0.05 * k + 0.025) for k in range(3)),
        cylinder(0.003, 0.06, 0.2),
    ],
    "icing without a cake": shell(0.15, 0.1, 0.005),
    "icing around a small cake": (*shell(0.15, 0.1, 0.005), cylinder(0.1, 0.05, -0.02)),
    "a torus": (trimesh.creation.torus(1, 0.3),),
    "a torus inside out": (turned(trimesh.creation.torus(1, 0.3)),),
    "two boxes": (block([1, 1, 1]), block([1, 1, 1], (2, 0, 0))),
    "two boxes that touch": (block([1, 1, 1]), block([1, 1, 1], (1, 0, 0))),
    "a terrain": (terrain(),),
}
MIRROR = np.diag([-1.0, 1.0, 1.0, 1.0])


def scene_of(parts: Parts, *, mirrored: bool = False) -> Scene:
    meshes = [
        Mesh(Geometry(part.vertices.astype(np.float32), part.faces.astype(np.uint32)))
        for part in parts
    ]
    placed = [replace(mesh, world_from_object=MIRROR) for mesh in meshes]
    return Scene(tuple(placed if mirrored else meshes))


@pytest.mark.parametrize("mirrored", [False, True], ids=["", "mirrored"])
@pytest.mark.parametrize("name", ROOMS)
def test_rooms_are_seen_from_inside(name: str, mirrored: bool):
    room = find_room(Probe.of(scene_of(ROOMS[name], mirrored=mirrored)))
    assert room is not None
    assert room.size[0] == pytest.approx(4, abs=0.1)


@pytest.mark.parametrize("mirrored", [False, True], ids=["", "mirrored"])
@pytest.mark.parametrize("name", THINGS)
def test_things_are_seen_from_outside_and_get_no_light(name: str, mirrored: bool):
    scene = with_defaults(scene_of(THINGS[name], mirrored=mirrored))
    assert not any(isinstance(light, PointLight) for light in scene.lights)
    low, high = scene.bounds
    eye = np.array(scene.camera.position)
    assert ((eye < low) | (eye > high)).any()


def test_winding_tells_a_solid_from_its_cavity_and_from_a_sheet_turned_inwards():
    points = np.array([[0.0, 0.0, 0.0], [2.1, 0.0, 0.0], [9.0, 9.0, 9.0]])
    outer, inner = block([4.4, 3.4, 6.4]), turned(block([4, 3, 6]))
    for parts, expected in (
        ((outer,), [1, 1, 0]),
        ((inner,), [-1, 0, 0]),
        ((outer, inner), [0, 1, 0]),
    ):
        found = Probe.of(scene_of(parts)).winding(points)
        np.testing.assert_allclose(found, expected, atol=1e-6)
