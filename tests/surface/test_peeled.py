"""Layers of translucent surfaces: which one each pixel has, from the eye on."""

from __future__ import annotations

import numpy as np
import pytest

from airlight.maths.transforms import clip_from_view_infinite, view_from_world
from airlight.scene import Material
from airlight.surface.gbuffer import GBuffer
from airlight.surface.peeled import PeeledGBuffer

SIZE = (32, 16)
NEAR_M = 0.01
pytestmark = pytest.mark.both_paths


def test_layers_come_in_the_order_of_their_depth(gpu, commands, owned, on_device, square):
    """A pane on the left, two all over, a solid square on the right before the last of them."""
    look = Material(base_color=(0.2, 0.4, 0.6), alpha=0.25, is_blended=True)
    solid = square((5, 0, 0), (5, 0, 0), (0, 9, 0), Material())
    last = square((0, 0, -1), (30, 0, 0), (0, 30, 0), look)
    first = square((0, 0, 2), (9, 0, 0), (0, 9, 0), look)
    left = square((-5, 0, 1), (5, 0, 0), (0, 9, 0), look)
    scene = on_device(last, solid, left, first)
    clip = clip_from_view_infinite(np.pi / 2, SIZE[0] / SIZE[1], NEAR_M)
    clip = clip @ view_from_world((0, 0, 4.0), (0, 0, -1), (0, 1, 0))
    whole, layer = GBuffer(gpu, SIZE), PeeledGBuffer(gpu, SIZE)
    whole.encode(commands, scene, clip)
    layer.begin(whole.depth, (0.0, 0.0, 4.0))
    distances, taken = [], []
    for _ in range(4):
        layer.encode(commands, scene, clip)
        commands.submit()
        depth = layer.depth.read()
        distances.append(np.where(depth > 0.0, NEAR_M / np.maximum(depth, 1e-9), np.inf))
        taken.append(layer.taken.read().astype(np.float64))
    is_left = np.arange(SIZE[0]) < SIZE[0] // 2
    for found, on_left, on_right in zip(
        distances, (2.0, 3.0, 5.0, np.inf), (2.0, np.inf, np.inf, np.inf), strict=True
    ):
        expected = np.broadcast_to(np.where(is_left, on_left, on_right), found.shape)
        np.testing.assert_allclose(found, expected, rtol=1e-5)
    for found, distance in zip(taken, distances, strict=True):
        share = np.where(np.isfinite(distance), 0.25, 0.0)
        np.testing.assert_allclose(found, share[..., None] * np.ones(4), atol=1e-3)
