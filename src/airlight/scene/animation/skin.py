"""Vertices that bones and morph targets move: vectorised NumPy on the host, float32.

Sources: Khronos, glTF 2.0 specification, sections 3.7.2.2 (morph targets) and 3.7.3 (skins).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import cast

import numpy as np
from numpy.typing import NDArray

from ..checks import F32, F64


@dataclass(frozen=True, eq=False)
class Skin:
    """`joints` (J,) are nodes, `inverse_bind` (J, 4, 4) takes a vertex to each joint's space.

    Of every vertex: `influences` (V, I), rows of `joints`, and their `weights` (V, I), which sum
    to 1.
    """

    joints: NDArray[np.int64]
    inverse_bind: F64
    influences: NDArray[np.int64]
    weights: F32

    def matrices(self, world: F64) -> F32:
        """(J, 3, 4): file_from_vertex of each joint, from world_from_node (N, 4, 4)."""
        chained = world[self.joints] @ self.inverse_bind
        return cast(F32, chained[:, :3].astype(np.float32))


@dataclass(frozen=True, eq=False)
class Morph:
    """Deltas (M, V, 3) of positions, metres, and perhaps of normals, for M targets."""

    positions: F32
    normals: F32 | None = None


@dataclass(frozen=True, eq=False)
class Shape:
    """What a deformed geometry is made of.

    `positions` (V, 3), metres; `normals` (V, 3), or None where the faces give them each time.
    """

    positions: F32
    normals: F32 | None
    skin: Skin | None = None
    morph: Morph | None = None

    def deformed(self, weights: F64, world: F64) -> tuple[F32, F32 | None]:
        """Positions and normals (V, 3) for morph `weights` (M,) and world_from_node (N, 4, 4).

        In the node's space; with a skin, in the file's.
        """
        # Morph targets first, then the skin, as the specification has it.
        positions, normals = self.positions, self.normals
        if self.morph is not None:
            positions = positions + _mixed(weights, self.morph.positions)
            if normals is not None and self.morph.normals is not None:
                normals = _unit(normals + _mixed(weights, self.morph.normals))
        if self.skin is None:
            return positions, normals
        return skinned(positions, normals, self.skin, self.skin.matrices(world))


def skinned(
    positions: F32, normals: F32 | None, skin: Skin, matrices: F32
) -> tuple[F32, F32 | None]:
    """Positions and normals (V, 3) through the mean of their joints' `matrices` (J, 3, 4)."""
    # Each vertex's matrix is the mean of its joints', by weight.
    blended = np.zeros((len(positions), 3, 4), np.float32)
    for k in range(skin.weights.shape[1]):
        blended += skin.weights[:, k, None, None] * matrices[skin.influences[:, k]]
    placed = np.einsum("vij,vj->vi", blended[:, :, :3], positions) + blended[:, :, 3]
    if normals is None:
        return placed, None
    a, b, c = (blended[:, :, k] for k in range(3))
    # The cofactor matrix is the inverse transpose up to its length, and exists where that does not.
    turned = (
        np.cross(b, c) * normals[:, :1]
        + np.cross(c, a) * normals[:, 1:2]
        + np.cross(a, b) * normals[:, 2:]
    )
    # A mirroring matrix turns cofactors around, so its sign goes into the normal.
    handed = np.sign(np.einsum("vi,vi->v", a, np.cross(b, c)))[:, None]
    return placed, _unit(turned * np.where(handed == 0.0, 1.0, handed).astype(np.float32))


def _mixed(weights: F64, deltas: F32) -> F32:
    return np.tensordot(weights.astype(np.float32), deltas, axes=1)


def _unit(vectors: F32) -> F32:
    length = np.linalg.norm(vectors, axis=1, keepdims=True)
    up = np.array((0.0, 1.0, 0.0), np.float32)
    return cast(F32, np.where(length > 0.0, vectors / np.maximum(length, 1e-30), up))
