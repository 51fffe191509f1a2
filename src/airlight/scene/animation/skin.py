"""Vertices that bones and morph targets move: vectorised NumPy on the host, float32.

Sources: Khronos, glTF 2.0 specification, sections 3.7.2.2 (morph targets) and 3.7.3 (skins).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import cast

import numpy as np
from numpy.typing import NDArray

from ..checks import F32, F64
from ..mesh import unit_or_up


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
    """Deltas (M, V, 3) of positions, metres, and perhaps of normals and tangents, for M targets."""

    positions: F32
    normals: F32 | None = None
    tangents: F32 | None = None


@dataclass(frozen=True, eq=False)
class Vertices:
    """Positions (V, 3), normals (V, 3) and tangents (V, 4), as a geometry has them."""

    positions: F32
    normals: F32 | None = None
    tangents: F32 | None = None


@dataclass(frozen=True, eq=False)
class Shape:
    """What a deformed geometry is made of.

    `at_rest`: its vertices, without normals where the faces give them each time.
    """

    at_rest: Vertices
    skin: Skin | None = None
    morph: Morph | None = None

    def deformed(self, weights: F64, world: F64) -> Vertices:
        """The vertices for morph `weights` (M,) and world_from_node (N, 4, 4).

        In the node's space; with a skin, in the file's.
        """
        # Morph targets first, then the skin, as the specification has it.
        vertices = self.at_rest
        if self.morph is not None:
            vertices = morphed(vertices, self.morph, weights)
        if self.skin is None:
            return vertices
        return skinned(vertices, self.skin, self.skin.matrices(world))


def morphed(vertices: Vertices, morph: Morph, weights: F64) -> Vertices:
    """The vertices with the targets' deltas added by `weights` (M,)."""
    normals, tangents = vertices.normals, vertices.tangents
    if normals is not None and morph.normals is not None:
        normals = unit_or_up(normals + _mixed(weights, morph.normals))
    # The side of the bitangent is no vector, and stays.
    if tangents is not None and morph.tangents is not None:
        moved = tangents[:, :3] + _mixed(weights, morph.tangents)
        tangents = np.concatenate([moved, tangents[:, 3:]], axis=1)
    return Vertices(vertices.positions + _mixed(weights, morph.positions), normals, tangents)


def skinned(vertices: Vertices, skin: Skin, matrices: F32) -> Vertices:
    """The vertices through the mean of their joints' `matrices` (J, 3, 4)."""
    # Each vertex's matrix is the mean of its joints', by weight.
    blended = np.zeros((len(vertices.positions), 3, 4), np.float32)
    for k in range(skin.weights.shape[1]):
        blended += skin.weights[:, k, None, None] * matrices[skin.influences[:, k]]
    linear = blended[:, :, :3]
    placed = np.einsum("vij,vj->vi", linear, vertices.positions) + blended[:, :, 3]
    a, b, c = (blended[:, :, k] for k in range(3))
    handed = np.sign(np.einsum("vi,vi->v", a, np.cross(b, c)))[:, None]
    handed = np.where(handed == 0.0, 1.0, handed).astype(np.float32)
    normals, tangents = vertices.normals, vertices.tangents
    if normals is not None:
        normals = _turned_normals(normals, (a, b, c), handed)
    # Tangents go with the surface; a mirroring matrix has bitangents on the other side.
    if tangents is not None:
        turned = np.einsum("vij,vj->vi", linear, tangents[:, :3])
        tangents = np.concatenate([turned, tangents[:, 3:] * handed], axis=1)
    return Vertices(placed, normals, tangents)


def _turned_normals(normals: F32, columns: tuple[F32, F32, F32], handed: F32) -> F32:
    """Normals through matrices of these columns (V, 3), whose determinants' signs are `handed`."""
    a, b, c = columns
    # The cofactor matrix is the inverse transpose up to its length, and exists where that does not.
    turned = (
        np.cross(b, c) * normals[:, :1]
        + np.cross(c, a) * normals[:, 1:2]
        + np.cross(a, b) * normals[:, 2:]
    )
    # A mirroring matrix turns cofactors around, so its sign goes into the normal.
    return unit_or_up(turned * handed)


def _mixed(weights: F64, deltas: F32) -> F32:
    return np.tensordot(weights.astype(np.float32), deltas, axes=1)
