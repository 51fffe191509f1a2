"""Node transforms."""

from __future__ import annotations

import math

import numpy as np
from scipy.spatial.transform import Rotation

from airlight.scene.io.gltf_nodes import trs_matrix


def test_a_quaternion_turns_as_scipy_says():
    rng = np.random.default_rng(5)
    for _ in range(20):
        q = rng.normal(size=4)
        q /= np.linalg.norm(q)
        shift, scale = rng.normal(size=3), rng.normal(size=3)
        matrix = trs_matrix(shift, q, scale)
        expected = Rotation.from_quat(q).as_matrix() @ np.diag(scale)
        np.testing.assert_allclose(matrix[:3, :3], expected, atol=1e-12)
        np.testing.assert_array_equal(matrix[:3, 3], shift)


def test_a_quarter_turn_about_y():
    half = math.sqrt(0.5)
    matrix = trs_matrix(np.zeros(3), np.array([0, half, 0, half]), np.ones(3))
    np.testing.assert_allclose(matrix @ [1, 0, 0, 1], [0, 0, -1, 1], atol=1e-12)
