"""What meshes enclose: how fine its voxels are, and that they hold all of it."""

from __future__ import annotations

import numpy as np
import pytest

from airlight.scene import Material, Mesh
from airlight.scene.enclosed import FEWEST, MOST, Body
from airlight.scene.shapes import box, quad, sphere


def placed(scale: tuple[float, float, float], shape=None) -> Mesh:
    return Mesh(shape or sphere(), Material(), np.diag([*scale, 1.0]))


def enclosed_m3(body: Body, free_path_m: float) -> float:
    found = body.density(free_path_m)
    assert found is not None
    density, (low, high) = found
    return float(density.mean(dtype=np.float64) * np.prod(np.subtract(high, low)))


def test_voxels_are_as_small_as_chords_and_free_paths_want() -> None:
    for scale, free_path_m, most in (
        ((1.0, 1.0, 1.0), 1.0, FEWEST),  # a ball of 43 voxels' mean chord in thin air
        ((1.0, 1.0, 1.0), 1e-4, MOST),
        ((1.0, 1.0, 0.02), 1.0, MOST),  # a disk
        ((5e3, 5e3, 5e3), 5e3, FEWEST),
    ):
        found = Body.of([placed(scale)]).density(free_path_m)
        assert found is not None
        assert max(found[0].shape) == most + 2  # an empty one on each side


def test_a_thin_box_has_its_volume_in_any_placing() -> None:
    for angle in (0.0, 0.3, 1.2):
        c, s = np.cos(angle), np.sin(angle)
        turn = np.array([[c, -s, 0, 7], [s, c, 0, 0], [0, 0, 1, -4], [0, 0, 0, 1.0]])
        mesh = Mesh(box(), Material(), turn @ np.diag([2.0, 0.1, 1.0, 1.0]))
        # Measured: 1e-3. Lines in rows that do not shift have .985 of the one that is upright.
        assert enclosed_m3(Body.of([mesh]), 1.0) == pytest.approx(0.2, rel=0.004)


def test_meshes_close_a_body_together_and_a_sheet_none() -> None:
    half = box().indices[:6], box().indices[6:]
    parts = [
        Mesh(type(box())(box().positions, indices, normals=box().normals), Material())
        for indices in half
    ]
    assert Body.of(parts[:1]).holes == 1
    body = Body.of(parts)
    assert body.holes == 0
    assert enclosed_m3(body, 1.0) == pytest.approx(1.0, rel=1e-6)
    assert Body.of([placed((1.0, 1.0, 1.0), quad())]).density(1.0) is None
