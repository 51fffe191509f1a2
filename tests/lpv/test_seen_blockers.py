"""The paper's mode takes its blockers from the camera and the lights, and bounces in one step."""

from __future__ import annotations

import numpy as np
import pytest

from airlight import Camera, Scene
from airlight.gpu.memory import buffer_of
from airlight.lattice.placement import Placement
from airlight.lpv.propagate import Propagate
from airlight.lpv.step import StepKind
from airlight.rendering import Renderer
from airlight.scene import Material

WHITE = Material(base_color=(0.8, 0.8, 0.8), two_sided=True)
SETTINGS = {
    "scheme": "paper",
    "resolution": 8,
    "map_resolution": 32,
    "surfel_resolution": 32,
    "sky_lights": 0,
    "iterations": 4,
    "ambient_occlusion": False,
}


def closed_faces(renderer):
    faces = renderer.technique.kit.blockers.faces.read(np.uint32).reshape(-1, 8)
    return faces[:, :6] >> 24 > 0


def test_a_camera_that_turns_sees_more_and_keeps_it(gpu, square):
    floor = square((0, 0, 0), (2, 0, 0), (0, 0, -2), WHITE)
    ceiling = square((0, 3, 0), (2, 0, 0), (0, 0, 2), WHITE)
    scene = Scene(
        meshes=(floor, ceiling),
        camera=Camera((0.0, 1.5, 1.0), (0.0, 0.0, 0.0)),
    )
    up = Camera((0.0, 1.5, 1.0), (0.0, 3.0, 0.0))
    with Renderer(scene, "lpv", (16, 16), settings={**SETTINGS, "keep_surfels": True}) as made:
        made.frame(read=False)
        first = closed_faces(made)
        made.frame(camera=up, read=False)
        later = closed_faces(made)
        assert later.sum() > first.sum() > 0
        assert later[first].all()
    with Renderer(scene, "lpv", (16, 16), settings={**SETTINGS, "keep_surfels": False}) as made:
        made.frame(read=False)
        made.frame(camera=up, read=False)
        upward = closed_faces(made)
        made.frame(camera=scene.camera, read=False)
        np.testing.assert_array_equal(closed_faces(made), first)
        assert not upward[first].any()


@pytest.mark.parametrize("reflectance", [0, 102, 255])
def test_the_papers_bounce_adds_no_energy(gpu, commands, owned, reflectance):
    # A wall before cell x = 4: 3/4 closed from inside, met by light that arrives in that cell.
    n = 8
    states = np.zeros((3, n, n, n, 4), np.float32)
    states[:, 4, 4, 2, 0] = 1.0
    words = np.zeros((n, n, n, 8), np.uint32)
    words[..., 6:] = 0xFFFFFFFF
    share = 191
    words[:, :, 4, 0] = share << 24 | sum((share * reflectance // 255) << s for s in (0, 8, 16))
    words[:, :, 5, 6] = 0xFFFFFF00 | (255 - share)
    placement = Placement((0, 0, 0), 1.0, (n, n, n))
    made = owned(Propagate(gpu, placement, StepKind("paper", is_blocked=True, is_reflecting=True)))
    powers = []
    for steps in range(1, 5):
        total = made.encode(
            commands, owned(buffer_of(gpu, "i", states)), owned(buffer_of(gpu, "f", words)), steps
        )
        commands.submit()
        powers.append(total.read().reshape(states.shape)[0, ..., 0].sum())
    gains = np.diff([0.0, *powers])
    assert (np.diff(gains) <= 1e-5).all()
    # Only what the wall takes is lost in the second step, which reaches it.
    lost = 1.0 - gains[1] / gains[0]
    assert lost == pytest.approx(0.0, abs=1e-4) if reflectance == 255 else lost > 0.01
