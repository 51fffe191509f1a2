"""A vertex's tangent as one number beside its normal; twin: wgsl/tangent_angle.wgsl.

The tangent is turned about the normal from the first axis of the normal's frame (Duff2017). Its
angle and the side of the bitangent fit into the 16-bit number that is left beside a normal of
three, so that tangents take no room of their own.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .arrays import F64
from .sampling import orthonormal_frame

STEPS = 32767
"""Of half a range of 16 bits."""


def packed_normals(normals: ArrayLike) -> NDArray[np.int16]:
    """Unit normals (V, 3) in steps of 1 / STEPS."""
    n = np.clip(np.asarray(normals, dtype=np.float64), -1.0, 1.0)
    return np.round(n * STEPS).astype(np.int16)


def packed_tangents(normals: NDArray[np.int16], tangents: ArrayLike) -> NDArray[np.int16]:
    """One number (V,) for tangents (V, 4), of normals as `packed_normals` has them (V, 3).

    The fourth component of a tangent is the side of the bitangent, 1 or -1. 0 stands for none: of
    a tangent along its normal, of length 0, or on no side.
    """
    t = np.asarray(tangents, dtype=np.float64)
    across, up = orthonormal_frame(_unit(normals))
    x, y = (np.einsum("ij,ij->i", t[:, :3], axis) for axis in (across, up))
    # Whole turns in STEPS - 1 parts, counted from 1.
    turns = np.mod(np.arctan2(y, x) / (2.0 * np.pi), 1.0)
    steps = 1.0 + np.round(turns * (STEPS - 1))
    is_there = np.hypot(x, y) > 1e-6
    return np.asarray(np.where(is_there, np.sign(t[:, 3]) * steps, 0.0), np.int16)


def tangent_of(normals: NDArray[np.int16], packed: NDArray[np.int16]) -> F64:
    """The tangents (V, 4) again, unit and at right angles to the normals; 0 for none."""
    across, up = orthonormal_frame(_unit(normals))
    angle = 2.0 * np.pi * (np.abs(packed.astype(np.float64)) - 1.0) / (STEPS - 1)
    around = np.cos(angle)[:, None] * across + np.sin(angle)[:, None] * up
    found = np.concatenate([around, np.sign(packed.astype(np.float64))[:, None]], axis=1)
    return np.asarray(np.where(packed[:, None] == 0, 0.0, found))


def _unit(normals: NDArray[np.int16]) -> F64:
    n = normals.astype(np.float64)
    return np.asarray(n / np.maximum(np.linalg.norm(n, axis=1, keepdims=True), 1.0))
