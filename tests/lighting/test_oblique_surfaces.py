"""Surfaces oblique to the cells: the light of their other side does not come through."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from airlight.rendering import Renderer
from airlight.scene.builtin import builtin_scene


@pytest.mark.parametrize(
    ("medium", "technique", "layer", "most"),
    [(False, "lpv", "indirect", 3.0), (True, "lpv-scatter", "multiple_scatter", 1.36)],
)
def test_a_board_lit_from_behind_shows_no_plates(medium, technique, layer, most):
    # The brightest twentieth of its dark side over the median: 2.25 and 1.33; 4.7 and 1.67 where
    # lookups stop at the steps of faces that an oblique board closes, 1.39 where fog before the
    # board is read in cells that it cuts.
    scene = builtin_scene("bleeding")
    scene = scene if medium else replace(scene, medium=None)
    with Renderer(scene, technique, (96, 54)) as renderer:
        layers = renderer.frame().layers
    along = np.abs(layers["normal"]).max(axis=-1)
    board = layers[layer].mean(axis=-1)[(along > 0.5) & (along < 0.95)]
    assert len(board) > 500
    assert np.percentile(board, 95.0) < most * np.median(board)
