"""The eye stays in the room that it is in, whatever a hand does, and orbits freely outside."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from airlight.app.view.controls import LEFT, CameraControls
from airlight.app.view.free_space import FreeSpace
from airlight.scene.camera import Camera
from airlight.scene.mesh import Mesh
from airlight.scene.scene import Scene
from airlight.scene.shapes import box

ROOM_LOW, ROOM_HIGH = np.array((-3.0, 0.0, -2.0)), np.array((3.0, 2.6, 2.0))
PILLAR_LOW, PILLAR_HIGH = np.array((0.2, 0.0, -0.9)), np.array((0.8, 2.6, -0.3))


def box_between(low, high, *, inside_out: bool = False) -> Mesh:
    matrix = np.diag([*(high - low), 1.0])
    matrix[:3, 3] = (low + high) / 2.0
    geometry = box()
    if inside_out:
        geometry = replace(
            geometry, indices=geometry.indices[:, ::-1].copy(), normals=-geometry.normals
        )
    return Mesh(geometry=geometry, world_from_object=matrix)


@pytest.fixture(scope="module")
def room() -> Scene:
    walls = box_between(ROOM_LOW, ROOM_HIGH, inside_out=True)
    return Scene(meshes=(walls, box_between(PILLAR_LOW, PILLAR_HIGH)))


def crosses(a, b, low, high) -> bool:
    """Whether the way from a to b meets the box low..high: by slabs, no triangles."""
    way = np.where(np.abs(b - a) < 1e-12, 1e-12, b - a)
    t0, t1 = (low - a) / way, (high - a) / way
    enters, leaves = np.minimum(t0, t1).max(), np.maximum(t0, t1).min()
    return bool(max(enters, 0.0) < min(leaves, 1.0))


def hands(camera: Camera, scene: Scene) -> CameraControls:
    made = CameraControls(camera, reach_m=8.0, free=FreeSpace(scene))
    made.height_px = 300.0
    return made


@pytest.mark.parametrize("seed", range(8))
def test_no_drag_and_no_wheel_leads_through_walls_or_the_pillar(room, seed):
    rng = np.random.default_rng(seed)
    # Targets behind the wall, as the default camera's, in the room, and in the pillar.
    targets = ((-9.0, 1.0, -1.0), (-0.5, 1.0, 0.5), (0.5, 1.3, -0.6))
    controls = hands(Camera((2.4, 1.6, 1.5), targets[seed % 3]), room)
    before = np.array(controls.camera.position)
    moved = 0.0
    for _ in range(6):
        at = rng.uniform(100.0, 200.0, 2)
        down = {"button": LEFT, "modifiers": ()}
        controls.handle({"event_type": "pointer_down", "x": at[0], "y": at[1], **down})
        way = rng.uniform(-25.0, 25.0, 2)
        for _ in range(12):
            at = at + way
            controls.handle({"event_type": "pointer_move", "x": at[0], "y": at[1], **down})
            eye = np.array(controls.camera.position)
            assert np.all(eye > ROOM_LOW)
            assert np.all(eye < ROOM_HIGH)
            assert not crosses(before, eye, PILLAR_LOW, PILLAR_HIGH)
            moved, before = moved + float(np.linalg.norm(eye - before)), eye
        controls.handle({"event_type": "pointer_up", **down})
        controls.handle({"event_type": "wheel", "dy": float(rng.choice([-900.0, 900.0]))})
        eye = np.array(controls.camera.position)
        assert np.all(eye > ROOM_LOW)
        assert np.all(eye < ROOM_HIGH)
        before = eye
    assert moved > 1.0  # walls hold the eye, they do not nail it down


def test_a_drag_begins_without_a_jump_of_the_view(room):
    controls = hands(Camera((2.4, 1.6, 1.5), (-9.0, 1.0, -1.0)), room)
    home = controls.camera
    down = {"button": LEFT, "modifiers": ()}
    controls.handle({"event_type": "pointer_down", "x": 10.0, "y": 10.0, **down})
    assert controls.camera == home  # a click alone changes nothing
    controls.handle({"event_type": "pointer_move", "x": 10.001, "y": 10.0, **down})
    eye, target = np.array(controls.camera.position), np.array(controls.camera.target)
    assert np.allclose(eye, home.position, atol=1e-3)
    look, was = target - eye, np.subtract(home.target, home.position)
    assert np.allclose(look / np.linalg.norm(look), was / np.linalg.norm(was), atol=1e-4)
    assert np.linalg.norm(look) < np.linalg.norm(was)  # the pivot is in the room now


def test_outside_nothing_holds_the_eye():
    """A box in the open, with another in the way of the orbit."""
    scene = Scene(
        meshes=(
            box_between(-np.ones(3), np.ones(3)),
            box_between(np.array((4.0, -1.0, -1.0)), np.array((6.0, 1.0, 1.0))),
        )
    )
    controls = hands(Camera((0.0, 0.0, 5.0), (0.0, 0.0, 0.0)), scene)
    down = {"button": LEFT, "modifiers": ()}
    controls.handle({"event_type": "pointer_down", "x": 0.0, "y": 0.0, **down})
    controls.handle({"event_type": "pointer_move", "x": -150.0, "y": 0.0, **down})
    assert np.allclose(controls.camera.position, (5.0, 0.0, 0.0), atol=1e-9)
    assert controls.camera.target == (0.0, 0.0, 0.0)


def test_what_is_looked_at_stays_the_pivot_and_a_wall_gives_it_back(room):
    free = FreeSpace(room)
    eye = np.array((2.4, 1.6, 1.5))
    pillar = np.array((0.5, 1.3, -0.6))
    assert np.allclose(free.pivot(eye, pillar), pillar)
    assert free.is_enclosed(eye)
    assert not free.is_enclosed(np.array((0.0, 20.0, 0.0)))
    by = free.moved(eye, np.array((0.0, 0.0, 3.0)))
    assert 0.0 < by[2] < ROOM_HIGH[2] - eye[2]
