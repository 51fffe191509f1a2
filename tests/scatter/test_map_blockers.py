"""Six maps around a scene block as samples of its surfaces do, where they see them."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from airlight.gpu.commands import Commands
from airlight.lattice.blockers import Blockers
from airlight.lattice.placement import fitted
from airlight.rendering import render
from airlight.scatter.map_blockers import MapBlockers
from airlight.scene.builtin import haze_box
from airlight.scene.builtin.patch import Finish
from airlight.scene.builtin.solids import box
from airlight.scene.camera import Camera
from airlight.scene.material import Material
from airlight.scene.scene import Scene
from airlight.surface.geometry import GpuScene

LOW, HIGH = np.array([-2.0, -1.0, -1.0]), np.array([2.0, 1.0, 1.0])


def blocks() -> Scene:
    """Two closed boxes; nothing of them is hidden from outside but what they hide themselves."""
    grey = Finish(Material(base_color=(0.7, 0.5, 0.3), specular=0.0, two_sided=False))
    boxes = box((-1.5, -1.0, -0.7), (-0.5, 0.4, 0.6)), box((0.4, -0.6, -1.0), (1.6, 0.9, 0.1))
    meshes = [mesh for body in boxes for mesh in grey.meshes(body, "block")]
    return Scene(meshes=tuple(meshes), camera=Camera((4.0, 2.0, 4.0), (0.0, 0.0, 0.0)))


def faces(gpu: Any, kind: Any, **more: Any) -> np.ndarray:
    """(Z, Y, X, 6): the open shares of incoming hops."""
    scene, commands = blocks(), Commands(gpu)
    made = kind(gpu, scene, GpuScene(gpu, scene), fitted(LOW, HIGH, 18), 60_000, **more)
    made.encode(commands)
    commands.submit()
    nx, ny, nz = made.placement.count
    packed = made.face_visibility.read(np.uint8).reshape(nz, ny, nx, 8)
    return np.asarray(packed[..., :6] / 255.0)


def test_the_same_faces_are_closed(gpu: Any) -> None:
    sampled = faces(gpu, Blockers)
    mapped = faces(gpu, MapBlockers, resolution=128)
    shut = sampled < 0.3
    assert shut.sum() > 200
    # What samples close, maps close; they close both sides, where samples close one.
    assert (mapped[shut] < 0.5).mean() > 0.9
    either = np.minimum(sampled[..., ::2], sampled[..., 1::2])
    both = np.minimum(mapped[..., ::2], mapped[..., 1::2])
    assert (both[either > 0.95] > 0.7).mean() > 0.9


def test_a_foggy_box_is_about_as_bright(gpu: Any) -> None:
    settings = {"resolution": 16, "surfels": 40_000, "lamp_resolution": 64, "map_resolution": 64}
    light = {}
    for kind in ("surfels", "maps"):
        image = render(
            haze_box(), "lpv-scatter", (24, 18), samples=1, settings={**settings, "blockers": kind}
        )
        light[kind] = float(image.layers["multiple_scatter"].mean())
    assert light["maps"] == pytest.approx(light["surfels"], rel=0.25)
