"""The room: closed but for its window, a patch of sun on its floor."""

from __future__ import annotations

import numpy as np

from airlight.scene import Scene
from airlight.scene.builtin import room_shell as shell
from airlight.scene.builtin.room import SUN_TRAVEL

from .conftest import make_caster, world_triangles

SHELL_ONLY = (
    *("sofa", "rug", "picture", "table", "chair", "vase", "lamp", "shelf", "books"),
    *("window", "curtain", "pot", "soil", "plant"),
)


def test_budget(room_scene: Scene) -> None:
    assert 5_000 <= room_scene.triangle_count <= 20_000


def test_rays_leave_only_through_the_window(room_scene: Scene) -> None:
    cast = make_caster(world_triangles(room_scene, SHELL_ONLY))
    rng = np.random.default_rng(0)
    directions = rng.standard_normal((600, 3))
    directions /= np.linalg.norm(directions, axis=1, keepdims=True)
    low, high = np.array(shell.LOW_M) + 0.05, np.array(shell.HIGH_M) - 0.05
    origins = rng.uniform(low, high, (600, 3))
    out = np.isinf(cast(origins, directions))
    steps = (shell.LOW_M[0] - origins[:, 0]) / directions[:, 0]
    at = origins + steps[:, None] * directions
    (sill, head), (near, far) = shell.WINDOW_Y_M, shell.WINDOW_Z_M
    window = (steps > 0) & (at[:, 1] > sill) & (at[:, 1] < head)
    window &= (at[:, 2] > near) & (at[:, 2] < far)
    assert 3 < out.sum() < 60
    assert np.all(window[out])


def test_the_sun_lies_on_the_floor(room_scene: Scene) -> None:
    cast = make_caster(world_triangles(room_scene, ("plant", "curtain")))
    to_sun = -np.array(SUN_TRAVEL) / np.linalg.norm(SUN_TRAVEL)
    x, z = np.meshgrid(np.linspace(-2.4, 2.4, 17), np.linspace(-1.9, 2.4, 15))
    floor = np.stack([x.ravel(), np.full(x.size, 0.03), z.ravel()], axis=1)
    lit = np.isinf(cast(floor, np.tile(to_sun, (len(floor), 1))))
    assert 0.04 < lit.mean() < 0.4


def test_shelf_boards_are_thin_and_walls_thick(room_scene: Scene) -> None:
    low, high = room_scene.bounds
    assert np.all(low <= np.array(shell.LOW_M) - shell.WALL_M + 1e-6)
    assert np.all(high >= np.array(shell.HIGH_M) + shell.WALL_M - 1e-6)
    names = {m.name for m in room_scene.meshes}
    assert {"shelf", "sofa", "table", "coloured wall", "plant"} <= names
