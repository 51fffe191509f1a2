"""Which lists are recomputed."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from airlight.scene import Material, Texture
from airlight.surface import draw_parts
from airlight.surface.draw_parts import DrawParts, in_draw_order


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
    monkeypatch.setattr(draw_parts, "MOST_CACHED_VIEWS", 2)
    scene = on_device(square((0, 0, 0), (1, 0, 0), (0, 1, 0)))
    some = [list(scene.draws) for _ in range(3)]
    made = [parts.of(scene, draws) for draws in some]
    assert parts.of(scene, some[2]) is made[2]
    assert parts.of(scene, some[0]) is not made[0]


def test_what_is_drawn_in_a_second_step_comes_last(on_device, square):
    glowing = Material(emission_texture=Texture(np.full((2, 2, 4), 255, np.uint8)))
    corners = ((0, 0, 0), (1, 0, 0), (0, 1, 0))
    colors = np.full((4, 4), 0.5, np.float32)
    holed = Material(alpha_cutoff=0.5)
    scene = on_device(
        square(*corners, colors=colors),
        square(*corners, glowing),
        square(*corners, holed),
        square(*corners, Material()),
    )
    found = in_draw_order(scene, scene.draws)
    late = [scene.is_drawn_last(draw) for draw in found]
    assert late == [False, False, True, True]
    for is_late in (False, True):
        wanted = [draw for draw in scene.draws if scene.is_drawn_last(draw) is is_late]
        assert [draw for draw in found if scene.is_drawn_last(draw) is is_late] == wanted
    plain = on_device(square(*corners), square(*corners, holed))
    assert in_draw_order(plain, plain.draws) is plain.draws
