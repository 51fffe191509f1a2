"""The lattices' light, made as bright as what paths trace says."""

from __future__ import annotations

import numpy as np
import pytest

from airlight.gather.calibration import Calibration
from airlight.gpu.commands import Commands
from airlight.gpu.memory import Buffer
from airlight.maths import gather
from airlight.rendering import render
from airlight.scene import Camera, Geometry, Material, Mesh, PointLight, Scene, SpotLight
from airlight.scene.shapes import box

WHITE = Material(base_color=(0.8, 0.8, 0.8), specular=0.0)
ANGLED = [(0.0, 0.0), (4.0, 0.0), (4.0, 2.0), (2.0, 2.0), (2.0, 6.0), (0.0, 6.0)]
HIGH = 2.5


def angled_room() -> Scene:
    """Two arms at right angles; a lamp shines on the floor of one, the camera is in the other."""

    def quad(*corners):
        points = np.array(corners, np.float32)
        return Mesh(Geometry(points, np.array([[0, 1, 2], [0, 2, 3]], np.uint32)), WHITE)

    walls = [
        quad((a, 0, b), (c, 0, d), (c, HIGH, d), (a, HIGH, b))
        for (a, b), (c, d) in zip(ANGLED, ANGLED[1:] + ANGLED[:1], strict=True)
    ]
    flat = [
        quad((x0, y, z0), (x1, y, z0), (x1, y, z1), (x0, y, z1))
        for y in (0.0, HIGH)
        for x0, x1, z0, z1 in ((0.0, 4.0, 0.0, 2.0), (0.0, 2.0, 2.0, 6.0))
    ]
    light = SpotLight((3.2, 2.3, 1.0), (0.0, -1.0, 0.0), (20.0, 20.0, 20.0), 10.0, 20.0)
    camera = Camera((0.5, 1.4, 2.6), (1.2, 1.0, 6.0), fov_y_deg=60.0)
    return Scene((*walls, *flat), (light,), camera=camera)


def energy(scene, bounces, samples=4, **settings):
    """Indirect light of an image."""
    settings = {"gather_bounces": bounces, "shadow_resolution": 256, **settings}
    image = render(scene, "lpv", (48, 27), samples=samples, settings=settings)
    return float(image.layers["indirect"].sum())


def test_a_lattice_that_is_too_dark_is_put_right():
    """In a closed box iterations end long before the light does; paths say by how much."""
    grey = Material(base_color=(0.5, 0.5, 0.5), specular=0.0)
    walls = Mesh(box(), grey, np.diag((4.0, 4.0, 4.0, 1.0)))
    eye = Camera((0.0, 0.0, 0.0), (1.0, 0.0, 0.0), fov_y_deg=90.0)
    scene = Scene((walls,), (PointLight((0, 0, 0), (10, 10, 10)),), camera=eye)
    lattice = {"resolution": 12, "tail": False, "lamp_resolution": 128}
    truth = energy(scene, 16, **lattice, iterations=128)
    assert energy(scene, 1, **lattice, iterations=12) / truth < 0.85
    assert energy(scene, 2, **lattice, iterations=12) / truth == pytest.approx(1.0, abs=0.06)


def test_lattices_that_are_off_in_one_place_alone_do_not_mislead():
    """Around a corner large cells are too bright, and little of the light there is traced.

    Without calibration 2 bounces have 1.27 and 1.04 of the light of 16; with a factor that takes
    lattices to be off by the same everywhere .73 and .67; now 1.20 and 1.11. Few samples say that
    too roughly: 16 of 16 bounces have 1.04 of the light of 512 (1.15 and 1.07 beside these), 64
    of them .99 to 1.01.
    """
    scene = angled_room()
    truth = energy(scene, 16, 64, resolution=12)
    assert energy(scene, 2, 16, resolution=12) / truth == pytest.approx(1.0, abs=0.22)
    assert energy(scene, 2, 16, resolution=24) / truth == pytest.approx(1.0, abs=0.13)


def test_the_factor_is_that_of_all_paths_and_ends_are_added(gpu):
    """More paths than one round of partial sums; those without an end stay as they are."""
    rng = np.random.default_rng(5)
    count = 5000
    shares = rng.random((count, 4)) * (1.0, 3.0, 1.0, 0.0)
    paths = rng.random((count, 2, 4)).astype(np.float32)
    paths[::3, 1, 3] = 0.0
    calibration = Calibration(gpu, count)
    calibration.shares.write(shares.astype(np.float32))
    buffer = Buffer(gpu, "paths", paths.nbytes)
    buffer.write(paths)
    commands = Commands(gpu)
    calibration.measure(commands, count)
    calibration.apply(commands, buffer, count)
    commands.submit()
    factor = gather.calibration(*shares.astype(np.float64).sum(axis=0)[:3])
    truth = paths[:, 0].copy()
    truth[:, :3] += np.where(paths[:, 1, 3:] > 0.0, factor, 0.0) * paths[:, 1, :3]
    found = buffer.read(np.float32).reshape(count, 2, 4)
    np.testing.assert_allclose(found[:, 0], truth, rtol=1e-5)
    assert abs(factor - 1.0) > 0.1
