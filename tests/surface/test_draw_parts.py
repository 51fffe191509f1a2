"""Which lists are made anew."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from airlight.surface import draw_parts
from airlight.surface.draw_parts import DrawParts


@pytest.fixture
def parts():
    """Copies of lists."""
    return DrawParts(lambda scene, draws: list(draws))


def _moved(mesh, x, **how):
    placed = np.eye(4)
    placed[0, 3] = x
    return replace(mesh, world_from_object=placed, geometry=replace(mesh.geometry, **how))


def test_each_list_is_made_once_until_something_moves(on_device, square, parts):
    mesh = square((0, 0, 0), (1, 0, 0), (0, 1, 0))
    scene = on_device(mesh)
    some = [list(scene.draws) for _ in range(3)]
    made = [parts.of(scene, draws) for draws in some]
    assert [parts.of(scene, draws) for draws in some] == made
    assert all(parts.of(scene, d) is m for d, m in zip(some, made, strict=True))
    whole = parts.of(scene, scene.draws)
    scene.move((_moved(mesh, 1.0),))
    assert parts.of(scene, scene.draws) is whole
    assert parts.of(scene, some[0]) is not made[0]
    other = on_device(mesh)
    parts.of(other, other.draws)
    assert parts.of(scene, scene.draws) is not whole


def test_colours_that_come_later_change_all_of_them(on_device, square, parts):
    mesh = square((0, 0, 0), (1, 0, 0), (0, 1, 0))
    scene = on_device(mesh)
    whole = parts.of(scene, scene.draws)
    scene.move((_moved(mesh, 0.0, colors=np.full((4, 4), 0.5, np.float32)),))
    assert parts.of(scene, scene.draws) is not whole


def test_no_more_are_kept_than_there_are_views(on_device, square, parts, monkeypatch):
    monkeypatch.setattr(draw_parts, "VIEWS_KEPT", 2)
    scene = on_device(square((0, 0, 0), (1, 0, 0), (0, 1, 0)))
    some = [list(scene.draws) for _ in range(3)]
    made = [parts.of(scene, draws) for draws in some]
    assert parts.of(scene, some[2]) is made[2]
    assert parts.of(scene, some[0]) is not made[0]
