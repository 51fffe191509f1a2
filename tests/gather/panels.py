"""What the tests of the gather share: a room's panels, and settings of a small lattice."""

from __future__ import annotations

import numpy as np

from airlight.scene import Geometry, Material, Mesh

LPV = {"resolution": 8, "shadow_resolution": 256, "map_resolution": 32, "iterations": 16}
PAINT = Material(base_color=(0.6, 0.5, 0.4), specular=0.0)
X, Y, Z = np.eye(3)


def rectangle(
    corner: np.ndarray, right: np.ndarray, down: np.ndarray, paint: Material = PAINT
) -> Mesh:
    """A parallelogram of these edges, laid onto corner + s right + t down."""
    points = np.array([corner, corner + right, corner + right + down, corner + down], np.float32)
    return Mesh(Geometry(points, np.array([[0, 1, 2], [0, 2, 3]], np.uint32)), paint)
